//! Tests that `verify` refutes a certificate file with any member changed in the unsafe direction and a new hash, and a file with any
//! byte changed and the old hash. Prints the score.

use netcert_testing::program;

use netcert::check::{Outcome, Report, certificate};
use netcert::seal::sealed;
use program::Place;
use rayon::prelude::*;
use serde_json::{Value, json};

/// Name, vehicle, `--max-shift`, corridor.
fn subjects() -> Vec<(&'static str, &'static str, &'static str, String)> {
    let corridor =
        |points: &[[f64; 2]], width: f64| json!({"frame": "metres", "points": points, "width_m": width}).to_string();
    let arc = |radius: f64, degrees: i32| -> Vec<[f64; 2]> {
        let turn = (0..=degrees).step_by(5).map(|d| f64::from(d).to_radians());
        let mut points = vec![[-20.0, 0.0], [-10.0, 0.0]];
        points.extend(turn.map(|t| [radius * t.sin(), radius * (1.0 - t.cos())]));
        let end = f64::from(degrees).to_radians();
        let last = points[points.len() - 1];
        points.extend([10.0, 20.0].map(|m| [last[0] + m * end.cos(), last[1] + m * end.sin()]));
        points
    };
    let bend_back = vec![[0.0, 0.0], [40.0, 0.0], [70.0, 8.0], [100.0, 16.0], [140.0, 16.0], [180.0, 16.0]];
    vec![
        ("straight", "AU-SEMI19", "1.5", corridor(&[[0.0, 0.0], [60.0, 0.0], [100.0, 0.0]], 3.5)),
        ("bend", "AU-SEMI19", "1.5", corridor(&arc(25.0, 60), 7.5)),
        ("hinge", "EU-EMS25-C", "0", corridor(&arc(16.0, 60), 13.0)),
        ("shrunk", "US-WB62", "0.3", corridor(&arc(60.0, 30), 4.15)),
        ("s-bend", "EU-SEMI16.5", "1.0", corridor(&bend_back, 5.5)),
    ]
}

fn certificates() -> Vec<(&'static str, String)> {
    let make = |(name, vehicle, shift, corridor): (&'static str, &str, &str, String)| {
        let place = Place::empty().file("c.json", corridor);
        place.netcert(&format!("corridor c.json --vehicle {vehicle} --max-shift {shift} --out o.json")).succeeds();
        (name, String::from_utf8(place.read("o.json")).unwrap())
    };
    subjects().into_iter().map(make).collect()
}

fn refutes(report: &Report) -> bool {
    !report.confirmed()
}

fn said(report: &Report) -> String {
    let said = report.claims.iter().filter(|(_, o)| *o != Outcome::Confirmed).map(|(c, o)| format!("{c}: {o:?}"));
    said.collect::<Vec<_>>().join("; ")
}

#[test]
fn honest_files_are_confirmed() {
    for (name, text) in certificates() {
        let report = certificate(&text);
        assert!(report.confirmed() && report.unknown.is_empty(), "{name}: {}", said(&report));
    }
}

/// A change, and what it is called.
type Mutation = (String, Box<dyn Fn(&mut Value) + Sync + Send>);

fn add(value: &mut Value, by: f64) {
    *value = json!(value.as_f64().unwrap() + by);
}

fn scaled(value: &mut Value, by: f64) {
    *value = json!(value.as_f64().unwrap() * by);
}

/// Every member, moved in the direction that makes the certificate promise more than it may, by an amount that matters: widths and
/// leeway by 10 cm (a single station's width by 70 %, wherever it limits), the RSC by 6 cm, a body by 20 cm to some metres, ε by
/// 10 cm. What is equivalent is left out: the last unit's hitch pulls nothing.
fn mutations(document: &Value) -> Vec<Mutation> {
    let mut all: Vec<Mutation> = Vec::new();
    let mut with = |name: &str, change: Box<dyn Fn(&mut Value) + Sync + Send>| all.push((name.to_owned(), change));
    with("rsc up", Box::new(|v| add(&mut v["rsc_m"], 0.06)));
    with("published up", Box::new(|v| add(&mut v["rsc_published_m"], 2.0)));
    with("hinge up", Box::new(|v| add(&mut v["hinge_margin_deg"], 5.0)));
    with("safe flipped", Box::new(|v| v["safe"] = json!(!v["safe"].as_bool().unwrap())));
    with("tolerance", Box::new(|v| add(&mut v["tracking_tolerance_m"], 0.01)));
    with("version", Box::new(|v| v["netcert"] = json!("new")));
    with("max shift", Box::new(|v| v["max_shift_m"] = json!(-1.0)));
    with(
        "limiting side",
        Box::new(|v| {
            let other = if v["limiting"]["side"] == "left" { "right" } else { "left" };
            v["limiting"]["side"] = json!(other);
            add(&mut v["limiting"]["nominal_m"], 0.05);
        }),
    );
    with("limiting place", Box::new(|v| add(&mut v["limiting"]["nominal_m"], -0.01)));
    with("limiting off the corridor", Box::new(|v| add(&mut v["limiting"]["s"], 300.0)));
    with("published a little up", Box::new(|v| add(&mut v["rsc_published_m"], 0.029)));
    with("verdict", Box::new(|v| v["verdict"] = json!(if v["verdict"] == "safe" { "unsafe" } else { "safe" })));
    with("reason", Box::new(|v| v["reason"] = if v["reason"] == "width" { Value::Null } else { json!("width") }));
    with("no such hinge", Box::new(|v| v["hinge_unit"] = json!(17)));
    with("half of the bounds", Box::new(|v| v["hinge_margin_deg"] = Value::Null));
    with("times", Box::new(|v| v["tubes"][0]["t"].as_array_mut().unwrap().iter_mut().for_each(|t| scaled(t, 0.9))));
    with(
        "centres",
        Box::new(|v| v["tubes"][1]["centre"].as_array_mut().unwrap().iter_mut().for_each(|at| add(&mut at[1], 0.02))),
    );
    for (column, first) in [("left", 0), ("right", 1), ("left_centred", 1), ("right_centred", 0)] {
        with(
            "every second entry",
            Box::new(move |v| {
                let entries = v["leeway"][column].as_array_mut().unwrap().iter_mut();
                entries.skip(first).step_by(2).for_each(|entry| add(entry, 5.0));
            }),
        );
        for place in ["first", "second", "last but one", "last"] {
            with(
                &format!("{place} entry"),
                Box::new(move |v| {
                    let entries = v["leeway"][column].as_array_mut().unwrap();
                    let last = entries.len() - 1;
                    let k = match place {
                        "first" => 0,
                        "second" => 1,
                        "last" => last,
                        _ => last - 1,
                    };
                    add(&mut entries[k], 5.0);
                }),
            );
        }
    }
    with("limiting unit", Box::new(|v| v["limiting"]["unit"] = json!(9)));
    with("limiting point", Box::new(|v| add(&mut v["limiting"]["point_m"], 30.0)));
    with("spacing", Box::new(|v| scaled(&mut v["corridor"]["spacing_m"], 1.01)));
    with("frame", Box::new(|v| v["corridor"]["frame"]["input"] = json!("lonlat")));
    if document["shrink"].as_f64().unwrap() < 1.0 {
        with(
            "shrink up",
            Box::new(|v| {
                let shrink = v["shrink"].as_f64().unwrap();
                v["shrink"] = json!((shrink + 0.4).min(1.0));
            }),
        );
    } else {
        with("shrink beyond", Box::new(|v| v["shrink"] = json!(1.1)));
    }
    for side in ["left", "right"] {
        with(
            "narrower",
            Box::new(move |v| {
                v["corridor"]["stations"].as_array_mut().unwrap().iter_mut().for_each(|s| add(&mut s[side], -0.1));
            }),
        );
        for column in [side.to_owned(), format!("{side}_centred")] {
            with(
                "leeway up",
                Box::new(move |v| {
                    v["leeway"][&column].as_array_mut().unwrap().iter_mut().for_each(|x| add(x, 0.1));
                }),
            );
        }
    }
    let stations = document["corridor"]["stations"].as_array().unwrap().len();
    for k in (0..stations).step_by(stations / 3) {
        for (member, by) in [("x", 0.1), ("y", 0.1), ("heading", 0.05), ("curvature", 0.2), ("s", 0.1)] {
            with("station bent", Box::new(move |v| add(&mut v["corridor"]["stations"][k][member], by)));
        }
        for side in ["left", "right"] {
            with("station narrowed", Box::new(move |v| scaled(&mut v["corridor"]["stations"][k][side], 0.3)));
        }
        with("plan point moved", Box::new(move |v| add(&mut v["plan"][k][1], 0.1)));
        with("tube time", Box::new(move |v| v["tubes"][0]["t"][k] = json!(-1.0)));
        with("tube smaller", Box::new(move |v| scaled(&mut v["tubes"][1]["lateral_m"][k], 0.5)));
        with("tube moved", Box::new(move |v| add(&mut v["tubes"][1]["centre"][k][0], 0.5)));
        with("tube shape", Box::new(move |v| scaled(&mut v["tubes"][0]["shape"][k][2], 2.0)));
    }
    with("plan to the left", Box::new(|v| plan_moved(v, 0.3)));
    with("plan to the right", Box::new(|v| plan_moved(v, -0.3)));
    let units = document["vehicle"]["unit"].as_array().unwrap().len();
    for unit in 0..units {
        for (field, by) in [
            ("width_m", 0.2),
            ("coupling_to_axle_m", 0.5),
            ("hitch_offset_m", -0.4),
            ("front_overhang_m", if unit == 0 { 1.0 } else { 6.0 }),
            ("rear_overhang_m", if unit == 0 { 8.0 } else { 1.0 }),
            ("sway_deg", 0.5),
            ("max_articulation_deg", -30.0),
        ] {
            if field == "hitch_offset_m" && unit + 1 == units {
                continue;
            }
            with(&format!("unit {unit} {field}"), Box::new(move |v| add(&mut v["vehicle"]["unit"][unit][field], by)));
        }
    }
    with(
        "eps",
        Box::new(|v| {
            add(&mut v["vehicle"]["tracking_tolerance_m"], 0.1);
            add(&mut v["tracking_tolerance_m"], 0.1);
        }),
    );
    with("heading tolerance", Box::new(|v| add(&mut v["vehicle"]["tracking_heading_deg"], 5.0)));
    for member in document.as_object().unwrap().keys().filter(|name| *name != "sha256") {
        let member = member.clone();
        with(
            &format!("without {member}"),
            Box::new(move |v| {
                v.as_object_mut().unwrap().shift_remove(&member);
            }),
        );
    }
    all
}

/// The whole plan a little to a side, told consistently.
fn plan_moved(v: &mut Value, by_m: f64) {
    let steps = (by_m * 4096.0).round();
    v["shift"].as_array_mut().unwrap().iter_mut().for_each(|c| *c = json!(c.as_i64().unwrap() + steps as i64));
    let headings: Vec<f64> =
        v["corridor"]["stations"].as_array().unwrap().iter().map(|s| s["heading"].as_f64().unwrap()).collect();
    for (point, heading) in v["plan"].as_array_mut().unwrap().iter_mut().zip(headings) {
        add(&mut point[0], -by_m * heading.sin());
        add(&mut point[1], by_m * heading.cos());
    }
    v["max_shift_m"] = json!(9.0);
}

#[test]
fn every_member_moved_in_the_unsafe_direction_is_refuted() {
    let (mut made, mut survivors) = (0, Vec::new());
    for (name, text) in certificates() {
        let mut document: Value = serde_json::from_str(&text).unwrap();
        document.as_object_mut().unwrap().shift_remove("sha256");
        let mutations = mutations(&document);
        made += mutations.len();
        let alive: Vec<String> = mutations
            .par_iter()
            .filter(|(_, change)| {
                let mut mutant = document.clone();
                change(&mut mutant);
                !refutes(&certificate(&sealed(&mutant)))
            })
            .map(|(mutation, _)| format!("{name}: {mutation}"))
            .collect();
        survivors.extend(alive);
    }
    println!("mutation score: {} of {made}", made - survivors.len());
    assert!(survivors.is_empty(), "{} survive: {survivors:#?}", survivors.len());
}

#[test]
fn a_byte_changed_without_the_hash_is_refuted() {
    let (_, text) = &certificates()[0];
    let bytes = text.as_bytes();
    // Every byte of the ends, every 97th between (97 is prime to the lengths of all tuples), one bit each.
    let places = (0..bytes.len() - 1).filter(|k| k % 97 == 0 || *k < 2000 || *k + 200 > bytes.len());
    let (mut tried, mut alive) = (0, 0);
    for k in places {
        let mut mutant = bytes.to_vec();
        mutant[k] ^= 1 << (k % 8);
        tried += 1;
        if std::str::from_utf8(&mutant).is_ok_and(|text| certificate(text).confirmed()) {
            alive += 1;
        }
    }
    println!("{tried} bytes changed");
    assert_eq!(alive, 0);
}
