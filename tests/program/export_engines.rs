//! Reads exports for engines with netcert's own reader. Nothing may be lost, and nothing refused may be open.

use netcert_testing::demo::demo;
use netcert_testing::program;
use netcert_testing::skip::skipped;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use netcert::network::{EdgeNo, Network, build};
use netcert::osm::facts::{Countries, Direction, Permission, Policy, cross_sections};
use netcert::osm::pbf::read_extract;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use netcert::osm::{LonLat, NodeId};
use netcert::store::QueryOptions;
use netcert::verdict::Verdict;
use netcert::words::VerdictKind;
use program::WorkFolder;

/// Pairs of nodes in driving order, and the number of roads of the extract that have each pair.
fn segments(path: &Path) -> BTreeMap<(i64, i64), u32> {
    let extract = read_extract(path, &|_| ()).unwrap();
    let mut pairs = BTreeMap::new();
    for way in &extract.ways {
        for pair in extract.refs[way.refs.start as usize..way.refs.end as usize].windows(2) {
            *pairs.entry((pair[0].get(), pair[1].get())).or_default() += 1;
        }
    }
    pairs
}

/// Every permitted edge by its places, in driving order.
fn permitted(place: &WorkFolder) -> (Network, BTreeSet<EdgeNo>) {
    let mut database = place.database();
    let options = QueryOptions { verdict: Some(VerdictKind::Safe), ..QueryOptions::new("AU-SEMI19", Policy::Lane) };
    let safe = database.query(&options).unwrap().map(|row| row.unwrap().edge.index).collect();
    (database.load_network().unwrap(), safe)
}

/// The last segments of permitted edges from which the only way on is a refused turn.
fn up_to_refused_corners(place: &WorkFolder, network: &Network, safe: &BTreeSet<EdgeNo>) -> BTreeSet<(LonLat, LonLat)> {
    let mut ends: BTreeMap<NodeId, BTreeSet<(u32, bool)>> = BTreeMap::new();
    for edge in &network.edges {
        let forward = edge.direction == Direction::Forward;
        ends.entry(edge.from_node).or_default().insert((edge.shape.start, forward));
        ends.entry(edge.to_node).or_default().insert((edge.shape.start, !forward));
    }
    let mut database = place.database();
    let steps = database.turn_steps("AU-SEMI19", Policy::Lane).unwrap().map(Result::unwrap);
    let refused = steps.filter(|step| step.arcs.is_none() && step.verdict != Verdict::Safe);
    let corners = refused.filter(|step| safe.contains(&step.from) && safe.contains(&step.to));
    let alone = corners.filter(|step| ends[&step.via_node].len() == 2);
    let last = |edge: EdgeNo| {
        let mut line = network.positions(&network.edges[edge.index()]).rev();
        let (end, before) = (line.next().unwrap(), line.next().unwrap());
        (before, end)
    };
    alone.map(|step| last(step.from)).collect()
}

#[test]
fn osrm_tables_close_every_segment_but_those_of_permitted_edges() {
    let place = WorkFolder::with_demo();
    place.netcert("export osrm --vehicle AU-SEMI19 --extract {demo} --out osrm").succeeds();
    let closed: BTreeSet<(i64, i64)> = String::from_utf8(place.read("osrm/segment-speeds.csv"))
        .unwrap()
        .lines()
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            assert_eq!((fields.len(), fields[2]), (3, "0"), "{line}");
            (fields[0].parse().unwrap(), fields[1].parse().unwrap())
        })
        .collect();
    let (network, safe) = permitted(&place);
    let extract = read_extract(&demo(), &|_| ()).unwrap();
    let place_of = |node: i64| extract.nodes.place(NodeId::new(node)).unwrap();
    let mut open = BTreeSet::new();
    for &edge in &safe {
        let line: Vec<_> = network.positions(&network.edges[edge.index()]).collect();
        open.extend(line.windows(2).map(|pair| (pair[0], pair[1])));
    }
    // Where nothing else meets, OSRM has no turn to refuse. The segment that only leads there is closed instead.
    for pair in up_to_refused_corners(&place, &network, &safe) {
        assert!(open.remove(&pair), "{pair:?}");
    }
    let mut found_open = 0;
    for &(a, b) in segments(&demo()).keys() {
        for (from, to) in [(a, b), (b, a)] {
            let is_open = open.contains(&(place_of(from), place_of(to)));
            assert_eq!(closed.contains(&(from, to)), !is_open, "segment {from} to {to}");
            found_open += u32::from(is_open);
        }
    }
    assert!(found_open > 500);
    for line in String::from_utf8(place.read("osrm/turn-penalties.csv")).unwrap().lines() {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!((fields.len(), fields[3]), (4, "3276.7"));
        let node = |i: usize| fields[i].parse::<i64>().unwrap();
        // A turn of which a part is closed needs no penalty, and would hide a fault.
        assert!(!closed.contains(&(node(0), node(1))) && !closed.contains(&(node(1), node(2))), "{line}");
    }
}

#[test]
fn the_rewritten_extract_has_every_road_and_nothing_new_is_open() {
    let place = WorkFolder::with_demo();
    for out in ["one.osm.pbf", "two.osm.pbf"] {
        place.netcert(&format!("export osm-pbf --vehicle AU-SEMI19 --extract {{demo}} --out {out}")).succeeds();
    }
    assert!(place.read("one.osm.pbf") == place.read("two.osm.pbf"), "the same input gives the same bytes");
    let (before, after) = (segments(&demo()), segments(&place.path("one.osm.pbf")));
    assert_eq!(before, after);

    // netcert itself, reading it as any extract: what was refused is forbidden now by the tag.
    let extract = read_extract(&place.path("one.osm.pbf"), &|_| ()).unwrap();
    let restrictions = extract.restrictions.len();
    let countries = Countries::load().unwrap();
    let rules = countries.rules();
    let (network, _) = build(extract, &|place| countries.jurisdiction(place), &|way, place, ring| {
        cross_sections(way, place, ring, rules)
    });
    let (old, safe) = permitted(&place);
    let line = |network: &Network, edge: EdgeNo| network.positions(&network.edges[edge.index()]).collect::<Vec<_>>();
    let mut open = BTreeSet::new();
    for &edge in &safe {
        open.extend(line(&old, edge).windows(2).map(|pair| (pair[0], pair[1])));
    }
    let mut tagged_open = 0;
    for (edge, facts) in network.numbered_edges() {
        let hgv = facts.legal.hgv;
        for pair in line(&network, edge).windows(2) {
            let permitted = open.contains(&(pair[0], pair[1]));
            let closed = hgv == Permission::No;
            assert!(permitted || closed, "way {} {:?}", network.road(facts).way_id, facts.direction);
            tagged_open += u32::from(permitted && !closed && facts.direction == Direction::Forward);
        }
    }
    assert!(tagged_open > 300);
    assert!(restrictions > 0);
}

/// Editors give new objects negative ids. Valhalla takes -5 for 2^64 - 5, and OSRM does not read it.
#[test]
fn an_extract_with_negative_ids_is_refused_with_a_way_out() {
    let node = |id| NodeRecord { id, place: LonLat { lon_e7: id as i32 * 30_000, lat_e7: 0 }, tags: vec![] };
    let way = |id, refs: &[i64]| {
        let tags = vec![("highway".to_owned(), "primary".to_owned()), ("width".to_owned(), "14".to_owned())];
        WayRecord { id, refs: refs.to_vec(), tags }
    };
    for (extract, named) in [
        (write_extract(&[node(-5), node(1), node(2)], &[way(7, &[-5, 1, 2])]), "way 7 has the negative id -5"),
        (write_extract(&[node(1), node(2)], &[way(-7, &[1, 2])]), "way -7 has the negative id -7"),
    ] {
        let place = WorkFolder::empty().file("drawn.osm.pbf", extract);
        place.netcert("ingest drawn.osm.pbf --vehicle AU-SEMI19 --quiet").succeeds();
        for target in ["osm-pbf", "valhalla", "osrm"] {
            let line = format!("export {target} --vehicle AU-SEMI19 --extract drawn.osm.pbf --out out");
            place.netcert(&line).fails().tells(named).tells("`osmium renumber`");
            assert!(!place.files().iter().any(|file| file.starts_with("out")), "{:?}", place.files());
        }
    }
}

#[test]
fn the_request_for_valhalla_lets_no_place_be_moved_to_another_road() {
    let place = WorkFolder::with_demo();
    place.netcert("export valhalla --vehicle AU-SEMI19 --extract {demo} --out valhalla").succeeds();
    let request: serde_json::Value = serde_json::from_slice(&place.read("valhalla/request.json")).unwrap();
    let places = request["locations"].as_array().unwrap();
    assert_eq!(places.len(), 2);
    for place in places {
        assert_eq!(place["minimum_reachability"], 0, "{request}");
        assert_eq!((&place["radius"], &place["node_snap_tolerance"]), (&0.into(), &0.into()), "{request}");
        assert!(place["search_cutoff"].as_u64().is_some_and(|metres| (1..=10).contains(&metres)), "{request}");
    }
}

#[test]
fn osmium_finds_the_rewritten_extract_sorted_and_whole() {
    if Command::new("osmium").arg("--version").output().is_err() {
        return skipped("osmium", "Debian: osmium-tool");
    }
    let place = WorkFolder::with_demo();
    place.netcert("export osm-pbf --vehicle AU-SEMI19 --extract {demo} --out out.osm.pbf").succeeds();
    let osmium = |arguments: &[&str]| {
        let out = Command::new("osmium").args(arguments).arg(place.path("out.osm.pbf")).output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr))
    };
    let info = osmium(&["fileinfo", "-e"]);
    assert!(info.contains("Objects ordered (by type and id): yes"), "{info}");
    assert!(info.contains("Multiple versions of same object: no"), "{info}");
    assert!(info.contains("generator=netcert"), "{info}");
    osmium(&["check-refs", "-r"]);
}

#[test]
fn an_extract_is_asked_for_and_must_be_the_right_one() {
    let place = WorkFolder::with_demo().file("other.osm.pbf", write_extract(&[], &[]));
    place.netcert("export osrm --vehicle AU-SEMI19 --out osrm").fails().tells("--extract");
    place
        .netcert("export osm-pbf --vehicle AU-SEMI19 --out x.osm.pbf --extract other.osm.pbf")
        .fails()
        .tells("not the extract that demo.gpkg was made from")
        .tells("demo.osm.pbf");
    assert_eq!(place.files(), ["demo.gpkg", "other.osm.pbf"]);
}

#[test]
fn an_extract_that_is_not_sorted_is_refused_with_the_way_out() {
    let node = |id, lon_e7| NodeRecord { id, place: LonLat { lon_e7, lat_e7: 0 }, tags: Vec::new() };
    let tags = vec![("highway".to_owned(), "primary".to_owned()), ("lanes".to_owned(), "2".to_owned())];
    let way = |id, refs: [i64; 2]| WayRecord { id, refs: refs.to_vec(), tags: tags.clone() };
    let extract = write_extract(&[node(1, 0), node(2, 10_000), node(3, 20_000)], &[way(8, [2, 3]), way(7, [1, 2])]);
    let place = WorkFolder::empty().file("unsorted.osm.pbf", extract);
    place.netcert("ingest unsorted.osm.pbf --vehicle AU-SEMI19").succeeds();
    for target in ["osrm", "osm-pbf"] {
        place
            .netcert(&format!("export {target} --vehicle AU-SEMI19 --extract unsorted.osm.pbf --out out"))
            .fails()
            .tells("osmium sort");
    }
    assert_eq!(place.files(), ["unsorted.gpkg", "unsorted.osm.pbf"]);
}

#[test]
fn pgrouting_tables_name_every_edge_and_the_script_beside_them() {
    let place = WorkFolder::with_demo();
    place.netcert("export pgrouting --vehicle AU-SEMI19 --out pg").succeeds();
    let edges = String::from_utf8(place.read("pg/edge.copy")).unwrap();
    let (network, safe) = permitted(&place);
    assert_eq!(edges.lines().count(), network.edges.len());
    for (i, line) in edges.lines().enumerate() {
        let fields: Vec<&str> = line.split('\t').collect();
        assert_eq!((fields.len(), fields[0]), (17, (i + 1).to_string().as_str()), "{line}");
        assert_eq!(fields[5] == "-1", !safe.contains(&EdgeNo::at(i)), "{line}");
        assert_eq!(fields[5] == "-1", fields[10] != "\\N", "{line}");
    }
    let script = String::from_utf8(place.read("pg/load.sql")).unwrap();
    for file in ["header.copy", "edge.copy", "restriction.copy", "step.copy"] {
        assert!(script.contains(file) && place.path(&format!("pg/{file}")).exists());
    }
}
