//! Tags in, strips and limits out, through the public functions only.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use proptest::prelude::*;

use crate::osm::facts::*;
use crate::vehicle::{Unit, Vehicle};
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};

const RIGHT: Place = Place { country: *b"ZZ", left_hand_traffic: false };
const LEFT: Place = Place { country: *b"ZZ", left_hand_traffic: true };

/// `highway=primary width=7` as tags.
fn tags(text: &str) -> Vec<(&str, &str)> {
    text.split_whitespace().map(|tag| tag.split_once('=').expect("key=value")).collect()
}

fn draft(text: &str) -> WayDraft<'_> {
    way_facts(&tags(text)).expect("a road")
}

fn sections(text: &str, place: &Place) -> [CrossSection; 2] {
    cross_sections(&draft(text).facts, place, &Rules::builtin().unwrap())
}

/// Left and right edge in centimetres, and the evidence.
fn show(strip: Option<Strip>) -> String {
    strip.map_or("-".to_owned(), |s| {
        format!("{:.0}..{:.0} {:?}", s.left_m * 100.0 + 0.0, s.right_m * 100.0 + 0.0, s.source).replace("-0.", "0.")
    })
}

/// `forward lane | backward lane | forward direction | carriageway`, traffic on the right.
fn check(text: &str, expected: &str) {
    check_at(text, &RIGHT, expected);
}

fn check_at(text: &str, place: &Place, expected: &str) {
    let [forward, backward] = sections(text, place);
    let carriageway = forward.carriageway.or(backward.carriageway);
    let got = [forward.lane, backward.lane, forward.direction, carriageway].map(show).join(" | ");
    assert_eq!(got, expected, "{text}");
}

#[test]
fn untagged_roads_have_assumed_lanes() {
    check("highway=tertiary", "0..-300 Assumed | 0..-300 Assumed | 0..-300 Assumed | 300..-300 Assumed");
    check("highway=motorway", "0..-350 Assumed | - | 350..-350 Assumed | 350..-350 Assumed");
    check("highway=motorway_link oneway=yes", "175..-175 Assumed | - | 175..-175 Assumed | 175..-175 Assumed");
    check("highway=service", "200..-200 Assumed | 200..-200 Assumed | 200..-200 Assumed | 200..-200 Assumed");
}

#[test]
fn lanes_times_lane_width() {
    check("highway=primary lanes=2", "0..-325 FromLanes | 0..-325 FromLanes | 0..-325 FromLanes | 325..-325 FromLanes");
    check(
        "highway=primary lanes=4",
        "-325..-650 FromLanes | -325..-650 FromLanes | 0..-650 FromLanes | 650..-650 FromLanes",
    );
    // An odd lane belongs to nobody.
    check(
        "highway=primary lanes=3",
        "-162..-488 FromLanes | -162..-488 FromLanes | -162..-488 FromLanes | 488..-488 FromLanes",
    );
    check(
        "highway=primary lanes=3 lanes:forward=2",
        "-162..-488 FromLanes | -162..-488 FromLanes | 162..-488 FromLanes | 488..-488 FromLanes",
    );
    check("highway=primary oneway=yes lanes=2", "0..-325 FromLanes | - | 325..-325 FromLanes | 325..-325 FromLanes");
    check("highway=primary oneway=-1 lanes=2", "- | 0..-325 FromLanes | - | 325..-325 FromLanes");
    check(
        "highway=primary lanes=3 lanes:both_ways=1",
        "-162..-488 FromLanes | -162..-488 FromLanes | -162..-488 FromLanes | 488..-488 FromLanes",
    );
}

#[test]
fn a_tagged_width_is_shared_out() {
    check("highway=primary width=7", "0..-350 Estimated | 0..-350 Estimated | 0..-350 Estimated | 350..-350 Tagged");
    check("highway=primary width=7 lanes=2", "0..-350 Tagged | 0..-350 Tagged | 0..-350 Tagged | 350..-350 Tagged");
    check(
        "highway=primary width=7 est_width=9 lanes=2 width:carriageway=6",
        "0..-300 Tagged | 0..-300 Tagged | 0..-300 Tagged | 300..-300 Tagged",
    );
    check(
        "highway=primary est_width=7 lanes=2",
        "0..-350 Estimated | 0..-350 Estimated | 0..-350 Estimated | 350..-350 Estimated",
    );
    check(
        "highway=primary width=7 lanes=2 source:width=survey",
        "0..-350 Surveyed | 0..-350 Surveyed | 0..-350 Surveyed | 350..-350 Surveyed",
    );
    check(
        "highway=primary width=7 lanes=2 width:source=estimated",
        "0..-350 Estimated | 0..-350 Estimated | 0..-350 Estimated | 350..-350 Estimated",
    );
    // How many lanes there are is not known: no more than 4.25 m at the kerb is one.
    check("highway=primary width=6 oneway=yes", "125..-300 Estimated | - | 300..-300 Estimated | 300..-300 Tagged");
}

#[test]
fn narrow_two_way_roads_are_shared() {
    check(
        "highway=unclassified width=4",
        "200..-200 Tagged | 200..-200 Tagged | 200..-200 Tagged | 200..-200 Tagged"
            .replace(
                "200..-200 Tagged | 200..-200 Tagged | 200..-200 Tagged",
                "200..-200 Estimated | 200..-200 Estimated | 200..-200 Estimated",
            )
            .as_str(),
    );
    check(
        "highway=unclassified width=4 lanes=1",
        "200..-200 Tagged | 200..-200 Tagged | 200..-200 Tagged | 200..-200 Tagged",
    );
    check(
        "highway=unclassified lanes=1",
        "138..-138 FromLanes | 138..-138 FromLanes | 138..-138 FromLanes | 138..-138 FromLanes",
    );
    check(
        "highway=unclassified narrow=yes",
        "110..-110 Assumed | 110..-110 Assumed | 110..-110 Assumed | 110..-110 Assumed",
    );
    check(
        "highway=unclassified oneway=alternating",
        "138..-138 Assumed | 138..-138 Assumed | 138..-138 Assumed | 138..-138 Assumed",
    );
}

#[test]
fn width_and_lanes_that_contradict_give_the_narrower_reading() {
    // 3 m for two lanes: one lane of 3 m for both.
    check(
        "highway=primary width=3 lanes=2",
        "150..-150 Estimated | 150..-150 Estimated | 150..-150 Estimated | 150..-150 Tagged",
    );
    // 7 m for five lanes: neither is believed beyond one assumed lane.
    check(
        "highway=primary width=7 lanes=5 oneway=yes",
        "162..-162 FromLanes | - | 162..-162 FromLanes | 162..-162 FromLanes",
    );
    // 14 m for two lanes: the width is not that of the lanes.
    check(
        "highway=primary width=14 lanes=2",
        "0..-325 FromLanes | 0..-325 FromLanes | 0..-325 FromLanes | 325..-325 FromLanes",
    );
    assert!(draft("highway=primary width=14 lanes=2").notes.has(Note::WidthContradictsLanes));
}

#[test]
fn kerb_side_uses_are_deducted_from_a_tagged_width() {
    // 10 m, of which 2 m are parking on the right: the lanes lie to the left of the middle.
    check(
        "highway=residential width=10 lanes=2 parking:right=lane parking:right:orientation=parallel parking:right:width=2",
        "100..-300 Tagged | -100..-500 Tagged | 100..-300 Tagged | 500..-300 Tagged",
    );
    for old in ["parking:lane:right=parallel", "parking:right=lane", "parking:right=on_street"] {
        let [forward, _] = sections(&format!("highway=residential width=10.2 lanes=2 {old}"), &RIGHT);
        assert!((forward.lane.unwrap().width_m() - 4.0).abs() < 1e-3, "{old}");
        assert_eq!(forward.lane.unwrap().source, WidthSource::Estimated);
    }
    for off in [
        "parking:lane:right=no_parking",
        "parking:right=no",
        "parking:right=street_side",
        "cycleway=track cycleway:width=2",
    ] {
        let [forward, _] = sections(&format!("highway=residential width=8 lanes=2 {off}"), &RIGHT);
        assert!((forward.lane.unwrap().width_m() - 4.0).abs() < 1e-3, "{off}");
    }
    check(
        "highway=primary width=11 lanes=2 cycleway:both=lane cycleway:both:width=1.5",
        "0..-400 Tagged | 0..-400 Tagged | 0..-400 Tagged | 400..-400 Tagged",
    );
    // Shoulders are paved: the carriageway policy may use them.
    check(
        "highway=motorway width=12 lanes=2 shoulder=right shoulder:right:width=2.5",
        "125..-350 Tagged | - | 600..-350 Tagged | 600..-600 Tagged",
    );
    // The width is that of the lanes alone.
    check(
        "highway=motorway width=7.5 lanes=2 shoulder=yes",
        "0..-350 FromLanes | - | 350..-350 FromLanes | 350..-350 FromLanes",
    );
    // More cars than road.
    check("highway=residential width=6 parking:both=lane parking:both:orientation=perpendicular", "- | - | - | -");
}

#[test]
fn lanes_for_others_are_not_the_kerb_side_lane() {
    check(
        "highway=primary oneway=yes lanes=3 bus:lanes=||designated",
        "162..-162 FromLanes | - | 488..-162 FromLanes | 488..-488 FromLanes",
    );
    check(
        "highway=primary oneway=yes lanes=3 lanes:bus=1",
        "162..-162 FromLanes | - | 488..-162 FromLanes | 488..-488 FromLanes",
    );
    check(
        "highway=primary oneway=yes lanes=2 width:lanes=3.5|3|1.5 bicycle:lanes=||designated",
        "50..-250 Tagged | - | 400..-250 Tagged | 400..-250 Tagged",
    );
    check("highway=primary oneway=yes lanes=1 bus:lanes=designated", "- | - | - | -");
}

#[test]
fn left_hand_traffic_mirrors() {
    check_at("highway=tertiary", &LEFT, "300..0 Assumed | 300..0 Assumed | 300..0 Assumed | 300..-300 Assumed");
    check_at(
        "highway=primary oneway=yes lanes=2 width:lanes=3|3.5",
        &LEFT,
        "325..25 Tagged | - | 325..-325 Tagged | 325..-325 Tagged",
    );
}

#[test]
fn placement_moves_the_strips() {
    check(
        "highway=primary oneway=yes lanes=2 placement=right_of:1",
        "0..-325 FromLanes | - | 325..-325 FromLanes | 325..-325 FromLanes",
    );
    check(
        "highway=primary oneway=yes lanes=2 placement=middle_of:2",
        "162..-162 FromLanes | - | 488..-162 FromLanes | 488..-162 FromLanes",
    );
    check("highway=primary oneway=-1 lanes=2 placement=left_of:1", "- | -325..-650 FromLanes | - | 0..-650 FromLanes");
    check(
        "highway=primary lanes=3 lanes:forward=1 lanes:backward=2 placement:forward=left_of:1",
        "0..-325 FromLanes | -325..-650 FromLanes | 0..-325 FromLanes | 650..-325 FromLanes",
    );
    check(
        "highway=primary oneway=yes lanes=2 width=7 placement=transition",
        "0..-350 Estimated | - | 350..-350 Estimated | 350..-350 Estimated",
    );
    assert!(draft("highway=primary placement=left_of:-1").notes.has(Note::BadPlacement));
}

#[test]
fn a_physical_width_bounds_the_carriageway() {
    check(
        "highway=primary lanes=2 maxwidth:physical=3",
        "150..-150 FromLanes | 150..-150 FromLanes | 150..-150 FromLanes | 150..-150 FromLanes",
    );
    check(
        "highway=primary oneway=yes lanes=2 maxwidth:physical=6",
        "0..-300 FromLanes | - | 300..-300 FromLanes | 300..-300 FromLanes",
    );
    assert_eq!(draft("highway=primary maxwidth:physical=3").facts.legal_forward.max_width, Limit::At(3.0));
}

#[test]
fn odd_values_are_noted_and_change_nothing() {
    let plain = sections("highway=primary", &RIGHT);
    for (tag, note) in [
        ("width=7,5", "bad_width"),
        ("width=-3", "bad_width"),
        ("width=0", "bad_width"),
        ("width=NaN", "bad_width"),
        ("width=1e400", "bad_width"),
        ("width=ten", "bad_width"),
        ("width=99999999999999999999", "bad_width"),
        ("width=1.5;2", "bad_width"),
        ("width=", "bad_width"),
        ("width=1.2", "bad_width"),
        ("lanes=2;3", "bad_lanes"),
        ("lanes=-3", "bad_lanes"),
        ("lanes=0", "bad_lanes"),
        ("lanes=1e400", "bad_lanes"),
        ("lanes=99999999999999999999", "bad_lanes"),
        ("lanes=NaN", "bad_lanes"),
        ("maxspeed=-3", "bad_speed"),
        ("maxspeed=NaN", "bad_speed"),
        ("maxheight=0", "bad_limit"),
        ("maxheight=below_default", "bad_limit"),
        ("maxweight=-3", "bad_limit"),
        ("oneway=ten", "bad_oneway"),
        ("width:lanes=3|x", "bad_lane_widths"),
        ("access=sometimes", "bad_access"),
    ] {
        let text = format!("highway=primary {tag}");
        assert_eq!(draft(&text).notes.names().collect::<Vec<_>>(), [note], "{tag}");
        assert_eq!(sections(&text, &RIGHT), plain, "{tag}");
    }
    for tag in [
        "maxspeed=none",
        "maxspeed=40_mph",
        "maxspeed=DE:urban",
        "maxheight=default",
        "maxheight=12'6\"",
        "oneway=-1",
        "width=6'",
    ] {
        let text = format!("highway=primary {tag}");
        assert_eq!(draft(&text).notes, Notes::default(), "{tag}");
    }
}

#[test]
fn what_is_no_road_for_lorries_is_left_out_for_a_reason() {
    for (text, reason) in [
        ("building=yes", "no_highway"),
        ("highway=footway", "not_a_road"),
        ("highway=construction construction=primary", "not_in_use"),
        ("highway=service area=yes", "area"),
        ("highway=service service=parking_aisle", "minor_service"),
        ("highway=service service=driveway", "minor_service"),
        ("highway=track tracktype=grade1", "track"),
        ("highway=track motor_vehicle=yes", "track"),
    ] {
        assert_eq!(way_facts(&tags(text)).err(), Some(reason), "{text}");
        assert!(LEFT_OUT_REASONS.contains(&reason));
    }
    for text in [
        "highway=service service=alley",
        "highway=service service=driveway hgv=designated",
        "highway=track tracktype=grade1 motor_vehicle=permissive",
        "highway=track width=3.5 access=yes",
        "highway=road",
        "highway=residential access=private",
    ] {
        assert!(way_facts(&tags(text)).is_ok(), "{text}");
    }
}

#[test]
fn directions_come_from_oneway_roundabouts_and_motorways() {
    for (text, oneway) in [
        ("highway=primary", Oneway::No),
        ("highway=primary oneway=-1", Oneway::Backward),
        ("highway=primary junction=roundabout", Oneway::Forward),
        ("highway=motorway", Oneway::Forward),
        ("highway=motorway oneway=no", Oneway::No),
        ("highway=motorway_link", Oneway::No),
        ("highway=primary oneway=yes oneway:motor_vehicle=no", Oneway::No),
    ] {
        assert_eq!(draft(text).facts.oneway, oneway, "{text}");
    }
    let reversible = draft("highway=motorway oneway=reversible lanes=2");
    assert_eq!(reversible.facts.oneway, Oneway::No);
    assert_eq!(reversible.facts.legal_backward.hgv, Permission::Restricted);
    check(
        "highway=motorway oneway=reversible lanes=2",
        "0..-350 FromLanes | 0..-350 FromLanes | 350..-350 FromLanes | 350..-350 FromLanes",
    );
}

#[test]
fn the_most_specific_access_tag_decides() {
    use Permission::{No, Restricted, Yes};
    for (text, motor_vehicle, hgv) in [
        ("highway=primary", Yes, Yes),
        ("highway=primary access=no", No, Yes),
        ("highway=primary access=no motor_vehicle=destination", Restricted, Yes),
        ("highway=primary motor_vehicle=no hgv=designated", Yes, Yes),
        ("highway=primary hgv=no", Yes, No),
        ("highway=primary hgv=destination;delivery", Restricted, Restricted),
        ("highway=primary motor_vehicle=agricultural;forestry", No, Yes),
        ("highway=primary hgv=yes hgv_articulated=no", Yes, No),
        ("highway=primary trailer=no", Yes, No),
        ("highway=primary goods=no", Yes, Yes),
        ("highway=busway", No, Yes),
        ("highway=primary hgv:conditional=no@(Mo-Fr_22:00-06:00)", Yes, Restricted),
        ("highway=primary motor_vehicle=no motor_vehicle:conditional=yes@(06:00-11:00)", No, Yes),
        ("highway=primary access:conditional=no@hazmat", Yes, Yes),
    ] {
        let legal = draft(text).facts.legal_forward;
        assert_eq!((legal.motor_vehicle, legal.hgv), (motor_vehicle, hgv), "{text}");
    }
    let forward_only = draft("highway=primary hgv:backward=no").facts;
    assert_eq!((forward_only.legal_forward.hgv, forward_only.legal_backward.hgv), (Yes, No));
}

#[test]
fn the_strictest_limit_counts() {
    let legal = |text| draft(text).facts.legal_forward;
    assert_eq!(legal("highway=primary maxheight=4.5 maxheight:physical=4.2").max_height, Limit::At(4.2));
    assert_eq!(legal("highway=primary maxheight:lanes=4.5|3.9").max_height, Limit::At(3.9));
    assert_eq!(legal("highway=primary maxweight=30 maxweightrating:hgv=7.5").max_weight, Limit::At(7.5));
    assert_eq!(legal("highway=primary maxweight:bus=5 maxweight:signed=no").max_weight, Limit::None);
    assert_eq!(legal("highway=primary maxweight:backward=5").max_weight, Limit::None);
    assert_eq!(legal("highway=primary maxlength=10 maxlength:hgv_articulated=12").max_length, Limit::At(10.0));
    assert_eq!(legal("highway=primary hgv:conditional=no@(weight>7.5)").max_weight, Limit::At(7.5));
    assert_eq!(legal("highway=primary hgv:conditional=no@(length>12)").max_length, Limit::At(12.0));
    assert_eq!(
        legal("highway=primary maxweight:hgv=7.5 maxweight:hgv:conditional=none@destination").max_weight,
        Limit::At(7.5)
    );
    let timed = legal("highway=primary access:conditional=no@(7:30-19:00_AND_weight>7.5)");
    assert_eq!((timed.max_weight, timed.motor_vehicle), (Limit::None, Permission::Restricted));
}

fn lorry() -> Vehicle {
    let unit = Unit {
        name: String::new(),
        coupling_to_axle_m: 5.0,
        hitch_offset_m: 0.0,
        front_overhang_m: 1.0,
        rear_overhang_m: 1.0,
        width_m: 2.55,
        max_articulation_rad: 0.6,
        sway_rad: 0.0,
    };
    Vehicle {
        id: "lorry".into(),
        name: String::new(),
        region: String::new(),
        length_m: 16.5,
        height_m: Some(4.0),
        gross_mass_t: Some(40.0),
        axle_load_t: None,
        tracking_tolerance_m: 0.1,
        tracking_heading_rad: 0.05,
        min_shrink: 0.3,
        source: String::new(),
        units: vec![unit],
    }
}

#[test]
fn limits_forbid_or_leave_unknown() {
    use ForbiddenReason::{Access, Height, Hgv, Length, Weight, Width};
    for (tag, expected) in [
        ("maxheight=3.9", Some(Verdict::Forbidden(Height))),
        ("maxheight=4", None),
        ("maxwidth=2.55", None),
        ("maxwidth=2.5", Some(Verdict::Forbidden(Width))),
        ("maxweight=7.5", Some(Verdict::Forbidden(Weight))),
        ("maxlength=12", Some(Verdict::Forbidden(Length))),
        ("maxaxleload=1", None),
        ("maxheight=low", Some(Verdict::Unknown(UnknownReason::Limit))),
        ("maxaxleload=low", None),
        ("access=private", Some(Verdict::Forbidden(Access))),
        ("hgv=no", Some(Verdict::Forbidden(Hgv))),
        ("hgv=delivery", None),
    ] {
        assert_eq!(draft(&format!("highway=primary {tag}")).facts.legal_forward.forbids(&lorry()), expected, "{tag}");
    }
    let both = draft("highway=primary maxheight=low maxlength=12").facts.legal_forward;
    assert_eq!(both.forbids(&lorry()), Some(Verdict::Forbidden(Length)));
}

#[test]
fn nodes_bar_narrow_and_limit() {
    for (text, barred, passage_m) in [
        ("barrier=bollard", true, None),
        ("barrier=bollard maxwidth:physical=2.2", false, Some(2.2)),
        ("barrier=gate locked=yes", true, None),
        ("barrier=gate maxwidth=3", false, Some(3.0)),
        ("barrier=gate width=3.5", false, Some(3.5)),
        ("traffic_calming=choker", false, Some(3.0)),
        ("traffic_calming=table;choker width=3.2", false, Some(3.2)),
    ] {
        let facts = point_facts(&tags(text)).expect(text);
        assert_eq!((facts.barred, facts.passage_m), (barred, passage_m), "{text}");
    }
    for text in [
        "highway=crossing",
        "barrier=gate",
        "barrier=bollard motor_vehicle=yes",
        "barrier=cattle_grid access=yes",
        "amenity=bar access=private width=2",
    ] {
        assert_eq!(point_facts(&tags(text)), None, "{text}");
    }
    let legal = |text| point_facts(&tags(text)).expect(text).legal;
    assert_eq!(legal("barrier=lift_gate access=private").motor_vehicle, Permission::No);
    assert_eq!(legal("barrier=height_restrictor").max_height, Limit::Unreadable);
    assert_eq!(legal("barrier=height_restrictor maxheight=2.1").max_height, Limit::At(2.1));
    assert_eq!(legal("maxheight:forward=2.1").max_height, Limit::At(2.1));
}

#[test]
fn facts_stay_small() {
    assert!(size_of::<WayFacts>() <= 160, "{} bytes", size_of::<WayFacts>());
}

const KEYS: &[&str] = &[
    "width",
    "width:carriageway",
    "est_width",
    "source:width",
    "lanes",
    "lanes:forward",
    "lanes:backward",
    "lanes:both_ways",
    "lanes:psv",
    "width:lanes",
    "width:lanes:forward",
    "width:lanes:backward",
    "bus:lanes",
    "access:lanes:forward",
    "bicycle:lanes",
    "oneway",
    "junction",
    "narrow",
    "maxwidth:physical",
    "shoulder",
    "shoulder:width",
    "shoulder:left",
    "cycleway",
    "cycleway:left",
    "cycleway:right",
    "cycleway:right:width",
    "parking:left",
    "parking:right",
    "parking:both",
    "parking:both:orientation",
    "parking:right:width",
    "parking:lane:left",
    "parking:lane:both",
    "busway",
    "busway:right",
    "maxheight",
    "maxweight:conditional",
    "hgv",
    "hgv:conditional",
    "placement",
    "placement:forward",
    "placement:backward",
];
const VALUES: &[&str] = &[
    "1",
    "2",
    "3",
    "4",
    "16",
    "0.1",
    "1.8",
    "2.5",
    "3.6",
    "5",
    "7",
    "9.5",
    "14",
    "40",
    "65",
    "1e400",
    "NaN",
    "-3",
    "16'3\"",
    "yes",
    "no",
    "lane",
    "both",
    "left",
    "right",
    "parallel",
    "diagonal",
    "perpendicular",
    "3|3",
    "3.5|3|1.5",
    "1.5|3",
    "4|4|4|4|4",
    "||designated",
    "designated|",
    "no|yes|no",
    "alternating",
    "reversible",
    "-1",
    "roundabout",
    "right_of:1",
    "left_of:2",
    "middle_of:3",
    "transition",
    "estimated",
    "no @ (weight>7.5; 22:00)",
    "survey",
];
const CLASSES: &[&str] =
    &["motorway", "motorway_link", "primary", "tertiary", "residential", "service", "living_street"];

fn some_tags() -> impl Strategy<Value = Vec<(String, String)>> {
    let value = prop_oneof![9 => prop::sample::select(VALUES).prop_map(str::to_owned), 1 => "\\PC{0,12}"];
    let tag = (prop::sample::select(KEYS).prop_map(str::to_owned), value);
    (prop::sample::select(CLASSES), prop::collection::vec(tag, 0..9)).prop_map(|(class, mut tags)| {
        tags.sort();
        tags.dedup_by(|a, b| a.0 == b.0);
        tags.push(("highway".to_owned(), class.to_owned()));
        tags
    })
}

fn borrowed(tags: &[(String, String)]) -> Vec<(&str, &str)> {
    tags.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect()
}

/// The same road seen in a mirror: left is right, and lists run the other way.
fn mirrored(tags: &[(String, String)]) -> Vec<(String, String)> {
    let swap = |text: &str| text.replace("left", "\u{1}").replace("right", "left").replace('\u{1}', "right");
    tags.iter()
        .map(|(key, value)| {
            let lists = key.contains(":lanes");
            let value = if lists { value.split('|').rev().collect::<Vec<_>>().join("|") } else { value.clone() };
            (swap(key), if key == "shoulder" { swap(&value) } else { value })
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn strips_are_sound_whatever_the_tags(tags in some_tags(), left_hand_traffic: bool) {
        let place = Place { left_hand_traffic, ..RIGHT };
        let facts = way_facts(&borrowed(&tags)).unwrap().facts;
        for section in cross_sections(&facts, &place, &Rules::builtin().unwrap()) {
            let strips = [section.lane, section.direction, section.carriageway];
            for strip in strips.into_iter().flatten() {
                prop_assert!(strip.left_m.is_finite() && strip.right_m.is_finite());
                prop_assert!((1.79..=80.0).contains(&strip.width_m()), "{strip:?}");
            }
            // Each policy allows at least what the one before allows.
            for pair in strips.windows(2) {
                if let [Some(inner), Some(outer)] = pair {
                    prop_assert!(outer.left_m >= inner.left_m && outer.right_m <= inner.right_m, "{section:?}");
                }
                prop_assert!(pair[0].is_none() || pair[1].is_some());
            }
            let physical_m = tags.iter().find(|(key, _)| key == "maxwidth:physical").and_then(|(_, value)| metres(value));
            if let (Some(most_m), Some(all)) = (physical_m, section.carriageway) {
                prop_assert!(all.width_m() <= most_m + 1e-3, "{all:?} of at most {most_m}");
            }
            if let (Some(width_m), Some(all)) = (facts.tagged_width_m(), section.carriageway)
                && all.source >= WidthSource::Tagged && !tags.iter().any(|(key, _)| key.starts_with("width:lanes"))
            {
                prop_assert!(all.width_m() <= width_m + 1e-3, "{all:?} of {width_m}");
            }
        }
    }

    #[test]
    fn left_hand_traffic_is_the_mirror_image(tags in some_tags()) {
        let tags: Vec<_> = tags.into_iter().filter(|(key, _)| !key.starts_with("placement")).collect();
        let mirror = mirrored(&tags);
        let rules = Rules::builtin().unwrap();
        let right = cross_sections(&way_facts(&borrowed(&tags)).unwrap().facts, &RIGHT, &rules);
        let left = cross_sections(&way_facts(&borrowed(&mirror)).unwrap().facts, &LEFT, &rules);
        for (a, b) in right.into_iter().zip(left) {
            for (a, b) in [(a.lane, b.lane), (a.direction, b.direction), (a.carriageway, b.carriageway)] {
                match (a, b) {
                    (None, None) => {}
                    (Some(a), Some(b)) => {
                        prop_assert!((a.left_m + b.right_m).abs() < 1e-3 && (a.right_m + b.left_m).abs() < 1e-3, "{a:?} {b:?}");
                        prop_assert_eq!(a.source, b.source);
                    }
                    _ => prop_assert!(false, "{a:?} {b:?}"),
                }
            }
        }
    }

    #[test]
    fn limits_are_positive_and_finite_whatever_the_text(text in "\\PC{0,16}", at in 0..VALUES.len()) {
        for value in [text.as_str(), VALUES[at]] {
            for key in ["maxheight", "maxweight", "maxaxleload", "maxlength", "maxwidth", "hgv:conditional"] {
                let legal = way_facts(&[("highway", "primary"), (key, value)]).unwrap().facts.legal_forward;
                for limit in [legal.max_height, legal.max_weight, legal.max_axle_load, legal.max_length, legal.max_width] {
                    if let Limit::At(limit) = limit {
                        prop_assert!(limit.is_finite() && limit > 0.0);
                    }
                }
            }
            let _ = point_facts(&[("barrier", value), ("maxwidth", value)]);
        }
    }
}
