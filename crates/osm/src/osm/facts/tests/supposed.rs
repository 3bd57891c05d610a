//! How many lanes a one-way road is supposed to have, by country and class.

use super::*;

const US: Jurisdiction = Jurisdiction { country: *b"US", left_hand_traffic: false };

/// Widths of lane, direction and carriageway in centimetres, in the direction of a one-way road, and the evidence of the direction.
fn widths(text: &str, jurisdiction: &Jurisdiction) -> String {
    let [forward, backward] = sections(text, jurisdiction);
    shown(if forward.direction.is_some() { forward } else { backward })
}

fn shown(section: CrossSection) -> String {
    let strips = [section.lane, section.direction, section.carriageway];
    let [lane, direction, carriageway] = strips.map(|strip| strip.map_or(0.0, |strip| 100.0 * strip.width_m()));
    let source = section.direction.map(|strip| format!(" {:?}", strip.source)).unwrap_or_default();
    format!("{lane:.0} {direction:.0} {carriageway:.0}{source}")
}

#[test]
fn a_group_of_which_nine_in_ten_have_two_lanes_has_two() {
    // On the right the own lane is the right half, whichever way the nodes run.
    check_at("highway=primary oneway=yes", &US, "0..-335 Assumed | - | 335..-335 Assumed | 335..-335 Assumed");
    check_at("highway=primary oneway=-1", &US, "- | 0..-335 Assumed | - | 335..-335 Assumed");
    // On the left it is the left half.
    let left = Jurisdiction { left_hand_traffic: true, ..US };
    check_at("highway=primary oneway=yes", &left, "335..0 Assumed | - | 335..-335 Assumed | 335..-335 Assumed");
    // The way's line may lie to the right of the first lane.
    check_at(
        "highway=primary oneway=yes placement=right_of:1",
        &US,
        "0..-335 Assumed | - | 335..-335 Assumed | 335..-335 Assumed",
    );
    // Names, speeds, and what lies beside the lanes say nothing of lanes.
    for tags in ["name=Broad_Street maxspeed=35_mph", "parking:right=lane", "cycleway:right=lane", "hgv=designated"] {
        assert_eq!(widths(&format!("highway=primary oneway=yes {tags}"), &US), "335 670 670 Assumed", "{tags}");
    }
}

#[test]
fn other_groups_have_the_lanes_of_their_class() {
    let at = |country: &[u8; 2]| Jurisdiction { country: *country, left_hand_traffic: false };
    for (country, class, expected) in [
        // Fewer than nine in ten, or too few to know.
        (b"US", "trunk", "335 335 335 Assumed"),
        (b"US", "secondary", "305 305 305 Assumed"),
        (b"US", "residential", "275 275 275 Assumed"),
        (b"DE", "primary", "325 325 325 Assumed"),
        (b"DE", "trunk", "350 350 350 Assumed"),
        (b"AU", "primary", "350 350 350 Assumed"),
        // Never held back by neighbourhood.
        (b"CN", "primary", "325 325 325 Assumed"),
        (b"ZZ", "primary", "325 325 325 Assumed"),
        // Two lanes of the class.
        (b"US", "motorway", "366 732 732 Assumed"),
        (b"ZZ", "motorway", "350 700 700 Assumed"),
    ] {
        let text = format!("highway={class} oneway=yes");
        assert_eq!(widths(&text, &at(country)), expected, "{class} {}", country.escape_ascii());
    }
    // One lane for each direction of a two-way road.
    assert_eq!(widths("highway=primary", &US), "335 335 670 Assumed");
}

#[test]
fn a_tag_says_more_than_the_group() {
    for (tags, expected) in [
        ("lanes=1", "335 335 335 FromLanes"),
        ("lanes=2", "335 670 670 FromLanes"),
        ("lanes=3", "335 1005 1005 FromLanes"),
        ("lanes:forward=1", "335 335 335 FromLanes"),
        ("turn:lanes=left|through|right", "335 1005 1005 FromLanes"),
        ("turn:lanes=through", "335 335 335 FromLanes"),
        ("narrow=yes", "220 220 220 Assumed"),
        ("maxwidth:physical=3", "300 300 300 Assumed"),
        ("width=7", "425 700 700 Estimated"),
        ("est_width=4", "400 400 400 Estimated"),
        ("width:lanes=3", "300 300 300 Tagged"),
    ] {
        let text = format!("highway=primary oneway=yes {tags}");
        assert_eq!(widths(&text, &US), expected, "{text}");
    }
    for (text, expected) in [
        ("highway=primary_link oneway=yes", "420 420 420 Assumed"),
        ("highway=primary junction=roundabout", "430 430 430 Assumed"),
        ("highway=primary junction=circular oneway=yes", "430 430 430 Assumed"),
        ("highway=primary oneway=reversible", "335 335 335 Assumed"),
    ] {
        assert_eq!(widths(text, &US), expected, "{text}");
    }
    // Even a tag of lanes that does not count them all.
    for tags in [
        "lanes:psv=1",
        "lanes:bus=1",
        "busway=lane",
        "hov=lane",
        "busway=opposite_lane",
        "oneway:bus=no",
        "bus:backward=yes",
        "lanes:backward=1",
        "bus:lanes=designated|",
        "width:lanes=|3",
        "cycleway:right=lane turn:lanes=through|right",
        "width=wide",
    ] {
        let text = format!("highway=primary oneway=yes {tags}");
        for section in sections(&text, &US) {
            assert_ne!(section.supposed_lanes(), Some(2), "{text}");
        }
    }
}

#[test]
fn a_source_that_does_not_tell_rings_has_one_lane() {
    let values = RoadValues {
        class: RoadClass::Primary,
        link: false,
        oneway: Oneway::Forward,
        traffic: Oneway::Forward,
        legal: [Legal::default(), Legal::default()],
        max_speed_km_h: [None; 2],
        width_m: None,
    };
    let facts = values.facts(&mut Notes::default());
    let [forward, _] = cross_sections(&facts, &US, None, &Rules::builtin().unwrap());
    assert_eq!(shown(forward), "335 335 335 Assumed");
}

/// What a wrong supposition may do under the policy of the own lane: the lane lies half a lane nearer to the kerb, and is no wider.
#[test]
fn the_own_lane_is_as_wide_with_supposed_lanes_as_with_one() {
    for left_hand_traffic in [false, true] {
        let place = Jurisdiction { left_hand_traffic, ..US };
        for oneway in ["yes", "-1"] {
            let text = format!("highway=primary oneway={oneway}");
            let (supposed, one) = (sections(&text, &place), sections(&format!("{text} lanes=1"), &place));
            for (supposed, one) in supposed.into_iter().zip(one) {
                let Some((own, alone)) = supposed.lane.zip(one.lane) else {
                    assert_eq!((supposed.lane, one.lane), (None, None), "{text}");
                    continue;
                };
                assert_eq!(own.width_m(), alone.width_m(), "{text}");
                let to_kerb_m = if left_hand_traffic { own.left_m - alone.left_m } else { alone.right_m - own.right_m };
                assert!((to_kerb_m - own.width_m() / 2.0).abs() < 1e-6, "{text}: {to_kerb_m}");
                assert_eq!([own.source, supposed.direction.unwrap().source], [WidthSource::Assumed; 2]);
                assert_eq!((supposed.supposed_lanes(), one.supposed_lanes()), (Some(2), None));
            }
        }
    }
}
