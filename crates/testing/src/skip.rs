//! Judges that are not there. A test without its judge says so and passes. `.ci/run` lists them at its end, and fails for each that the
//! machine has after all.

use std::fs::OpenOptions;
use std::io::Write;

/// Says that a test is skipped without this judge, and why. `judge` is the name of a program, of an extract, or of what else is asked. A name
/// that is neither must be known to `is_here` of `.ci/run`: other names with a space fail there.
pub fn skipped(judge: &str, why: &str) {
    eprintln!("skipped: no {judge} ({why})");
    let Some(list) = std::env::var_os("NETCERT_SKIPPED") else { return };
    let mut list = OpenOptions::new().create(true).append(true).open(list).unwrap();
    list.write_all(format!("{judge}\t{why}\n").as_bytes()).unwrap();
}
