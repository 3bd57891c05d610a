//! The shipped demo region matches its source, is one network, and contains the features that it must show.

#[path = "../../examples/draw_region/alignment.rs"]
mod alignment;
#[path = "../../examples/draw_region/junctions.rs"]
mod junctions;
#[path = "../../examples/draw_region/region.rs"]
mod region;

use std::collections::{BTreeMap, BTreeSet};

use alignment::{Corner, Point, align, distance};
use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord};
use osmpbfreader::{OsmObj, OsmPbfReader};

const SOURCE: &str = include_str!("../../data/demo/region.toml");
const SHIPPED: &[u8] = include_bytes!("../../data/demo.osm.pbf");

fn drawn() -> region::Map {
    region::draw(SOURCE).unwrap()
}

fn tag<'w>(way: &'w WayRecord, key: &str) -> Option<&'w str> {
    way.tags.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str())
}

fn tags(tags: &osmpbfreader::Tags) -> Vec<(String, String)> {
    let mut pairs: Vec<_> = tags.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
    pairs.sort();
    pairs
}

/// Objects are compared, not bytes: another release of the compressor may pack them differently.
#[test]
fn the_shipped_file_is_what_the_source_draws() {
    let (mut nodes, mut ways) = (Vec::new(), Vec::new());
    for object in OsmPbfReader::new(SHIPPED).iter() {
        match object.unwrap() {
            OsmObj::Node(n) => {
                let place = LonLat { lon_e7: n.decimicro_lon, lat_e7: n.decimicro_lat };
                nodes.push(NodeRecord { id: n.id.0, place, tags: tags(&n.tags) });
            }
            OsmObj::Way(w) => {
                let refs = w.nodes.iter().map(|n| n.0).collect();
                ways.push(WayRecord { id: w.id.0, refs, tags: tags(&w.tags) });
            }
            OsmObj::Relation(r) => panic!("a relation: {r:?}"),
        }
    }
    let map = drawn();
    let hint = "run `cargo run --example draw_region` after changing the source";
    assert!(nodes == map.nodes, "{hint}");
    assert!(ways == map.ways, "{hint}");
}

#[test]
fn the_region_is_one_network_of_distinct_places() {
    let map = drawn();
    let mut known: Vec<BTreeSet<i64>> = Vec::new();
    for way in &map.ways {
        assert!(way.refs.windows(2).all(|w| w[0] != w[1]), "way {} repeats a node", way.id);
        let (touching, apart): (Vec<_>, Vec<_>) =
            known.into_iter().partition(|set| way.refs.iter().any(|r| set.contains(r)));
        known = apart;
        known.push(touching.into_iter().flatten().chain(way.refs.iter().copied()).collect());
    }
    // Carriageways, ramps and streets are connected, and each node is on a way.
    assert_eq!(known.len(), 1, "apart: {:?}", known.iter().map(|s| s.first()).collect::<Vec<_>>());
    assert_eq!(known[0].len(), map.nodes.len());
    let places: BTreeSet<LonLat> = map.nodes.iter().map(|n| n.place).collect();
    assert_eq!(places.len(), map.nodes.len());
}

#[test]
fn only_ramps_meet_the_motorway() {
    let map = drawn();
    let is = |way: &WayRecord, class: &str| tag(way, "highway") == Some(class);
    let motorway: BTreeSet<i64> =
        map.ways.iter().filter(|w| is(w, "motorway")).flat_map(|w| w.refs.iter().copied()).collect();
    let mut ramps = 0;
    for way in map.ways.iter().filter(|w| !is(w, "motorway") && w.refs.iter().any(|r| motorway.contains(r))) {
        assert!(is(way, "motorway_link"), "way {}", way.id);
        ramps += 1;
    }
    assert_eq!(ramps, 9);
}

#[test]
fn the_region_holds_what_it_is_there_to_show() {
    let map = drawn();
    let mut with: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for (key, value) in map.ways.iter().flat_map(|w| &w.tags).chain(map.nodes.iter().flat_map(|n| &n.tags)) {
        *with.entry((key, value)).or_default() += 1;
        *with.entry((key, "*")).or_default() += 1;
    }
    let count = |key, value| with.get(&(key, value)).copied().unwrap_or(0);
    for class in [
        "motorway",
        "motorway_link",
        "trunk",
        "primary",
        "secondary",
        "tertiary",
        "unclassified",
        "residential",
        "living_street",
        "service",
        "track",
        "rest_area",
    ] {
        assert!(count("highway", class) > 0, "{class}");
    }
    for key in ["maxheight", "maxweight", "maxaxleload", "maxlength", "maxwidth", "bridge", "barrier", "parking:both"] {
        assert!(count(key, "*") > 0, "{key}");
    }
    assert!(count("hgv", "no") > 0 && count("narrow", "yes") > 0 && count("oneway", "-1") > 0);
    assert_eq!(count("junction", "roundabout"), 4);
    assert_eq!(map.name, "Quandong");
    let untagged = map.ways.iter().filter(|w| tag(w, "width").is_none()).count();
    assert!(untagged > 50 && map.ways.len() - untagged > 50, "{untagged} of {} untagged", map.ways.len());
    assert!((150..=400).contains(&map.ways.len()) && (60e3..200e3).contains(&map.length_m));
}

/// Traffic keeps left, so each ring runs clockwise.
#[test]
fn roundabouts_run_clockwise() {
    let map = drawn();
    for way in map.ways.iter().filter(|w| tag(w, "junction").is_some()) {
        assert_eq!(way.refs.first(), way.refs.last());
        let at: Vec<LonLat> = way.refs.iter().map(|r| map.nodes[*r as usize - 1].place).collect();
        let twice_area: i64 = at
            .windows(2)
            .map(|w| {
                let (x, y) = (i64::from(w[0].lon_e7 - at[0].lon_e7), i64::from(w[0].lat_e7 - at[0].lat_e7));
                let (u, v) = (i64::from(w[1].lon_e7 - at[0].lon_e7), i64::from(w[1].lat_e7 - at[0].lat_e7));
                x * v - u * y
            })
            .sum();
        assert!(twice_area < 0, "way {}", way.id);
    }
}

/// Radius of the circle through three points.
fn radius_m(a: Point, b: Point, c: Point) -> f64 {
    let cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    distance(a, b) * distance(b, c) * distance(c, a) / (2.0 * cross.abs())
}

#[test]
fn a_corner_is_rounded_with_the_radius_asked_for() {
    let sharp = |at| Corner { at, radius_m: 0.0, clothoid_m: 0.0 };
    let corner = Corner { at: [500.0, 0.0], radius_m: 120.0, clothoid_m: 40.0 };
    let line = align(&[sharp([0.0, 0.0]), corner, sharp([600.0, 700.0])]).unwrap();
    assert_eq!((line[0], *line.last().unwrap()), ([0.0, 0.0], [600.0, 700.0]));
    let radii: Vec<f64> = line.windows(3).map(|w| radius_m(w[0], w[1], w[2])).collect();
    let tightest = radii.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((tightest - 120.0).abs() < 1.0, "{tightest}");
    assert!(line.windows(2).all(|w| distance(w[0], w[1]) > 0.05));
}

#[test]
fn a_curve_that_does_not_fit_its_tangents_is_refused() {
    let sharp = |at| Corner { at, radius_m: 0.0, clothoid_m: 0.0 };
    let corner = Corner { at: [50.0, 0.0], radius_m: 120.0, clothoid_m: 0.0 };
    let said = align(&[sharp([0.0, 0.0]), corner, sharp([50.0, 700.0])]).unwrap_err().to_string();
    assert!(said.contains("needs 120.0 m before it"), "{said}");
}
