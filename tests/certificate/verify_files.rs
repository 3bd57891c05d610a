//! Certificate files and the checker, on random vehicles and corridors. Every member of an honest file is confirmed. A
//! changed and newly sealed file is refuted.

use netcert_testing::mutations::{COLUMNS, add, each, leeway, other_side, said, scale, survives};
use netcert_testing::oracle::files::{OracleCase, case};
use netcert_testing::thorough;

use netcert::check::{Outcome, certificate};
use netcert::seal::sealed;
use netcert::stet::{Model, certify};
use netcert::stop::Stop;
use rayon::prelude::*;
use serde_json::{Value, json};

/// Number of cases; more with `NETCERT_THOROUGH` set.
fn cases() -> u64 {
    thorough::cases(40, 400)
}

fn written(case: &OracleCase) -> Value {
    let model = Model::new(&case.vehicle).unwrap();
    let made = certify(&case.given.corridor, &model, &case.options, &Stop::never()).unwrap().unwrap();
    netcert::certificate::json(&case.given, &model, &made, &case.options).unwrap()
}

#[test]
fn honest_files_are_confirmed() {
    let refused: Vec<String> = (0..cases())
        .into_par_iter()
        .filter_map(|index| {
            let case = case(index);
            let report = certificate(&sealed(&written(&case)));
            let well = report.confirmed() && report.unknown.is_empty();
            (!well).then(|| format!("{index}, {}: {}", case.vehicle.id, said(&report)))
        })
        .collect();
    assert!(refused.is_empty(), "{} of {} are refused: {refused:#?}", refused.len(), cases());
}

/// On these a vehicle folds up metres outside of the road, where the two programs follow it for different ways. Their entries promise nothing
/// there: what the checker does not find is a remark, and no claim is refused.
#[test]
fn entries_of_a_vehicle_that_folds_up_are_remarks() {
    for index in [1031, 1062, 1138, 1421, 1549, 2022, 2358] {
        let honest = written(&case(index));
        let report = certificate(&sealed(&honest));
        assert!(report.confirmed(), "{index}: {}", said(&report));
        assert!(report.claims.iter().any(|(_, outcome)| matches!(outcome, Outcome::Remarked(_))), "{index}");
        assert_eq!(honest["verdict"], "unsafe");
    }
}

/// Name of a change, and the change itself. It returns whether there was anything to change.
type Mutation = (&'static str, fn(&mut Value) -> bool);

/// Moves the published measure by 29 mm, or by the share of it that counts where it diverges.
fn published(v: &mut Value, towards: f64) -> bool {
    let by = v["rsc_published_m"].as_f64().map_or(0.0, |m| (5e-5 * m.abs()).max(0.029));
    add(&mut v["rsc_published_m"], towards * by)
}

/// Changes all tubes' entries of a member.
fn tubes(v: &mut Value, member: &str, change: impl Fn(&mut Value) -> bool) -> bool {
    each(&mut v["tubes"], |tube| each(&mut tube[member], &change))
}

fn verdict(v: &mut Value) -> bool {
    let safe = !v["safe"].as_bool().unwrap();
    (v["safe"], v["verdict"]) = (json!(safe), json!(if safe { "safe" } else { "unsafe" }));
    v["reason"] = if safe { Value::Null } else { json!("width") };
    true
}

fn bounded(v: &mut Value) -> bool {
    let nothing = v["rsc_m"].is_null();
    if nothing {
        (v["rsc_m"], v["hinge_margin_deg"], v["hinge_unit"]) = (json!(90.0), json!(1.0), json!(0));
        (v["safe"], v["verdict"], v["reason"]) = (json!(true), json!("safe"), Value::Null);
    }
    nothing
}

/// Changes that a file of any vehicle and corridor must not survive. Those of `tests/program/verify_mutations.rs` are more, and many of them
/// are only as large as matters for the five corridors there: a random file may promise no more after them.
const MUTATIONS: &[Mutation] = &[
    ("every second entry on the left", |v| leeway(v, COLUMNS[0], |k, _| k % 2 == 1)),
    ("every second entry on the right", |v| leeway(v, COLUMNS[1], |k, _| k % 2 == 0)),
    ("every second entry on the left, centred", |v| leeway(v, COLUMNS[2], |k, _| k % 2 == 0)),
    ("every second entry on the right, centred", |v| leeway(v, COLUMNS[3], |k, _| k % 2 == 1)),
    ("first entry", |v| leeway(v, COLUMNS[0], |k, _| k == 0)),
    ("second entry", |v| leeway(v, COLUMNS[1], |k, _| k == 1)),
    ("last entry", |v| leeway(v, COLUMNS[2], |k, count| k + 1 == count)),
    ("last entry but one", |v| leeway(v, COLUMNS[3], |k, count| k + 2 == count)),
    ("one entry", |v| leeway(v, COLUMNS[1], |k, count| k == count / 2)),
    ("centres 20 mm aside", |v| tubes(v, "centre", |at| add(&mut at[0], 0.014) & add(&mut at[1], 0.0143))),
    ("times a tenth less", |v| tubes(v, "t", |t| scale(t, 0.9))),
    ("tubes half as wide", |v| tubes(v, "lateral_m", |m| scale(m, 0.5))),
    ("published up", |v| published(v, 1.0)),
    ("published down", |v| published(v, -1.0)),
    ("RSC 1 m up", |v| add(&mut v["rsc_m"], 1.0) && v["verdict"] == "safe"),
    ("hinge margin 20° up", |v| add(&mut v["hinge_margin_deg"], 20.0)),
    ("another verdict", verdict),
    ("bounds where there are none", bounded),
    ("another reason", |v| {
        let had = !v["reason"].is_null();
        v["reason"] = json!("steering_lock_or_so");
        had
    }),
    ("more room at the limiting place", |v| !v["limiting"].is_null() && add(&mut v["limiting"]["nominal_m"], 0.02)),
    ("limiting beyond the vehicle", |v| !v["limiting"].is_null() && add(&mut v["limiting"]["point_m"], 90.0)),
    ("limiting on the other side", other_side),
];

#[test]
fn what_is_changed_and_sealed_anew_is_refuted() {
    let every = thorough::cases(4, 1);
    let all: Vec<(usize, Vec<String>)> = (0..cases())
        .step_by(every)
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|index| {
            let honest = written(&case(index));
            let (mut tried, mut alive) = (0, Vec::new());
            for (name, change) in MUTATIONS {
                let Some(survives) = survives(&honest, change) else { continue };
                tried += 1;
                if survives {
                    alive.push(format!("{index}: {name}"));
                }
            }
            (tried, alive)
        })
        .collect();
    let tried: usize = all.iter().map(|one| one.0).sum();
    let alive: Vec<&String> = all.iter().flat_map(|one| &one.1).collect();
    println!("{tried} changes, {} survive", alive.len());
    assert!(tried > 100 && alive.is_empty(), "{alive:#?}");
}
