//! Tests that `verify` refutes a certificate file with any member changed in the unsafe direction and a new hash, and a file with any
//! byte changed and the old hash. Prints the score.

use netcert_testing::mutations::{COLUMNS, add, each, leeway, other_side, said, scale, set, survives};
use netcert_testing::program;

use netcert::check::certificate;
use program::WorkFolder;
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
        let place = WorkFolder::empty().file("c.json", corridor);
        place.netcert(&format!("corridor c.json --vehicle {vehicle} --max-shift {shift} --out o.json")).succeeds();
        (name, String::from_utf8(place.read("o.json")).unwrap())
    };
    subjects().into_iter().map(make).collect()
}

#[test]
fn honest_files_are_confirmed() {
    for (name, text) in certificates() {
        let report = certificate(&text);
        assert!(report.confirmed() && report.unknown.is_empty(), "{name}: {}", said(&report));
    }
}

type Change = Box<dyn Fn(&mut Value) -> bool + Sync + Send>;

/// Changes, and what they are called.
#[derive(Default)]
struct Mutations(Vec<(String, Change)>);

impl Mutations {
    fn with(&mut self, name: &str, change: impl Fn(&mut Value) -> bool + Sync + Send + 'static) {
        self.0.push((name.to_owned(), Box::new(change)));
    }

    /// Single stations, and what is told of them.
    fn add_stations(&mut self, document: &Value) {
        let stations = document["corridor"]["stations"].as_array().unwrap().len();
        for k in (0..stations).step_by(stations / 3) {
            for (member, by) in [("x", 0.1), ("y", 0.1), ("heading", 0.05), ("curvature", 0.2), ("s", 0.1)] {
                self.with("station bent", move |v| add(&mut v["corridor"]["stations"][k][member], by));
            }
            for side in ["left", "right"] {
                self.with("station narrowed", move |v| scale(&mut v["corridor"]["stations"][k][side], 0.3));
            }
            self.with("plan point moved", move |v| add(&mut v["plan"][k][1], 0.1));
            self.with("tube time", move |v| set(&mut v["tubes"][0]["t"][k], json!(-1.0)));
            self.with("tube smaller", move |v| scale(&mut v["tubes"][1]["lateral_m"][k], 0.5));
            self.with("tube moved", move |v| add(&mut v["tubes"][1]["centre"][k][0], 0.5));
            self.with("tube shape", move |v| scale(&mut v["tubes"][0]["shape"][k][2], 2.0));
        }
    }

    /// The vehicle's units.
    fn add_units(&mut self, document: &Value) {
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
                self.with(&format!("unit {unit} {field}"), move |v| add(&mut v["vehicle"]["unit"][unit][field], by));
            }
        }
    }
}

/// Every member, moved in the direction that makes the certificate promise more than it may, by an amount that matters: widths and
/// leeway by 10 cm (a single station's width by 70 %, wherever it limits), the RSC by 6 cm, a body by 20 cm to some metres, ε by
/// 10 cm. What is equivalent is left out: the last unit's hitch pulls nothing.
fn mutations(document: &Value) -> Mutations {
    let mut all = Mutations::default();
    all.with("rsc up", |v| add(&mut v["rsc_m"], 0.06));
    all.with("published up", |v| add(&mut v["rsc_published_m"], 2.0));
    all.with("hinge up", |v| add(&mut v["hinge_margin_deg"], 5.0));
    all.with("safe flipped", |v| {
        let safe = v["safe"].as_bool().unwrap();
        set(&mut v["safe"], json!(!safe))
    });
    all.with("tolerance", |v| add(&mut v["tracking_tolerance_m"], 0.01));
    all.with("version", |v| set(&mut v["netcert"], json!("new")));
    all.with("max shift", |v| set(&mut v["max_shift_m"], json!(-1.0)));
    all.with("limiting side", other_side);
    all.with("limiting place", |v| add(&mut v["limiting"]["nominal_m"], -0.01));
    all.with("limiting off the corridor", |v| add(&mut v["limiting"]["s"], 300.0));
    all.with("published a little up", |v| add(&mut v["rsc_published_m"], 0.029));
    all.with("verdict", |v| {
        let other = if v["verdict"] == "safe" { "unsafe" } else { "safe" };
        set(&mut v["verdict"], json!(other))
    });
    all.with("reason", |v| {
        let other = if v["reason"] == "width" { Value::Null } else { json!("width") };
        set(&mut v["reason"], other)
    });
    all.with("no such hinge", |v| set(&mut v["hinge_unit"], json!(17)));
    all.with("half of the bounds", |v| set(&mut v["hinge_margin_deg"], Value::Null));
    all.with("times", |v| each(&mut v["tubes"][0]["t"], |t| scale(t, 0.9)));
    all.with("centres", |v| each(&mut v["tubes"][1]["centre"], |at| add(&mut at[1], 0.02)));
    for (column, first) in COLUMNS.into_iter().zip([0, 1, 1, 0]) {
        all.with("every second entry", move |v| leeway(v, column, |k, _| k % 2 == first));
        all.with("first entry", move |v| leeway(v, column, |k, _| k == 0));
        all.with("second entry", move |v| leeway(v, column, |k, _| k == 1));
        all.with("last but one entry", move |v| leeway(v, column, |k, count| k + 2 == count));
        all.with("last entry", move |v| leeway(v, column, |k, count| k + 1 == count));
    }
    all.with("limiting unit", |v| set(&mut v["limiting"]["unit"], json!(9)));
    all.with("limiting point", |v| add(&mut v["limiting"]["point_m"], 30.0));
    all.with("spacing", |v| scale(&mut v["corridor"]["spacing_m"], 1.01));
    all.with("frame", |v| set(&mut v["corridor"]["frame"]["input"], json!("lonlat")));
    let shrink = document["shrink"].as_f64().unwrap();
    if shrink < 1.0 {
        all.with("shrink up", move |v| set(&mut v["shrink"], json!((shrink + 0.4).min(1.0))));
    } else {
        all.with("shrink beyond", |v| set(&mut v["shrink"], json!(1.1)));
    }
    for side in ["left", "right"] {
        all.with("narrower", move |v| each(&mut v["corridor"]["stations"], |s| add(&mut s[side], -0.1)));
        for column in [side.to_owned(), format!("{side}_centred")] {
            all.with("leeway up", move |v| each(&mut v["leeway"][&column], |x| add(x, 0.1)));
        }
    }
    all.add_stations(document);
    all.with("plan to the left", |v| plan_moved(v, 0.3));
    all.with("plan to the right", |v| plan_moved(v, -0.3));
    all.add_units(document);
    all.with("eps", |v| add(&mut v["vehicle"]["tracking_tolerance_m"], 0.1) & add(&mut v["tracking_tolerance_m"], 0.1));
    all.with("heading tolerance", |v| add(&mut v["vehicle"]["tracking_heading_deg"], 5.0));
    for member in document.as_object().unwrap().keys() {
        let member = member.clone();
        all.with(&format!("without {member}"), move |v| v.as_object_mut().unwrap().shift_remove(&member).is_some());
    }
    all
}

/// The whole plan a little to a side, told consistently.
fn plan_moved(v: &mut Value, by_m: f64) -> bool {
    let steps = (by_m * 4096.0).round();
    v["shift"].as_array_mut().unwrap().iter_mut().for_each(|c| *c = json!(c.as_i64().unwrap() + steps as i64));
    let headings: Vec<f64> =
        v["corridor"]["stations"].as_array().unwrap().iter().map(|s| s["heading"].as_f64().unwrap()).collect();
    for (point, heading) in v["plan"].as_array_mut().unwrap().iter_mut().zip(headings) {
        add(&mut point[0], -by_m * heading.sin());
        add(&mut point[1], by_m * heading.cos());
    }
    set(&mut v["max_shift_m"], json!(9.0))
}

#[test]
fn every_member_moved_in_the_unsafe_direction_is_refuted() {
    let (mut made, mut survivors) = (0, Vec::new());
    for (name, text) in certificates() {
        let mut document: Value = serde_json::from_str(&text).unwrap();
        document.as_object_mut().unwrap().shift_remove("sha256");
        let mutations = mutations(&document).0;
        made += mutations.len();
        let alive: Vec<String> = mutations
            .par_iter()
            .filter(|(mutation, change)| {
                survives(&document, change).unwrap_or_else(|| panic!("{name}: {mutation}: nothing to change"))
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
