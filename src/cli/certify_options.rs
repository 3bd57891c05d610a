//! How certificates are made: the options of `ingest` and `certify`.
//!
//! A set of certificates keeps its settings, and whoever computes it again takes those: `CertifiedSet::settings`. For a set that
//! is yet to be made, what is not given is as in the database's own ingest.

use anyhow::anyhow;
use clap::{Args, ValueEnum};
use netcert::corridor::Params;
use netcert::osm::facts::Policy;
use netcert::settings::Settings;
use netcert::stet::Options;
use netcert::store::{Database, StoreError};
use serde_json::Value;

use super::values::{metres, word};

#[derive(Args, Default)]
#[command(next_help_heading = "How certificates are made")]
pub(crate) struct CertifyOptions {
    /// Which width counts: one's own lane, all lanes of one's direction, or the whole carriageway [default: lane].
    #[arg(long, value_name = "POLICY", value_parser = word::<Policy>())]
    pub(crate) corridor: Option<Policy>,
    /// How far the smoothed centreline may be from the map's line, metres [default: 0.5].
    #[arg(long, value_name = "METRES", value_parser = metres)]
    smoothing_tolerance: Option<f64>,
    /// Taken off each side for what the map's own position is worth, metres [default: 0].
    #[arg(long, value_name = "METRES", value_parser = metres)]
    map_tolerance: Option<f64>,
    /// How far the steer axle may be planned off the centreline to leave the trailers room, metres [default: 1.5].
    #[arg(long, value_name = "METRES", value_parser = metres)]
    max_shift: Option<f64>,
    /// Which width counts near turns: no more than elsewhere, all lanes of the vehicle's direction, or the whole carriageway
    /// [default: direction].
    ///
    /// Long vehicles use all lanes of their direction before and after a turn. `same` forbids that. Never less than
    /// --corridor counts.
    #[arg(long, value_name = "POLICY")]
    turn_corridor: Option<TurnCorridor>,
    /// Certify edges only, no turns.
    #[arg(long)]
    no_turns: bool,
}

/// Values of `--turn-corridor`.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TurnCorridor {
    Same,
    Direction,
    Carriageway,
}

impl TurnCorridor {
    fn policy(self) -> Policy {
        match self {
            Self::Same => Policy::Lane,
            Self::Direction => Policy::Direction,
            Self::Carriageway => Policy::Carriageway,
        }
    }
}

impl CertifyOptions {
    /// The options over the defaults.
    pub(crate) fn settings(&self) -> Settings {
        self.over(&Settings::default())
    }

    /// The options over some settings.
    pub(crate) fn over(&self, base: &Settings) -> Settings {
        Settings {
            policy: self.corridor.unwrap_or(base.policy),
            corridor: Params {
                tolerance_m: self.smoothing_tolerance.unwrap_or(base.corridor.tolerance_m),
                map_tolerance_m: self.map_tolerance.unwrap_or(base.corridor.map_tolerance_m),
                ..base.corridor
            },
            stet: Options { max_shift_m: self.max_shift.unwrap_or(base.stet.max_shift_m), ..base.stet },
            turn_policy: self.turn_corridor.map_or(base.turn_policy, TurnCorridor::policy),
            kerbs: base.kerbs.clone(),
            turns: base.turns && !self.no_turns,
        }
    }
}

/// The settings for the `run` record, which is for people: nothing is computed by it.
pub(crate) fn parameters(settings: &Settings) -> anyhow::Result<serde_json::Map<String, Value>> {
    settings.options().map_err(|detail| anyhow!("these settings cannot be kept: {detail}"))
}

/// The policy that is asked for, else that of the database's ingest.
pub(crate) fn policy_of(database: &mut Database, asked: Option<Policy>) -> Result<Policy, StoreError> {
    match asked {
        Some(policy) => Ok(policy),
        None => Ok(database.settings_of_new_sets()?.policy),
    }
}

/// What a vehicle that the database does not certify would be certified with.
pub(crate) fn of_a_new_set(database: &mut Database, policy: Policy) -> Result<Settings, StoreError> {
    Ok(Settings { policy, ..database.settings_of_new_sets()? })
}
