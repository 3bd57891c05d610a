//! Turn restrictions of the map become sequences of edges that may not be driven one right after the other.
//!
//! A restriction whose members are on the network forbids at least what its sign forbids. If it is drawn loosely (a way
//! that continues past the junction), every reading applies. `only_…` forbids every other movement out of the node.
//! Over ways it is read strictly: after the `from` way a vehicle must take the `via` ways, and to their end. A
//! restriction whose members no vehicle can drive one after the other forbids nothing and is counted.

use std::ops::Range;

use super::vertices::Vertices;
use super::{Network, Restriction, reverse};
use crate::osm::facts::{RestrictedTurn, RestrictionKind};
use crate::osm::{self, NodeTable, Via};

/// Most sequences of one restriction, and most edges of one way over which a path is followed. No hand-drawn
/// restriction comes near, and a crafted file cannot cause more work.
const MOST_SEQUENCES: usize = 1024;
const MOST_VIA_EDGES: usize = 256;

/// What is found of an extract's restrictions in a network.
#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Resolved {
    /// By restriction of the network: the relation and its rule, as indices.
    pub(super) rules: Vec<(u32, u32)>,
    /// Relations whose members can be driven one after the other, as indices.
    pub(super) on_network: Vec<u32>,
}

/// Fills `restrictions` and `restriction_edges` of a network without restrictions. Leaves out the relations that `takes` refuses.
pub(super) fn resolve(
    network: &mut Network,
    restrictions: &[osm::Restriction],
    nodes: &NodeTable,
    vertices: &Vertices,
    takes: impl Fn(&osm::Restriction) -> bool,
) -> Resolved {
    let mut resolved = Resolved::default();
    if restrictions.is_empty() {
        return resolved;
    }
    let found: Vec<(usize, usize, Vec<u32>)> = {
        let resolver = Resolver { leaving: Leaving::of(network), network, nodes, vertices };
        let mut found = Vec::new();
        for (no, restriction) in restrictions.iter().enumerate().filter(|(_, restriction)| takes(restriction)) {
            let mut on_network = false;
            for (rule, sequences) in resolver.sequences(restriction).into_iter().enumerate() {
                let Some(sequences) = sequences else { continue };
                on_network = true;
                found.extend(sequences.into_iter().map(|edges| (no, rule, edges)));
            }
            if on_network {
                resolved.on_network.push(no as u32);
            }
        }
        found
    };
    for (no, rule_no, edges) in found {
        let Some((of, rule)) = restrictions.get(no).and_then(|of| Some((of, of.rules.get(rule_no)?))) else { continue };
        resolved.rules.push((no as u32, rule_no as u32));
        let start = network.restriction_edges.len() as u32;
        network.restriction_edges.extend(edges);
        let edges = start..network.restriction_edges.len() as u32;
        network.restrictions.push(Restriction {
            relation_id: of.id,
            kind: rule.kind,
            conditional: rule.conditional,
            edges,
        });
    }
    resolved
}

/// Edges, sorted by the node that they leave.
pub(super) struct Leaving(Vec<u32>);

impl Leaving {
    pub(super) fn of(network: &Network) -> Self {
        let mut edges: Vec<u32> = (0..network.edges.len() as u32).collect();
        edges.sort_by_key(|&edge| network.edges[edge as usize].from_node);
        Self(edges)
    }

    /// The edges that leave a node, in edge order.
    pub(super) fn at(&self, network: &Network, node: i64) -> &[u32] {
        let from = |edge: &u32| network.edges[*edge as usize].from_node;
        let start = self.0.partition_point(|edge| from(edge) < node);
        let end = start + self.0[start..].partition_point(|edge| from(edge) == node);
        &self.0[start..end]
    }
}

struct Resolver<'n> {
    network: &'n Network,
    nodes: &'n NodeTable,
    vertices: &'n Vertices,
    leaving: Leaving,
}

impl Resolver<'_> {
    /// The sequences that each rule forbids, sorted. `None` if the members are not on the network.
    fn sequences(&self, restriction: &osm::Restriction) -> Vec<Option<Vec<Vec<u32>>>> {
        let members = |ways: &[i64]| ways.iter().flat_map(|&way| self.edges_of(way)).collect::<Vec<u32>>();
        let (from, to) = (members(&restriction.from), members(&restriction.to));
        let sequences = |kind: RestrictionKind| {
            let mut all = match &restriction.via {
                Via::Nodes(nodes) => self.at_nodes(kind, &from, nodes, &to),
                Via::Ways(ways) => self.over_ways(kind, &from, ways, &to),
            }?;
            all.sort_unstable();
            all.dedup();
            all.truncate(MOST_SEQUENCES);
            Some(all)
        };
        restriction.rules.iter().map(|rule| sequences(rule.kind)).collect()
    }

    fn at_nodes(&self, kind: RestrictionKind, from: &[u32], via: &[i64], to: &[u32]) -> Option<Vec<Vec<u32>>> {
        let mut on_network = false;
        let mut all = Vec::new();
        for node in via.iter().filter_map(|&id| self.vertices.node(self.nodes, id)) {
            let leaving = self.leaving.at(self.network, node);
            for &f in from.iter().filter(|&&f| self.network.edges[f as usize].to_node == node) {
                let named = |t: u32| to.contains(&t) && self.is_meant(kind, f, t);
                on_network |= kind.only || leaving.iter().any(|&t| to.contains(&t));
                let forbidden = leaving.iter().filter(|&&t| named(t) != kind.only);
                all.extend(forbidden.take(MOST_SEQUENCES).map(|&t| vec![f, t]));
            }
            if all.len() > MOST_SEQUENCES {
                break;
            }
        }
        on_network.then_some(all)
    }

    /// A U-turn on one way means its reversal, not the continuation past the node.
    fn is_meant(&self, kind: RestrictionKind, from: u32, to: u32) -> bool {
        let same_way = self.way(from) == self.way(to);
        kind.turn != RestrictedTurn::UTurn || !same_way || reverse(self.network, from, to)
    }

    fn over_ways(&self, kind: RestrictionKind, from: &[u32], via: &[i64], to: &[u32]) -> Option<Vec<Vec<u32>>> {
        let mut paths = Vec::new();
        for &f in from {
            self.follow(&mut vec![f], via, to, &mut paths);
        }
        if paths.is_empty() {
            return None;
        }
        if !kind.only {
            return Some(paths);
        }
        let mut forbidden = Vec::new();
        for path in &paths {
            for length in 1..path.len() {
                let prefix = &path[..length];
                let on = |x: u32| paths.iter().any(|p| p.starts_with(prefix) && p.get(length) == Some(&x));
                let end = self.network.edges[path[length - 1] as usize].to_node;
                let others = self.leaving.at(self.network, end).iter().filter(|&&x| !on(x));
                forbidden.extend(others.map(|&x| [prefix, &[x]].concat()));
            }
        }
        Some(forbidden)
    }

    /// Follows all paths from the end of `path` over the ways `via` to an edge of `to`. Each way is driven in one
    /// direction.
    fn follow(&self, path: &mut Vec<u32>, via: &[i64], to: &[u32], paths: &mut Vec<Vec<u32>>) {
        let Some(&last) = path.last() else { return };
        let leaving = self.leaving.at(self.network, self.network.edges[last as usize].to_node);
        let Some((&way, rest)) = via.split_first() else {
            let ends = leaving.iter().filter(|t| to.contains(t));
            paths.extend(ends.map(|&t| [path.as_slice(), &[t]].concat()));
            return;
        };
        let length = path.len();
        for &first in leaving.iter().filter(|&&edge| self.way(edge) == way && !reverse(self.network, last, edge)) {
            let mut edge = Some(first);
            while let Some(next) = edge.filter(|next| !path[length..].contains(next)) {
                path.push(next);
                if path.len() > MOST_VIA_EDGES || paths.len() > MOST_SEQUENCES {
                    break;
                }
                self.follow(path, rest, to, paths);
                edge = self.along(next);
            }
            path.truncate(length);
        }
    }

    /// The next edge of the same way in the same direction.
    fn along(&self, edge: u32) -> Option<u32> {
        let e = &self.network.edges[edge as usize];
        let goes_on = |&&other: &&u32| {
            let o = &self.network.edges[other as usize];
            o.road == e.road && o.direction == e.direction && other != edge
        };
        self.leaving.at(self.network, e.to_node).iter().find(goes_on).copied()
    }

    fn way(&self, edge: u32) -> i64 {
        self.network.road(&self.network.edges[edge as usize]).way_id
    }

    fn edges_of(&self, way: i64) -> Range<u32> {
        let edges = &self.network.edges;
        let id = |edge: &super::Edge| self.network.road(edge).way_id;
        let start = edges.partition_point(|edge| id(edge) < way);
        let end = start + edges[start..].partition_point(|edge| id(edge) == way);
        start as u32..end as u32
    }
}
