//! What verbs share that ask about one vehicle in a database: the vehicle, the width that it may use, and the time.

use clap::Args;
use jiff::civil::DateTime;
use netcert::osm::facts::Policy;

use crate::cli::arguments::values::{local_time, word};
use crate::cli::arguments::vehicle_files::VehicleFiles;

#[derive(Args)]
pub(crate) struct VehicleArgs {
    /// The vehicle; `netcert vehicles list` shows the ids.
    #[arg(long = "vehicle", value_name = "ID")]
    pub(crate) id: String,
    #[command(flatten)]
    pub(crate) files: VehicleFiles,
}

// A struct of its own, because verbs have other options between this one and those of the vehicle.
#[derive(Args)]
pub(crate) struct PolicyArgs {
    /// The width that the vehicle may use: its own lane, all lanes of its direction, or the whole carriageway [default:
    /// as in the database's ingest, which uses lane unless told otherwise].
    #[arg(long, value_name = "POLICY", value_parser = word::<Policy>())]
    pub(crate) corridor: Option<Policy>,
}

#[derive(Args)]
pub(crate) struct TimeArgs {
    /// The time of the journey, in local time of the place: a road that is closed at some times is judged by its rules then, and not
    /// as `unknown: time`.
    #[arg(long, value_name = "2026-12-01T08:00", value_parser = local_time)]
    pub(crate) at: Option<DateTime>,
}
