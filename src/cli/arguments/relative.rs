//! `--relative-to REF`: what the verbs share that compare a vehicle with a reference vehicle.

use std::io::Write;
use std::path::Path;

use clap::Args;
use netcert::osm::facts::Policy;
use netcert::rows::{Cell, CertificateRow, Relative, Standing};
use netcert::store::{Beside, DRIVABLE_BY, Database, StoreError};

use crate::cli::arguments::certify_options;

#[derive(Args)]
pub(crate) struct RelativeArgs {
    /// Compare with this vehicle on the same road: `relative_m` is the RSC less its RSC, and `as_reference` says that no
    /// more room is needed than it needs. That is a statement of its own and not `safe`. `drivable_by` compares with the
    /// vehicles that the register of measurements knows to go there, where it knows any; not for routes.
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
        for id in database.reference_ids(id)?.iter().filter(|id| *id != vehicle) {
            let set = database.certified_set(id, policy)?.ok_or_else(|| StoreError::not_certified(path, id, policy))?;
            database.reference(&set, id)?.check_turns(&mut database)?;
        }
        Ok(())
    }

    /// Refuses [`DRIVABLE_BY`] for whole routes.
    ///
    /// # Errors
    /// The reference is [`DRIVABLE_BY`].
    pub(crate) fn check_one_vehicle(&self) -> anyhow::Result<()> {
        anyhow::ensure!(
            self.relative_to.as_deref() != Some(DRIVABLE_BY),
            "--relative-to {DRIVABLE_BY} compares single edges and turns: use it with `query`, `stats` and `export`, and give a route \
             one vehicle to compare with"
        );
        Ok(())
    }
}

/// The comparison of a row, if one is asked for.
pub(crate) fn beside(
    reference: &mut Option<Beside<'_>>,
    index: u32,
    certificate: &CertificateRow,
) -> Result<Option<Relative>, StoreError> {
    reference.as_mut().map(|reference| reference.relative(index, Standing::of(certificate))).transpose()
}

/// What follows the scope of `safe` in an answer that compares.
pub(crate) fn scope(reference: &str) -> String {
    if reference == DRIVABLE_BY {
        return " `as_reference` compares with vehicles that the register of measurements knows to go there, and says nothing elsewhere: by \
                their certificates on the same road, the vehicle needs no more room than one of them. It makes nothing safe and is no \
                permit."
            .to_owned();
    }
    format!(
        " `as_reference` compares with {reference} alone: by their certificates on the same road, the vehicle needs no more room \
         than {reference}. It makes nothing safe and is no permit."
    )
}

/// The additional columns of a table for people: `relative_m`, and a word for `as_reference`.
pub(crate) fn words(relative: Relative) -> [String; 2] {
    let relative_m = relative.relative_m.map_or_else(String::new, |m| format!("{m:+.3} m"));
    let word = match relative {
        Relative { as_reference: true, .. } => "yes",
        Relative { relative_m: Some(_), .. } => "no",
        Relative { relative_m: None, .. } => "",
    };
    [relative_m, word.to_owned()]
}

/// The additional members of a JSON object.
pub(crate) fn members(relative: Relative) -> impl Iterator<Item = (String, serde_json::Value)> {
    let names = Relative::COLUMNS.map(|(name, _)| name.to_owned());
    names.into_iter().zip(relative.cells().map(|cell: Cell<'_>| cell.into()))
}

/// Prints the comparison of a route with a reference in one line.
pub(crate) fn tell(out: &mut dyn Write, id: &str, relative: Relative) -> std::io::Result<()> {
    let Some(relative_m) = relative.relative_m else {
        return writeln!(out, "  relative              no comparison with {id}: it has no RSC on this way");
    };
    let words = match relative_m {
        _ if relative.as_reference => "no more room is needed than it needs here",
        m if m < 0.0 => "more room is needed than it needs here",
        _ => "a hinge, the steering lock or the law stops it here",
    };
    writeln!(out, "  relative     {relative_m:>+8.3} m  beside {id}: {words}")
}
