//! `explain` names the tag behind a refusal, with its value as the map has it.

use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use netcert::words::verdict_words;

use crate::update::place_of;
use netcert_testing::program::WorkFolder;

type Pairs = &'static [(&'static str, &'static str)];

/// Tags of a way, tags of a node on it, and the tag that decides, with the verdict and its reason.
struct Case(Pairs, Pairs, &'static str, &'static str);

const CASES: [Case; 37] = [
    Case(&[("access", "no")], &[], "access=no", "forbidden access"),
    Case(
        &[("access", "private"), ("vehicle", "yes"), ("motor_vehicle", "military")],
        &[],
        "motor_vehicle=military",
        "forbidden access",
    ),
    Case(&[("access", "yes"), ("hgv", "no")], &[], "hgv=no", "forbidden hgv"),
    Case(&[("hgv:forward", "no"), ("hgv:backward", "no")], &[], "ward=no", "forbidden hgv"),
    Case(&[("trailer", "no")], &[], "trailer=no", "forbidden hgv"),
    Case(&[("maxheight", "12'6\"")], &[], "maxheight=12'6\"", "forbidden height"),
    Case(&[("maxheight", "380 cm"), ("maxheight:physical", "4.5")], &[], "maxheight=380 cm", "forbidden height"),
    Case(&[("maxweight", "30"), ("maxgcweight", "18")], &[], "maxgcweight=18", "forbidden weight"),
    Case(&[("maxweightrating", "7.5")], &[], "maxweightrating=7.5", "forbidden weight"),
    Case(&[("maxweight:legal", "12")], &[], "maxweight:legal=12", "forbidden weight"),
    Case(&[("maxunladenweight", "7.5")], &[], "maxunladenweight=7.5", "unknown limit"),
    Case(&[("maxaxleload", "8 st")], &[], "maxaxleload=8 st", "forbidden axle_load"),
    Case(&[("maxlength", "40'")], &[], "maxlength=40'", "forbidden length"),
    Case(&[("maxwidth", "2")], &[], "maxwidth=2", "forbidden width"),
    Case(&[("maxaxles", "3")], &[], "maxaxles=3", "forbidden axles"),
    Case(&[("maxweight", "yes")], &[], "maxweight=yes", "unknown limit"),
    Case(&[("maxheight", "low")], &[], "maxheight=low", "unknown limit"),
    Case(&[("impassable", "yes")], &[], "impassable=yes", "forbidden access"),
    Case(&[("oneway", "reversible")], &[], "oneway=reversible", "unknown time"),
    Case(&[("winter_road", "yes")], &[], "winter_road=yes", "unknown time"),
    Case(
        &[("hgv:conditional", "no @ (weight>7.5 AND length>12)")],
        &[],
        "hgv:conditional=no @ (weight>7.5 AND length>12)",
        "forbidden",
    ),
    Case(
        &[("hgv:conditional", "no @ (emissions<euro_5)")],
        &[],
        "hgv:conditional=no @ (emissions<euro_5)",
        "unknown rule",
    ),
    Case(&[("access:conditional", "no @ may-oct")], &[], "access:conditional=no @ may-oct", "unknown time"),
    Case(&[("width", "1.5")], &[], "width=1.5", "unsafe width"),
    Case(&[("est_width", "1.9")], &[], "est_width=1.9", "unsafe width"),
    Case(&[("width:carriageway", "1.7")], &[], "width:carriageway=1.7", "unsafe width"),
    Case(&[("narrow", "yes"), ("highway", "service")], &[], "narrow=yes", "unsafe width"),
    Case(&[("oneway", "yes"), ("lanes", "2"), ("width:lanes", "3.5|1.5")], &[], "width:lanes=3.5|1.5", "unsafe width"),
    Case(&[("width", "50")], &[], "width=50", "unknown width"),
    Case(&[], &[("barrier", "bollard")], "barrier=bollard", "forbidden barrier"),
    Case(&[], &[("barrier", "gate"), ("locked", "yes")], "barrier=gate, locked=yes", "forbidden barrier"),
    Case(&[], &[("barrier", "height_restrictor")], "barrier=height_restrictor", "unknown limit"),
    Case(&[], &[("barrier", "lift_gate"), ("hgv", "no")], "hgv=no", "forbidden hgv"),
    Case(&[], &[("access", "no")], "access=no", "forbidden access"),
    Case(&[("maxheight", "4.5")], &[("maxheight", "3.5")], "maxheight=3.5", "forbidden height"),
    Case(&[("width", "7")], &[("traffic_calming", "choker"), ("width", "2.2")], "width=2.2", "unsafe width"),
    Case(
        &[("width", "7"), ("maxwidth", "2.8")],
        &[("traffic_calming", "choker"), ("width", "2.2")],
        "has a narrow place: traffic_calming=choker, width=2.2.",
        "unsafe width",
    ),
];

#[test]
fn explain_names_the_tag_and_its_value() {
    let (mut nodes, mut ways) = (Vec::new(), Vec::new());
    let pairs = |of: Pairs| of.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect::<Vec<_>>();
    for (id, Case(of_way, of_node, ..)) in (1_i64..).zip(&CASES) {
        for (k, east_m) in (0_i64..).zip([0.0, 150.0, 300.0]) {
            let tags = if k == 1 { pairs(of_node) } else { Vec::new() };
            nodes.push(NodeRecord { id: 3 * id + k, place: place_of(east_m, 100.0 * id as f64), tags });
        }
        let mut tags = pairs(of_way);
        let mut add = |key: &str, value: &str| {
            if !tags.iter().any(|(known, _)| known == key) {
                tags.push((key.to_owned(), value.to_owned()));
            }
        };
        add("highway", "secondary");
        if !of_way.iter().any(|(key, _)| key.contains("width") && *key != "maxwidth" || *key == "narrow") {
            add("width", "9");
        }
        ways.push(WayRecord { id, refs: vec![3 * id, 3 * id + 1, 3 * id + 2], tags });
    }
    let place = WorkFolder::empty().file("tags.osm.pbf", write_extract(&nodes, &ways));
    place.netcert("ingest tags.osm.pbf --db demo.gpkg --vehicle EU-SEMI16.5 --country DE --needs off").succeeds();
    let rows = place.rows("EU-SEMI16.5");
    let mut wrong = Vec::new();
    for (way, Case(of_way, of_node, tag, verdict)) in (1_i64..).zip(&CASES) {
        let row = rows.iter().find(|row| row.edge.way_id == way);
        let Some(row) = row else { panic!("no edge of {of_way:?}") };
        let explain = format!("explain {} --vehicle EU-SEMI16.5", row.edge.id);
        let told = place.netcert(&explain).succeeds().out();
        let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
        let (verdict_is, reason) = verdict_words(row.certificate.verdict);
        let known = format!("{verdict_is} {reason}");
        if !told.contains(tag) || !known.starts_with(verdict) {
            wrong.push(format!("{of_way:?} {of_node:?}: {known}: {told}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    place.netcert("verify --db demo.gpkg").succeeds();
}

#[test]
fn a_line_in_a_tag_makes_no_other_tag() {
    let nodes =
        [(1, 0.0), (2, 150.0)].map(|(id, east_m)| NodeRecord { id, place: place_of(east_m, 0.0), tags: Vec::new() });
    let tags = [("highway", "residential"), ("maxheight", "3\nhgv=no")];
    let tags = tags.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec();
    let way = WayRecord { id: 1, refs: vec![1, 2], tags };
    let place = WorkFolder::empty().file("line.osm.pbf", write_extract(&nodes, &[way]));
    place.netcert("ingest line.osm.pbf --db demo.gpkg --vehicle EU-SEMI16.5 --country DE --needs off").succeeds();
    let told = crate::update::sql(&place.path("demo.gpkg"), "SELECT DISTINCT legal_tags FROM edge");
    assert_eq!(told.trim(), "maxheight=3 hgv=no");
}
