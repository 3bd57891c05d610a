//! Which ways are kept, their directions, and the notes on them.

use super::*;

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
fn facts_stay_small() {
    assert!(size_of::<WayFacts>() <= 160, "{} bytes", size_of::<WayFacts>());
}
