//! `--relative-to REF`: what the verbs share that compare a vehicle with a reference vehicle.

use std::path::Path;

use clap::Args;
use netcert::osm::facts::Policy;
use netcert::store::{ATTESTED, DRIVABLE_BY, Database, StoreError};

use crate::cli::arguments::certify_options;

#[derive(Args)]
pub(crate) struct RelativeArgs {
    /// Compare with this vehicle on the same road: `relative_m` is the RSC less its RSC, and `as_reference` says that no
    /// more room is needed than it needs. That is a statement of its own and not `safe`. `drivable_by` compares with the
    /// vehicles that the register of measurements knows to go there, where it knows any. `attested` compares with these and with
    /// the certified vehicles that signs on the map admit there. Both are not for routes.
    #[arg(long, value_name = "REF")]
    pub(crate) relative_to: Option<String>,
}

impl RelativeArgs {
    /// Checks that the reference is certified under the policy, turns included. `vehicle` is certified on demand, so it may be
    /// the reference and not there yet.
    pub(crate) fn check(&self, path: &Path, vehicle: &str, asked: Option<Policy>) -> anyhow::Result<()> {
        let Some(id) = self.relative_to.as_deref().filter(|id| *id != vehicle) else { return Ok(()) };
        let mut database = Database::open(path)?;
        let policy = certify_options::policy_of(&mut database, asked)?;
        for id in database.reference_ids(id, vehicle, policy)?.iter().filter(|id| *id != vehicle) {
            let set = database.certified_set(id, policy)?.ok_or_else(|| StoreError::not_certified(path, id, policy))?;
            database.reference(&set, id)?.check_turns(&mut database)?;
        }
        Ok(())
    }

    /// Refuses references that differ from road to road, for whole routes.
    ///
    /// # Errors
    /// The reference is [`DRIVABLE_BY`] or [`ATTESTED`].
    pub(crate) fn check_one_vehicle(&self) -> anyhow::Result<()> {
        let several = self.relative_to.as_deref().filter(|id| [DRIVABLE_BY, ATTESTED].contains(id));
        anyhow::ensure!(
            several.is_none(),
            "--relative-to {} compares single edges and turns: use it with `query`, `stats` and `export`, and give a route \
             one vehicle to compare with",
            several.unwrap_or_default()
        );
        Ok(())
    }
}
