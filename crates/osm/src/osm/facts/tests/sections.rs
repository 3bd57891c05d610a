//! Strips from widths, lanes, kerb-side uses and placements.

use super::*;

#[test]
fn untagged_roads_have_assumed_lanes() {
    check("highway=tertiary", "0..-300 Assumed | 0..-300 Assumed | 0..-300 Assumed | 300..-300 Assumed");
    check("highway=motorway", "0..-350 Assumed | - | 350..-350 Assumed | 350..-350 Assumed");
    check("highway=motorway_link oneway=yes", "210..-210 Assumed | - | 210..-210 Assumed | 210..-210 Assumed");
    check("highway=service", "200..-200 Assumed | 200..-200 Assumed | 200..-200 Assumed | 200..-200 Assumed");
}

#[test]
fn rings_and_ramps_of_one_lane_are_wider_than_a_lane() {
    let carriageway = |text: &str, country: &[u8; 2], ring_radius_m| {
        let jurisdiction = Jurisdiction { country: *country, left_hand_traffic: false };
        let [forward, _] = cross_sections(&draft(text).facts, &jurisdiction, ring_radius_m, &Rules::builtin().unwrap());
        show(forward.carriageway)
    };
    let ring = "highway=tertiary junction=roundabout";
    assert_eq!(carriageway(ring, b"FR", Some(15.0)), "215..-215 Assumed");
    assert_eq!(carriageway(ring, b"DE", Some(8.0)), "215..-215 Assumed");
    assert_eq!(carriageway(ring, b"DE", Some(15.0)), "300..-300 Assumed");
    assert_eq!(carriageway(&format!("{ring} lanes=1"), b"DE", Some(15.0)), "300..-300 FromLanes");
    // Not if a tag says more.
    assert_eq!(carriageway(&format!("{ring} lanes=2"), b"DE", Some(15.0)), "300..-300 FromLanes");
    assert_eq!(carriageway(&format!("{ring} width=5"), b"DE", Some(15.0)), "250..-250 Tagged");
    assert_eq!(carriageway(&format!("{ring} narrow=yes"), b"DE", Some(15.0)), "110..-110 Assumed");
    check("highway=trunk_link oneway=-1 lanes=1", "- | 210..-210 FromLanes | - | 210..-210 FromLanes");
    check("highway=trunk_link oneway=yes lanes=2", "0..-350 FromLanes | - | 350..-350 FromLanes | 350..-350 FromLanes");
    check("highway=trunk oneway=yes lanes=1", "175..-175 FromLanes | - | 175..-175 FromLanes | 175..-175 FromLanes");
}

#[test]
fn lanes_times_lane_width() {
    check("highway=primary lanes=2", "0..-325 FromLanes | 0..-325 FromLanes | 0..-325 FromLanes | 325..-325 FromLanes");
    check(
        "highway=primary lanes=4",
        "-325..-650 FromLanes | -325..-650 FromLanes | 0..-650 FromLanes | 650..-650 FromLanes",
    );
    // Neither direction gets an odd lane.
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
    // The number of lanes is unknown: at most 4.25 m at the kerb count as one lane.
    check("highway=primary width=6 oneway=yes", "125..-300 Estimated | - | 300..-300 Estimated | 300..-300 Tagged");
}

#[test]
fn narrow_two_way_roads_are_shared() {
    check(
        "highway=unclassified width=4",
        "200..-200 Estimated | 200..-200 Estimated | 200..-200 Estimated | 200..-200 Tagged",
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
    // 3 m for two lanes: one lane of 3 m for both directions.
    check(
        "highway=primary width=3 lanes=2",
        "150..-150 Estimated | 150..-150 Estimated | 150..-150 Estimated | 150..-150 Tagged",
    );
    // 7 m for five lanes: at most one assumed lane is certain.
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
    // 10 m with 2 m of parking on the right: the lanes lie to the left of the middle.
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
    // Shoulders are paved, so the carriageway policy may use them.
    check(
        "highway=motorway width=12 lanes=2 shoulder=right shoulder:right:width=2.5",
        "125..-350 Tagged | - | 600..-350 Tagged | 600..-600 Tagged",
    );
    // The width is that of the lanes alone.
    check(
        "highway=motorway width=7.5 lanes=2 shoulder=yes",
        "0..-350 FromLanes | - | 350..-350 FromLanes | 350..-350 FromLanes",
    );
    // The cars need more than the road has.
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
fn lanes_with_turns_are_counted_where_lanes_are_not() {
    check(
        "highway=primary oneway=yes turn:lanes=left|through",
        "0..-325 FromLanes | - | 325..-325 FromLanes | 325..-325 FromLanes",
    );
    check("highway=primary oneway=-1 turn:lanes:backward=left|none", "- | 0..-325 FromLanes | - | 325..-325 FromLanes");
    check(
        "highway=primary lanes=3 turn:lanes:forward=left|through",
        "-162..-488 FromLanes | -162..-488 FromLanes | 162..-488 FromLanes | 488..-488 FromLanes",
    );
    // No lane would be left for the way back.
    check(
        "highway=primary lanes=2 turn:lanes:forward=left|through",
        "0..-325 FromLanes | 0..-325 FromLanes | 0..-325 FromLanes | 325..-325 FromLanes",
    );
    // A tagged number of lanes counts.
    check(
        "highway=primary oneway=yes lanes=2 turn:lanes=left|through|right",
        "0..-325 FromLanes | - | 325..-325 FromLanes | 325..-325 FromLanes",
    );
    // One of the lanes may be the cycle lane.
    let ambiguous = "highway=primary oneway=yes cycleway:right=lane";
    let carriageway = |text: &str| {
        let jurisdiction = Jurisdiction { country: *b"DE", left_hand_traffic: false };
        let [forward, _] = cross_sections(&draft(text).facts, &jurisdiction, None, &Rules::builtin().unwrap());
        show(forward.carriageway)
    };
    assert_eq!(carriageway(&format!("{ambiguous} turn:lanes=left|through")), carriageway(ambiguous));
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
