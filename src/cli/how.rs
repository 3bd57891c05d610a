//! How certificates are made: the options, and what an existing database was made with.
//!
//! What is not given is as in the database's own ingest, so that certificates made later stand beside the first ones on
//! the same terms.

use clap::Args;
use netcert::corridor::Params;
use netcert::osm::facts::Policy;
use netcert::pipeline::Settings;
use netcert::stet::Options;
use netcert::store::{Database, Named, StoreError};
use serde_json::{Value, json};

use super::values::{metres, word};

#[derive(Args, Default)]
#[command(next_help_heading = "How certificates are made")]
pub(crate) struct How {
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
    /// Certify edges only, no turns.
    #[arg(long)]
    no_turns: bool,
}

impl How {
    /// The options over the defaults.
    pub(crate) fn settings(&self) -> Settings {
        self.over(&default_settings())
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
            turns: base.turns && !self.no_turns,
        }
    }
}

fn default_settings() -> Settings {
    Settings { policy: Policy::Lane, corridor: Params::default(), stet: Options::default(), turns: true }
}

/// What the database's ingest was given.
pub(crate) fn recorded(database: &mut Database) -> Result<Settings, StoreError> {
    let runs = database.runs()?;
    let ingest = runs.iter().rev().find(|(run, _)| run.command == "ingest");
    let parameters: Value = ingest.and_then(|(run, _)| serde_json::from_str(&run.parameters).ok()).unwrap_or_default();
    let number = |name: &str, default: f64| parameters[name].as_f64().unwrap_or(default);
    let Settings { policy, corridor, stet, turns } = default_settings();
    Ok(Settings {
        policy: parameters["corridor"].as_str().and_then(Policy::named).unwrap_or(policy),
        corridor: Params {
            tolerance_m: number("smoothing_tolerance_m", corridor.tolerance_m),
            map_tolerance_m: number("map_tolerance_m", corridor.map_tolerance_m),
            ..corridor
        },
        stet: Options { max_shift_m: number("max_shift_m", stet.max_shift_m), ..stet },
        turns: parameters["turns"].as_bool().unwrap_or(turns),
    })
}

/// All of it, for the `run` record; [`recorded`] reads it again.
pub(crate) fn parameters(settings: &Settings) -> serde_json::Map<String, Value> {
    let Settings { policy, corridor, stet, turns } = settings;
    let pairs = [
        ("corridor", json!(policy.name())),
        ("smoothing_tolerance_m", json!(corridor.tolerance_m)),
        ("smoothing_cutoff_m", json!(corridor.cutoff_m)),
        ("map_tolerance_m", json!(corridor.map_tolerance_m)),
        ("station_spacing_m", json!(corridor.spacing_m)),
        ("lead_in_m", json!(corridor.lead_in_m)),
        ("max_shift_m", json!(stet.max_shift_m)),
        ("correction_sweeps", json!(stet.correction_sweeps)),
        ("turns", json!(turns)),
    ];
    pairs.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}
