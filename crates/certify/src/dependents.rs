//! Which certificates may differ where only some widths and kerbs do. In doubt more are named than need be: naming too few would leave
//! certificates of roads that are no longer so.
//!
//! A stroke's corridor depends on the widths of its own edges and those of its approach. A turn depends on the corridors of all strokes that it
//! leads over, and on the roads and kerbs at its nodes and at nodes close to them.

use rstar::{AABB, RTree};
use rustc_hash::FxHashSet;

use crate::network::{EARTH_RADIUS_M, EdgeNo, Network};
use crate::osm::{LonLat, NodeId};
use netcert_roads::turns::{TurnFacts, TurnNo};

/// Roads and kerbs at nodes farther from a turn's line than this are no part of its area, metres. Its area has crossings up to 30 m along
/// its roads.
const NEAR_M: f64 = 150.0;

/// Strokes and turns to certify again.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Dependents {
    /// Indices into [`Network::strokes`], sorted.
    pub strokes: Vec<u32>,
    /// Turns, sorted.
    pub turns: Vec<TurnNo>,
    /// Nodes at which a road's width, a kerb or a surface differs, sorted.
    pub nodes: Vec<NodeId>,
}

impl Dependents {
    /// What may differ if the widths of `edges` (ids) and the kerbs at `nodes` do.
    #[must_use]
    pub fn find(network: &Network, turns: &[TurnFacts], edges: &[i64], nodes: &[NodeId]) -> Self {
        let edges: FxHashSet<i64> = edges.iter().copied().collect();
        let changed: Vec<bool> = network.edges.iter().map(|edge| edges.contains(&edge.id)).collect();
        let of_chain = |stroke: &crate::network::Stroke| {
            let chains = [&stroke.approach, &stroke.edges].map(|range| range.start as usize..range.end as usize);
            let chain = chains.into_iter().flat_map(|range| network.stroke_edges.get(range).unwrap_or_default());
            chain.into_iter().any(|&edge| changed.get(edge.index()).copied().unwrap_or(true))
        };
        let strokes: Vec<u32> =
            (0..).zip(&network.strokes).filter(|(_, stroke)| of_chain(stroke)).map(|(index, _)| index).collect();
        let mut places: FxHashSet<NodeId> = nodes.iter().copied().collect();
        for (edge, _) in network.edges.iter().zip(&changed).filter(|(_, changed)| **changed) {
            places.extend([edge.from_node, edge.to_node]);
        }
        let touched = TouchedTurns::new(network, &strokes, &places);
        let turns = TurnNo::all().zip(turns).filter(|(_, turn)| touched.has(turn)).map(|(index, _)| index).collect();
        let mut nodes: Vec<NodeId> = places.into_iter().collect();
        nodes.sort_unstable();
        Self { strokes, turns, nodes }
    }

    /// The edges of the touched strokes.
    pub fn edges<'n>(&self, network: &'n Network) -> impl Iterator<Item = EdgeNo> + use<'_, 'n> {
        let strokes = self.strokes.iter().filter_map(|&stroke| network.strokes.get(stroke as usize));
        strokes
            .flat_map(|stroke| network.stroke_edges.get(stroke.edges.start as usize..stroke.edges.end as usize))
            .flatten()
            .copied()
    }
}

/// Places near nodes at which something differs.
pub struct NearNodes {
    /// The nodes, degrees.
    nodes: RTree<[f64; 2]>,
}

struct TouchedTurns {
    of_edge: Vec<u32>,
    strokes: FxHashSet<u32>,
    nodes: NearNodes,
}

impl NearNodes {
    /// What is near some nodes of a network, given by their ids.
    #[must_use]
    pub fn new(network: &Network, nodes: &[NodeId]) -> Self {
        Self::of(network, &nodes.iter().copied().collect())
    }

    fn of(network: &Network, nodes: &FxHashSet<NodeId>) -> Self {
        let ends = network.edges.iter().filter_map(|edge| {
            let mut line = network.positions(edge);
            let (first, last) = (line.next()?, line.next_back()?);
            let ends = [(edge.from_node, first), (edge.to_node, last)];
            Some(ends.into_iter().filter(|(node, _)| nodes.contains(node)).map(|(_, at)| at))
        });
        let mut places: Vec<LonLat> = ends.flatten().collect();
        places.sort_unstable_by_key(|at| (at.lon_e7, at.lat_e7));
        places.dedup();
        Self { nodes: RTree::bulk_load(places.into_iter().map(|at| at.degrees().into()).collect()) }
    }

    /// Whether a node is within 150 m of a line's positions, on either side of the antimeridian.
    #[must_use]
    pub fn has(&self, line: &[LonLat]) -> bool {
        let north = (NEAR_M / EARTH_RADIUS_M).to_degrees();
        line.iter().any(|place| {
            let (lon, lat) = place.degrees();
            let east = (north / lat.to_radians().cos().abs().max(1e-6)).min(360.0);
            [-360.0, 0.0, 360.0].iter().any(|turn| {
                let around = AABB::from_corners([lon + turn - east, lat - north], [lon + turn + east, lat + north]);
                self.nodes.locate_in_envelope(&around).next().is_some()
            })
        })
    }
}

impl TouchedTurns {
    fn new(network: &Network, strokes: &[u32], nodes: &FxHashSet<NodeId>) -> Self {
        let nodes = NearNodes::of(network, nodes);
        Self { of_edge: network.strokes_of_edges(), strokes: strokes.iter().copied().collect(), nodes }
    }

    fn has(&self, turn: &TurnFacts) -> bool {
        let mut edges = [turn.movement.from, turn.movement.to].into_iter().chain(turn.through.iter().copied());
        let stroke = |edge: EdgeNo| self.of_edge.get(edge.index());
        edges.any(|edge| stroke(edge).is_none_or(|stroke| self.strokes.contains(stroke))) || self.nodes.has(&turn.line)
    }
}
