//! Rows whose place is given by ids, and surfaces.

use super::super::{Along, MeasurementRow, Place, Quantity, Value};
use super::drawing::{Drawing, at, edge_id, point, row, told};
use crate::network::Network;
use crate::osm::NodeId;

/// A main road 1-2-3-4, a side road 2-5, a one-way road 3-6, and a ring 10-11-12.
fn network() -> Network {
    Drawing::default()
        .main_road([0.0, 100.0, 200.0, 300.0], [80.0, 80.0])
        .node(10, [1000.0, 0.0])
        .node(11, [1060.0, 0.0])
        .node(12, [1030.0, 60.0])
        .node(13, [1030.0, 160.0])
        .node(14, [940.0, 0.0])
        .node(15, [1160.0, 0.0])
        .way(1, &[1, 2, 3, 4], "name=Main")
        .way(2, &[2, 5], "")
        .way(3, &[3, 6], "oneway=yes")
        .way(4, &[10, 11, 12, 10], "junction=roundabout")
        .way(5, &[12, 13], "")
        .way(6, &[14, 10], "")
        .way(7, &[11, 15], "")
        .network()
}

fn way(way_id: i64, nodes: Option<[i64; 2]>) -> MeasurementRow {
    row(Place::Way { way_id, nodes: nodes.map(|nodes| nodes.map(NodeId::new)) })
}

#[test]
fn an_edge_is_meant_and_only_it() {
    let network = network();
    let id = edge_id(&network, 2, 3);
    assert_eq!(told(&network, &row(Place::Edge(id))), "1:2-3");
    assert_eq!(told(&network, &row(Place::Edge(5))), "unmatched: edge 5 does not exist");
    let gone = MeasurementRow { way_id: Some(3), ..row(Place::Edge(5)) };
    let today = format!("unmatched: edge 5 does not exist; way 3 has today {} (node 3 to 6)", edge_id(&network, 3, 6));
    assert_eq!(told(&network, &gone), today);
    let other = MeasurementRow { way_id: Some(3), ..row(Place::Edge(id)) };
    assert_eq!(told(&network, &other), format!("unmatched: edge {id} is part of way 1, and the row names way 3"));
}

#[test]
fn a_way_is_meant_in_the_directions_of_the_row() {
    let network = network();
    assert_eq!(told(&network, &way(1, None)), "1:1-2 1:2-1 1:2-3 1:3-2 1:3-4 1:4-3");
    let forward = MeasurementRow { along: Along::Forward, ..way(1, None) };
    assert_eq!(told(&network, &forward), "1:1-2 1:2-3 1:3-4");
    let backward = MeasurementRow { along: Along::Backward, ..way(1, Some([2, 4])) };
    assert_eq!(told(&network, &backward), "1:3-2 1:4-3");
    assert_eq!(told(&network, &way(1, Some([3, 2]))), "1:2-3 1:3-2");
    assert_eq!(told(&network, &way(9, None)), "unmatched: way 9 is no road of this network");
    let one_way = MeasurementRow { along: Along::Backward, ..way(3, None) };
    assert_eq!(told(&network, &one_way), "unmatched: way 3 is one-way and has no edge backward");
    let unknown = "unmatched: way 1: no edge begins or ends at node 7; they do at 1, 2, 3, 4";
    assert_eq!(told(&network, &way(1, Some([2, 7]))), unknown);
}

#[test]
fn a_ring_goes_on_over_its_end() {
    let network = network();
    assert_eq!(told(&network, &way(4, Some([10, 12]))), "4:10-11 4:11-12");
    assert_eq!(told(&network, &way(4, Some([12, 11]))), "4:10-11 4:12-10");
    assert_eq!(told(&network, &way(4, Some([10, 10]))), "4:10-11 4:11-12 4:12-10");
}

#[test]
fn a_corner_is_between_an_edge_that_ends_and_one_that_begins() {
    let network = network();
    let corner = |edges| MeasurementRow {
        quantity: Quantity::KerbRadius,
        ..row(Place::Junction { node: NodeId::new(2), edges })
    };
    let [to, away, far] = [(1, 2), (2, 5), (3, 4)].map(|(from, to)| edge_id(&network, from, to));
    assert_eq!(told(&network, &corner(None)), "corner 2");
    assert_eq!(told(&network, &corner(Some([to, away]))), "corner 2 1:1-2 2:2-5");
    let wrong = format!("unmatched: edge {away} ends at node 5, not 2");
    assert_eq!(told(&network, &corner(Some([away, away]))), wrong);
    assert_eq!(told(&network, &corner(Some([to, far]))), format!("unmatched: edge {far} begins at node 3, not 2"));
    assert!(told(&network, &corner(Some([to, 7]))).starts_with("unmatched: no edge 7; at node 2 end "));
    let gone = MeasurementRow {
        quantity: Quantity::KerbRadius,
        ..row(Place::Junction { node: NodeId::new(99), edges: None })
    };
    assert_eq!(told(&network, &gone), "unmatched: no edge begins or ends at node 99");
}

#[test]
fn a_geometry_beside_ids_must_lie_there() {
    let network = network();
    let beside = |place| MeasurementRow { at: Some(at(place)), ..way(1, Some([1, 2])) };
    assert_eq!(told(&network, &beside([50.0, 40.0])), "1:1-2 1:2-1");
    let far = told(&network, &beside([50.0, 400.0]));
    assert!(far.starts_with("unmatched: its geometry lies 400 m from what its ids mean"), "{far}");
}

#[test]
fn a_surface_is_that_of_the_junctions_on_it() {
    let network = network();
    let ring = |east: f64, hole: bool| {
        let square = |half: f64| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
                .map(|[x, y]| at([east + half * x, half * y]))
                .to_vec()
        };
        let rings = if hole { vec![square(20.0), square(5.0)] } else { vec![square(20.0)] };
        let place = Place::Polygon(rings[0].clone());
        MeasurementRow { quantity: Quantity::Surface, value: Value::Polygon(rings), ..row(place) }
    };
    assert_eq!(told(&network, &ring(110.0, false)), "area [2]");
    assert_eq!(told(&network, &ring(100.0, true)), "unmatched: no junction lies on the surface");
    assert_eq!(told(&network, &ring(50.0, false)), "unmatched: no junction lies on the surface");
    let named = |node| MeasurementRow { place: Place::Junction { node, edges: None }, ..ring(100.0, false) };
    assert_eq!(told(&network, &named(NodeId::new(2))), "area [2]");
    assert_eq!(told(&network, &named(NodeId::new(3))), "unmatched: node 3 does not lie on the surface");
}

#[test]
fn a_sharp_bend_is_a_junction_and_a_gentle_one_is_not() {
    let bent = |aside: f64| {
        let drawing = Drawing::default().node(1, [0.0, 0.0]).node(2, [100.0, 0.0]).node(3, [110.0, aside]);
        drawing.way(1, &[1, 2], "").way(2, &[2, 3], "highway=tertiary").network()
    };
    let ring: Vec<_> = [[90.0, -10.0], [120.0, -10.0], [120.0, 10.0], [90.0, 10.0], [90.0, -10.0]].map(at).to_vec();
    let surface = MeasurementRow {
        quantity: Quantity::Surface,
        value: Value::Polygon(vec![ring.clone()]),
        ..row(Place::Polygon(ring))
    };
    let kerb = MeasurementRow { quantity: Quantity::KerbRadius, ..point([103.0, 2.0]) };
    let [sharp, gentle] = [bent(90.0), bent(0.5)];
    assert_eq!(told(&sharp, &surface), "area [2]");
    assert_eq!(told(&sharp, &kerb), "corner 2");
    assert_eq!(told(&gentle, &surface), "unmatched: no junction lies on the surface");
    assert_eq!(told(&gentle, &kerb), "unmatched: no junction within 25 m");
}
