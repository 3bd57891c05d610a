//! Checks the records of a database: definitions of vehicles, accounts of runs, and the hash of the source.

use std::path::Path;

use super::{Complaint, Grade, VerifyError};
use crate::account::AccountRow;
use crate::store::Database;
use crate::vehicle::Vehicle;

/// Checks the hashes of the vehicles' definitions, the accounts of the runs, and the hash of the source.
pub(super) fn check(database: &mut Database, source: Option<&Path>) -> Result<Vec<Complaint>, VerifyError> {
    let mut complaints = Vec::new();
    let sets = database.certified()?;
    for record in database.vehicles()? {
        let hash = record.blake3();
        for set in sets.iter().filter(|set| set.vehicle_id == record.id && set.vehicle_blake3 != hash) {
            let detail = format!("its definition is not the one of its hash ({})", set.layer);
            complaints.push(malformed(format!("vehicle {}: {detail}", record.id)));
        }
        match Vehicle::from_json(&record.definition) {
            Ok(vehicle) if vehicle.id == record.id && vehicle.name == record.name => {}
            Ok(_) => {
                complaints.push(malformed(format!("vehicle {}: id or name differ from the definition", record.id)));
            }
            Err(e) => complaints.push(malformed(format!("vehicle {}: {e}", record.id))),
        }
    }
    let runs = database.runs()?;
    for (k, (run, account)) in runs.iter().enumerate() {
        complaints.extend(unbalanced(account).into_iter().map(|what| malformed(format!("run {}: {what}", k + 1))));
        if let (Some(source), Some(said)) = (source, &run.input_blake3)
            && hash_of(source)? != *said
        {
            let detail = format!("run {}: {} has another hash", k + 1, source.display());
            complaints.push(Complaint { grade: Grade::NotConfirmed, detail });
        }
    }
    Ok(complaints)
}

fn malformed(detail: String) -> Complaint {
    Complaint { grade: Grade::Malformed, detail }
}

/// The hash of a source, as databases keep it.
fn hash_of(source: &Path) -> Result<String, VerifyError> {
    #[cfg(feature = "overture")]
    if netcert_overture::is_source(source) {
        return Ok(netcert_overture::hash(&[source])?);
    }
    let unreadable = |error| VerifyError::Source { path: source.to_owned(), error };
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(std::fs::File::open(source).map_err(unreadable)?).map_err(unreadable)?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// Messages for the items of which the counts by outcome do not add up to the count that was read.
fn unbalanced(account: &[AccountRow]) -> Vec<String> {
    let parts = |total: &AccountRow| -> Option<u64> {
        let part = |row: &&AccountRow| {
            row.stage == total.stage && row.item == total.item && !["read", "noted"].contains(&row.outcome.as_str())
        };
        account.iter().filter(part).map(|row| row.count).reduce(|a, b| a + b)
    };
    let total = account.iter().filter(|row| row.outcome == "read");
    // A total without counts by outcome, such as that of strokes, has nothing to add up.
    let wrong = |row: &&AccountRow| parts(row).is_some_and(|sum| sum != row.count);
    total.filter(wrong).map(|row| format!("{} {}s of stage {} do not add up", row.count, row.item, row.stage)).collect()
}
