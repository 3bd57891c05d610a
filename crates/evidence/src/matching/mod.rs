//! Which edges or junctions a row of evidence means.
//!
//! Ids are looked up, geometries are measured. A row that could mean two roads is ambiguous and never guessed. Every row is
//! matched alone, so the number of threads does not matter.

mod area;
mod candidate;
mod ids;
mod index;
mod line;
mod names;
mod point;
mod rivals;
mod track;

use rayon::prelude::*;

use super::row::{Along, MeasurementRow, Place};
use crate::network::{EdgeNo, Network};
use crate::osm::NodeId;
use index::MatchingIndex;

/// What a row means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Match {
    /// Edges, as sorted indices into [`Network::edges`]; at least one.
    Edges(Vec<EdgeNo>),
    /// A junction, or one corner of it.
    Corner {
        /// OSM node id.
        node: NodeId,
        /// The edge that ends and the edge that begins at the corner: indices into [`Network::edges`].
        edges: Option<[EdgeNo; 2]>,
    },
    /// The surface of these junctions: OSM node ids, sorted, at least one.
    Area(Vec<NodeId>),
    /// No road or junction. The text says why.
    Unmatched(String),
    /// Several could be meant. The text names them with their distances.
    Ambiguous(String),
}

/// Matches rows to the network. The result has the order of the rows.
#[must_use]
pub fn match_rows(network: &Network, rows: &[MeasurementRow]) -> Vec<Match> {
    let index = MatchingIndex::new(network);
    rows.par_iter().map(|row| match_row(&index, row).unwrap_or_else(|other| other)).collect()
}

/// A match, or as `Err` what stands in its way. Both are answers.
type Found = Result<Match, Match>;

fn match_row(index: &MatchingIndex<'_>, row: &MeasurementRow) -> Found {
    match &row.place {
        Place::Edge(id) => ids::edge(index, row, *id),
        Place::Way { way_id, nodes } => ids::way(index, row, *way_id, *nodes),
        Place::Junction { node, edges } => ids::junction(index, row, *node, *edges),
        Place::Line(line) => line::matched(index, row, line),
        Place::Point(at) => point::matched(index, row, *at),
        Place::Polygon(_) => area::matched(index, row),
    }
}

fn unmatched<T>(why: impl Into<String>) -> Result<T, Match> {
    Err(Match::Unmatched(why.into()))
}

/// Candidates that a message names.
const TOLD: usize = 4;

/// The first candidates, and how many more there are.
fn listed(told: &[String], or: &str) -> String {
    let more = if told.len() > TOLD { format!(" and {} more", told.len() - TOLD) } else { String::new() };
    told.iter().take(TOLD).map(String::as_str).collect::<Vec<_>>().join(or) + more.as_str()
}

/// Which of the edges `[forward, backward]` of a piece are meant.
fn directed(edges: [Option<EdgeNo>; 2], along: Along) -> Vec<EdgeNo> {
    let [forward, backward] = edges;
    match along {
        Along::Both => forward.into_iter().chain(backward).collect(),
        Along::Forward => forward.into_iter().collect(),
        Along::Backward => backward.into_iter().collect(),
    }
}
