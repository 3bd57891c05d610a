//! The titles and places of edges, turns and passages.

use super::assemble::{PartKind, passes_over};
use crate::network::{EdgeNo, Network, PassageKind};

/// The title of an edge, turn or passage, such as `A87 Great Inland Highway`, `Main Street into High Street` or `Main Street over
/// the roundabout into High Street`.
#[must_use]
pub fn title(network: &Network, at: PartKind) -> String {
    let of = |edge: EdgeNo| network.edges.get(edge.index()).map_or_else(String::new, |edge| network.title(edge));
    match at {
        PartKind::Edge(edge) => of(edge),
        PartKind::Turn { from, to } if passes_over(network, at) == Some(PassageKind::Roundabout) => {
            format!("{} over the roundabout into {}", of(from), of(to))
        }
        PartKind::Turn { from, to } => format!("{} into {}", of(from), of(to)),
    }
}

/// Longitude and latitude of an edge's middle vertex, or of the node where a turn or passage begins, degrees.
#[must_use]
pub fn place(network: &Network, at: PartKind) -> Option<[f64; 2]> {
    let (edge, last) = match at {
        PartKind::Edge(edge) => (edge, false),
        PartKind::Turn { from, .. } => (from, true),
    };
    let line: Vec<_> = network.positions(network.edges.get(edge.index())?).collect();
    let position = if last { line.last()? } else { line.get(line.len() / 2)? };
    let (lon, lat) = position.degrees();
    Some([lon, lat])
}
