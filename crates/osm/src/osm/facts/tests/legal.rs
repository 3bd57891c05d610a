//! Limits and access of ways and nodes, and their comparison with a vehicle.

use super::*;
use crate::vehicle::{Unit, Vehicle};
use crate::verdict::{ForbiddenReason, UnknownReason, Verdict};

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
        class: None,
        axles: None,
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
        ("maxaxleload:hgv=low", None),
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
fn a_vehicle_at_the_limit_of_its_law_passes_the_sign_with_that_limit() {
    use ForbiddenReason::{AxleLoad, Height, Length, Weight, Width};
    let catalogue = crate::vehicle::Catalogue::builtin().unwrap();
    for (id, tag, expected) in [
        ("US-WB67", "maxweight=40_st", None),
        ("US-WB67", "maxweight=80000_lbs", None),
        ("US-WB67", "maxweight=39_st", Some(Weight)),
        ("US-WB67", "maxweight=79900_lbs", Some(Weight)),
        ("US-WB92D", "maxweight=129000_lbs", None),
        ("US-WB100T", "maxweight=115000_lbs", None),
        ("US-WB109D", "maxweight=147000_lbs", None),
        ("US-WB109D", "maxweight=146900_lbs", Some(Weight)),
        ("US-WB67", "maxaxleload=20000_lbs", None),
        ("US-WB67", "maxaxleload=10_st", None),
        ("US-WB67", "maxaxleload=8_st", Some(AxleLoad)),
        ("BUS-ART18-AASHTO", "maxaxleload=24000_lbs", None),
        ("US-WB40", "maxwidth=8'", None),
        ("US-WB67", "maxwidth=8'", Some(Width)),
        ("US-WB67", "maxwidth=8'6\"", None),
        ("US-WB67", "maxheight=13'6\"", None),
        ("US-WB67", "maxheight=13'5\"", Some(Height)),
        ("US-WB40", "maxlength=45_ft_6_in", None),
        ("US-WB50", "maxlength=55'", None),
        ("US-WB62", "maxlength=69'", None),
        ("US-WB67", "maxlength=73'6\"", None),
        ("US-WB109D", "maxlength=114'", None),
        ("US-WB109D", "maxlength=113'", Some(Length)),
        ("BUS-ART18-AASHTO", "maxlength=60'", None),
        ("EU-SEMI16.5", "maxweight=40", None),
        ("EU-SEMI16.5", "maxlength=16.5", None),
        ("EU-SEMI16.5", "maxwidth=2.55", None),
        ("CA-SEMI23", "maxwidth=2.6", None),
        ("AU-ATRIPLE53", "maxweight=115.5", None),
    ] {
        let (key, value) = tag.split_once('=').unwrap();
        let value = value.replace('_', " ");
        let legal = way_facts(&[("highway", "primary"), (key, &value)]).unwrap().facts.legal_forward;
        let said = legal.forbids(catalogue.get(id).unwrap());
        assert_eq!(said, expected.map(Verdict::Forbidden), "{id} {tag}");
    }
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
        "motorcar=no",
        "foot=no bicycle=yes",
    ] {
        assert_eq!(point_facts(&tags(text)), None, "{text}");
    }
    let legal = |text| point_facts(&tags(text)).expect(text).legal;
    assert_eq!(legal("barrier=lift_gate access=private").motor_vehicle, Permission::No);
    assert_eq!(legal("barrier=height_restrictor").max_height, Limit::Unreadable);
    assert_eq!(legal("barrier=height_restrictor maxheight=2.1").max_height, Limit::At(2.1));
    assert_eq!(legal("maxheight:forward=2.1").max_height, Limit::At(2.1));
}
