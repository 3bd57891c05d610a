//! Lists of lanes as far as they go, and lanes of others.

use proptest::prelude::*;

use super::*;

/// Width of the own lane in centimetres and its evidence, of the direction, and of the carriageway with its evidence.
fn own(text: &str, jurisdiction: &Jurisdiction) -> String {
    let [forward, backward] = sections(text, jurisdiction);
    let section = if forward == backward || forward.carriageway.is_some() { forward } else { backward };
    let show =
        |strip: Option<Strip>| strip.map_or("-".to_owned(), |s| format!("{:.0} {:?}", s.width_m() * 100.0, s.source));
    [section.lane, section.direction, section.carriageway].map(show).join(" | ")
}

const ONE_WAY: &str = "highway=secondary oneway=yes";

#[test]
fn a_list_is_read_as_far_as_it_goes() {
    for (tags, expected) in [
        // The ways of a drawn map.
        ("lanes=3 width:lanes=|3.0|2.2", "220 Tagged | 820 FromLanes | 820 FromLanes"),
        ("lanes=2 width:lanes=|2.2", "220 Tagged | 520 FromLanes | 520 FromLanes"),
        ("lanes=2 width:lanes=3.5|", "300 FromLanes | 650 FromLanes | 650 FromLanes"),
        ("lanes=2 width:lanes=3.5|2.2m", "220 Tagged | 570 Tagged | 570 Tagged"),
        ("lanes=2 width:lanes=11'|7'6\"", "225 Tagged | 560 Tagged | 560 Tagged"),
        ("lanes=2 width:lanes=3.5|none", "300 FromLanes | 650 FromLanes | 650 FromLanes"),
        ("lanes=2 width:lanes=2.2", "220 FromLanes | 440 FromLanes | 440 FromLanes"),
        ("lanes=2 hov:lanes=designated| width=7", "350 Tagged | 350 Tagged | 700 Tagged"),
        ("lanes=2 taxi:lanes=|designated access:lanes=|no width=7", "350 Tagged | 350 Tagged | 700 Tagged"),
        ("lanes=2 emergency:lanes=yes| vehicle:lanes=no|yes width=7", "350 Tagged | 350 Tagged | 700 Tagged"),
        ("lanes=2 lanes:bus=1 width=7", "350 Tagged | 350 Tagged | 700 Tagged"),
        ("lanes=2 busway=lane width=7", "350 Tagged | 350 Tagged | 700 Tagged"),
        ("lanes=2 hgv:lanes=yes|discouraged width=7", "350 Tagged | 350 Tagged | 700 Tagged"),
        ("lanes=2 width=7", "350 Tagged | 700 Tagged | 700 Tagged"),
        ("lanes=2 width:lanes=2.2|3.5 hgv:lanes=no|", "350 Tagged | 350 Tagged | 570 Tagged"),
        // Others of the kind.
        ("lanes=2 width:lanes=3.5|1.5", "150 Tagged | 500 Tagged | 500 Tagged"),
        ("lanes=2 width:lanes=3.5|0.9", "90 Tagged | 440 Tagged | 440 Tagged"),
        ("width:lanes=3.5|1.5", "150 Tagged | 500 Tagged | 500 Tagged"),
        ("width:lanes=1.5", "150 Tagged | 150 Tagged | 150 Tagged"),
        ("lanes=1 width:lanes=2,2", "220 Tagged | 220 Tagged | 220 Tagged"),
        ("lanes=2 width:lanes=3,5|2,25", "225 Tagged | 575 Tagged | 575 Tagged"),
        ("lanes=3 width:lanes=3.5||2.2", "220 Tagged | 870 FromLanes | 870 FromLanes"),
        ("lanes=3 width:lanes=3.5|3", "300 FromLanes | 950 FromLanes | 950 FromLanes"),
        ("lanes=3 width:lanes=2.1|3", "210 FromLanes | 720 FromLanes | 720 FromLanes"),
        ("lanes=2 width:lanes=3.5|9", "300 FromLanes | 650 FromLanes | 650 FromLanes"),
        ("lanes=2 width:lanes=||", "300 FromLanes | 900 FromLanes | 900 FromLanes"),
        ("lanes=2 width:lanes=|2.2 width=6", "220 Tagged | 600 Tagged | 600 Tagged"),
        ("lanes=2 width:lanes=3.5| width=6", "250 Tagged | 600 Tagged | 600 Tagged"),
        ("lanes=2 width:lanes=3.5| width=5", "150 Tagged | 500 Tagged | 500 Tagged"),
        ("lanes=2 width:lanes=|2.2 width=3", "220 Tagged | 300 Tagged | 300 Tagged"),
        // A width too small for the list: no lane is wider than its entry or than its share.
        ("lanes=2 width:lanes=3.5|2.2 width=5", "220 Tagged | 470 Tagged | 470 Tagged"),
        ("lanes=2 width:lanes=3.5|3.5 width=5", "250 Tagged | 500 Tagged | 500 Tagged"),
        ("lanes=2 width:lanes=2.2|2.2 width=3", "220 FromLanes | 220 FromLanes | 220 FromLanes"),
        // Cycle lanes are in lists and not in `lanes`.
        ("lanes=1 width:lanes=3.2|1.2", "320 Tagged | 320 Tagged | 320 Tagged"),
        ("lanes=1 width:lanes=3.2|1.2 bicycle:lanes=|designated", "320 Tagged | 320 Tagged | 320 Tagged"),
        ("width:lanes=3.2|1.2 cycleway:right=lane", "320 Tagged | 320 Tagged | 320 Tagged"),
        ("lanes=2 width:lanes=3|3|1.5|1.5", "300 Tagged | 600 Tagged | 600 Tagged"),
        ("lanes=2 width:lanes=3|1.6|1.5", "160 Tagged | 460 Tagged | 460 Tagged"),
        // Lists that disagree bound all lanes.
        ("lanes=2 width:lanes=3|2.4 bicycle:lanes=||designated", "240 FromLanes | 480 FromLanes | 480 FromLanes"),
        ("width:lanes=3|3|3|3|3|3|3|3|2.2", "220 Assumed | 220 Assumed | 220 Assumed"),
        ("lanes=2 hgv:lanes=no", "- | - | -"),
        ("lanes=2 hgv:lanes=yes", "300 FromLanes | 600 FromLanes | 600 FromLanes"),
        ("lanes=2 hgv_articulated:lanes=|no width:lanes=3.1|3.2", "310 Tagged | 310 Tagged | 630 Tagged"),
    ] {
        let text = format!("{ONE_WAY} {tags}");
        // The same lanes against the node order.
        let against = text.replace("oneway=yes", "oneway=-1");
        for text in [text, against] {
            assert_eq!(own(&text, &RIGHT), expected, "{text}");
        }
    }
    for (tags, noted) in [
        ("lanes=2 width:lanes=3.5|", false),
        ("lanes=2 width:lanes=2.2", false),
        ("lanes=2 width:lanes=3,5|3,25", false),
        ("lanes=2 width:lanes=3.5|none", true),
        ("lanes=2 width:lanes=3.5|-1", true),
        ("lanes=2 width:lanes=3.5|0", true),
        ("lanes=2 width:lanes=3.5|9", true),
        ("lanes=2 width:lanes=3|3 bicycle:lanes=||designated", true),
        ("width:lanes=3|3|3|3|3|3|3|3|2.2", true),
    ] {
        let text = format!("{ONE_WAY} {tags}");
        assert_eq!(draft(&text).notes.has(Note::BadLaneWidths), noted, "{text}");
    }
}

#[test]
fn the_lane_at_the_kerb_is_the_own_one_on_either_side() {
    for (tags, right, left) in [
        ("lanes=2 width:lanes=3.5|2.2", "220 Tagged", "350 Tagged"),
        ("lanes=2 width:lanes=3.5|", "300 FromLanes", "350 Tagged"),
        ("lanes=2 width:lanes=|2.2", "220 Tagged", "300 FromLanes"),
        ("lanes=2 width:lanes=2.2", "220 FromLanes", "220 Tagged"),
        ("lanes=3 lanes:bus=1 width:lanes=3.5|3|2.5", "300 Tagged", "300 Tagged"),
    ] {
        let text = format!("{ONE_WAY} {tags}");
        let lane = |jurisdiction| own(&text, jurisdiction).split(" | ").next().unwrap_or_default().to_owned();
        assert_eq!((lane(&RIGHT).as_str(), lane(&LEFT).as_str()), (right, left), "{text}");
    }
}

#[test]
fn a_list_without_a_direction_covers_a_two_way_road() {
    for (tags, right, left) in [
        ("lanes=2 width:lanes=2.3|2.3", ["230 Tagged"; 2], ["230 Tagged"; 2]),
        ("width:lanes=2.3|2.3", ["230 Tagged"; 2], ["230 Tagged"; 2]),
        ("lanes=2 width:lanes=2.3|3.1", ["310 Tagged", "230 Tagged"], ["230 Tagged", "310 Tagged"]),
        ("lanes=2 width:lanes=|3.1", ["310 Tagged", "300 FromLanes"], ["300 FromLanes", "310 Tagged"]),
        ("lanes=4 width:lanes=2.1|2.2|2.3|2.4", ["240 Tagged", "210 Tagged"], ["210 Tagged", "240 Tagged"]),
        ("lanes=3 width:lanes=2.1|2.2|2.3", ["230 Tagged", "210 Tagged"], ["210 Tagged", "230 Tagged"]),
        ("lanes=3 lanes:forward=2 width:lanes=2.1|2.2|2.3", ["230 Tagged", "210 Tagged"], ["210 Tagged", "230 Tagged"]),
        ("lanes=2 width:lanes=1.5|2.9|2.8|1.5", ["280 Tagged", "290 Tagged"], ["290 Tagged", "280 Tagged"]),
        // Another length: which lane is which is unknown.
        ("lanes=2 width:lanes=2.3", ["230 FromLanes"; 2], ["230 FromLanes"; 2]),
        ("lanes=2 width:lanes=3|2.4|3", ["240 FromLanes"; 2], ["240 FromLanes"; 2]),
        ("lanes=1 width:lanes=2.3", ["230 Tagged"; 2], ["230 Tagged"; 2]),
        ("oneway=alternating width:lanes=2.3", ["230 Tagged"; 2], ["230 Tagged"; 2]),
        ("lanes=2 width:lanes:forward=2.3", ["230 Tagged", "300 FromLanes"], ["230 Tagged", "300 FromLanes"]),
        ("lanes=2 width:lanes:backward=2.3", ["300 FromLanes", "230 Tagged"], ["300 FromLanes", "230 Tagged"]),
    ] {
        let text = format!("highway=secondary {tags}");
        for (jurisdiction, expected) in [(&RIGHT, right), (&LEFT, left)] {
            let got = sections(&text, jurisdiction).map(|section| {
                section.lane.map_or("-".to_owned(), |s| format!("{:.0} {:?}", s.width_m() * 100.0, s.source))
            });
            assert_eq!(got, expected, "{text}");
        }
    }
}

#[test]
fn lanes_for_both_directions_take_their_share() {
    let width = |tags: &str| own(&format!("highway=secondary {tags}"), &RIGHT);
    assert_eq!(width("width=9"), "425 Estimated | 450 Estimated | 900 Tagged");
    assert_eq!(width("width=9 turn:lanes:both_ways=left"), "300 Estimated | 300 Estimated | 900 Tagged");
    assert_eq!(width("lanes=3 width=9 width:lanes:both_ways=4"), "250 Tagged | 250 Tagged | 900 Tagged");
}

#[test]
fn lanes_of_oncoming_buses_are_not_those_of_a_lorry() {
    // Forward lane | forward direction | carriageway.
    for (tags, expected) in [
        ("lanes=2 busway=opposite_lane width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 busway:left=opposite_lane width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 lanes:psv:backward=1 width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 lanes:bus:backward=1 width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 lanes:forward=1 lanes:backward=1 width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 lanes:forward=1 width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 bus:lanes:backward=designated width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 oneway:bus=no width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 oneway:psv=no width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=2 bus:backward=yes width=7", "0..-350 | 0..-350 | 350..-350"),
        ("oneway:bus=no width=7", "0..-350 | 0..-350 | 350..-350"),
        ("lanes=3 busway=opposite_lane width=9", "-150..-450 | 150..-450 | 450..-450"),
        ("lanes=2 busway=opposite_lane", "0..-300 | 0..-300 | 300..-300"),
        ("busway=opposite_lane", "0..-300 | 0..-300 | 300..-300"),
        ("lanes=2 busway=opposite_lane width:lanes=3|3.5", "25..-325 | 25..-325 | 325..-325"),
        (
            "lanes=2 busway=opposite_lane width:lanes:forward=3 width:lanes:backward=3.5",
            "-25..-325 | -25..-325 | 325..-325",
        ),
        ("lanes=1 busway=opposite_lane width=7", "0..-350 | 0..-350 | 350..-350"),
        // One lane for all, and a permission alone makes no road wider.
        ("lanes=1 oneway:bus=no width=5", "250..-250 | 250..-250 | 250..-250"),
        ("oneway:bus=no", "150..-150 | 150..-150 | 150..-150"),
        // Left from before a road was mapped as two.
        ("lanes:forward=3 lanes:backward=3", "-150..-450 | 450..-450 | 450..-450"),
        ("lanes=3 lanes:forward=3 lanes:backward=3", "-150..-450 | 450..-450 | 450..-450"),
        ("lanes:backward=2", "150..-150 | 150..-150 | 150..-150"),
        ("bus:lanes:backward=|designated", "150..-150 | 150..-150 | 150..-150"),
        ("lanes=2 lanes:backward=5", "0..-300 | 0..-300 | 300..-300"),
        // A lane in the same direction.
        ("lanes=2 lanes:psv=1 width=7", "350..0 | 350..0 | 350..-350"),
        ("lanes=2 lanes:psv:forward=1 width=7", "350..0 | 350..0 | 350..-350"),
        ("lanes=2 busway:forward=lane width=7", "350..0 | 350..0 | 350..-350"),
    ] {
        let text = format!("{ONE_WAY} {tags}");
        let [forward, _] = sections(&text, &RIGHT);
        let strips = [forward.lane, forward.direction, forward.carriageway].map(edges).join(" | ");
        assert_eq!(strips, expected, "{text}");
        // The mirror image.
        let mirror = text.replace("busway:left", "busway:right").replace("3|3.5", "3.5|3");
        let [forward, _] = sections(&mirror, &LEFT);
        let flip = |strip: Option<Strip>| strip.map(|s| Strip { left_m: -s.right_m, right_m: -s.left_m, ..s });
        let strips = [forward.lane, forward.direction, forward.carriageway].map(flip).map(edges).join(" | ");
        assert_eq!(strips, expected, "{mirror}");
        assert!(!draft(&text).notes.has(Note::BadLanes));
    }
}

fn edges(strip: Option<Strip>) -> String {
    strip.map_or("-".to_owned(), |s| format!("{:.0}..{:.0}", s.left_m * 100.0 + 0.0, s.right_m * 100.0 + 0.0))
}

#[test]
fn lanes_for_full_cars_are_not_those_of_a_lorry() {
    for (tags, expected) in [
        ("lanes=3 hov:lanes=designated|| width=9", "-150..-450 | 150..-450"),
        ("lanes=3 hov:lanes=||designated width=9", "150..-150 | 450..-150"),
        ("lanes=3 lanes:hov=1 width=9", "-150..-450 | 150..-450"),
        ("lanes=3 hov=lane width=9", "-150..-450 | 150..-450"),
        ("lanes=3 hov=designated width=9", "-150..-450 | 450..-450"),
        ("lanes=3 hov:lanes=yes|| width=9", "-150..-450 | 450..-450"),
        ("lanes=1 lanes:hov=1 width=4", "- | -"),
    ] {
        let text = format!("{ONE_WAY} {tags}");
        let [forward, _] = sections(&text, &RIGHT);
        assert_eq!([forward.lane, forward.direction].map(edges).join(" | "), expected, "{text}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_smaller_entry_never_gives_a_wider_lane(
        lanes in prop::collection::vec(prop::option::of(2..60_u32), 1..5), at in 0..5_usize, less in 1..40_u32, more in 0..3_u8,
        two_way: bool, left: bool, width in prop::option::of(20..150_u32),
    ) {
        let jurisdiction = if left { LEFT } else { RIGHT };
        let at = at % lanes.len();
        let Some(before) = lanes[at] else { return Ok(()) };
        let mut smaller = lanes.clone();
        smaller[at] = Some(before.saturating_sub(less).max(1));
        let oneway = if two_way { "no" } else { "yes" };
        let count = lanes.len() + usize::from(more);
        let width = width.map_or(String::new(), |dm| format!(" width={}", f64::from(dm) / 10.0));
        let text = |lanes: &[Option<u32>]| {
            let list: Vec<String> =
                lanes.iter().map(|dm| dm.map_or(String::new(), |dm| format!("{}", f64::from(dm) / 10.0))).collect();
            format!("highway=secondary oneway={oneway} lanes={count} width:lanes={}{width}", list.join("|"))
        };
        let (great, small) = (text(&lanes), text(&smaller));
        // A list of two entries or more has an entry for the kerb only if it has one for each lane.
        for (great_section, small_section) in sections(&great, &jurisdiction).into_iter().zip(sections(&small, &jurisdiction)) {
            let width_m = |section: CrossSection| section.lane.map_or(0.0, |lane| lane.width_m());
            prop_assume!(width.is_empty());
            prop_assert!(width_m(small_section) <= width_m(great_section) + 1e-5, "{great} {small}");
        }
    }
}
