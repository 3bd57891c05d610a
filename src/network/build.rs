//! From an extract to a network: the steps in order.
//!
//! The same extract gives the same network with any number of threads. The builder takes the extract by value and frees
//! each part as soon as it is no longer needed.

use super::edges::Source;
use super::vertices::Vertices;
use super::{Crossings, Network, NetworkAccount, Splits, StrokeOptions, areas, border, edge_id, restrictions, stroke};
use crate::osm::facts::{CrossSection, Place, WayFacts};
use crate::osm::{Extract, LonLat};

/// As [`build_with`], with default strokes.
pub fn build(
    extract: Extract,
    places: &(impl Fn(LonLat) -> Place + Sync),
    sections: &(impl Fn(&WayFacts, &Place, Option<f64>) -> [CrossSection; 2] + Sync),
) -> (Network, NetworkAccount) {
    build_with(extract, places, sections, &StrokeOptions::default())
}

/// Cuts an extract's ways into directed edges and chains them into strokes.
///
/// `places` returns the country rules at a position. It is called once per way, at the way's first located node.
/// `sections` returns a way's strips along its node order and against it. It also gets the radius (metres) of the ring
/// that a roundabout's way is part of.
pub fn build_with(
    extract: Extract,
    places: &(impl Fn(LonLat) -> Place + Sync),
    sections: &(impl Fn(&WayFacts, &Place, Option<f64>) -> [CrossSection; 2] + Sync),
    options: &StrokeOptions,
) -> (Network, NetworkAccount) {
    let Extract { ways, refs, nodes, points, restrictions, areas, strings, account: read } = extract;
    let vertices = Vertices::resolve(&ways, &refs, &nodes, &points);
    drop((refs, points));
    let mut account = NetworkAccount {
        missing_references: vertices.missing,
        same_place_nodes: vertices.merged,
        ..NetworkAccount::default()
    };
    let mut network = Network { strings, ..Network::default() };
    Source { nodes: &nodes, vertices: &vertices, places, sections }.build(&ways, &mut network, &mut account);
    drop(ways);
    border::mark(&mut network, read.header.bbox_deg(), &mut account);
    restrictions::resolve(&mut network, &restrictions, &nodes, &vertices, &mut account);
    areas::resolve(&mut network, areas, &nodes, &mut account);
    drop((nodes, vertices));
    account.id_collisions = edge_id::resolve_collisions(&mut network.edges);
    stroke::chain(&mut network, options, &mut account);
    network.splits = Splits::find(&network);
    network.crossings = Crossings::find(&network);
    (network, account)
}
