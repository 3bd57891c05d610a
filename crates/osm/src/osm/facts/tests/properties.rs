//! Properties that hold for any tags.

use proptest::prelude::*;

use super::*;

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
    "hgv:lanes",
    "hov:lanes",
    "hov",
    "lanes:hov",
    "lanes:psv:backward",
    "width:lanes:both_ways",
    "oneway:bus",
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
    "0.9",
    "1.5",
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
    "3.5||2.2",
    "|2.2",
    "3,5|3,25",
    "opposite_lane",
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

/// The same road mirrored: left becomes right, and lists are reversed.
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
    fn strips_are_sound_whatever_the_tags(
        tags in some_tags(), country in prop::sample::select(vec![*b"ZZ", *b"US", *b"DE"]), left_hand_traffic: bool,
    ) {
        let jurisdiction = Jurisdiction { country, left_hand_traffic };
        let facts = way_facts(&borrowed(&tags)).unwrap().facts;
        for section in cross_sections(&facts, &jurisdiction, None, &Rules::builtin().unwrap()) {
            let strips = [section.lane, section.direction, section.carriageway];
            for strip in strips.into_iter().flatten() {
                prop_assert!(strip.left_m.is_finite() && strip.right_m.is_finite());
                prop_assert!(strip.width_m() > 0.0 && strip.width_m() <= 80.0, "{strip:?}");
            }
            // Each policy allows at least what the previous one allows.
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
        // Neither has a list that is shorter than the road has lanes: it begins at the left in either case.
        let listed = tags.iter().any(|(key, _)| key.contains(":lanes"));
        let mirrored_too = |key: &str| !(key.starts_with("placement") || listed && key.starts_with("lanes"));
        let tags: Vec<_> = tags.into_iter().filter(|(key, _)| mirrored_too(key)).collect();
        let mirror = mirrored(&tags);
        let rules = Rules::builtin().unwrap();
        let right = cross_sections(&way_facts(&borrowed(&tags)).unwrap().facts, &RIGHT, None, &rules);
        let left = cross_sections(&way_facts(&borrowed(&mirror)).unwrap().facts, &LEFT, None, &rules);
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
