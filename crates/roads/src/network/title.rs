//! What a road is called: its ref and name, or else what it joins, such as `ramp from I 405 to US 30`.
//!
//! A title is for people. No id, verdict or way depends on it.

use std::collections::BinaryHeap;
use std::sync::OnceLock;

use rustc_hash::FxHashSet;

use super::{Edge, EdgeNo, Network, Road};
use crate::osm::NodeId;
use crate::osm::facts::{Oneway, RoadClass};
use crate::words::Named as _;

/// How far a named road is searched from the end of a `_link`, metres. The ramps of an interchange are shorter.
const REACH_OF_LINK_M: f64 = 3000.0;
/// The same of other roads, such as driveways.
const REACH_M: f64 = 600.0;
/// Most edges that one search looks at.
const MOST_EDGES: usize = 200;

/// The edges at each end of an unnamed road. They are found when a title is first asked for.
#[derive(Debug, Clone, Default)]
pub struct RoadEnds(OnceLock<Vec<(NodeId, EdgeNo)>>);

impl RoadEnds {
    /// The edges that begin or end at a node.
    fn at<'n>(&'n self, network: &Network, node: NodeId) -> impl Iterator<Item = EdgeNo> + 'n {
        let all = self.0.get_or_init(|| Self::find(network));
        let first = all.partition_point(|end| end.0 < node);
        all.iter().skip(first).take_while(move |end| end.0 == node).map(|end| end.1)
    }

    fn find(network: &Network) -> Vec<(NodeId, EdgeNo)> {
        let unnamed = network.edges.iter().filter(|edge| named(network.road(edge)).is_empty());
        let mut nodes: Vec<NodeId> = unnamed.flat_map(|edge| [edge.from_node, edge.to_node]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let ends = |(index, edge): (EdgeNo, &Edge)| [(edge.from_node, index), (edge.to_node, index)];
        let mut all: Vec<(NodeId, EdgeNo)> = network.numbered_edges().flat_map(ends).collect();
        all.retain(|end| nodes.binary_search(&end.0).is_ok());
        all.sort_unstable();
        all
    }
}

/// Ref and name, as far as there are any.
fn named(road: &Road) -> Vec<crate::osm::StringId> {
    [road.reference, road.name].into_iter().flatten().collect()
}

/// The end of an edge at which a search begins.
#[derive(Clone, Copy, PartialEq)]
enum End {
    From,
    To,
}

impl Network {
    /// Ref and name, such as `A87 Great Inland Highway`. If both are missing: what the road joins, such as `ramp from I 405 to US 30`,
    /// `link A 5 – B 3` or `service road at Main Street`. If that is unknown, too, class and way.
    #[must_use]
    pub fn title(&self, edge: &Edge) -> String {
        let road = self.road(edge);
        let texts: Vec<&str> = named(road).into_iter().map(|id| self.strings.text(id)).collect();
        if !texts.is_empty() {
            return texts.join(" ");
        }
        let (kind, one_way) = (kind(road), road.oneway != Oneway::No);
        let (from, to) = (self.nearest_name(edge, End::From), self.nearest_name(edge, End::To));
        match (from, to) {
            (Some(from), Some(to)) if from == to => format!("{kind} at {from}"),
            (Some(a), Some(b)) if road.roundabout => format!("{kind} at {} and {}", a.clone().min(b.clone()), a.max(b)),
            (Some(from), Some(to)) if one_way => format!("{kind} from {from} to {to}"),
            // Both directions of a road have one title.
            (Some(from), Some(to)) => format!("{kind} {} – {}", from.clone().min(to.clone()), from.max(to)),
            (Some(from), None) if one_way => format!("{kind} from {from}"),
            (None, Some(to)) if one_way => format!("{kind} to {to}"),
            (Some(at), None) | (None, Some(at)) => format!("{kind} at {at}"),
            (None, None) => format!("{kind} (way {})", road.way_id),
        }
    }

    /// The ref, or else the name, of the nearest named road before or after an edge, along the direction of travel and over unnamed roads
    /// alone. Of several at one node it is that of the highest class.
    fn nearest_name(&self, edge: &Edge, end: End) -> Option<String> {
        let node = |edge: &Edge, end| if end == End::From { edge.from_node } else { edge.to_node };
        let reach_m = if self.road(edge).link { REACH_OF_LINK_M } else { REACH_M };
        // The nearest node first; distances are in whole decimetres, so that they can be sorted.
        let mut open = BinaryHeap::from([(std::cmp::Reverse(0_u64), node(edge, end))]);
        let (mut seen, mut closed) = (FxHashSet::from_iter([edge.shape.start]), Vec::new());
        while let Some((std::cmp::Reverse(far), at)) = open.pop() {
            if closed.contains(&at) {
                continue;
            }
            closed.push(at);
            let mut best: Option<(bool, RoadClass, EdgeNo)> = None;
            for index in self.ends.at(self, at) {
                let Some(next) = self.edges.get(index.index()) else { continue };
                let (road, back) = (self.road(next), if end == End::From { End::To } else { End::From });
                // Before an edge comes what ends there, and after it what begins there. A dead end leads back the way it came.
                if seen.contains(&next.shape.start) || node(next, back) != at {
                    continue;
                }
                if !named(road).is_empty() {
                    best = best.into_iter().chain([(road.link, road.class, index)]).min();
                    continue;
                }
                seen.insert(next.shape.start);
                let further = far + (10.0 * self.length_m(next)) as u64;
                if (further as f64) < 10.0 * reach_m && seen.len() < MOST_EDGES {
                    open.push((std::cmp::Reverse(further), node(next, end)));
                }
            }
            if let Some((.., index)) = best {
                return self.edges.get(index.index()).map(|edge| self.short_name(self.road(edge)));
            }
        }
        None
    }

    /// The ref with `/` between its parts, or else the name.
    fn short_name(&self, road: &Road) -> String {
        match (road.reference, road.name) {
            (Some(id), _) => self.strings.text(id).split(';').map(str::trim).collect::<Vec<_>>().join("/"),
            (None, Some(id)) => self.strings.text(id).to_owned(),
            (None, None) => String::new(),
        }
    }
}

fn kind(road: &Road) -> String {
    let plain = road.class.name().replace('_', " ");
    match road.class {
        _ if road.roundabout => "roundabout".to_owned(),
        RoadClass::Motorway | RoadClass::Trunk if road.link => "ramp".to_owned(),
        _ if road.link => "link".to_owned(),
        RoadClass::Motorway | RoadClass::Track | RoadClass::Busway | RoadClass::LivingStreet => plain,
        _ => format!("{plain} road"),
    }
}

#[cfg(test)]
mod tests {
    use crate::corridor::tests::network;
    use crate::network::Edge;
    use crate::osm::NodeId;
    use crate::osm::facts::CrossSection;

    /// A list of the edges seen would be searched for each of them: 10^11 comparisons.
    #[test]
    fn a_title_at_a_node_of_very_many_driveways_takes_few_looks() {
        let none = CrossSection { lane: None, direction: None, carriageway: None };
        let (mut n, _) = network(&[(vec![[0.0, 0.0], [10.0, 0.0]], none)], false);
        let (one, ends) = (n.edges[0].clone(), n.shapes.clone());
        for k in 0..300_000 {
            let start = n.shapes.len() as u32;
            n.shapes.extend(&ends);
            n.edges.push(Edge {
                id: 10 + k,
                from_node: NodeId::new(10 + k),
                to_node: NodeId::new(0),
                shape: start..start + 2,
                ..one.clone()
            });
        }
        for _ in 0..3 {
            assert_eq!(n.title(&one), "primary road (way 0)");
        }
    }
}
