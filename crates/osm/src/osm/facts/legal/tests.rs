//! Tags to verdicts, for vehicles of the catalogue.
#![allow(clippy::unwrap_used)]

use jiff::civil::date;
use proptest::prelude::*;

use super::{At, RuleSet};
use crate::osm::facts::{Direction, Legal, Oneway, Permission, point_facts, way_facts};
use crate::vehicle::{Catalogue, Vehicle};
use crate::verdict::{ForbiddenReason as F, UnknownReason as U, Verdict};
use crate::words::verdict_words;

fn vehicle(id: &str) -> Vehicle {
    Catalogue::builtin().unwrap().get(id).unwrap().clone()
}

/// Tags as `key=value`, separated by `|` with blanks around.
fn tags(text: &str) -> Vec<(&str, &str)> {
    let mut tags: Vec<(&str, &str)> =
        text.split(" | ").filter(|tag| !tag.is_empty()).map(|tag| tag.split_once('=').unwrap()).collect();
    if !tags.iter().any(|(key, _)| *key == "highway") {
        tags.insert(0, ("highway", "secondary"));
    }
    tags
}

/// Limits and access by direction; `None` where nobody drives.
fn legal(text: &str) -> [Option<Legal>; 2] {
    let facts = way_facts(&tags(text)).unwrap().facts;
    let driven = |other| facts.oneway == Oneway::No || facts.oneway == other;
    [
        driven(Oneway::Forward).then(|| facts.legal_forward.clone()),
        driven(Oneway::Backward).then(|| facts.legal_backward.clone()),
    ]
}

fn words(verdict: Option<Verdict>) -> String {
    verdict.map_or("open".to_owned(), |verdict| {
        let (kind, reason) = verdict_words(verdict);
        format!("{kind}/{reason}")
    })
}

/// `open`, `gone` where nobody drives, or verdict and reason; one word where both directions agree.
fn said(text: &str, id: &str) -> String {
    let vehicle = vehicle(id);
    let [forward, backward] = legal(text).map(|legal| {
        legal.map_or("gone".to_owned(), |legal| {
            // What is stored and read judges the same.
            if let Some(rules) = &legal.rules {
                assert_eq!(RuleSet::from_text(rules.text()).as_ref(), Some(rules), "{text}");
            }
            words(legal.forbids(&vehicle))
        })
    });
    if forward == backward { forward } else { format!("{forward} {backward}") }
}

fn check(id: &str, rows: &[(&str, &str)]) {
    let wrong: Vec<String> = rows
        .iter()
        .map(|&(text, expected)| (text, expected, said(text, id)))
        .filter(|(_, expected, got)| expected != got)
        .map(|(text, expected, got)| format!("{id}: {text}: {got}, not {expected}"))
        .collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn directions_closed_by_vehicle_or_time_are_no_directions() {
    check(
        "EU-SEMI16.5",
        &[
            ("", "open"),
            ("oneway=reversible", "unknown/time"),
            ("oneway=reversible | hgv=yes", "unknown/time"),
            ("oneway=reversible | oneway:conditional=yes @ (09:00-17:00); -1 @ (17:01-08:59)", "unknown/time"),
            ("oneway=reversible | oneway:hgv=-1", "forbidden/oneway unknown/time"),
            ("highway=trunk | oneway=reversible", "unknown/time"),
            ("oneway=alternating", "open"),
            ("oneway=-1", "gone open"),
            ("oneway=1", "open gone"),
            ("oneway=true", "open gone"),
            ("oneway=reverse", "gone open"),
            ("oneway=no", "open"),
            ("oneway=yes | oneway:conditional=no @ (22:00-06:00)", "open unknown/time"),
            ("oneway=-1 | oneway:conditional=no @ (22:00-06:00)", "unknown/time open"),
            ("oneway:conditional=yes @ (Mo-Fr 06:00-10:00)", "open unknown/time"),
            ("oneway:conditional=-1 @ (Mo-Fr 06:00-10:00)", "unknown/time open"),
            ("oneway:hgv:conditional=yes @ (Mo-Fr 06:00-10:00)", "open unknown/time"),
            ("oneway:motor_vehicle:conditional=yes @ (Sa,Su)", "open unknown/time"),
            ("oneway:conditional=yes @ (24/7)", "open gone"),
            ("oneway:hgv:conditional=yes @ (weight>7.5)", "open forbidden/oneway"),
            ("oneway:hgv:conditional=yes @ (weight>60)", "open"),
            ("oneway=yes | oneway:bus=no", "open forbidden/oneway"),
            ("oneway=yes | oneway:psv=no", "open forbidden/oneway"),
            ("oneway:hgv=yes", "open forbidden/oneway"),
            ("oneway:hgv=-1", "forbidden/oneway open"),
            ("oneway:motor_vehicle=yes", "open gone"),
            ("oneway:vehicle=yes", "open gone"),
            ("oneway:access=yes", "open gone"),
            ("oneway:trailer=yes", "open forbidden/oneway"),
            ("oneway:hgv_articulated=yes", "open forbidden/oneway"),
            ("oneway:goods=yes", "open forbidden/oneway"),
            ("oneway:bus=yes", "open"),
            ("oneway:motorcar=yes", "open"),
            ("oneway:bicycle=yes", "open"),
            ("oneway:bicycle=no | oneway=yes", "open gone"),
            ("oneway=yes | oneway:hgv=no", "open"),
            ("oneway=yes | oneway:motor_vehicle=no", "open"),
            ("oneway=yes;no", "open unknown/rule"),
            ("oneway=perhaps", "unknown/rule"),
            ("oneway:hgv=perhaps", "unknown/rule"),
            ("highway=motorway | oneway:bus=no", "open forbidden/oneway"),
            ("highway=motorway", "open gone"),
            ("highway=motorway | oneway=no", "open"),
        ],
    );
    check(
        "BUS-ART18-EU",
        &[
            ("oneway=yes | oneway:bus=no", "open"),
            ("oneway=yes | oneway:psv=no", "open"),
            ("oneway:hgv=yes", "open"),
            ("oneway:bus=yes", "open forbidden/oneway"),
            ("oneway:trailer=yes", "open"),
        ],
    );
}

#[test]
fn classes_of_long_vehicles_are_those_of_the_data() {
    check(
        "AU-BDOUBLE26",
        &[
            ("bdouble=no", "forbidden/class"),
            ("b_double=no", "forbidden/class"),
            ("bdouble=yes | hgv=yes", "open"),
            ("roadtrain=no", "open"),
            ("hgv=no | bdouble=yes", "open"),
            ("bdouble:conditional=no @ (06:00-09:00)", "unknown/time"),
            ("bdouble:forward=no", "forbidden/class open"),
            ("bdouble=destination", "open"),
            ("access=no | bdouble=designated", "open"),
            ("access=no | bdouble=designated | maxlength=19", "forbidden/length"),
            ("maxlength=19", "forbidden/length"),
            ("access=no | roadtrain=yes", "forbidden/access"),
            ("access=no", "forbidden/access"),
            ("lhv=no", "forbidden/class"),
        ],
    );
    check(
        "AU-ATRIPLE53",
        &[
            ("access=no | bdouble=yes", "forbidden/access"),
            ("hgv=no | bdouble=yes", "forbidden/hgv"),
            ("bdouble=no", "forbidden/class"),
            ("roadtrain=no", "forbidden/class"),
            ("road_train=no", "forbidden/class"),
            ("roadtrain=yes", "open"),
            ("access=no | roadtrain=designated", "open"),
            ("bdouble=yes | roadtrain=no", "forbidden/class"),
            ("hgv:conditional=no @ (length>36.5)", "forbidden/length"),
            ("roadtrain=designated | roadtrain:conditional=no @ (sunset-sunrise)", "unknown/time"),
            ("roadtrain:trailers=2", "forbidden/trailers"),
            ("roadtrain:trailers=3", "open"),
            ("maxtrailers=2", "forbidden/trailers"),
            ("maxlength=53.5", "open"),
        ],
    );
    check(
        "AU-ADOUBLE36",
        &[("roadtrain:trailers=2", "open"), ("roadtrain=no", "forbidden/class"), ("roadtrain=yes", "open")],
    );
    check(
        "AU-SEMI19",
        &[("bdouble=no", "open"), ("access=no | bdouble=yes", "forbidden/access"), ("roadtrain=no", "open")],
    );
    check(
        "EU-EMS25-D",
        &[
            ("lhv=no", "forbidden/class"),
            ("lhv=designated", "open"),
            ("hgv:conditional=no @ (length>18.75)", "forbidden/length"),
            ("hgv:conditional=no @ (trailers>=2)", "unknown/rule"),
            ("trailer=no", "forbidden/hgv"),
            ("maxlength=18.75", "forbidden/length"),
            ("roadtrain=no", "forbidden/class"),
            ("maxlength=25.25", "open"),
            ("access=no | lhv=yes", "open"),
            ("hgv=designated | lhv=no", "forbidden/class"),
            ("hgv=no | lhv=designated", "open"),
            ("lhv:conditional=no @ (Sa,Su)", "unknown/time"),
        ],
    );
    check(
        "EU-EMS2-AB34.5",
        &[("access=no | lhv=yes", "forbidden/access"), ("lhv=no", "forbidden/class"), ("lhv=yes", "open")],
    );
    check(
        "EU-EMS25-B",
        &[("bdouble=no", "forbidden/class"), ("access=no | lhv=yes", "open"), ("roadtrain=no", "open")],
    );
    check("US-WB67", &[("lhv=no", "forbidden/class")]);
}

#[test]
fn trailers_and_articulated_lorries_obey_their_keys() {
    check(
        "EU-SEMI16.5",
        &[
            ("maxweight:hgv_articulated=23 st", "forbidden/weight"),
            ("maxweight=13 st | maxweight:hgv_articulated=60", "forbidden/weight"),
            ("trailer=no", "forbidden/hgv"),
            ("hgv_articulated=no", "forbidden/hgv"),
            ("hgv:trailer=no", "forbidden/hgv"),
            ("motor_vehicle:trailer=no", "forbidden/class"),
            ("semitrailer=no", "forbidden/hgv"),
            ("maxlength:hgv_articulated=12", "forbidden/length"),
            ("maxweight:conditional=23 st @ (trailer)", "forbidden/weight"),
            ("maxlength:conditional=12 @ (trailer>=1)", "forbidden/length"),
            ("maxweight:trailer=2", "unknown/limit"),
            ("maxweight:trailer=41", "open"),
            ("hgv:conditional=no @ (trailer)", "forbidden/trailers"),
            ("hgv:conditional=no @ (trailers>=2)", "open"),
            ("motor_vehicle:conditional=no @ (length>12)", "forbidden/length"),
            ("trailer:conditional=no @ (length>12)", "forbidden/length"),
            ("vehicle:conditional=no @ (trailer)", "forbidden/trailers"),
            ("caravan=no", "open"),
            ("tourist_bus=no", "open"),
            ("motorhome=no", "open"),
            ("goods=no", "forbidden/hgv"),
            ("goods=no | hgv=yes", "open"),
            ("access=no | goods=yes", "forbidden/access"),
            ("lhv=no", "open"),
            ("maxlength:hgv=12", "forbidden/length"),
            ("maxlength:trailer=8", "forbidden/length"),
            ("maxlength:trailer=20", "open"),
            ("hgv=no | hgv_articulated=yes", "open"),
            ("maxtrailers=0", "forbidden/trailers"),
            ("maxtrailers=1", "open"),
            ("trailer=destination", "open"),
            ("trailer=yes | maxspeed=50", "open"),
            ("access=no | trailer=yes", "forbidden/access"),
        ],
    );
    check(
        "EU-DRAWBAR18.75",
        &[
            ("hgv=no | hgv_articulated=yes", "forbidden/hgv"),
            ("hgv_articulated=no", "forbidden/hgv"),
            ("semitrailer=no", "open"),
        ],
    );
    let restricted = legal("trailer=destination")[0].clone().unwrap();
    assert_eq!(restricted.judge(&vehicle("EU-SEMI16.5"), At::Always).permission, Permission::Restricted);
    assert_eq!(restricted.judge(&vehicle("BUS-ART18-EU"), At::Always).permission, Permission::Yes);
}

/// Conditional access, and what it is for `EU-SEMI16.5`.
const CONDITIONS: &[(&str, &str)] = &[
    ("hgv:conditional=no @ (weight>3.5)", "forbidden/weight"),
    ("hgv:conditional=destination @ (maxweight>5)", "open"),
    ("hgv:conditional=no @ (weight>=12)", "forbidden/weight"),
    ("hgv:conditional=no @ (maxweightrating>7.5)", "forbidden/weight"),
    ("hgv:conditional=no @ (Sa 15:00-24:00)", "unknown/time"),
    ("hgv:conditional=no @ (weight>3.5 AND 22:00-06:00)", "unknown/time"),
    ("hgv:conditional=no @ (22:00-06:00 AND weight>60)", "open"),
    ("hgv:conditional=no @ (weight>60)", "open"),
    ("hgv:conditional=no @ (length>25)", "open"),
    ("hgv:conditional=no @ (length>12)", "forbidden/length"),
    ("hgv:conditional=no @ (length>16.5)", "open"),
    ("hgv:conditional=no @ (length>=16.5)", "forbidden/length"),
    ("hgv:conditional=no @ (length<12)", "open"),
    ("hgv:conditional=no @ (height>3.5)", "forbidden/height"),
    ("hgv:conditional=no @ (axles>3)", "forbidden/axles"),
    ("hgv:conditional=no @ (axles>5)", "open"),
    ("hgv:conditional=no @ weight>3.5", "forbidden/weight"),
    ("hgv:conditional=no@(weight>3.5)", "forbidden/weight"),
    ("hgv:conditional=no @ (weight > 3.5 t)", "forbidden/weight"),
    ("hgv:conditional=no @ (weight>3500 kg)", "forbidden/weight"),
    ("hgv:conditional=no @ (weight>90000 lbs)", "open"),
    ("hgv:conditional=no @ (weight>3,5)", "forbidden/weight"),
    ("hgv:conditional=no @ (weight≥12)", "forbidden/weight"),
    ("hgv:conditional=no @ (width>2.3)", "forbidden/width"),
    ("hgv:conditional=no @ (axleload>8)", "forbidden/axle_load"),
    ("hgv:conditional=delivery @ (weight>7.5)", "open"),
    ("hgv:conditional=no @ (weight>7.5);yes @ (weight<=7.5)", "forbidden/hgv"),
    ("hgv:conditional=no @ (weight>3.5 st)", "forbidden/weight"),
    ("hgv:conditional=no @ (maxweight>12)", "forbidden/weight"),
    ("hgv:conditional=no @ (22:00-06:00)", "unknown/time"),
    ("hgv:conditional=no @ (weight>7.5 AND length>12)", "forbidden/hgv"),
    ("hgv:conditional=no @ (weight>7.5 AND length>20)", "open"),
    ("hgv:conditional=no @ (weight>7.5 and length>12)", "forbidden/hgv"),
    ("hgv:conditional=no @ (weight>50; length>12)", "forbidden/hgv"),
    ("hgv:conditional=no @ (weight>50; length>20)", "open"),
    ("hgv:conditional=no @ (weight>50 OR length>12)", "forbidden/hgv"),
    ("hgv:conditional=no @ ((weight>7.5) AND (length>12))", "forbidden/hgv"),
    ("hgv:conditional=no @ (weight>7.5", "forbidden/weight"),
    ("hgv:conditional=no @ (hazmat)", "open"),
    ("hgv:conditional=no @ (wet)", "unknown/time"),
    ("hgv:conditional=no @ (snow AND length>12)", "unknown/time"),
    ("hgv:conditional=no @ (emissions<euro_5)", "unknown/rule"),
    ("hgv:conditional=no @ (lane=1)", "unknown/rule"),
    ("hgv:conditional=no @ (articulated)", "forbidden/hgv"),
    ("hgv:conditional=no @ (gross_weight>7.5)", "forbidden/weight"),
    ("hgv:conditional=no @ (weightrating>7.5)", "forbidden/weight"),
    ("hgv:conditional=no @ (vehicle_weight>7.5)", "forbidden/weight"),
    ("hgv:conditional=no @ (>7.5t)", "forbidden/weight"),
    ("hgv:conditional=no @ (> 7.5 t)", "forbidden/weight"),
    ("hgv:conditional=no @ (maxgcweight>7.5)", "forbidden/weight"),
    ("hgv:conditional=no @ (unladenweight>3)", "unknown/rule"),
    ("hgv:conditional=no", "unknown/rule"),
    ("hgv:conditional=no @ gobbledygook", "unknown/rule"),
    ("hgv:conditional=yes @ gobbledygook", "open"),
    ("hgv=no | hgv:conditional=yes @ gobbledygook", "forbidden/hgv"),
    ("hgv=no | hgv:conditional=yes @ (06:00-22:00)", "unknown/time"),
    ("hgv=no | hgv:conditional=yes @ (weight<=60)", "open"),
    ("hgv=no | hgv:conditional=yes @ (weight<=7.5)", "forbidden/hgv"),
    ("hgv=no | hgv:conditional=yes @ (weight<=7.5 AND 22:00-06:00)", "forbidden/hgv"),
    ("hgv=no | hgv:conditional=yes @ (hazmat)", "forbidden/hgv"),
    ("hgv=no | hgv:conditional=destination @ (22:00-06:00)", "unknown/time"),
    ("hgv=no | hgv:conditional=yes @ delivery", "open"),
    ("access:conditional=no @ may-oct", "unknown/time"),
    ("motor_vehicle:conditional=no @ (Nov-May)", "unknown/time"),
    ("access:conditional=no @ (24/7)", "forbidden/access"),
    ("access:conditional=no @ (2020 Jan 1-2020 Feb 2)", "unknown/time"),
    ("access:conditional=no @ (winter)", "unknown/time"),
    ("access:conditional=no @ (Mo-Fr 22:00-06:00,PH)", "unknown/time"),
    ("access:conditional=no @ (10 am-4 pm)", "unknown/time"),
    ("access:conditional=no @ Mo-Fr 07:00-09:00; Sa 10:00-12:00", "unknown/time"),
    ("hgv=yes | access:conditional=no @ (weight>3.5)", "forbidden/weight"),
    ("hgv=designated | motor_vehicle:conditional=no @ (22:00-06:00)", "open"),
    ("hgv=designated | access:conditional=no @ (Nov-Apr)", "unknown/time"),
    ("hgv=yes | motor_vehicle:conditional=no @ (Nov-Apr)", "unknown/time"),
    ("motor_vehicle=no | motor_vehicle:conditional=yes @ (weight>3.5)", "open"),
    ("motor_vehicle:conditional=destination @ (weight>7.5)", "open"),
    ("motor_vehicle:conditional=no @ (weight>7.5)", "forbidden/weight"),
    ("goods:conditional=no @ (weight>7.5)", "forbidden/weight"),
    ("hgv:conditional=no @ (22:00-06:00); yes @ (weight<=60)", "open"),
    ("hgv:forward:conditional=no @ (22:00-06:00)", "unknown/time open"),
    ("hgv:conditional:forward=no @ (weight>7.5)", "forbidden/weight open"),
];

#[test]
fn conditions_are_decided_where_they_can_be() {
    check("EU-SEMI16.5", CONDITIONS);
    let restricted = |text: &str| legal(text)[0].clone().unwrap().judge(&vehicle("EU-SEMI16.5"), At::Always).permission;
    assert_eq!(restricted("hgv:conditional=delivery @ (weight>7.5)"), Permission::Restricted);
    assert_eq!(restricted("hgv:conditional=delivery @ (weight>60)"), Permission::Yes);
    assert_eq!(restricted("hgv=no | hgv:conditional=yes @ delivery"), Permission::Restricted);
    assert_eq!(restricted("hgv=destination"), Permission::Restricted);
}

#[test]
fn limits_by_class_and_of_special_kinds_bind_whom_they_name() {
    check(
        "EU-SEMI16.5",
        &[
            ("maxweight:hgv=7.5", "forbidden/weight"),
            ("maxweightrating:hgv=7.5", "forbidden/weight"),
            ("maxweightrating=7.5", "forbidden/weight"),
            ("maxgcweight=18", "forbidden/weight"),
            ("maxaxleload=8", "forbidden/axle_load"),
            ("maxbogieweight=12", "unknown/limit"),
            ("maxbogieweight=40", "open"),
            ("maxweight:goods=3.5", "forbidden/weight"),
            ("maxgcweightrating=20", "forbidden/weight"),
            ("maxweightrating:conditional=3.5 @ (22:00-06:00)", "unknown/time"),
            ("maxweight:conditional=50 @ (22:00-06:00)", "open"),
            ("maxweight:conditional=none @ (22:00-06:00)", "open"),
            ("maxweight:hgv=none | maxweight=5", "forbidden/weight"),
            ("maxweight:bus=5", "open"),
            ("maxweight:signed=7.5", "forbidden/weight"),
            ("maxweight:signed=no", "open"),
            ("maxweightrating:hgv:conditional=none @ destination | maxweightrating:hgv=7.5", "forbidden/weight"),
            ("maxweightrating:goods=7.5", "forbidden/weight"),
            ("maxgcweight:hgv=18", "forbidden/weight"),
            ("maxunladenweight=3", "unknown/limit"),
            ("maxunladenweight=44", "open"),
            ("maxweight:legal=12", "forbidden/weight"),
            ("maxweight:physical=12", "forbidden/weight"),
            ("maxweight:vehicle=7.5", "forbidden/weight"),
            ("maxweight:motor_vehicle=7.5", "forbidden/weight"),
            ("maxtandemaxleload=10", "unknown/limit"),
            ("hgv:maxweight=7.5", "forbidden/weight"),
            ("maxweightrating:trailer=10", "unknown/limit"),
            ("bridge:maxweight=7.5", "forbidden/weight"),
            ("bridge=yes", "open"),
            ("maxaxles=4", "forbidden/axles"),
            ("maxaxles=5", "open"),
            ("maxweight=yes", "unknown/limit"),
            ("maxweight:forward=7.5", "forbidden/weight open"),
            ("maxweight:hgv:forward=7.5", "forbidden/weight open"),
            ("maxheight:lanes=4.5|3.8", "forbidden/height"),
            ("maxweight:note=7.5", "open"),
            ("maxweight:motorcar=2", "open"),
        ],
    );
    check(
        "BUS-ART18-EU",
        &[
            ("maxweight:bus=5", "forbidden/weight"),
            ("maxweight:hgv=7.5", "open"),
            ("maxweight=7.5", "forbidden/weight"),
            ("maxlength:trailer=8", "open"),
            ("maxtrailers=0", "open"),
            ("maxaxles=2", "forbidden/axles"),
        ],
    );
    let mut own = vehicle("EU-SEMI16.5");
    (own.axles, own.class) = (None, None);
    let verdict = |text: &str| words(legal(text)[0].clone().unwrap().forbids(&own));
    assert_eq!([verdict("maxaxles=2"), verdict("maxaxles=4")], ["forbidden/axles", "unknown/limit"]);
}

#[test]
fn buses_and_tugs_obey_keys_of_their_own() {
    check(
        "BUS-ART18-EU",
        &[
            ("bus=no", "forbidden/class"),
            ("psv=no", "forbidden/class"),
            ("psv=no | bus=yes", "open"),
            ("hgv=no", "open"),
            ("hgv=no | hgv:conditional=yes @ (22:00-06:00)", "open"),
            ("motor_vehicle=no", "forbidden/access"),
            ("motor_vehicle=no | bus=yes", "open"),
            ("motor_vehicle=no | psv=designated", "open"),
            ("motor_vehicle=no | hgv=yes", "forbidden/access"),
            ("access=no | hgv=designated", "forbidden/access"),
            ("access=bus", "open"),
            ("access=psv", "open"),
            ("trailer=no", "open"),
            ("tourist_bus=no", "open"),
            ("hgv:conditional=no @ (weight>7.5)", "open"),
            ("bus:conditional=no @ (length>12)", "forbidden/length"),
            ("motor_vehicle:conditional=no @ (Mo-Fr 10:00-18:00) | bus=yes", "open"),
            ("lhv=no", "open"),
            ("highway=busway", "forbidden/access"),
            ("highway=busway | bus=yes", "open"),
        ],
    );
    check(
        "EU-SEMI16.5",
        &[
            ("bus=no", "open"),
            ("psv=no", "open"),
            ("motor_vehicle=no | bus=yes", "forbidden/access"),
            ("access=bus", "forbidden/access"),
            ("motor_vehicle=no | hgv=yes", "open"),
            ("motor_vehicle=no | hgv=destination", "open"),
        ],
    );
    check(
        "AGV-TUG4",
        &[("hgv=no", "forbidden/hgv"), ("motor_vehicle=no | hgv=yes", "forbidden/access"), ("bus=no", "open")],
    );
    let mut coach = vehicle("BUS-ART18-EU");
    coach.class = Some("coach".to_owned());
    let verdict = |text: &str| words(legal(text)[0].clone().unwrap().forbids(&coach));
    assert_eq!(verdict("tourist_bus=no"), "forbidden/class");
    assert_eq!(verdict("coach=no"), "forbidden/class");
    assert_eq!(verdict("motor_vehicle=no | bus=yes"), "forbidden/access");
}

#[test]
fn seasons_and_impassable_roads_are_not_open() {
    check(
        "EU-SEMI16.5",
        &[
            ("impassable=yes", "forbidden/access"),
            ("impassable=no", "open"),
            ("ice_road=yes", "unknown/time"),
            ("winter_road=yes", "unknown/time"),
            ("seasonal=yes", "unknown/time"),
            ("seasonal=winter", "unknown/time"),
            ("seasonal=no", "open"),
            ("hgv=designated | ice_road=yes", "unknown/time"),
            ("ford=yes", "open"),
        ],
    );
}

#[test]
fn nodes_without_barriers_close_roads_too() {
    let vehicle = vehicle("EU-SEMI16.5");
    for (text, expected) in [
        ("access=no", "forbidden/access"),
        ("motor_vehicle=no", "forbidden/access"),
        ("motor_vehicle=private", "forbidden/access"),
        ("hgv=no", "forbidden/hgv"),
        ("barrier=toll_booth | hgv=no", "forbidden/hgv"),
        ("barrier=entrance | hgv=no", "forbidden/hgv"),
        ("barrier=cattle_grid | maxweight=3.5", "forbidden/weight"),
        ("traffic_sign=DE:253 | hgv=no", "forbidden/hgv"),
        ("highway=crossing | access=no | foot=yes", "forbidden/access"),
        ("railway=level_crossing | maxlength=12", "forbidden/length"),
        ("motorcar=no", "open"),
        ("amenity=parking_entrance | access=private", "open"),
        ("highway=bus_stop | access=no | bus=yes", "open"),
        ("barrier=gate | motorcar:conditional=no @ (22:00-06:00)", "unknown/time"),
        ("barrier=gate | trailer=no", "forbidden/hgv"),
        ("barrier=lift_gate | hgv_articulated=no", "forbidden/hgv"),
        ("barrier=gate | access:conditional=no @ (Nov-Apr)", "unknown/time"),
        ("barrier=lift_gate | access=no | motor_vehicle:conditional=yes @ (May-Oct)", "unknown/time"),
        ("barrier=gate | access=no | hgv:conditional=yes @ (06:00-20:00)", "unknown/time"),
        ("barrier=gate | hgv:conditional=no @ (weight>7.5)", "forbidden/weight"),
        ("barrier=gate | access=no | hgv=yes", "open"),
        ("barrier=swing_gate | motor_vehicle=permissive", "open"),
        ("hgv:backward=no", "forbidden/hgv"),
        ("maxweight:bus=5", "open"),
        ("maxaxles=3", "forbidden/axles"),
    ] {
        let facts = point_facts(&tags(&format!("highway=x | {text}"))[1..]);
        let got = facts.map_or("open".to_owned(), |facts| words(facts.legal.forbids(&vehicle)));
        assert_eq!(got, expected, "{text}");
    }
}

#[test]
fn a_time_decides_what_time_decides() {
    let vehicle = vehicle("EU-SEMI16.5");
    // A Wednesday.
    let at = |hour| At::Time { time: date(2026, 12, 2).at(hour, 30, 0, 0), country: *b"DE" };
    for (text, expected) in [
        ("hgv:conditional=no @ (22:00-06:00)", ["forbidden/hgv", "open"]),
        ("hgv=no | hgv:conditional=yes @ (06:00-22:00)", ["forbidden/hgv", "open"]),
        ("access:conditional=no @ may-oct", ["open", "open"]),
        ("motor_vehicle:conditional=no @ (Nov-May)", ["forbidden/access", "forbidden/access"]),
        ("hgv:conditional=no @ (Sa,Su)", ["open", "open"]),
        ("maxweight:conditional=3.5 @ (22:00-06:00)", ["forbidden/weight", "open"]),
        ("hgv:conditional=no @ (wet)", ["unknown/time", "unknown/time"]),
        ("hgv:conditional=no @ (sunset-sunrise)", ["unknown/time", "unknown/time"]),
        ("hgv:conditional=no @ (SH)", ["unknown/time", "unknown/time"]),
        ("hgv:conditional=no @ (PH)", ["open", "open"]),
        ("hgv:conditional=no @ (emissions<euro_5)", ["unknown/rule", "unknown/rule"]),
        ("oneway=reversible", ["unknown/time", "unknown/time"]),
        ("hgv=no", ["forbidden/hgv", "forbidden/hgv"]),
        ("ice_road=yes", ["unknown/time", "unknown/time"]),
    ] {
        let legal = legal(text)[0].clone().unwrap();
        let got = [2, 12].map(|hour| words(legal.judge(&vehicle, at(hour)).verdict));
        assert_eq!(got, expected, "{text}");
    }
    let [forward, backward] = legal("oneway=yes | oneway:conditional=no @ (22:00-06:00)").map(Option::unwrap);
    assert_eq!([2, 12].map(|hour| words(forward.judge(&vehicle, at(hour)).verdict)), ["open", "open"]);
    assert_eq!([2, 12].map(|hour| words(backward.judge(&vehicle, at(hour)).verdict)), ["open", "forbidden/oneway"]);
}

/// What the grammar and mappers may read differently decides nothing.
#[test]
fn a_time_that_can_be_read_in_two_ways_decides_only_where_both_agree() {
    let vehicle = vehicle("EU-SEMI16.5");
    for (text, day, hour, expected) in [
        // One rule to mappers; two to the grammar, the first of them all day.
        ("hgv=no | hgv:conditional=yes @ (Mo-Fr, PH 06:00-22:00)", date(2026, 12, 2), 23, "unknown/time"),
        ("hgv=no | hgv:conditional=yes @ (Mo-Fr, PH 06:00-22:00)", date(2026, 12, 2), 12, "open"),
        // Friday's night goes on, though Saturday has a rule of its own.
        ("hgv:conditional=no @ (Mo-Fr 22:00-06:00; Sa 20:00-06:00)", date(2026, 12, 5), 3, "unknown/time"),
        ("hgv:conditional=no @ (Mo-Fr 22:00-06:00; Sa 20:00-06:00)", date(2026, 12, 5), 22, "forbidden/hgv"),
        ("hgv:conditional=no @ (Mo-Fr 22:00-06:00; Sa 20:00-06:00)", date(2026, 12, 5), 12, "open"),
        // Not all of Sunday, and holidays in the morning.
        ("hgv=no | hgv:conditional=yes @ (Sunday,PH 08:00-10:00)", date(2026, 12, 6), 15, "forbidden/hgv"),
        // A slip of the pen.
        ("hgv:conditional=no @ (22:00-06:00)", date(1026, 12, 1), 23, "unknown/time"),
        ("hgv:conditional=no @ (PH)", date(1991, 12, 25), 12, "unknown/time"),
    ] {
        let legal = legal(text)[0].clone().unwrap();
        let at = At::Time { time: day.at(hour, 30, 0, 0), country: *b"DE" };
        assert_eq!(words(legal.judge(&vehicle, at).verdict), expected, "{text} {day} {hour}");
    }
}

#[test]
fn a_road_to_a_destination_stays_one_where_it_is_closed_at_times() {
    let vehicle = vehicle("EU-SEMI16.5");
    for text in
        ["hgv=destination | hgv:conditional=no @ (22:00-06:00)", "hgv=no | hgv:conditional=destination @ (06:00-22:00)"]
    {
        let judged = legal(text)[0].clone().unwrap().judge(&vehicle, At::Always);
        assert_eq!(
            (words(judged.verdict), judged.permission),
            ("unknown/time".to_owned(), Permission::Restricted),
            "{text}"
        );
        assert!(judged.destination.is_some_and(|tag| tag.contains("destination")), "{text}");
    }
}

#[test]
fn public_holidays_decide_where_the_whole_country_has_them() {
    let vehicle = vehicle("EU-SEMI16.5");
    let legal = legal("hgv:conditional=no @ (Su,PH 00:00-22:00)")[0].clone().unwrap();
    let christmas = date(2026, 12, 25);
    let corpus_christi = date(2026, 6, 4); // in some of the German states only
    for (day, hour, country, expected) in [
        (date(2026, 12, 6), 9, *b"DE", "forbidden/hgv"), // a Sunday
        (date(2026, 12, 8), 9, *b"DE", "open"),          // a Tuesday
        (christmas, 9, *b"DE", "forbidden/hgv"),
        (christmas, 23, *b"DE", "open"),
        (corpus_christi, 9, *b"DE", "unknown/time"),
        (corpus_christi, 9, *b"FR", "open"),
        (date(2026, 12, 8), 9, *b"??", "unknown/time"),
        (date(2990, 12, 8), 9, *b"DE", "unknown/time"), // no list goes so far
    ] {
        let at = At::Time { time: day.at(hour, 0, 0, 0), country };
        assert_eq!(words(legal.judge(&vehicle, at).verdict), expected, "{day} {hour} {country:?}");
    }
}

#[test]
fn a_width_that_cannot_be_read_is_kept_and_says_nothing_of_a_vehicle() {
    let vehicle = vehicle("EU-SEMI16.5");
    let unreadable = |text: &str| {
        let legal = legal(text)[0].clone().unwrap();
        let kept: Vec<String> = legal.rules.iter().flat_map(RuleSet::unreadable_widths).map(str::to_owned).collect();
        (kept.join(", "), words(legal.forbids(&vehicle)))
    };
    let said = |widths: &str, verdict: &str| (widths.to_owned(), verdict.to_owned());
    assert_eq!(unreadable("width=50"), said("width=50", "open"));
    assert_eq!(unreadable("width=ten | est_width=narrow"), said("est_width=narrow, width=ten", "open"));
    assert_eq!(unreadable("width=50 | maxweight=7.5"), said("width=50", "forbidden/weight"));
    assert_eq!(unreadable("width=50 | hgv=no"), said("width=50", "forbidden/hgv"));
    // Another width is known.
    assert_eq!(unreadable("width=50 | est_width=3"), said("", "open"));
    assert_eq!(unreadable("width=3"), said("", "open"));
}

#[test]
fn the_rule_is_named_with_what_it_allows_and_what_the_vehicle_has() {
    let vehicle = vehicle("EU-SEMI16.5");
    let judged = |text: &str| legal(text)[0].clone().unwrap().judge(&vehicle, At::Always);
    let both = judged("hgv:conditional=no @ (weight>7.5 AND length>12)");
    assert_eq!(both.rule.as_deref(), Some("hgv:conditional=no @ (weight>7.5 AND length>12)"));
    let weight = judged("maxweight:hgv=7.5");
    assert_eq!(
        (weight.rule.as_deref(), weight.allowed, weight.has, weight.unit),
        (Some("maxweight:hgv=7.5"), Some(7.5), Some(40.0), "t")
    );
    assert_eq!(judged("hgv:conditional=no @ (axles>3)").has, Some(5.0));
    let timed = legal("hgv:conditional=no @ (22:00-06:00) | access:conditional=no @ (weight>3.5) | seasonal=yes")[0]
        .clone()
        .unwrap();
    assert_eq!(timed.open_when().as_deref(), Some("hgv:conditional=no @ (22:00-06:00); seasonal=yes"));
}

#[test]
fn most_roads_keep_no_rules() {
    for text in [
        "",
        "access=private",
        "hgv=no",
        "hgv=yes",
        "motor_vehicle=destination",
        "maxweight=7.5 | maxheight:forward=3.8",
        "oneway=yes",
        "oneway:bicycle=no | oneway=yes",
        "bicycle=designated",
        "maxspeed:hgv=60",
    ] {
        assert!(legal(text).into_iter().flatten().all(|legal| legal.rules.is_none()), "{text}");
    }
    let fact = legal("hgv=designated")[0].clone().unwrap();
    assert_eq!(fact.rules.unwrap().rules().collect::<Vec<_>>(), ["hgv=designated"]);
}

/// Tags of which a road may have several.
const TAGS: [&str; 34] = [
    "access=no",
    "access=destination",
    "motor_vehicle=no",
    "hgv=no",
    "hgv=yes",
    "hgv=designated",
    "bus=yes",
    "psv=no",
    "goods=no",
    "hgv_articulated=no",
    "hgv_articulated=yes",
    "trailer=no",
    "bdouble=yes",
    "roadtrain=no",
    "lhv=no",
    "maxweight=7.5",
    "maxweight:hgv=18",
    "maxheight=3.8",
    "maxheight=low",
    "maxlength:trailer=8",
    "maxaxles=4",
    "hgv:forward=no",
    "hgv:conditional=no @ (22:00-06:00)",
    "access:conditional=no @ (Nov-Apr)",
    "hgv:conditional=no @ (weight>7.5)",
    "hgv:conditional=yes @ (delivery)",
    "motor_vehicle:conditional=no @ (what)",
    "maxweight:conditional=3.5 @ (Sa)",
    "oneway=reversible",
    "oneway:hgv=yes",
    "oneway:conditional=yes @ (Mo)",
    "seasonal=yes",
    "hgv=delivery",
    "maxwidth=2.5",
];

/// Rules that only restrict, whatever else is tagged.
const LIMITS: [&str; 12] = [
    "maxweight=7.5",
    "maxweight:hgv=7.5",
    "maxheight:physical=3.8",
    "maxlength=12",
    "maxlength:hgv_articulated=12",
    "maxaxleload=8",
    "maxaxles=3",
    "maxtrailers=0",
    "maxunladenweight=3",
    "maxweight:conditional=3.5 @ (22:00-06:00)",
    "impassable=yes",
    "seasonal=yes",
];

fn some_tags() -> impl Strategy<Value = Vec<&'static str>> {
    prop::collection::vec(prop::sample::select(TAGS.to_vec()), 0..5).prop_map(|tags| {
        let mut keys = Vec::new();
        tags.into_iter()
            .filter(|tag| {
                let key = tag.split('=').next().unwrap().to_owned();
                !keys.contains(&key) && {
                    keys.push(key);
                    true
                }
            })
            .collect()
    })
}

fn any_vehicle() -> impl Strategy<Value = Vehicle> {
    prop::sample::select(Catalogue::builtin().unwrap().iter().cloned().collect::<Vec<_>>())
}

proptest! {
    #[test]
    fn a_further_limit_opens_nothing(tags in some_tags(), limit in prop::sample::select(LIMITS.to_vec()), vehicle in any_vehicle()) {
        let key = limit.split('=').next().unwrap();
        prop_assume!(!tags.iter().any(|tag| tag.split('=').next() == Some(key)));
        let before = legal(&tags.join(" | "));
        let after = legal(&tags.iter().copied().chain([limit]).collect::<Vec<_>>().join(" | "));
        for (before, after) in before.into_iter().zip(after) {
            let (Some(before), Some(after)) = (before, after) else { continue };
            if let Some(refused) = before.forbids(&vehicle) {
                let now = after.forbids(&vehicle);
                prop_assert!(now.is_some(), "{:?} {} {:?}", tags, limit, refused);
                prop_assert!(!matches!(refused, Verdict::Forbidden(_)) || matches!(now, Some(Verdict::Forbidden(_))));
            }
        }
    }

    #[test]
    fn merging_is_commutative_and_never_opens(a in some_tags(), b in some_tags(), vehicle in any_vehicle()) {
        let [a, b] = [a, b].map(|tags| {
            let facts = way_facts(&super::tests::tags(&tags.join(" | "))).unwrap().facts;
            facts.legal_forward.clone()
        });
        let (ab, ba) = (a.merge(&b), b.merge(&a));
        prop_assert_eq!(&ab, &ba);
        prop_assert_eq!(&ab.merge(&a), &ab);
        for at in [At::Always, At::Time { time: date(2026, 7, 4).at(23, 0, 0, 0), country: *b"FR" }] {
            let strict = |legal: &Legal| super::judge::weight(legal.judge(&vehicle, at).verdict.unwrap_or(Verdict::Safe));
            prop_assert_eq!(strict(&ab), strict(&a).max(strict(&b)));
        }
    }

    #[test]
    fn a_time_never_closes_what_is_open_always(tags in some_tags(), vehicle in any_vehicle(), hour in 0..24_i8, month in 1..13_i8) {
        for legal in legal(&tags.join(" | ")).into_iter().flatten() {
            let then = legal.judge(&vehicle, At::Time { time: date(2027, month, 3).at(hour, 0, 0, 0), country: *b"DE" }).verdict;
            match legal.forbids(&vehicle) {
                None => prop_assert_eq!(then, None),
                Some(forbidden @ Verdict::Forbidden(_)) => prop_assert_eq!(then.map(super::judge::weight), Some(super::judge::weight(forbidden))),
                _ => {}
            }
        }
    }

    #[test]
    fn any_text_is_read_and_comes_back(key in "(hgv|access|maxweight|oneway|maxaxles)(:(forward|hgv|conditional|trailer|x)){0,3}", value in "[ -~≥\n]{0,40}") {
        for side in [Direction::Forward, Direction::Backward] {
            let group = super::set::RuleGroup::new([(key.as_str(), value.as_str())].into_iter(), side);
            if let Some(set) = RuleSet::of(vec![group]) {
                prop_assert_eq!(RuleSet::from_text(set.text()), Some(set.clone()));
                let _ = set.open_when();
            }
        }
    }
}

#[test]
fn reasons_are_words() {
    for verdict in [
        Verdict::Forbidden(F::Oneway),
        Verdict::Forbidden(F::Axles),
        Verdict::Forbidden(F::Trailers),
        Verdict::Forbidden(F::Class),
        Verdict::Unknown(U::Time),
        Verdict::Unknown(U::Rule),
    ] {
        assert!(!verdict_words(verdict).1.is_empty());
    }
}

#[derive(serde::Deserialize)]
struct Page {
    section: Vec<Section>,
}

#[derive(serde::Deserialize)]
struct Section {
    title: String,
    text: String,
    #[serde(default)]
    node: bool,
    #[serde(default)]
    row: Vec<Row>,
}

#[derive(serde::Deserialize)]
struct Row {
    tags: String,
    vehicle: String,
    verdict: String,
    what: Option<String>,
}

fn rendered(page: &Page) -> String {
    let mut text = "# Rules of the road\n\nWhich tags netcert reads, which not, and what each does to a verdict. A verdict of the geometry stands only where the rules leave the road open. This page is \
                    made from `data/rules.toml`; a test holds each row against the program.\n"
        .to_owned();
    for section in page.section.iter().filter(|section| !(section.text.is_empty() && section.row.is_empty())) {
        text += &format!("\n## {}\n", section.title);
        if !section.text.is_empty() {
            text += &format!("\n{}\n", section.text.trim());
        }
        if !section.row.is_empty() {
            text += "\n| tags | vehicle | verdict | |\n| --- | --- | --- | --- |\n";
        }
        for Row { tags, vehicle, verdict, what } in &section.row {
            let tags: Vec<String> = tags.split(" | ").map(|tag| format!("`{tag}`")).collect();
            let words = |one: &str| one.replace('/', ": ");
            let verdict = match verdict.split_once(' ') {
                Some((along, against)) => format!("along {}, against {}", words(along), words(against)),
                None => words(verdict),
            };
            let what = what.as_deref().unwrap_or("");
            text += &format!("| {} | {vehicle} | {verdict} | {what} |\n", tags.join(" "));
        }
    }
    text
}

/// `NETCERT_WRITE_DOCS=1` writes the page.
#[test]
fn the_page_of_rules_is_true() {
    let page: Page = toml::from_str(include_str!("../../../../../../data/rules.toml")).unwrap();
    for section in &page.section {
        for Row { tags: text, vehicle: id, verdict, .. } in &section.row {
            let got = if section.node {
                let facts = point_facts(&tags(&format!("highway=x | {text}"))[1..]);
                facts.map_or("open".to_owned(), |facts| words(facts.legal.forbids(&vehicle(id))))
            } else {
                said(text, id)
            };
            assert_eq!(&got, verdict, "{id}: {text}");
        }
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/rules.md");
    let page = rendered(&page);
    if std::env::var_os("NETCERT_WRITE_DOCS").is_some() {
        std::fs::write(path, &page).unwrap();
    }
    assert!(
        std::fs::read_to_string(path).unwrap_or_default() == page,
        "docs/rules.md differs; NETCERT_WRITE_DOCS=1 writes it"
    );
}
