//! Roads that end at +180° and −180° at one latitude are one road.

use netcert::network::{EdgeNo, Network, build};
use netcert::osm::facts::{Jurisdiction, Rules, cross_sections};
use netcert::osm::pbf::read_extract;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use netcert::osm::{Extract, LonLat, NodeId};

use crate::portions::compare;

fn node(id: i64, lon: f64, lat: f64) -> NodeRecord {
    let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
    NodeRecord { id, place: LonLat { lon_e7: e7(lon), lat_e7: e7(lat) }, tags: vec![] }
}

fn way(id: i64, refs: &[i64]) -> WayRecord {
    let tags = [("highway", "primary"), ("lanes", "2"), ("width", "8")];
    let tags = tags.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect();
    WayRecord { id, refs: refs.to_vec(), tags }
}

fn extract(nodes: &[NodeRecord], ways: &[WayRecord]) -> Extract {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("region.osm.pbf");
    std::fs::write(&path, write_extract(nodes, ways)).unwrap();
    read_extract(&path, &|_| ()).unwrap()
}

fn network(nodes: &[NodeRecord], ways: &[WayRecord]) -> Network {
    let rules = Rules::builtin().unwrap();
    let place = |_| Jurisdiction { country: *b"FJ", left_hand_traffic: true };
    build(extract(nodes, ways), &place, &|facts, place, ring| cross_sections(facts, place, ring, &rules)).0
}

/// A road along a parallel, in two ways, and a side road from its western part.
fn fiji() -> (Vec<NodeRecord>, Vec<WayRecord>) {
    let nodes = vec![
        node(1, 179.99, -16.8),
        node(2, 179.995, -16.8),
        node(3, 180.0, -16.8),
        node(4, -180.0, -16.8),
        node(5, -179.99, -16.8),
        node(6, 179.995, -16.81),
    ];
    (nodes, vec![way(11, &[1, 2, 3]), way(12, &[4, 5]), way(13, &[2, 6])])
}

fn edges(network: &Network) -> Vec<(i64, i64, i64, i64)> {
    network.edges.iter().map(|e| (e.id, network.road(e).way_id, e.from_node.get(), e.to_node.get())).collect()
}

#[test]
fn a_road_goes_on_over_the_180th_meridian() {
    let (nodes, ways) = fiji();
    let network = network(&nodes, &ways);
    let find = |way: i64, from: i64, to: i64| {
        let found = edges(&network).iter().position(|e| (e.1, e.2, e.3) == (way, from, to));
        EdgeNo::at(found.unwrap_or_else(|| panic!("{from} {to}")))
    };
    let (before, after) = (find(11, 2, 3), find(12, 3, 5));
    find(12, 5, 3);
    let stroke = network.strokes_of_edges()[after.index()];
    let range = network.strokes[stroke as usize].approach.clone();
    let approach = &network.stroke_edges[range.start as usize..range.end as usize];
    assert!(approach.contains(&before), "{approach:?}");
    // The lines stay on their own sides.
    for edge in &network.edges {
        let line: Vec<i32> = network.positions(edge).map(|at| at.lon_e7).collect();
        assert!(line.iter().all(|lon| *lon > 0) || line.iter().all(|lon| *lon < 0), "{line:?}");
    }
}

#[test]
fn ids_are_those_of_a_file_with_one_side() {
    let (nodes, ways) = fiji();
    let both = edges(&network(&nodes, &ways));
    for part in [&ways[..1], &ways[1..2]] {
        for alone in edges(&network(&nodes, part)).iter().filter(|e| e.1 != 11) {
            assert!(both.iter().any(|e| (e.0, e.1) == (alone.0, alone.1)), "{alone:?} {both:?}");
        }
    }
}

#[test]
fn a_barrier_on_one_side_bars_the_road() {
    let (mut nodes, ways) = fiji();
    nodes[3].tags = vec![("barrier".to_owned(), "bollard".to_owned())];
    let network = network(&nodes, &ways);
    for edge in &network.edges {
        let touches = [edge.from_node, edge.to_node].contains(&NodeId::new(3));
        assert_eq!(edge.barred, touches, "{} {}", edge.from_node, edge.to_node);
    }
}

#[test]
fn roads_that_only_end_there_stay_apart() {
    let (nodes, ways) = fiji();
    // Another latitude, by the map's least step.
    let mut shifted = nodes.clone();
    shifted[3].place.lat_e7 += 1;
    // Two roads end at one place on the same side.
    let mut crowded = nodes.clone();
    crowded.extend([node(7, 180.0, -16.8), node(8, 179.995, -16.79)]);
    let with_bridge = [ways.clone(), vec![way(14, &[8, 7])]].concat();
    // A road that passes the meridian without ending there.
    let mut passing = nodes.clone();
    passing.push(node(9, -180.0, -16.81));
    let along = vec![way(11, &[1, 2, 3]), way(12, &[5, 4, 9])];
    for (nodes, ways) in [(shifted, ways), (crowded, with_bridge), (passing, along)] {
        let edges = edges(&network(&nodes, &ways));
        assert!(edges.iter().all(|e| e.1 != 12 || (e.2 != 3 && e.3 != 3)), "{edges:?}");
    }
}

#[test]
fn portions_see_both_sides() {
    let (nodes, ways) = fiji();
    let extract = extract(&nodes, &ways);
    for most in [u64::MAX, 3, 1] {
        compare(&extract, most);
    }
}
