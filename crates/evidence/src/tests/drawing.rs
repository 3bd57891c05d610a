//! Drawn networks: nodes at metres east and north of a place, ways through them, and rows of evidence on them.

use super::super::{Along, Match, MeasurementRow, Place, Quantity, Value, match_rows};
use crate::network::{EdgeNo, Network, build};
use crate::osm::facts::{CrossSection, Jurisdiction, way_facts};
use crate::osm::{Extract, LonLat, NodeId, NodeTable, Way};

/// The place of `[0, 0]`.
const ORIGIN: LonLat = LonLat { lon_e7: 80_000_000, lat_e7: 490_000_000 };

/// The place east and north of the origin.
pub(super) fn at([east_m, north_m]: [f64; 2]) -> LonLat {
    const DEGREE_M: f64 = 111_195.0;
    let e7 = |metres: f64, degree_m: f64| (metres / degree_m * 1e7).round() as i32;
    LonLat {
        lon_e7: ORIGIN.lon_e7 + e7(east_m, DEGREE_M * ORIGIN.degrees().1.to_radians().cos()),
        lat_e7: ORIGIN.lat_e7 + e7(north_m, DEGREE_M),
    }
}

/// A network that is being drawn. Ways and nodes are numbered by whoever draws.
#[derive(Default)]
pub(super) struct Drawing {
    nodes: Vec<(i64, LonLat)>,
    ways: Vec<(i64, Vec<i64>, Tags)>,
}

type Tags = Vec<(&'static str, String)>;

impl Drawing {
    pub(super) fn node(mut self, id: i64, place: [f64; 2]) -> Self {
        self.nodes.push((id, at(place)));
        self
    }

    /// Nodes 1 to 4 of a main road, so many metres along it, and the far ends 5 and 6 of side roads at nodes 2 and 3.
    pub(super) fn main_road(self, along: [f64; 4], aside: [f64; 2]) -> Self {
        let drawn = (1..).zip(along).fold(self, |drawn, (id, east_m)| drawn.node(id, [east_m, 0.0]));
        drawn.node(5, [along[1], aside[0]]).node(6, [along[2], aside[1]])
    }

    /// A residential way, or one with other tags `key=value`.
    pub(super) fn way(mut self, id: i64, nodes: &[i64], tags: &'static str) -> Self {
        let mut pairs: Vec<(&str, String)> = vec![("highway", "residential".to_owned())];
        pairs.extend(
            tags.split_whitespace().filter_map(|tag| tag.split_once('=')).map(|(key, value)| (key, value.to_owned())),
        );
        self.ways.push((id, nodes.to_vec(), pairs));
        self
    }

    /// A named way through places of its own.
    pub(super) fn road(mut self, id: i64, line: &[[f64; 2]], name: &str) -> Self {
        let nodes: Vec<i64> = (0..).zip(line).map(|(i, _)| 1000 * id + i).collect();
        self.nodes.extend(nodes.iter().copied().zip(line.iter().map(|&place| at(place))));
        let mut tags = vec![("highway", "residential".to_owned())];
        tags.extend((!name.is_empty()).then(|| ("name", name.to_owned())));
        self.ways.push((id, nodes, tags));
        self
    }

    pub(super) fn network(mut self) -> Network {
        let mut extract = Extract::default();
        self.ways.sort();
        self.nodes.sort();
        for (id, nodes, tags) in &self.ways {
            let start = extract.refs.len() as u32;
            extract.refs.extend(nodes.iter().copied().map(NodeId::new));
            let tags: Vec<(&str, &str)> = tags.iter().map(|(key, value)| (*key, value.as_str())).collect();
            let draft = way_facts(&tags).unwrap();
            let mut facts = draft.facts;
            facts.name = draft.name.map(|name| extract.strings.intern(name));
            facts.reference = draft.reference.map(|name| extract.strings.intern(name));
            extract.ways.push(Way { id: *id, refs: start..extract.refs.len() as u32, facts });
        }
        let (ids, places) = self.nodes.iter().map(|&(id, place)| (NodeId::new(id), Some(place))).unzip();
        extract.nodes = NodeTable { ids, places };
        let country = |_: LonLat| Jurisdiction { country: *b"DE", left_hand_traffic: false };
        let none = CrossSection { lane: None, direction: None, carriageway: None };
        build(extract, &country, &|_, _, _| [none; 2]).0
    }
}

/// A width at a place.
pub(super) fn row(place: Place) -> MeasurementRow {
    MeasurementRow {
        number: 1,
        id: None,
        quantity: Quantity::CarriagewayWidth,
        value: Value::Metres(6.0),
        sigma: 0.0,
        along: Along::Both,
        place,
        way_id: None,
        at: None,
        source: "office".to_owned(),
        date: None,
        licence: None,
        name: None,
        note: None,
    }
}

/// A width along a line.
pub(super) fn line(places: &[[f64; 2]]) -> MeasurementRow {
    row(Place::Line(places.iter().map(|&place| at(place)).collect()))
}

/// A width at a position.
pub(super) fn point(place: [f64; 2]) -> MeasurementRow {
    row(Place::Point(at(place)))
}

pub(super) fn matched(network: &Network, row: &MeasurementRow) -> Match {
    match_rows(network, std::slice::from_ref(row)).remove(0)
}

/// A match as text: edges by way and nodes, in order, or the words of a refusal.
pub(super) fn told(network: &Network, row: &MeasurementRow) -> String {
    let edge = |&index: &EdgeNo| {
        let edge = &network.edges[index.index()];
        format!("{}:{}-{}", network.road(edge).way_id, edge.from_node, edge.to_node)
    };
    match matched(network, row) {
        Match::Edges(edges) => edges.iter().map(edge).collect::<Vec<_>>().join(" "),
        Match::Corner { node, edges } => {
            let edges: Vec<String> = edges.iter().flatten().map(edge).collect();
            format!("corner {node} {}", edges.join(" ")).trim_end().to_owned()
        }
        Match::Area(nodes) => format!("area {nodes:?}"),
        Match::Unmatched(why) => format!("unmatched: {why}"),
        Match::Ambiguous(why) => format!("ambiguous: {why}"),
    }
}

/// The id of the edge between two nodes.
pub(super) fn edge_id(network: &Network, from: i64, to: i64) -> i64 {
    network.edges.iter().find(|edge| (edge.from_node.get(), edge.to_node.get()) == (from, to)).unwrap().id
}
