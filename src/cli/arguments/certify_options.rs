//! The options of `ingest` and `certify` that say how certificates are made.
//!
//! A stored set of certificates keeps its settings; `CertifiedSet::settings` returns them for a new computation. A new set takes
//! the settings of the database's ingest for every option that is not given.

use anyhow::anyhow;
use clap::{Args, ValueEnum};
use netcert::corridor::Params;
use netcert::osm::facts::Policy;
use netcert::settings::{Needs, Settings};
use netcert::stet::Options;
use netcert::store::{Database, StoreError};
use serde_json::Value;

use crate::cli::arguments::values::{metres, word};

#[derive(Args, Default)]
#[command(next_help_heading = "How certificates are made")]
pub(crate) struct CertifyOptions {
    /// The width that the vehicle may use: its own lane, all lanes of its direction, or the whole carriageway [default:
    /// lane].
    ///
    /// Several are separated by commas, as in lane,direction,carriageway. There are then certificates for each of them, and tables say in the
    /// column `uses` which is the narrowest that is safe. Of `ingest`, the first is what other verbs ask for by default.
    #[arg(long, value_name = "POLICY,...", value_parser = word::<Policy>(), value_delimiter = ',')]
    corridor: Vec<Policy>,
    /// The greatest distance between the smoothed centreline and the map's line, metres [default: 0.5].
    #[arg(long, value_name = "METRES", value_parser = metres)]
    smoothing_tolerance: Option<f64>,
    /// Width deducted on each side for errors of the map's position, metres [default: 0].
    #[arg(long, value_name = "METRES", value_parser = metres)]
    map_tolerance: Option<f64>,
    /// The greatest planned distance of the steer axle from the centreline, metres. The shift gives the trailers room
    /// in bends [default: 1.5].
    #[arg(long, value_name = "METRES", value_parser = metres)]
    max_shift: Option<f64>,
    /// The width that the vehicle may use near turns: the same as elsewhere, all lanes of its direction, or the whole
    /// carriageway [default: direction].
    ///
    /// Long vehicles use all lanes of their direction before and after a turn; `same` does not allow that. The width is never
    /// less than that of --corridor.
    #[arg(long, value_name = "POLICY")]
    turn_corridor: Option<TurnCorridor>,
    /// Certify edges only, not the turns at junctions.
    #[arg(long)]
    no_turns: bool,
    /// What is said where room is lacking of how much would be enough: `estimated` for the likely width of edges, `edges` for a
    /// certified width, which takes about a third longer, `all` for the certified kerb radius of turns, too, which takes several
    /// times as long, `off` for nothing [default: estimated].
    #[arg(long, value_name = "HOW", value_parser = word::<Needs>())]
    needs: Option<Needs>,
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
    /// The default settings with the given options in place.
    pub(crate) fn settings(&self) -> Settings {
        self.over(&Settings::default())
    }

    /// The policies that were given, each once.
    pub(crate) fn policies(&self) -> Vec<Policy> {
        let mut policies: Vec<Policy> = Vec::new();
        for &policy in &self.corridor {
            if !policies.contains(&policy) {
                policies.push(policy);
            }
        }
        policies
    }

    /// The settings `base` with the given options in place, and of several policies the first.
    pub(crate) fn over(&self, base: &Settings) -> Settings {
        Settings {
            policy: self.corridor.first().copied().unwrap_or(base.policy),
            corridor: Params {
                tolerance_m: self.smoothing_tolerance.unwrap_or(base.corridor.tolerance_m),
                map_tolerance_m: self.map_tolerance.unwrap_or(base.corridor.map_tolerance_m),
                ..base.corridor
            },
            stet: Options { max_shift_m: self.max_shift.unwrap_or(base.stet.max_shift_m), ..base.stet },
            turn_policy: self.turn_corridor.map_or(base.turn_policy, TurnCorridor::policy),
            kerbs: base.kerbs.clone(),
            turns: base.turns && !self.no_turns,
            needs: self.needs.unwrap_or(base.needs),
        }
    }
}

/// The settings for the `run` record. People read that record; no computation uses it.
pub(crate) fn parameters(settings: &Settings) -> anyhow::Result<serde_json::Map<String, Value>> {
    settings.options().map_err(|detail| anyhow!("these settings cannot be kept: {detail}"))
}

/// The policy `asked`, or the policy of the database's ingest.
pub(crate) fn policy_of(database: &mut Database, asked: Option<Policy>) -> Result<Policy, StoreError> {
    match asked {
        Some(policy) => Ok(policy),
        None => Ok(database.settings_of_new_sets()?.policy),
    }
}

/// The settings for a new set of certificates under `policy`.
pub(crate) fn of_a_new_set(database: &mut Database, policy: Policy) -> Result<Settings, StoreError> {
    Ok(Settings { policy, ..database.settings_of_new_sets()? })
}
