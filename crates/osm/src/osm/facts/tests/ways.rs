//! Which ways are kept, their directions, and the notes on them.

use super::*;

#[test]
fn odd_values_are_noted_and_change_nothing() {
    let plain = sections("highway=primary", &RIGHT);
    for (tag, note) in [
        ("lanes=2;3", "bad_lanes"),
        ("lanes=-3", "bad_lanes"),
        ("lanes=0", "bad_lanes"),
        ("lanes=1e400", "bad_lanes"),
        ("lanes=99999999999999999999", "bad_lanes"),
        ("lanes=NaN", "bad_lanes"),
        ("maxspeed=-3", "bad_speed"),
        ("maxspeed=NaN", "bad_speed"),
        ("maxspeed=50;70", "bad_speed"),
        ("maxspeed:hgv:forward=fast", "bad_speed"),
        ("maxspeed=DE:urban", "national_speed"),
        ("maxspeed:hgv=AU:rural", "national_speed"),
        ("maxheight=0", "bad_limit"),
        ("maxheight=below_default", "bad_limit"),
        ("maxweight=-3", "bad_limit"),
        ("oneway=ten", "bad_oneway"),
        ("width:lanes:forward=x|x|x|x|x|x|x|x|x", "bad_lane_widths"),
        ("access=sometimes", "bad_access"),
    ] {
        let text = format!("highway=primary {tag}");
        assert_eq!(draft(&text).notes.names().collect::<Vec<_>>(), [note], "{tag}");
        assert_eq!(sections(&text, &RIGHT), plain, "{tag}");
    }
    for tag in [
        "maxspeed=none",
        "maxspeed=40mph",
        "maxspeed:conditional=30_@_(22:00-06:00)",
        "maxspeed:lanes=80|60",
        "maxspeed:type=DE:urban",
        "maxspeed:bus=fast",
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
fn the_lowest_speed_limit_for_heavy_vehicles_counts_in_its_direction() {
    for (text, km_h) in [
        ("", [0, 0]),
        ("maxspeed=50", [50, 50]),
        ("maxspeed=30mph", [48, 48]),
        ("maxspeed=walk", [7, 7]),
        ("maxspeed=none", [0, 0]),
        ("maxspeed=none maxspeed:hgv=80", [80, 80]),
        ("maxspeed=100 maxspeed:hgv=60", [60, 60]),
        ("maxspeed=50 maxspeed:hgv=80", [50, 50]),
        ("maxspeed:hgv=none maxspeed=70", [70, 70]),
        ("maxspeed:forward=70", [70, 0]),
        ("maxspeed:backward=30", [0, 30]),
        ("maxspeed=100 maxspeed:backward=70", [100, 70]),
        ("maxspeed=100 maxspeed:hgv:forward=60 maxspeed:hgv:backward=40", [60, 40]),
        ("maxspeed=DE:rural", [0, 0]),
        ("maxspeed=DE:rural maxspeed:hgv=60", [60, 60]),
        ("maxspeed=50;70", [0, 0]),
        ("maxspeed=fast maxspeed:forward=40", [40, 0]),
        ("maxspeed=80 maxspeed:conditional=30_@_(22:00-06:00) maxspeed:hgv:conditional=60_@_wet", [80, 80]),
        ("maxspeed=80 maxspeed:lanes=60|40 maxspeed:bus=20 maxspeed:advisory=10 zone:maxspeed=30", [80, 80]),
        ("oneway=-1 maxspeed:backward=30", [0, 30]),
    ] {
        let read = draft(&format!("highway=primary {text}")).facts.max_speed_km_h;
        assert_eq!(read.map(|limit| limit.map_or(0, std::num::NonZeroU8::get)), km_h, "{text}");
    }
}

#[test]
fn facts_stay_small() {
    // 48 of them point to the tags that people see.
    assert!(size_of::<WayFacts>() <= 232, "{} bytes", size_of::<WayFacts>());
}
