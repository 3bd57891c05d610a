//! One condition for one road: which edges of a way belong to one road, and one width where they need nearly the same. There is less to
//! measure then, and the sheet is shorter.

use std::collections::BTreeMap;

use super::suppositions::Suppositions;
use crate::network::{EdgeNo, Network, Road};
use crate::osm::facts::Policy;

/// Widths of one road that differ by no more than this become one condition, metres.
const LEVEL_M: f64 = 0.5;

/// The number of the road of each edge of a way. A road ends where the way leaves it; the same road further on has another number.
pub(super) fn roads(network: &Network, way: &[EdgeNo]) -> Vec<usize> {
    let strokes = network.strokes_of_edges();
    let mut road = 0;
    let mut numbers = Vec::with_capacity(way.len());
    for (i, &edge) in way.iter().enumerate() {
        road += usize::from(i > 0 && !goes_on(network, &strokes, way[i - 1], edge));
        numbers.push(road);
    }
    numbers
}

/// Whether an edge belongs to the road of the edge before it: the same way, name or reference, or straight on.
fn goes_on(network: &Network, strokes: &[u32], a: EdgeNo, b: EdgeNo) -> bool {
    let stroke = |edge: EdgeNo| strokes.get(edge.index()).filter(|&&stroke| stroke != u32::MAX);
    let road = |edge: EdgeNo| network.edges.get(edge.index()).map(|edge| network.road(edge));
    let same = |a: &Road, b: &Road| {
        let name = a.name.is_some() && a.name == b.name;
        let reference = a.reference.is_some() && a.reference == b.reference;
        a.way_id == b.way_id || (a.link == b.link && (name || reference))
    };
    road(a).zip(road(b)).is_some_and(|(a, b)| same(a, b)) || stroke(a).is_some_and(|of_a| stroke(b) == Some(of_a))
}

impl Suppositions {
    /// Gives edges of one road of a way the greatest of their widths, if these differ little. A lane that is all of its direction is
    /// measured as a lane.
    pub(crate) fn level_roads(&mut self, network: &Network, way: &[EdgeNo]) {
        self.level_directions(network, way);
        let mut of_road: BTreeMap<(usize, Policy), Vec<(EdgeNo, f64)>> = BTreeMap::new();
        for (&edge, road) in way.iter().zip(roads(network, way)) {
            for (&(_, strip), &width_m) in self.widths_m.range((edge, Policy::Lane)..=(edge, Policy::Carriageway)) {
                of_road.entry((road, strip)).or_default().push((edge, width_m));
            }
        }
        for ((_, strip), mut edges) in of_road {
            edges.sort_by(|a, b| b.1.total_cmp(&a.1));
            let mut level_m = f64::INFINITY;
            for (edge, width_m) in edges {
                if level_m - width_m > LEVEL_M {
                    level_m = width_m;
                }
                self.widths_m.insert((edge, strip), level_m);
            }
        }
    }

    /// Supposes widths of lanes instead of directions where both are the same strip, if lanes are what counts on this way.
    fn level_directions(&mut self, network: &Network, way: &[EdgeNo]) {
        if !self.widths_m.keys().any(|(_, strip)| *strip == Policy::Lane) {
            return;
        }
        for &edge in way {
            let [lane, direction] =
                [Policy::Lane, Policy::Direction].map(|strip| self.known_width_m(network, edge, strip));
            if lane.is_none() || lane != direction {
                continue;
            }
            if let Some(direction_m) = self.widths_m.remove(&(edge, Policy::Direction)) {
                let lane_m = self.widths_m.entry((edge, Policy::Lane)).or_insert(direction_m);
                *lane_m = lane_m.max(direction_m);
            }
        }
    }
}
