//! Finds the vehicle of an id in the catalogue, in the files of `--vehicle-file`, or in a database.

use anyhow::Context as _;
use netcert::store::Database;
use netcert::vehicle::{Catalogue, Vehicle};

use crate::cli::arguments::vehicle_args::VehicleArgs;
use crate::cli::arguments::vehicle_files::VehicleFiles;

/// The built-in catalogue extended by the user's files, and the ids of the user's vehicles.
pub(crate) struct Fleet {
    pub(crate) catalogue: Catalogue,
    pub(crate) own: Vec<String>,
}

impl VehicleFiles {
    /// The catalogue with the vehicles of these files.
    pub(crate) fn fleet(&self) -> anyhow::Result<Fleet> {
        let mut fleet = Fleet { catalogue: Catalogue::builtin()?, own: Vec::new() };
        for file in &self.paths {
            let more = Catalogue::from_path(file)?;
            fleet.own.extend(more.iter().map(|vehicle| vehicle.id.clone()));
            fleet.catalogue = fleet.catalogue.extended(more, &file.display().to_string())?;
        }
        Ok(fleet)
    }
}

/// The vehicle as the database defines it; `None` if the database does not have it.
pub(crate) fn kept(database: &mut Database, id: &str) -> anyhow::Result<Option<Vehicle>> {
    let Some(record) = database.vehicles()?.into_iter().find(|record| record.id == id) else { return Ok(None) };
    let vehicle = Vehicle::from_json(&record.definition)
        .with_context(|| format!("vehicle {id} of the database cannot be read; run `netcert ingest` again"))?;
    Ok(Some(vehicle))
}

/// The vehicle's definition. A `--vehicle-file` comes first, then the database, whose certificates were made with its own
/// definition, then the catalogue.
pub(crate) fn definition(database: &mut Database, id: &str, files: &VehicleFiles) -> anyhow::Result<Vehicle> {
    let fleet = files.fleet()?;
    match kept(database, id)? {
        Some(vehicle) if !fleet.own.iter().any(|own| own == id) => Ok(vehicle),
        _ => Ok(fleet.catalogue.get(id)?.clone()),
    }
}

impl VehicleArgs {
    /// The vehicle's definition.
    pub(crate) fn definition(&self, database: &mut Database) -> anyhow::Result<Vehicle> {
        definition(database, &self.id, &self.files)
    }

    /// Whether one of the user's files defines the vehicle.
    pub(crate) fn is_own(&self) -> anyhow::Result<bool> {
        Ok(self.files.fleet()?.own.contains(&self.id))
    }
}
