//! What is known of single places beside the map: widths of edges, radii of kerbs and limits, measured on site or supposed by a condition.
//!
//! Certificates see a network with a site like any other network. A place without an entry is as the map has it.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;

use super::{Edge, Network};
use crate::osm::facts::{CrossSection, Direction, Legal};
use crate::osm::{LonLat, NodeId};

/// Two pieces of road that form a corner, in order. A piece is known by its road and by where its shape begins.
pub type Pieces = [(u32, u32); 2];

/// Limits of an edge that count in place of the map's. `None` leaves the map's limit.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SiteLimits {
    /// Greatest height of a vehicle, metres.
    pub height_m: Option<f32>,
    /// Greatest mass of a vehicle, tonnes.
    pub weight_t: Option<f32>,
}

/// Entries for single places.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Site {
    /// By `edge_id`.
    sections: FxHashMap<i64, CrossSection>,
    /// By node, and by corner. Metres.
    kerbs: FxHashMap<(NodeId, Option<Pieces>), f64>,
    /// Paved surfaces by the node of their junction: closed rings.
    surfaces: FxHashMap<NodeId, Vec<Vec<LonLat>>>,
    /// By `edge_id`.
    limits: FxHashMap<i64, SiteLimits>,
}

impl Site {
    /// Whether every place is as the map has it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { sections, kerbs, surfaces, limits } = self;
        sections.is_empty() && kerbs.is_empty() && surfaces.is_empty() && limits.is_empty()
    }

    /// The cross section that an edge has here.
    #[must_use]
    pub fn section(&self, edge: &Edge) -> Option<CrossSection> {
        self.sections.get(&edge.id).copied()
    }

    /// Gives an edge a cross section of its own.
    pub fn set_section(&mut self, edge: &Edge, section: CrossSection) {
        self.sections.insert(edge.id, section);
    }

    /// The limits that an edge has here.
    #[must_use]
    pub fn limits(&self, edge: &Edge) -> SiteLimits {
        self.limits.get(&edge.id).copied().unwrap_or_default()
    }

    /// The limits that an edge has here, to be changed.
    pub fn limits_mut(&mut self, edge: &Edge) -> &mut SiteLimits {
        self.limits.entry(edge.id).or_default()
    }

    /// Gives all corners at a node a kerb radius, metres, or only the corner between two edges.
    pub fn set_kerb(&mut self, node: NodeId, between: Option<[&Edge; 2]>, radius_m: f64) {
        self.kerbs.insert((node, between.map(pieces)), radius_m);
    }

    /// Adds a paved surface without kerbs and islands to the junction at a node: a closed ring that does not cross itself.
    pub fn add_surface(&mut self, node: NodeId, ring: Vec<LonLat>) {
        self.surfaces.entry(node).or_default().push(ring);
    }

    /// The nodes of junctions that have a kerb or a surface of their own.
    pub fn junctions(&self) -> impl Iterator<Item = NodeId> {
        self.kerbs.keys().map(|corner| corner.0).chain(self.surfaces.keys().copied())
    }

    /// The paved surfaces of the junction at a node.
    pub fn surfaces(&self, node: NodeId) -> &[Vec<LonLat>] {
        self.surfaces.get(&node).map_or(&[], Vec::as_slice)
    }
}

/// The pieces of a corner, the same for both ways round it.
pub fn pieces(edges: [&Edge; 2]) -> Pieces {
    let mut pieces = edges.map(|edge| (edge.road, edge.shape.start));
    pieces.sort_unstable();
    pieces
}

impl Site {
    /// Where two sites differ: ids of edges with other widths or limits, and ids of nodes with other kerbs or surfaces; both sorted.
    #[must_use]
    pub fn differences(&self, other: &Self) -> (Vec<i64>, Vec<NodeId>) {
        let differ = |edge: &&i64| self.sections.get(edge) != other.sections.get(edge);
        let mut edges: BTreeSet<i64> =
            self.sections.keys().chain(other.sections.keys()).filter(differ).copied().collect();
        let differ = |edge: &&i64| self.limits.get(edge) != other.limits.get(edge);
        edges.extend(self.limits.keys().chain(other.limits.keys()).filter(differ));
        let differ = |corner: &&(NodeId, Option<Pieces>)| self.kerbs.get(corner) != other.kerbs.get(corner);
        let corners = self.kerbs.keys().chain(other.kerbs.keys()).filter(differ);
        let mut nodes: BTreeSet<NodeId> = corners.map(|corner| corner.0).collect();
        let differ = |node: &&NodeId| self.surfaces.get(node) != other.surfaces.get(node);
        nodes.extend(self.surfaces.keys().chain(other.surfaces.keys()).filter(differ));
        (edges.into_iter().collect(), nodes.into_iter().collect())
    }
}

impl Network {
    /// The strips of an edge: those of its site, else those of its road.
    #[must_use]
    pub fn section(&self, edge: &Edge) -> CrossSection {
        self.site.section(edge).unwrap_or_else(|| self.mapped_section(edge))
    }

    /// The strips of an edge's road.
    #[must_use]
    pub fn mapped_section(&self, edge: &Edge) -> CrossSection {
        self.road(edge).sections[usize::from(edge.direction == Direction::Backward)]
    }

    /// The limits and access rules of an edge: those of its site, else those of the map.
    #[must_use]
    pub fn legal(&self, edge: &Edge) -> Legal {
        let SiteLimits { height_m, weight_t } = self.site.limits(edge);
        edge.legal.with_limits(height_m, weight_t)
    }

    /// The kerb radius that the site has for the corner of two edges at a node, metres. `None` if the site says nothing.
    #[must_use]
    pub fn site_kerb_m(&self, node: NodeId, between: [&Edge; 2]) -> Option<f64> {
        if self.site.kerbs.is_empty() {
            return None;
        }
        let at = |corner| self.site.kerbs.get(&(node, corner)).copied();
        at(Some(pieces(between))).or_else(|| at(None))
    }
}
