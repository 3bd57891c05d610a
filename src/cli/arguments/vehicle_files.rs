//! `--vehicle-file`: files of the user's vehicles.

use std::path::PathBuf;

use clap::Args;

/// Files of vehicles that are looked up beside the catalogue. A verb for which the help text is not right replaces it with `mut_arg`.
#[derive(Args)]
pub(crate) struct VehicleFiles {
    /// A file that defines the vehicle, if neither the catalogue nor the database does.
    #[arg(id = VehicleFiles::ID, long = "vehicle-file", value_name = "F.toml")]
    pub(crate) paths: Vec<PathBuf>,
}

impl VehicleFiles {
    /// The argument's id.
    pub(crate) const ID: &str = "vehicle_file";
}
