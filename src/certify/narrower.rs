//! Plans of narrower roads for turns whose roads were measured.
//!
//! The search for a path is no monotone function of widths: a path that it finds on a narrow road may be missed on a wider one. The path still
//! fits there, because the wider area contains the narrow one. So a turn that lacks room on measured roads is planned on some narrower roads,
//! too, that of the map among them. Otherwise a larger measured width could take a certificate away.

use std::ops::Range;

use rustc_hash::FxHashSet;

use crate::network::Network;
use crate::osm::facts::{CrossSection, Strip};
use crate::turns::TurnFacts;

/// How much farther out on each side than the map's strip a measured one may be, metres, widest first. The steps are fixed: the roads that
/// are tried for a width are tried for every larger one.
const MORE_M: [f32; 12] = [1.6, 1.2, 0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05, 0.0, -0.1, -0.2];

/// The places of a network where a width was measured.
pub(super) struct MeasuredWidths {
    /// Edges, by index, and the nodes at their ends.
    edges: FxHashSet<u32>,
    nodes: FxHashSet<i64>,
    /// The most that a strip is farther out than on the map, metres.
    most_m: f32,
}

impl MeasuredWidths {
    /// `None` if there is none.
    pub(super) fn find(network: &Network) -> Option<Self> {
        if network.site.is_empty() {
            return None;
        }
        let (edges, nodes) = (FxHashSet::default(), FxHashSet::default());
        let mut all = Self { edges, nodes, most_m: f32::NEG_INFINITY };
        for (index, edge) in (0_u32..).zip(&network.edges) {
            let Some(section) = network.site.section(edge) else { continue };
            all.most_m = all.most_m.max(beyond(&section, &network.mapped_section(edge)));
            all.edges.insert(index);
            all.nodes.extend([edge.from_node, edge.to_node]);
        }
        (!all.edges.is_empty()).then_some(all)
    }

    /// Whether a turn leads over or past such an edge. `strokes` has the stroke of each edge.
    pub(super) fn concerns(&self, network: &Network, strokes: &[u32], turn: &TurnFacts) -> bool {
        let at_node = |edge: u32| {
            let edge = &network.edges[edge as usize];
            self.nodes.contains(&edge.from_node) || self.nodes.contains(&edge.to_node)
        };
        let on_stroke = |edge: u32| {
            let Some(stroke) = network.strokes.get(strokes[edge as usize] as usize) else { return false };
            let edges = |range: &Range<u32>| &network.stroke_edges[range.start as usize..range.end as usize];
            edges(&stroke.edges).iter().chain(edges(&stroke.approach)).any(|edge| self.edges.contains(edge))
        };
        let mut met = turn.through.iter().chain([&turn.movement.from, &turn.movement.to]).copied();
        met.any(|edge| at_node(edge) || on_stroke(edge))
    }

    /// The network with narrower measured strips, widest first.
    pub(super) fn narrower<'n>(&self, network: &'n Network) -> impl Iterator<Item = Network> + use<'n> {
        let most_m = self.most_m;
        MORE_M.into_iter().filter(move |more_m| *more_m < most_m).map(move |more_m| {
            let mut narrower = network.clone();
            for edge in &network.edges {
                if let Some(section) = network.site.section(edge) {
                    narrower.site.set_section(edge, limited(&section, &network.mapped_section(edge), more_m));
                }
            }
            narrower
        })
    }
}

/// The section with each strip no farther out than that of the map and so much more.
fn limited(section: &CrossSection, mapped: &CrossSection, more_m: f32) -> CrossSection {
    let limited = |strip: Option<Strip>, mapped: Option<Strip>| match (strip, mapped) {
        (Some(strip), Some(mapped)) => {
            let left_m = strip.left_m.min(mapped.left_m + more_m);
            let right_m = strip.right_m.max(mapped.right_m - more_m);
            Some(Strip { left_m, right_m, source: strip.source }).filter(|strip| strip.width_m() > 0.0)
        }
        (strip, _) => strip,
    };
    CrossSection {
        lane: limited(section.lane, mapped.lane),
        direction: limited(section.direction, mapped.direction),
        carriageway: limited(section.carriageway, mapped.carriageway),
    }
}

/// The most that one of a section's strips lies beyond that of another one, metres.
fn beyond(section: &CrossSection, mapped: &CrossSection) -> f32 {
    let strips = |of: &CrossSection| [of.lane, of.direction, of.carriageway];
    let more = |(strip, mapped): (Option<Strip>, Option<Strip>)| match (strip, mapped) {
        (Some(strip), Some(mapped)) => (strip.left_m - mapped.left_m).max(mapped.right_m - strip.right_m),
        _ => f32::NEG_INFINITY,
    };
    strips(section).into_iter().zip(strips(mapped)).map(more).fold(f32::NEG_INFINITY, f32::max)
}
