//! Turn restrictions of the map become sequences of edges that may not be driven one right after the other.
//!
//! A restriction whose members are on the network forbids at least what its sign forbids. If it is drawn loosely (a way
//! that runs on over the node), the value's side decides, and every reading applies where it does not (`sides`). A member
//! that does not reach the node stands for the road that goes on there (`onward`). `only_…` forbids every other movement
//! out of the node. Over ways it is read strictly: after the `from` way a vehicle must take the `via` ways, and to their
//! end. A restriction whose members no vehicle can drive one after the other forbids nothing and is counted.

use std::cell::OnceCell;
use std::ops::Range;

use rustc_hash::FxHashSet;

use super::leaving::Leaving;
use super::onward::Onward;
use super::sides::{Meant, meant};
use super::vertices::Vertices;
use super::{EdgeNo, ForbiddenSequence, Network, reverse};
use crate::osm::facts::RestrictionKind;
use crate::osm::{self, NodeId, NodeTable, Via};

/// Most sequences of one restriction, and most edges of one way over which a path is followed. No hand-drawn
/// restriction comes near, and a crafted file cannot cause more work.
const MOST_SEQUENCES: usize = 1024;
const MOST_VIA_EDGES: usize = 256;

/// What is found of an extract's restrictions in a network.
#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Resolved {
    /// By restriction of the network: the relation and its rule, as indices.
    pub(super) rules: Vec<(u32, u32)>,
    /// By restriction of the network: how its rule was read.
    pub(super) readings: Vec<RuleReading>,
    /// Relations whose members can be driven one after the other, as indices.
    pub(super) on_network: Vec<u32>,
}

/// How a rule was read that its members do not spell out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) struct RuleReading {
    /// A way runs on over the node, and the value's side decides.
    pub(super) by_side: bool,
    /// A way runs on over the node, and the side does not decide: every reading applies.
    pub(super) any_side: bool,
    /// A member is reached over the rest of its road, from which it was split.
    pub(super) beyond_split: bool,
    /// The `via` ways are in another order, or no `via` is given.
    pub(super) via_found: bool,
    /// An `only_…` whose destination is not on the network: every movement is forbidden.
    pub(super) no_destination: bool,
}

impl RuleReading {
    pub(super) fn and(&mut self, other: Self) {
        self.by_side |= other.by_side;
        self.any_side |= other.any_side;
        self.beyond_split |= other.beyond_split;
        self.via_found |= other.via_found;
        self.no_destination |= other.no_destination;
    }
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
    let found: Vec<(usize, usize, RuleReading, Vec<EdgeNo>)> = {
        let leaving = Leaving::of(network);
        let resolver = Resolver { leaving: &leaving, arriving: OnceCell::new(), network, nodes, vertices };
        let mut found = Vec::new();
        for (no, restriction) in restrictions.iter().enumerate().filter(|(_, restriction)| takes(restriction)) {
            let mut on_network = false;
            for (rule, read) in resolver.read(restriction).into_iter().enumerate() {
                let Some((reading, sequences)) = read else { continue };
                on_network = true;
                found.extend(sequences.into_iter().map(|edges| (no, rule, reading, edges)));
            }
            if on_network {
                resolved.on_network.push(no as u32);
            }
        }
        found
    };
    for (no, rule_no, reading, edges) in found {
        let Some((of, rule)) = restrictions.get(no).and_then(|of| Some((of, of.rules.get(rule_no)?))) else { continue };
        resolved.rules.push((no as u32, rule_no as u32));
        resolved.readings.push(reading);
        let start = network.restriction_edges.len() as u32;
        network.restriction_edges.extend(edges);
        let edges = start..network.restriction_edges.len() as u32;
        network.restrictions.push(ForbiddenSequence {
            relation_id: of.id,
            kind: rule.kind,
            conditional: rule.conditional,
            edges,
        });
    }
    resolved
}

/// What a rule forbids, sorted, and how it was read.
type Read = (RuleReading, Vec<Vec<EdgeNo>>);

/// The role of a way in a restriction.
#[derive(Clone, Copy, PartialEq)]
enum Member {
    From,
    To,
}

struct Resolver<'n> {
    network: &'n Network,
    nodes: &'n NodeTable,
    vertices: &'n Vertices,
    leaving: &'n Leaving,
    /// Edges, sorted by the node at which they arrive. Rarely needed.
    arriving: OnceCell<Vec<EdgeNo>>,
}

impl Resolver<'_> {
    /// What each rule forbids. `None` if the members are not on the network.
    fn read(&self, restriction: &osm::Restriction) -> Vec<Option<Read>> {
        let read = |kind: RestrictionKind| {
            let mut reading = RuleReading::default();
            let mut all = match &restriction.via {
                Via::Nodes(nodes) => self.at_nodes(kind, restriction, nodes, &mut reading),
                Via::Ways(ways) => self.over_ways(kind, restriction, ways, &mut reading),
            }?;
            all.sort_unstable();
            all.dedup();
            all.truncate(MOST_SEQUENCES);
            Some((reading, all))
        };
        restriction.rules.iter().map(|rule| read(rule.kind)).collect()
    }

    fn at_nodes(
        &self,
        kind: RestrictionKind,
        restriction: &osm::Restriction,
        via: &[NodeId],
        reading: &mut RuleReading,
    ) -> Option<Vec<Vec<EdgeNo>>> {
        let nodes: Vec<NodeId> = match via {
            [] => self.meetings(restriction),
            via => via.iter().filter_map(|&id| self.vertices.node(self.nodes, id)).collect(),
        };
        reading.via_found = via.is_empty();
        let from = self.at_each(&nodes, &restriction.from, Member::From, reading);
        let to = self.at_each(&nodes, &restriction.to, Member::To, reading);
        let mut on_network = false;
        let mut all = Vec::new();
        for (node, (from, to)) in nodes.iter().zip(from.iter().zip(&to)) {
            let pairs =
                if kind.only { self.only(kind, *node, from, to, reading) } else { self.no(kind, from, to, reading) };
            let arrives = from.iter().any(|edges| !edges.is_empty());
            on_network |= arrives && (kind.only || to.iter().any(|edges| !edges.is_empty()));
            all.extend(pairs.into_iter().take(MOST_SEQUENCES).map(|(f, t)| vec![f, t]));
            if all.len() > MOST_SEQUENCES {
                break;
            }
        }
        on_network.then_some(all)
    }

    /// The nodes at which a way `from` meets a way `to`.
    fn meetings(&self, restriction: &osm::Restriction) -> Vec<NodeId> {
        let edges =
            |ways: &[i64]| ways.iter().flat_map(|&way| EdgeNo::each(self.edges_of(way))).collect::<Vec<EdgeNo>>();
        let edge = |edge: &EdgeNo| &self.network.edges[edge.index()];
        let starts: Vec<NodeId> = edges(&restriction.to).iter().map(|to| edge(to).from_node).collect();
        let mut nodes: Vec<NodeId> = edges(&restriction.from).iter().map(|from| edge(from).to_node).collect();
        nodes.retain(|node| starts.contains(node));
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// By node: for each way, its edges that end there, or begin there if it is a `to`. Without ways, all edges there count as
    /// those of one way. A way that is at none of the nodes stands for the road that goes on to it.
    fn at_each(
        &self,
        nodes: &[NodeId],
        ways: &[i64],
        member: Member,
        reading: &mut RuleReading,
    ) -> Vec<Vec<Vec<EdgeNo>>> {
        let leave = member == Member::To;
        if ways.is_empty() {
            let all =
                |&node: &NodeId| vec![if leave { self.leaving_at(node) } else { self.arriving_at(node) }.to_vec()];
            return nodes.iter().map(all).collect();
        }
        let mut by_node = vec![Vec::new(); nodes.len()];
        for &way in ways {
            let at = |node: NodeId| -> Vec<EdgeNo> {
                let there = |&edge: &EdgeNo| {
                    let edge = &self.network.edges[edge.index()];
                    (if leave { edge.from_node } else { edge.to_node }) == node
                };
                EdgeNo::each(self.edges_of(way)).filter(there).collect()
            };
            let mut own: Vec<Vec<EdgeNo>> = nodes.iter().map(|&node| at(node)).collect();
            if own.iter().all(Vec::is_empty) {
                let onward = Onward { network: self.network, leaving: self.leaving };
                let edges = self.edges_of(way);
                if edges.is_empty() {
                    by_node.iter_mut().for_each(|all| all.push(Vec::new()));
                    continue;
                }
                let found = |&node: &NodeId| {
                    if leave { onward.leaving_node(node, &edges) } else { onward.arriving_at(&edges, node) }
                };
                own = nodes.iter().map(found).collect();
                reading.beyond_split |= own.iter().any(|edges| !edges.is_empty());
            }
            by_node.iter_mut().zip(own).for_each(|(all, own)| all.push(own));
        }
        by_node
    }

    /// The movements that a `no_…` forbids at a node.
    fn no(
        &self,
        kind: RestrictionKind,
        from: &[Vec<EdgeNo>],
        to: &[Vec<EdgeNo>],
        reading: &mut RuleReading,
    ) -> Vec<(EdgeNo, EdgeNo)> {
        let mut all = Vec::new();
        for (f, t) in from.iter().flat_map(|f| to.iter().map(move |t| (f, t))) {
            let meant = meant(self.network, kind, f, t);
            reading.by_side |= matches!(meant, Meant::BySide(_));
            reading.any_side |= matches!(meant, Meant::Any(_));
            all.extend_from_slice(meant.pairs());
        }
        all
    }

    /// The movements that an `only_…` forbids at a node: all but those that it surely means.
    fn only(
        &self,
        kind: RestrictionKind,
        node: NodeId,
        from: &[Vec<EdgeNo>],
        to: &[Vec<EdgeNo>],
        reading: &mut RuleReading,
    ) -> Vec<(EdgeNo, EdgeNo)> {
        let leaving = self.leaving_at(node);
        let mut all = Vec::new();
        for arrivals in from.iter().filter(|arrivals| !arrivals.is_empty()) {
            let meant: Vec<Meant> = to.iter().map(|to| meant(self.network, kind, arrivals, to)).collect();
            reading.by_side |= meant.iter().any(|meant| matches!(meant, Meant::BySide(_)));
            reading.no_destination |= meant.iter().all(|meant| meant.pairs().is_empty());
            // Of two approaches on one way, the side names one.
            let decided = |&f: &EdgeNo| {
                let of = |meant: &Meant| matches!(meant, Meant::BySide(pairs) if pairs.iter().any(|pair| pair.0 == f));
                meant.iter().any(of)
            };
            let by_side = arrivals.len() > 1 && arrivals.iter().any(decided);
            for &f in arrivals.iter().filter(|f| !by_side || decided(f)) {
                let kept: Vec<EdgeNo> = meant.iter().filter_map(|meant| alone(meant, f)).collect();
                reading.any_side |= meant.iter().any(|meant| matches!(meant, Meant::Any(_)));
                all.extend(leaving.iter().filter(|t| !kept.contains(t)).map(|&t| (f, t)));
            }
        }
        all
    }

    fn over_ways(
        &self,
        kind: RestrictionKind,
        restriction: &osm::Restriction,
        via: &[i64],
        reading: &mut RuleReading,
    ) -> Option<Vec<Vec<EdgeNo>>> {
        let edges =
            |ways: &[i64]| ways.iter().flat_map(|&way| EdgeNo::each(self.edges_of(way))).collect::<Vec<EdgeNo>>();
        let (from, to) = (edges(&restriction.from), edges(&restriction.to));
        let mut paths = Vec::new();
        let mut steps = 0;
        for &f in &from {
            self.follow(&mut vec![f], &mut steps, via, Some(&to), &mut paths);
        }
        if paths.is_empty() && !to.is_empty() {
            let mut wander = Wander { resolver: self, via, to: &to, paths: Vec::new(), steps: 0 };
            from.iter().for_each(|&f| wander.on(&mut vec![f], &mut Vec::new(), 0));
            paths = wander.paths;
            reading.beyond_split |= paths.iter().any(|path| self.leaves_members(path, restriction, via));
            reading.via_found |= !paths.is_empty() && !reading.beyond_split;
        }
        if paths.is_empty() && (kind.only || restriction.to.is_empty()) {
            // Where the last way ends, every way on may be the wrong one.
            for &f in &from {
                self.follow(&mut vec![f], &mut steps, via, None, &mut paths);
            }
            reading.no_destination |= !paths.is_empty();
        }
        // Not all paths were found: no movement onto the first way is left open.
        let cut_short = if steps > MOST_STEPS { self.entries(&from, via) } else { Vec::new() };
        reading.any_side |= !cut_short.is_empty();
        if paths.is_empty() && cut_short.is_empty() {
            return None;
        }
        if !kind.only || !cut_short.is_empty() {
            return Some([paths, cut_short].concat());
        }
        let begins: FxHashSet<&[EdgeNo]> =
            paths.iter().flat_map(|path| (1..=path.len()).map(|to| &path[..to])).collect();
        let mut forbidden = Vec::new();
        for path in &paths {
            let last = if reading.no_destination { path.len() + 1 } else { path.len() };
            for length in 1..last {
                let prefix = &path[..length];
                let end = self.network.edges[path[length - 1].index()].to_node;
                let others = self.leaving_at(end).iter().map(|&x| [prefix, &[x]].concat());
                forbidden.extend(others.filter(|other| !begins.contains(&other[..])));
            }
            if forbidden.len() > MOST_SEQUENCES {
                break;
            }
        }
        Some(forbidden)
    }

    /// The movements from edges onto a way of `via`.
    fn entries(&self, from: &[EdgeNo], via: &[i64]) -> Vec<Vec<EdgeNo>> {
        let onto = |&f: &EdgeNo| {
            let leaving = self.leaving_at(self.network.edges[f.index()].to_node).iter();
            leaving.filter(|&&edge| via.contains(&self.way(edge))).map(move |&edge| vec![f, edge])
        };
        from.iter().flat_map(onto).collect()
    }

    /// Whether a path uses a way that is no member.
    fn leaves_members(&self, path: &[EdgeNo], restriction: &osm::Restriction, via: &[i64]) -> bool {
        let member = |way: i64| [&restriction.from[..], via, &restriction.to].iter().any(|ways| ways.contains(&way));
        path.iter().any(|&edge| !member(self.way(edge)))
    }

    /// Follows all paths from the end of `path` over the ways `via` to an edge of `to`, or to the end of the last way. Each way is
    /// driven in one direction.
    fn follow(
        &self,
        path: &mut Vec<EdgeNo>,
        steps: &mut usize,
        via: &[i64],
        to: Option<&[EdgeNo]>,
        paths: &mut Vec<Vec<EdgeNo>>,
    ) {
        let Some(&last) = path.last() else { return };
        let leaving = self.leaving_at(self.network.edges[last.index()].to_node);
        let Some((&way, rest)) = via.split_first() else {
            match to {
                Some(to) => {
                    let ends = leaving.iter().filter(|t| to.contains(t));
                    paths.extend(ends.map(|&t| [path.as_slice(), &[t]].concat()));
                }
                None if self.along(last).is_none_or(|next| path.contains(&next)) => paths.push(path.clone()),
                None => {}
            }
            return;
        };
        let length = path.len();
        for &first in leaving.iter().filter(|&&edge| self.way(edge) == way && !reverse(self.network, last, edge)) {
            let mut edge = Some(first);
            while let Some(next) = edge.filter(|next| !path[length..].contains(next)) {
                path.push(next);
                // Dead ends count, too: over a way that is named often, their number grows with every edge.
                *steps += 1;
                if path.len() > MOST_VIA_EDGES || paths.len() > MOST_SEQUENCES || *steps > MOST_STEPS {
                    break;
                }
                self.follow(path, steps, rest, to, paths);
                edge = self.along(next);
            }
            path.truncate(length);
        }
    }

    /// The next edge of the same way in the same direction.
    fn along(&self, edge: EdgeNo) -> Option<EdgeNo> {
        let e = &self.network.edges[edge.index()];
        let goes_on = |&&other: &&EdgeNo| {
            let o = &self.network.edges[other.index()];
            o.road == e.road && o.direction == e.direction && other != edge
        };
        self.leaving_at(e.to_node).iter().find(goes_on).copied()
    }

    fn leaving_at(&self, node: NodeId) -> &[EdgeNo] {
        self.leaving.at(self.network, node)
    }

    fn arriving_at(&self, node: NodeId) -> &[EdgeNo] {
        let to = |edge: &EdgeNo| self.network.edges[edge.index()].to_node;
        let all = self.arriving.get_or_init(|| {
            let mut all: Vec<EdgeNo> = EdgeNo::first(self.network.edges.len()).collect();
            all.sort_by_key(to);
            all
        });
        let start = all.partition_point(|edge| to(edge) < node);
        let end = start + all[start..].partition_point(|edge| to(edge) == node);
        &all[start..end]
    }

    fn way(&self, edge: EdgeNo) -> i64 {
        self.network.road(&self.network.edges[edge.index()]).way_id
    }

    fn edges_of(&self, way: i64) -> Range<EdgeNo> {
        let edges = &self.network.edges;
        let id = |edge: &super::Edge| self.network.road(edge).way_id;
        let start = edges.partition_point(|edge| id(edge) < way);
        let end = start + edges[start..].partition_point(|edge| id(edge) == way);
        EdgeNo::at(start)..EdgeNo::at(end)
    }
}

/// The edge into which `f` may go, if there is only one.
fn alone(meant: &Meant, f: EdgeNo) -> Option<EdgeNo> {
    let mut of_f = meant.pairs().iter().filter(|pair| pair.0 == f).map(|pair| pair.1);
    of_f.next().filter(|_| of_f.next().is_none())
}

/// Most edges of one path that is found without an order, and most steps of the search for one restriction.
const MOST_WANDERED: usize = 64;
const MOST_STEPS: usize = 4096;
/// Most edges of a path that are on no member.
const MOST_STRAY: usize = 6;

/// Finds paths over `via` ways that are listed in another order, or that were split since, so that parts of them are missing.
struct Wander<'w, 'n> {
    resolver: &'w Resolver<'n>,
    via: &'w [i64],
    to: &'w [EdgeNo],
    paths: Vec<Vec<EdgeNo>>,
    steps: usize,
}

impl Wander<'_, '_> {
    /// Goes on from the end of `path`. `used` are the ways of `via` that it has been on, in order; it has `stray` edges of other ways.
    fn on(&mut self, path: &mut Vec<EdgeNo>, used: &mut Vec<i64>, stray: usize) {
        let Some(&last) = path.last() else { return };
        self.steps += 1;
        if path.len() > MOST_WANDERED || self.steps > MOST_STEPS || self.paths.len() > MOST_SEQUENCES {
            return;
        }
        let (resolver, network) = (self.resolver, self.resolver.network);
        let onward = Onward { network, leaving: resolver.leaving };
        let end = network.edges[last.index()].to_node;
        for &next in resolver.leaving_at(end) {
            let way = resolver.way(next);
            if reverse(network, last, next) || path.contains(&next) {
                continue;
            }
            if self.to.contains(&next) && self.via.iter().all(|via| used.contains(via)) {
                self.paths.push(self.cut(&[path.as_slice(), &[next]].concat()));
                continue;
            }
            let again = used.last() == Some(&way) && way == resolver.way(last);
            let new = self.via.contains(&way) && !used.contains(&way);
            // The rest of a road goes on from the last edge, or leads to a way that goes on from it.
            let leads = || {
                let after = resolver.leaving_at(network.edges[next.index()].to_node).iter();
                after.into_iter().any(|&edge| self.via.contains(&resolver.way(edge)) && onward.goes_on(next, edge))
            };
            let strays = !self.via.contains(&way) && stray < MOST_STRAY && (onward.goes_on(last, next) || leads());
            if again || new || strays {
                used.extend(new.then_some(way));
                path.push(next);
                self.on(path, used, stray + usize::from(strays));
                path.pop();
                if new {
                    used.pop();
                }
            }
        }
    }

    /// The path from the last edge before the `via` ways to the first edge after them.
    fn cut(&self, path: &[EdgeNo]) -> Vec<EdgeNo> {
        let on = |edge: &EdgeNo| self.via.contains(&self.resolver.way(*edge));
        let first = path.iter().position(on).unwrap_or(1).saturating_sub(1);
        let last = path.iter().rposition(on).map_or(path.len(), |last| last + 2).min(path.len());
        path[first..last].to_vec()
    }
}
