//! Changes of certificate files that `verify` must refute, for the files of the program (`tests/program/verify_mutations.rs`) and
//! for those of random vehicles and corridors (`tests/certificate/verify_files.rs`). A change returns whether there was anything to
//! change.

use netcert::check::{Outcome, Report, certificate};
use netcert::seal::sealed;
use serde_json::{Value, json};

/// The columns of `leeway`.
pub const COLUMNS: [&str; 4] = ["left", "right", "left_centred", "right_centred"];

pub fn set(value: &mut Value, to: Value) -> bool {
    let changed = *value != to;
    *value = to;
    changed
}

pub fn add(value: &mut Value, by: f64) -> bool {
    let Some(number) = value.as_f64() else { return false };
    set(value, json!(number + by))
}

pub fn scale(value: &mut Value, by: f64) -> bool {
    let Some(number) = value.as_f64() else { return false };
    set(value, json!(number * by))
}

/// Changes the entries of a list, of those `which` chooses by place and count.
pub fn some(list: &mut Value, which: impl Fn(usize, usize) -> bool, change: impl Fn(&mut Value) -> bool) -> bool {
    let Some(entries) = list.as_array_mut() else { return false };
    let count = entries.len();
    let chosen = entries.iter_mut().enumerate().filter(|(k, _)| which(*k, count));
    chosen.fold(false, |any, (_, entry)| change(entry) | any)
}

/// Changes all entries of a list.
pub fn each(list: &mut Value, change: impl Fn(&mut Value) -> bool) -> bool {
    some(list, |_, _| true, change)
}

/// Raises some entries of a column of leeway by 5 m.
pub fn leeway(v: &mut Value, column: &str, which: impl Fn(usize, usize) -> bool) -> bool {
    some(&mut v["leeway"][column], which, |entry| add(entry, 5.0))
}

/// Moves the limiting place to the other side, and its nominal distance with it.
pub fn other_side(v: &mut Value) -> bool {
    if v["limiting"].is_null() {
        return false;
    }
    let other = if v["limiting"]["side"] == "left" { "right" } else { "left" };
    set(&mut v["limiting"]["side"], json!(other)) & add(&mut v["limiting"]["nominal_m"], 0.05)
}

/// Whether a changed file, sealed anew, is confirmed all the same. `None`: there was nothing to change.
pub fn survives(honest: &Value, change: impl Fn(&mut Value) -> bool) -> Option<bool> {
    let mut mutant = honest.clone();
    change(&mut mutant).then(|| certificate(&sealed(&mutant)).confirmed())
}

/// The claims of a report that are not confirmed.
pub fn said(report: &Report) -> String {
    let said = report.claims.iter().filter(|(_, o)| *o != Outcome::Confirmed).map(|(c, o)| format!("{c}: {o:?}"));
    said.collect::<Vec<_>>().join("; ")
}
