//! Plans of narrower roads for turns whose roads were measured.
//!
//! The search for a path is no monotone function of widths: a path that it finds on a narrow road may be missed on a wider one. The path still
//! fits there, because the wider area contains the narrow one. So a turn that lacks room on measured roads is planned on some narrower roads,
//! too, that of the map among them. Otherwise a larger measured width could take a certificate away.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::network::{EdgeNo, Network};
use crate::osm::NodeId;
use crate::osm::facts::{CrossSection, Strip};
use netcert_roads::turns::TurnFacts;

/// Steps by which strips are narrower, metres on each side. They count from the map's strip, so the roads that are tried for a width are
/// tried for every larger one, too.
const STEP_M: f32 = 0.025;
/// The narrowest and the widest roads that are tried, in steps from the map's.
const STEPS: Range<i16> = -8..65;
/// Every step is tried down to so much less than was measured, metres, where no more than this lacks; farther away every fourth one.
const NEAR_M: f32 = 0.3;
const LACKS_M: f64 = 0.5;
const FAR_STEPS: i16 = 4;

/// The places of a network where a width was measured: how much farther out a strip is than on the map, metres.
pub(super) struct MeasuredWidths {
    /// By edge, and by the nodes at its ends.
    edges: FxHashMap<EdgeNo, f32>,
    nodes: FxHashMap<NodeId, f32>,
}

impl MeasuredWidths {
    /// `None` if there is none.
    pub(super) fn find(network: &Network) -> Option<Self> {
        if network.site.is_empty() {
            return None;
        }
        let mut all = Self { edges: FxHashMap::default(), nodes: FxHashMap::default() };
        for (index, edge) in network.numbered_edges() {
            let Some(section) = network.site.section(edge) else { continue };
            let more_m = beyond(&section, &network.mapped_section(edge));
            all.edges.insert(index, more_m);
            for node in [edge.from_node, edge.to_node] {
                all.nodes.entry(node).and_modify(|most_m| *most_m = most_m.max(more_m)).or_insert(more_m);
            }
        }
        (!all.edges.is_empty()).then_some(all)
    }

    /// The most that a strip is farther out than on the map where a turn leads over or past it, metres. `None` if nothing is measured there.
    /// `strokes` has the stroke of each edge.
    pub(super) fn most_m(&self, network: &Network, strokes: &[u32], turn: &TurnFacts) -> Option<f32> {
        let of_edge = |edge: EdgeNo| {
            let ends = &network.edges[edge.index()];
            let nodes = [ends.from_node, ends.to_node].into_iter().filter_map(|node| self.nodes.get(&node));
            let stroke = network.strokes.get(strokes[edge.index()] as usize);
            let ranges = stroke.map(|stroke| [&stroke.edges, &stroke.approach]).into_iter().flatten();
            let edges = ranges.flat_map(|range| &network.stroke_edges[range.start as usize..range.end as usize]);
            nodes.chain(edges.filter_map(|edge| self.edges.get(edge))).copied().reduce(f32::max)
        };
        let met = turn.through.iter().chain([&turn.movement.from, &turn.movement.to]);
        met.filter_map(|&edge| of_edge(edge)).reduce(f32::max)
    }
}

/// A network whose measured strips can be made narrower.
pub(super) struct Narrower<'n> {
    as_measured: &'n Network,
    pub(super) network: Network,
}

impl<'n> Narrower<'n> {
    pub(super) fn new(network: &'n Network) -> Self {
        Self { as_measured: network, network: network.clone() }
    }

    /// Makes the measured strips no farther out than those of the map and so many steps.
    pub(super) fn set(&mut self, step: i16) {
        for edge in &self.as_measured.edges {
            if let Some(section) = self.as_measured.site.section(edge) {
                let limited = limited(&section, &self.as_measured.mapped_section(edge), more_m(step));
                self.network.site.set_section(edge, limited);
            }
        }
    }
}

/// The steps that are tried, the widest roads first.
pub(super) fn steps() -> impl Iterator<Item = i16> {
    STEPS.rev()
}

/// Whether a step is tried for a turn whose strips are so much farther out than on the map, metres, and that lacks this, metres.
pub(super) fn tried(step: i16, most_m: f32, lacks_m: f64) -> bool {
    let less_m = most_m - more_m(step);
    less_m > 0.0 && (step % FAR_STEPS == 0 || (less_m <= NEAR_M && lacks_m <= LACKS_M))
}

fn more_m(step: i16) -> f32 {
    f32::from(step) * STEP_M
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
