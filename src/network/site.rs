//! What is known of single places beside the map: widths of edges and radii of kerbs, measured on site or supposed by a condition.
//!
//! Certificates see a network with a site like any other network. A place without an entry is as the map has it.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;

use super::{Edge, Network};
use crate::osm::facts::{CrossSection, Direction};

/// Two pieces of road that form a corner, in order. A piece is known by its road and by where its shape begins.
pub(crate) type Pieces = [(u32, u32); 2];

/// Entries for single places.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Site {
    /// By `edge_id`.
    sections: FxHashMap<i64, CrossSection>,
    /// By node, and by corner. Metres.
    kerbs: FxHashMap<(i64, Option<Pieces>), f64>,
}

impl Site {
    /// Whether every place is as the map has it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sections.is_empty() && self.kerbs.is_empty()
    }

    /// Gives an edge a cross section of its own.
    pub fn set_section(&mut self, edge: &Edge, section: CrossSection) {
        self.sections.insert(edge.id, section);
    }

    /// Gives all corners at a node a kerb radius, metres, or only the corner between two edges.
    pub fn set_kerb(&mut self, node: i64, between: Option<[&Edge; 2]>, radius_m: f64) {
        self.kerbs.insert((node, between.map(pieces)), radius_m);
    }

    /// Where two sites differ: ids of edges, and ids of nodes with other kerbs; both sorted.
    #[must_use]
    pub fn differences(&self, other: &Self) -> (Vec<i64>, Vec<i64>) {
        let differ = |edge: &&i64| self.sections.get(edge) != other.sections.get(edge);
        let edges: BTreeSet<i64> = self.sections.keys().chain(other.sections.keys()).filter(differ).copied().collect();
        let differ = |corner: &&(i64, Option<Pieces>)| self.kerbs.get(corner) != other.kerbs.get(corner);
        let corners = self.kerbs.keys().chain(other.kerbs.keys()).filter(differ);
        let nodes: BTreeSet<i64> = corners.map(|corner| corner.0).collect();
        (edges.into_iter().collect(), nodes.into_iter().collect())
    }
}

/// The pieces of a corner, the same for both ways round it.
pub(crate) fn pieces(edges: [&Edge; 2]) -> Pieces {
    let mut pieces = edges.map(|edge| (edge.road, edge.shape.start));
    pieces.sort_unstable();
    pieces
}

impl Network {
    /// The strips of an edge: those of its site, else those of its road.
    #[must_use]
    pub fn section(&self, edge: &Edge) -> CrossSection {
        let own = self.site.sections.get(&edge.id).copied();
        own.unwrap_or_else(|| self.map_section(edge))
    }

    /// The strips of an edge as the map has them, whatever its site says.
    #[must_use]
    pub fn map_section(&self, edge: &Edge) -> CrossSection {
        self.road(edge).sections[usize::from(edge.direction == Direction::Backward)]
    }

    /// The kerb radius that the site has for the corner of two edges at a node, metres. `None` if the site says nothing.
    #[must_use]
    pub fn site_kerb_m(&self, node: i64, between: [&Edge; 2]) -> Option<f64> {
        if self.site.kerbs.is_empty() {
            return None;
        }
        let at = |corner| self.site.kerbs.get(&(node, corner)).copied();
        at(Some(pieces(between))).or_else(|| at(None))
    }
}
