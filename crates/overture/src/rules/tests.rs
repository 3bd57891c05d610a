// `json!` takes what it is given.
#![allow(clippy::unwrap_used, clippy::needless_pass_by_value)]
use proptest::prelude::*;
use serde_json::{Value, json};

use super::*;
use crate::record::Segment;
use crate::vehicle::{Catalogue, Vehicle};
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};

fn rules(segment: Value) -> (SegmentRules, Account) {
    let mut account = Account::default();
    let segment: Segment = serde_json::from_value(segment).unwrap();
    let rules = SegmentRules::of(&segment, &mut account);
    (rules, account)
}

fn whole(access: Value) -> (RoadValues, Account) {
    let (rules, account) = rules(json!({"access_restrictions": access}));
    (rules.road(RoadClass::Secondary, [0.0, 1.0]), account)
}

fn semi() -> Vehicle {
    Catalogue::builtin().unwrap().get("EU-SEMI16.5").unwrap().clone()
}

/// Rows of rules: outcome, reason, count.
fn counts(account: &Account) -> Vec<(String, String, u64)> {
    let rows = account.rows().into_iter().filter(|row| row.item == "rule");
    rows.map(|row| (row.outcome, row.reason, row.count)).collect()
}

fn verdicts(road: &RoadValues) -> [Option<Verdict>; 2] {
    road.legal.clone().map(|legal| legal.forbids(&semi()))
}

#[test]
fn a_oneway_is_a_denial_for_everybody_and_a_ban_of_lorries_is_none() {
    let (road, _) = whole(json!([{"access_type": "denied", "when": {"heading": "backward"}}]));
    assert_eq!((road.oneway, verdicts(&road)[0]), (Oneway::Forward, None));
    let (road, _) = whole(json!([{"access_type": "denied", "when": {"heading": "backward", "mode": ["hgv"]}}]));
    assert_eq!((road.oneway, verdicts(&road)), (Oneway::No, [None, Some(Verdict::Forbidden(ForbiddenReason::Hgv))]));
    let both = json!([
        {"access_type": "denied", "when": {"heading": "backward"}},
        {"access_type": "allowed", "when": {"heading": "backward", "mode": ["truck"]}}]);
    assert_eq!((whole(both.clone()).0.oneway, verdicts(&whole(both).0)), (Oneway::No, [None, None]));
}

#[test]
fn sizes_are_limits_under_the_bounds_of_tags() {
    let size = |dimension: &str, comparison: &str, value: f64, unit: &str| {
        let size = json!({"dimension": dimension, "comparison": comparison, "value": value, "unit": unit});
        let (road, _) = whole(json!([{"access_type": "denied", "when": {"vehicle": [size]}}]));
        assert_eq!(road.legal[0], road.legal[1]);
        road.legal[0].clone()
    };
    assert_eq!(size("height", "greater_than", 3.8, "m").max_height, Limit::At(3.8));
    assert_eq!(size("height", "greater_than", 12.0, "ft").max_height, Limit::At(3.6576));
    assert_eq!(size("weight", "greater_than", 7500.0, "kg").max_weight, Limit::At(7.5));
    assert_eq!(size("weight", "greater_than", 7500.0, "t").max_weight, Limit::Unreadable);
    let to_length = |comparison, value| size("length", comparison, value, "m").forbids(&semi());
    assert_eq!(to_length("greater_than", 16.5), None);
    assert_eq!(to_length("greater_than_equal", 16.5), Some(Verdict::Forbidden(ForbiddenReason::Length)));
    assert_eq!(to_length("greater_than_equal", 16.6), None);
    for unclear in [
        size("length", "less_than", 5.0, "m"),
        size("axle_count", "less_than", 4.0, ""),
        size("height", "equal", 4.0, "m"),
    ] {
        assert_eq!(unclear.forbids(&semi()), Some(Verdict::Unknown(UnknownReason::Limit)));
    }
}

#[test]
fn buses_axles_and_times_have_rules_of_their_own() {
    let vehicle = |id: &str| Catalogue::builtin().unwrap().get(id).unwrap().clone();
    let (lorry, bus) = (vehicle("EU-SEMI16.5"), vehicle("BUS-ART18-EU"));
    let said = |access: Value| {
        let legal = whole(access).0.legal[0].clone();
        [&lorry, &bus].map(|vehicle| legal.forbids(vehicle))
    };
    let forbidden = |reason| Some(Verdict::Forbidden(reason));
    let time = Some(Verdict::Unknown(UnknownReason::Time));
    for (access, expected) in [
        (json!([{"access_type": "denied", "when": {"mode": ["bus"]}}]), [None, forbidden(ForbiddenReason::Class)]),
        (json!([{"access_type": "denied", "when": {"mode": ["hgv"]}}]), [forbidden(ForbiddenReason::Hgv), None]),
        (
            json!([{"access_type": "denied", "when": {"mode": ["motor_vehicle"]}}, {"access_type": "allowed", "when": {"mode": ["bus"]}}]),
            [forbidden(ForbiddenReason::Access), None],
        ),
        (json!([{"access_type": "denied"}]), [forbidden(ForbiddenReason::Access); 2]),
        (json!([{"access_type": "denied", "when": {"during": "22:00-06:00"}}]), [time; 2]),
        (json!([{"access_type": "denied", "when": {"during": "22:00-06:00", "mode": ["bus"]}}]), [None, time]),
        (
            json!([{"access_type": "denied", "when": {"vehicle": [{"dimension": "axle_count", "comparison": "greater_than", "value": 4}]}}]),
            [forbidden(ForbiddenReason::Axles), None],
        ),
        (
            json!([{"access_type": "denied", "when": {"mode": ["bus"], "vehicle": [{"dimension": "length", "comparison": "greater_than", "value": 12, "unit": "m"}]}}]),
            [None, forbidden(ForbiddenReason::Length)],
        ),
    ] {
        assert_eq!(said(access.clone()), expected, "{access}");
    }
}

#[test]
fn what_is_not_understood_closes_and_never_opens() {
    for strange in [
        json!({"access_type": "denied", "when": {"mode": ["land_train"]}}),
        json!({"access_type": "denied", "when": {"weather": "snow"}}),
        json!({"access_type": "forbidden_somehow"}),
        json!({"access_type": "denied", "when": {"heading": "sideways"}}),
        json!({"access_type": "denied", "between": [0.7, 0.2]}),
    ] {
        let (road, account) = whole(json!([strange]));
        let closed = |verdict: Option<Verdict>| matches!(verdict, Some(Verdict::Forbidden(_)));
        assert!(verdicts(&road).into_iter().all(closed), "{strange}");
        assert_eq!(counts(&account)[1], ("kept".to_owned(), String::new(), 1), "{strange}");
    }
    for lenient in [
        json!({"access_type": "allowed", "when": {"mode": ["land_train"]}}),
        json!({"access_type": "allowed", "when": {"weather": "snow"}}),
        json!({"access_type": "allowed", "when": {"during": "22:00-06:00"}}),
        json!({"access_type": "allowed", "when": {"recognized": ["as_private"]}}),
        json!({"access_type": "allowed", "when": {"vehicle": [{"dimension": "length", "comparison": "less_than", "value": 30, "unit": "m"}]}}),
        json!({"access_type": "allowed", "between": [0.7, 0.2]}),
        json!({"access_type": "allowed", "when": {"mode": ["foot"]}}),
    ] {
        let (road, account) = whole(json!([{"access_type": "denied"}, lenient]));
        assert_eq!(verdicts(&road), [Some(Verdict::Forbidden(ForbiddenReason::Access)); 2], "{lenient}");
        assert_eq!(counts(&account)[2].2, 1, "{lenient}");
    }
}

#[test]
fn conditions_and_purposes_are_read_as_those_of_tags() {
    let road = |access| whole(access).0.legal[0].clone();
    let at_night = road(json!([{"access_type": "denied", "when": {"during": "22:00-06:00"}}]));
    assert_eq!((at_night.motor_vehicle, at_night.hgv), (Permission::Restricted, Permission::Yes));
    let delivery = json!([{"access_type": "denied", "when": {"mode": ["hgv"]}}, {"access_type": "allowed", "when": {"mode": ["hgv"], "using": ["to_deliver"]}}]);
    assert_eq!(road(delivery).hgv, Permission::Restricted);
    let but_lorries = json!([{"access_type": "denied"}, {"access_type": "designated", "when": {"mode": ["hgv"]}}]);
    assert_eq!(road(but_lorries).forbids(&semi()), None);
    // Less specific than the ban that stands before it.
    let general = json!([{"access_type": "denied", "when": {"mode": ["hgv"]}}, {"access_type": "allowed", "when": {"mode": ["vehicle"]}}]);
    assert_eq!(road(general).hgv, Permission::No);
}

#[test]
fn parts_have_their_own_width_speed_and_closure() {
    let (rules, account) = rules(json!({
        "width_rules": [{"value": 7.0}, {"value": 5.5, "between": [0.5, 1.0]}, {"value": null}],
        "speed_limits": [
            {"max_speed": {"value": 30, "unit": "mph"}},
            {"max_speed": {"value": 30, "unit": "km/h"}, "when": {"heading": "forward", "mode": ["hgv"]}, "between": [0.0, 0.5]},
            {"max_speed": {"value": 90, "unit": "km/h"}, "when": {"mode": ["car"]}},
            {"max_speed": {"value": 20, "unit": "km/h"}, "when": {"during": "Mo-Fr"}}],
        "road_flags": [{"values": ["is_bridge"]}, {"values": ["is_under_construction"], "between": [0.75, 1.0]}, {"values": ["is_link"]}],
        "road_surface": [{"value": "paved"}], "level_rules": [{"value": 1}],
        "routes": [{"ref": "B 3"}, {"ref": "B 37", "between": [0.0, 0.5]}, {"ref": "B 3"}],
    }));
    assert_eq!(rules.changes(), [0.5, 0.75]);
    let [first, second, third] =
        [[0.0, 0.5], [0.5, 0.75], [0.75, 1.0]].map(|part| rules.road(RoadClass::Primary, part));
    assert_eq!((first.width_m, second.width_m), (Some(7.0), Some(5.5)));
    assert_eq!(first.max_speed_km_h.map(|limit| limit.unwrap().get()), [30, 48]);
    assert_eq!(second.max_speed_km_h.map(|limit| limit.unwrap().get()), [48, 48]);
    assert_eq!(verdicts(&second), [None; 2]);
    assert_eq!(verdicts(&third), [Some(Verdict::Forbidden(ForbiddenReason::Access)); 2]);
    assert!(first.link && rules.reference([0.0, 0.5]).as_deref() == Some("B 3;B 37"));
    assert_eq!(rules.reference([0.5, 0.75]).as_deref(), Some("B 3"));
    let left_out: Vec<String> =
        counts(&account).into_iter().filter(|row| row.0 == "left_out").map(|row| row.1).collect();
    assert_eq!(
        left_out,
        ["level", "other_vehicles", "road_flags", "road_surface", "speed_conditional", "width_unreadable"]
    );
    assert_eq!(
        counts(&account)[0].2,
        counts(&account).iter().filter(|row| row.0 != "read" && row.0 != "noted").map(|row| row.2).sum::<u64>()
    );
}

/// What the schema says of a lorry: the last rule that matches decides. Sizes are compared as they are.
fn denied_by_schema(access: &Value, heading: &str, vehicle: &Vehicle) -> bool {
    let matches = |rule: &&Value| {
        let when = &rule["when"];
        let mode = when["mode"].as_array().is_none_or(|modes| {
            modes.iter().any(|mode| ["vehicle", "motor_vehicle", "truck", "hgv"].contains(&mode.as_str().unwrap()))
        });
        let sizes = when["vehicle"].as_array().is_none_or(|sizes| {
            sizes.iter().all(|size| {
                let ours = match size["dimension"].as_str().unwrap() {
                    "length" => vehicle.length_m,
                    "width" => vehicle.width_m(),
                    "height" => vehicle.height_m.unwrap(),
                    _ => vehicle.gross_mass_t.unwrap(),
                };
                let bound = size["value"].as_f64().unwrap();
                match size["comparison"].as_str().unwrap() {
                    "greater_than" => ours > bound,
                    "greater_than_equal" => ours >= bound,
                    "less_than" => ours < bound,
                    _ => ours <= bound,
                }
            })
        });
        mode && sizes && when["heading"].as_str().is_none_or(|only| only == heading)
    };
    let last = access.as_array().unwrap().iter().rfind(matches);
    last.is_some_and(|rule| rule["access_type"] == "denied")
}

fn any_rule() -> impl Strategy<Value = Value> {
    let size = (0..4_usize, 0..4_usize, 1..60_u32).prop_map(|(dimension, comparison, value)| {
        let unit = if dimension == 3 { "t" } else { "m" };
        // A tenth and a bit: no vehicle has such a size, so rounding of limits does not matter.
        let value = f64::from(value) + 0.137;
        let dimension = ["length", "width", "height", "weight"][dimension];
        let comparison = ["greater_than", "greater_than_equal", "less_than", "less_than_equal"][comparison];
        json!({"dimension": dimension, "comparison": comparison, "value": value, "unit": unit})
    });
    let modes = prop::sample::subsequence(vec!["vehicle", "motor_vehicle", "hgv", "truck", "bus", "foot", "car"], 1..3);
    let heading = prop::sample::select(vec!["forward", "backward"]);
    let kind = prop::sample::select(vec!["denied", "denied", "allowed", "designated"]);
    let sizes = prop::collection::vec(size, 1..3);
    (kind, prop::option::of(heading), prop::option::of(modes), prop::option::weighted(0.4, sizes)).prop_map(
        |(kind, heading, modes, sizes)| {
            let when = json!({"heading": heading, "mode": modes, "vehicle": sizes});
            json!({"access_type": kind, "when": when})
        },
    )
}

proptest! {
    #[test]
    fn no_road_is_more_open_than_the_schema_says(access in prop::collection::vec(any_rule(), 0..6)) {
        let mut vehicle = semi();
        vehicle.height_m.get_or_insert(4.0);
        vehicle.gross_mass_t.get_or_insert(40.0);
        let access = Value::Array(access);
        let (road, account) = whole(access.clone());
        let gone = [road.oneway == Oneway::Backward, road.oneway == Oneway::Forward];
        for (i, heading) in ["forward", "backward"].into_iter().enumerate() {
            if denied_by_schema(&access, heading, &vehicle) {
                prop_assert!(gone[i] || road.legal[i].forbids(&vehicle).is_some(), "{heading}: {access}");
            }
        }
        let counts = counts(&account);
        let sum: u64 = counts.iter().filter(|row| row.0 == "kept" || row.0 == "left_out").map(|row| row.2).sum();
        prop_assert_eq!((counts[0].2, sum), (access.as_array().unwrap().len() as u64, sum));
    }
}
