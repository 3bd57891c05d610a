//! One condition for one road: one width where its edges need nearly the same. There is less to measure then, and the sheet is shorter.

use std::collections::BTreeMap;

use super::suppositions::Suppositions;
use super::way_roads::roads;
use crate::network::{EdgeNo, Network};
use crate::osm::facts::Policy;

/// Widths of one road that differ by no more than this become one condition, metres.
const LEVEL_M: f64 = 0.5;

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
