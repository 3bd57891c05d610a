//! A folder of changes in the layout of planet replication: `state.txt` has the number of the last file, and file 1,234,567 is
//! `001/234/567.osc.gz`.

use std::path::{Path, PathBuf};

use crate::error::RunError;
use crate::osm::changes::ChangeError;

/// Most files of one update: two weeks of minutes. Beyond that a newer extract is faster.
const MOST_FILES: i64 = 20_160;

/// The files after a number, the earliest first, and the number of the last one.
///
/// # Errors
/// The folder has no readable state, lacks a file, or ends before the number.
pub(super) fn files_after(folder: &Path, from: Option<i64>) -> Result<(Vec<PathBuf>, i64), RunError> {
    let state = folder.join("state.txt");
    let text = std::fs::read_to_string(&state).map_err(|error| ChangeError::new(&state, None, error.to_string()))?;
    let last: i64 = text
        .lines()
        .find_map(|line| line.trim().strip_prefix("sequenceNumber=")?.trim().parse().ok())
        .ok_or_else(|| ChangeError::new(&state, None, "it has no sequenceNumber"))?;
    let Some(from) = from else {
        return Err(RunError::Misfit(format!(
            "{}: the extract does not say at which number of the sequence it stands; say it with --after NUMBER",
            folder.display()
        )));
    };
    if last < from {
        return Err(RunError::Misfit(format!(
            "{}: its last change has the number {last}, and the database stands at {from}; this folder is older or of another sequence",
            folder.display()
        )));
    }
    if last - from > MOST_FILES {
        return Err(RunError::Misfit(format!(
            "{}: {} changes are more than {MOST_FILES}; update to a newer extract with --new-extract",
            folder.display(),
            last - from
        )));
    }
    let files: Vec<PathBuf> = (from + 1..=last).map(|number| folder.join(path_of(number))).collect();
    match (from + 1..).zip(&files).find(|(_, file)| !file.is_file()) {
        Some((number, file)) => Err(RunError::Misfit(format!(
            "{}: change {number} is missing; fetch it, as no later one may be applied without it",
            file.display()
        ))),
        None => Ok((files, last)),
    }
}

fn path_of(number: i64) -> String {
    let (high, middle, low) = (number / 1_000_000, number / 1000 % 1000, number % 1000);
    format!("{high:03}/{middle:03}/{low:03}.osc.gz")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_lie_where_the_planet_has_them() {
        assert_eq!(path_of(6_234_567), "006/234/567.osc.gz");
        assert_eq!(path_of(12), "000/000/012.osc.gz");
    }
}
