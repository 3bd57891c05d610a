//! Certificate files against the checker, on random vehicles and corridors: what is honestly written is confirmed in every member, and
//! what is changed and sealed anew is refuted.

use crate::oracle::files::{Case, case};

use netcert::check::{Outcome, Report, certificate, sealed};
use netcert::stet::{Model, certify};
use rayon::prelude::*;
use serde_json::{Value, json};

/// A quick run, and one with `NETCERT_THOROUGH` set.
fn cases() -> u64 {
    if std::env::var_os("NETCERT_THOROUGH").is_some() { 400 } else { 40 }
}

fn written(case: &Case) -> Value {
    let model = Model::new(&case.vehicle).unwrap();
    let made = certify(&case.given.corridor, &model, &case.options).unwrap();
    netcert::certificate::json(&case.given, &model, &made, &case.options).unwrap()
}

fn said(report: &Report) -> String {
    let said = report.claims.iter().filter(|(_, o)| *o != Outcome::Confirmed).map(|(c, o)| format!("{c}: {o:?}"));
    said.collect::<Vec<_>>().join("; ")
}

#[test]
fn honest_files_are_confirmed() {
    let first = std::env::var("FIRST").map_or(0, |s| s.parse().unwrap());
    let refused: Vec<String> = (first..first + cases())
        .into_par_iter()
        .filter_map(|index| {
            let case = case(index);
            let document = written(&case);
            let report = certificate(&sealed(&document));
            let line = format!("{index} {} rsc {} safe {}: {}", case.vehicle.id, document["rsc_m"], document["safe"], said(&report));
            (!report.confirmed()).then_some(line)
        })
        .collect();
    for line in &refused {
        println!("{line}");
    }
    assert!(refused.is_empty(), "{} refused", refused.len());
}
