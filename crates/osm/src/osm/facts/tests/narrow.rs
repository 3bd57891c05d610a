//! Widths however small, widths that cannot be read, and narrow roads.

use proptest::prelude::*;

use super::*;

/// Widths of the forward lane and of the carriageway in centimetres, and the lane's evidence.
fn forward(text: &str) -> String {
    let [forward, _] = sections(text, &RIGHT);
    let cm = |strip: Option<Strip>| strip.map_or("-".to_owned(), |s| format!("{:.0}", s.width_m() * 100.0));
    let source = forward.lane.map_or(String::new(), |lane| format!(" {:?}", lane.source));
    format!("{} {}{source}", cm(forward.lane), cm(forward.carriageway))
}

#[test]
fn a_width_counts_however_small() {
    for (text, expected) in [
        // The ways of a drawn map.
        ("highway=service width=1.5", "150 150 Tagged"),
        ("highway=residential width=1.5", "150 150 Estimated"),
        ("highway=unclassified width=1.7", "170 170 Estimated"),
        ("highway=residential width=1.79", "179 179 Estimated"),
        ("highway=residential width=1.8", "180 180 Estimated"),
        ("highway=residential width:carriageway=1.7", "170 170 Estimated"),
        ("highway=residential width=0.9", "90 90 Estimated"),
        ("highway=service width=1.5 lanes=1", "150 150 Tagged"),
        ("highway=track tracktype=grade1 motor_vehicle=yes width=1.5", "150 150 Tagged"),
        ("highway=residential", "275 550 Assumed"),
        ("highway=secondary", "300 600 Assumed"),
        // Others of the kind.
        ("highway=residential width=0.3", "30 30 Estimated"),
        ("highway=residential width=0.0001", "0 0 Estimated"),
        ("highway=residential width=5'", "152 152 Estimated"),
        ("highway=residential width=5'6\"", "168 168 Estimated"),
        ("highway=residential width=150cm", "150 150 Estimated"),
        ("highway=residential width=1,6", "160 160 Estimated"),
        ("highway=residential est_width=1.6", "160 160 Estimated"),
        ("highway=residential est_width=0.9 width=ten", "90 90 Estimated"),
        ("highway=residential width=1.6 est_width=5", "160 160 Estimated"),
        ("highway=residential lanes=1 width=1.6", "160 160 Tagged"),
        ("highway=residential lanes=2 width=1.6", "160 160 Estimated"),
        ("highway=residential oneway=yes width=1.6", "160 160 Tagged"),
        ("highway=residential oneway=yes lanes=2 width=3", "275 275 FromLanes"),
        ("highway=residential oneway=alternating width=1.6", "160 160 Tagged"),
        ("highway=motorway width=1.6", "160 160 Estimated"),
        ("highway=tertiary junction=roundabout width=1.6", "160 160 Tagged"),
        ("highway=trunk_link oneway=yes width=1.6", "160 160 Tagged"),
        ("highway=residential maxwidth:physical=1.5", "150 150 Assumed"),
        ("highway=residential width=5 maxwidth:physical=1.5", "150 150 Estimated"),
        // The least of what is said.
        ("highway=residential lanes=1 width=1.5;2", "150 150 Estimated"),
        ("highway=residential lanes=1 width=2-3", "200 200 Estimated"),
        ("highway=residential lanes=1 width=~3", "300 300 Estimated"),
        ("highway=residential lanes=1 width=ca.3", "300 300 Estimated"),
        ("highway=residential lanes=1 width=3+", "300 300 Estimated"),
    ] {
        assert_eq!(forward(text), expected, "{text}");
        assert!(!draft(text).notes.has(Note::BadWidth) || text.contains("ten"), "{text}");
    }
}

#[test]
fn a_width_that_cannot_be_read_is_unknown_and_noted() {
    for value in [
        "-3",
        "0",
        "0.0",
        "NaN",
        "1e400",
        "ten",
        "99999999999999999999",
        "",
        "50",
        "40.1",
        "narrow",
        "<3",
        "1.5;x",
        "3,500",
        "7.5.2",
        "yes",
    ] {
        for key in ["width", "width:carriageway", "est_width"] {
            for class in ["residential", "secondary lanes=2", "motorway", "service", "secondary oneway=yes lanes=1"] {
                let text = format!("highway={class} {key}={value}");
                let draft = draft(&text);
                assert_eq!(draft.notes.names().collect::<Vec<_>>(), ["bad_width"], "{text}");
                for section in sections(&text, &RIGHT) {
                    assert_eq!(section, layout_of_nothing(), "{text}");
                }
            }
        }
    }
    // What other tags say counts.
    for (text, expected) in [
        ("highway=residential lanes=1 width=ten est_width=3", "300 300 Estimated"),
        ("highway=residential lanes=1 width=50 width:carriageway=3", "300 300 Tagged"),
        ("highway=secondary oneway=yes lanes=2 width=50 width:lanes=3|3", "300 600 Tagged"),
        ("highway=secondary oneway=yes lanes=2 width=50 width:lanes=3|", "- -"),
    ] {
        assert_eq!(forward(text), expected, "{text}");
        assert!(draft(text).notes.has(Note::BadWidth));
    }
}

fn layout_of_nothing() -> CrossSection {
    CrossSection { lane: None, direction: None, carriageway: None }
}

#[test]
fn narrow_roads_of_unknown_width_have_no_ordinary_lanes() {
    for (text, expected) in [
        ("highway=service narrow=yes", "220 220 Assumed"),
        ("highway=residential narrow=yes", "220 220 Assumed"),
        ("highway=secondary narrow=yes", "220 220 Assumed"),
        ("highway=secondary narrow=yes lanes=1", "220 220 FromLanes"),
        ("highway=secondary narrow=yes lanes=2", "220 440 FromLanes"),
        ("highway=secondary narrow=yes oneway=yes", "220 220 Assumed"),
        ("highway=secondary narrow=yes oneway=yes lanes=2", "220 440 FromLanes"),
        ("highway=secondary narrow=yes oneway=yes lanes=2 width:lanes=3|", "220 520 FromLanes"),
        ("highway=secondary narrow=yes oneway=yes width:lanes=", "220 220 FromLanes"),
        ("highway=trunk_link narrow=yes oneway=yes lanes=1", "220 220 FromLanes"),
        ("highway=secondary narrow=no", "300 600 Assumed"),
        // A width says more.
        ("highway=secondary narrow=yes lanes=1 width=3.4", "340 340 Tagged"),
        ("highway=secondary narrow=yes lanes=1 est_width=3.4", "340 340 Estimated"),
    ] {
        assert_eq!(forward(text), expected, "{text}");
    }
}

#[test]
fn one_lane_for_both_directions_is_not_halved() {
    for text in [
        "highway=secondary lanes=1 width=3.2 oneway=alternating",
        "highway=secondary lanes=1 width=3.2",
        "highway=secondary width=3.2 oneway=alternating",
    ] {
        for section in sections(text, &RIGHT) {
            let lane = section.lane.unwrap();
            assert!((lane.width_m() - 3.2).abs() < 1e-3, "{text}: {lane:?}");
        }
    }
    assert_eq!(forward("highway=secondary lanes=1 width=5 oneway=alternating"), "500 500 Tagged");
    // Wider than one lane: the lane is as wide as assumed.
    assert_eq!(forward("highway=secondary lanes=1 width=9 oneway=alternating"), "300 300 FromLanes");
}

const ROADS: &[&str] = &[
    "highway=residential",
    "highway=service",
    "highway=secondary lanes=1",
    "highway=secondary lanes=2",
    "highway=secondary oneway=yes",
    "highway=secondary oneway=yes lanes=2",
    "highway=secondary oneway=-1 lanes=3 lanes:bus=1",
    "highway=secondary lanes=3 lanes:both_ways=1",
    "highway=motorway shoulder=right",
    "highway=residential parking:right=lane",
    "highway=residential cycleway:both=lane cycleway:both:width=1",
    "highway=tertiary junction=roundabout",
    "highway=residential oneway=alternating",
    "highway=secondary oneway=yes lanes=2 busway=opposite_lane",
    "highway=residential narrow=yes",
];
const KEYS: &[&str] = &["width", "width:carriageway", "est_width", "maxwidth:physical"];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Below the least lane there is one lane at most, so a smaller width gives narrower strips.
    #[test]
    fn a_smaller_width_never_gives_a_wider_strip(
        road in prop::sample::select(ROADS), key in prop::sample::select(KEYS), a in 1..1800_u32, b in 1..1800_u32, left: bool,
    ) {
        let place = if left { LEFT } else { RIGHT };
        let at = |mm: u32| format!("{road} {key}={}", f64::from(mm) / 1000.0);
        let (small, great) = (a.min(b), a.max(b));
        let [narrow, wide] = [small, great].map(|mm| sections(&at(mm), &place));
        let untagged = sections(road, &place);
        for ((narrow, wide), untagged) in narrow.into_iter().zip(wide).zip(untagged) {
            for policy in [Policy::Lane, Policy::Direction, Policy::Carriageway] {
                let width_m = |section: CrossSection| section.strip(policy).map_or(0.0, |strip| strip.width_m());
                prop_assert!(width_m(narrow) <= width_m(wide) + 1e-5, "{} {}: {narrow:?} {wide:?}", at(small), at(great));
                prop_assert!(width_m(narrow) <= small as f32 / 1000.0 + 1e-5, "{}: {narrow:?}", at(small));
                prop_assert!(width_m(wide) <= width_m(untagged) + 1e-5, "{}: {wide:?} {untagged:?}", at(great));
            }
        }
    }
}
