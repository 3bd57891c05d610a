//! Node references become vertices: indices into the node table, with nodes at one place merged into one vertex.
//!
//! Two consecutive located vertices of a way, if different, have different places, so no edge has zero length. Nodes at
//! one place that no way joins (a bridge over a road) stay separate. The 180th meridian is one place with two longitudes: roads
//! that end there on either side are one road, so their nodes are one node with two vertices.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::osm::facts::PointFacts;
use crate::osm::{NodeId, NodeTable, Way};

/// A reference to a node that is not in the file.
pub(super) const MISSING: u32 = u32::MAX;

/// The vertices of all ways, and facts about each vertex.
pub(super) struct Vertices {
    /// Parallel to `Extract::refs`: index into the node table, or [`MISSING`].
    pub(super) of_refs: Vec<u32>,
    /// Flags by node table index.
    marks: Vec<u8>,
    /// Facts of tagged vertices. Never iterated, because its order is not fixed.
    points: FxHashMap<u32, PointFacts>,
    /// For each merged node the node that replaces it. Never iterated, because its order is not fixed.
    same: FxHashMap<u32, u32>,
    /// For each vertex at the 180th meridian the one at its place on the other side. Never iterated.
    across: FxHashMap<u32, u32>,
    /// Number of references without a position.
    pub(super) missing: u64,
    /// Number of nodes merged with an earlier one at the same place.
    pub(super) merged: u64,
}

const USED: u8 = 1;
const USED_AGAIN: u8 = 2;
const TAGGED: u8 = 4;

impl Vertices {
    /// Resolves every reference of `ways`. `points` are the tagged nodes.
    pub(super) fn resolve(ways: &[Way], refs: &[NodeId], nodes: &NodeTable, points: &[(NodeId, PointFacts)]) -> Self {
        let buckets = Buckets::new(&nodes.ids);
        let vertex = |&id: &NodeId| buckets.find(&nodes.ids, id).filter(|&v| nodes.places[v as usize].is_some());
        let mut of_refs: Vec<u32> = refs.par_iter().map(|id| vertex(id).unwrap_or(MISSING)).collect();
        drop(buckets);
        let missing = of_refs.par_iter().filter(|&&v| v == MISSING).count() as u64;
        let same = same_place_aliases(ways, &of_refs, nodes);
        if !same.is_empty() {
            of_refs.par_iter_mut().for_each(|v| *v = *same.get(v).unwrap_or(v));
        }
        let mut marks = vec![0; nodes.ids.len()];
        mark_uses(ways, &of_refs, &mut marks);
        let across = over_the_antimeridian(ways, &of_refs, nodes);
        for &v in across.keys() {
            marks[v as usize] |= USED_AGAIN;
        }
        let points = point_facts(points, nodes, [&same, &across], &mut marks);
        Self { of_refs, marks, points, missing, merged: same.len() as u64, same, across }
    }

    /// Whether roads go on over the 180th meridian.
    pub(super) fn go_on_over_the_antimeridian(&self) -> bool {
        !self.across.is_empty()
    }

    /// The id of a vertex's node, alike on both sides of the 180th meridian.
    pub(super) fn id(&self, nodes: &NodeTable, vertex: u32) -> NodeId {
        let id = nodes.ids[vertex as usize];
        self.across.get(&vertex).map_or(id, |&other| id.min(nodes.ids[other as usize]))
    }

    /// Whether more than one stretch of road meets here: several ways use the node, or one way uses it several times.
    pub(super) fn is_junction(&self, vertex: u32) -> bool {
        self.marks[vertex as usize] & USED_AGAIN != 0
    }

    /// The node that replaces this one in the network, if the file has it.
    pub(super) fn node(&self, nodes: &NodeTable, id: NodeId) -> Option<NodeId> {
        let v = located(nodes, id);
        (v != MISSING).then(|| self.id(nodes, *self.same.get(&v).unwrap_or(&v)))
    }

    /// The facts from the tags of the vertex's nodes, if any node has relevant tags.
    pub(super) fn point(&self, vertex: u32) -> Option<&PointFacts> {
        if self.marks[vertex as usize] & TAGGED == 0 { None } else { self.points.get(&vertex) }
    }
}

fn located(nodes: &NodeTable, id: NodeId) -> u32 {
    match nodes.index(id) {
        Some(i) if nodes.places[i].is_some() => i as u32,
        _ => MISSING,
    }
}

/// Start and end of a search in a sorted list of ids: ids with the same upper bits share a bucket. With plain binary
/// searches, a network of 3.0 million edges from 7.6 million references took 1.3 to 1.7 times as long.
struct Buckets {
    least: NodeId,
    shift: u32,
    /// By upper bits, less those of the least id: number of ids before the bucket. There is one more entry than
    /// buckets.
    starts: Vec<u32>,
}

impl Buckets {
    /// Four ids per bucket if they were evenly spread.
    fn new(ids: &[NodeId]) -> Self {
        let (Some(&least), Some(&most)) = (ids.first(), ids.last()) else {
            return Self { least: NodeId::new(0), shift: 0, starts: Vec::new() };
        };
        let span = most.get().abs_diff(least.get());
        let wanted = (ids.len() as u64 / 4).max(1);
        let shift = (u64::BITS - (span / wanted).leading_zeros()).min(u64::BITS - 1);
        let mut starts = vec![0_u32; (span >> shift) as usize + 2];
        for &id in ids {
            starts[(id.get().abs_diff(least.get()) >> shift) as usize + 1] += 1;
        }
        for bucket in 1..starts.len() {
            starts[bucket] += starts[bucket - 1];
        }
        Self { least, shift, starts }
    }

    fn find(&self, ids: &[NodeId], id: NodeId) -> Option<u32> {
        if id < self.least {
            return None;
        }
        let bucket = usize::try_from(id.get().abs_diff(self.least.get()) >> self.shift).ok()?;
        let start = *self.starts.get(bucket)?;
        let end = *self.starts.get(bucket + 1)?;
        let within = ids[start as usize..end as usize].binary_search(&id).ok()?;
        Some(start + within as u32)
    }
}

/// A way's slice of an array parallel to `Extract::refs`.
fn of_way<'v>(of_refs: &'v [u32], way: &Way) -> &'v [u32] {
    &of_refs[way.refs.start as usize..way.refs.end as usize]
}

/// For each node that follows another at its very place along a way: the node that replaces it. That is the node with
/// the smallest id among all that are joined.
fn same_place_aliases(ways: &[Way], of_refs: &[u32], nodes: &NodeTable) -> FxHashMap<u32, u32> {
    let same = |pair: &[u32]| {
        pair[0] != pair[1]
            && !pair.contains(&MISSING)
            && nodes.places[pair[0] as usize] == nodes.places[pair[1] as usize]
    };
    let pairs: Vec<(u32, u32)> = ways
        .par_iter()
        .flat_map_iter(|way| of_way(of_refs, way).windows(2).filter(|w| same(w)).map(|w| (w[0], w[1])))
        .collect();
    let mut parent = FxHashMap::default();
    for (a, b) in pairs {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        if a != b {
            parent.insert(a.max(b), a.min(b));
        }
    }
    let mut joined: Vec<u32> = parent.keys().copied().collect();
    joined.sort_unstable();
    joined.into_iter().map(|v| (v, root(&mut parent, v))).collect()
}

/// The root of `v`. The path to it is halved on the way.
fn root(parent: &mut FxHashMap<u32, u32>, mut v: u32) -> u32 {
    while let Some(&up) = parent.get(&v) {
        match parent.get(&up) {
            Some(&upper) => {
                parent.insert(v, upper);
                v = upper;
            }
            None => return up,
        }
    }
    v
}

/// The vertices at the 180th meridian where roads end on both sides at the same latitude, each with the other one. Where several
/// roads end at one place on one side, which of them goes on is unknown.
fn over_the_antimeridian(ways: &[Way], of_refs: &[u32], nodes: &NodeTable) -> FxHashMap<u32, u32> {
    const EAST_E7: i32 = 1_800_000_000;
    let ends = |way: &Way| {
        let refs = of_way(of_refs, way);
        [refs.first().copied(), refs.last().copied()].into_iter().flatten().filter(|&v| v != MISSING)
    };
    let place = |v: u32| nodes.places[v as usize].filter(|place| place.lon_e7.abs() == EAST_E7);
    let mut found: Vec<(i32, i32, u32)> =
        ways.par_iter().flat_map_iter(ends).filter_map(|v| place(v).map(|at| (at.lat_e7, at.lon_e7, v))).collect();
    found.sort_unstable();
    found.dedup();
    let mut across = FxHashMap::default();
    for here in found.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, west, a), (_, east, b)] = *here
            && west != east
        {
            across.extend([(a, b), (b, a)]);
        }
    }
    across
}

fn mark_uses(ways: &[Way], of_refs: &[u32], marks: &mut [u8]) {
    for way in ways {
        let mut last = MISSING;
        for &v in of_way(of_refs, way) {
            if v != last && v != MISSING {
                let mark = &mut marks[v as usize];
                *mark |= if *mark & USED == 0 { USED } else { USED_AGAIN };
            }
            last = v;
        }
    }
}

fn point_facts(
    points: &[(NodeId, PointFacts)],
    nodes: &NodeTable,
    [same, across]: [&FxHashMap<u32, u32>; 2],
    marks: &mut [u8],
) -> FxHashMap<u32, PointFacts> {
    let mut by_vertex: FxHashMap<u32, PointFacts> = FxHashMap::default();
    for (id, facts) in points {
        let v = located(nodes, *id);
        if v == MISSING {
            continue;
        }
        let v = *same.get(&v).unwrap_or(&v);
        for v in [Some(v), across.get(&v).copied()].into_iter().flatten() {
            marks[v as usize] |= TAGGED;
            by_vertex.entry(v).and_modify(|known| *known = both(known, facts)).or_insert_with(|| facts.clone());
        }
    }
    by_vertex
}

/// Merges the facts of two tagged nodes at one place: each prohibition and each narrowing counts.
fn both(a: &PointFacts, b: &PointFacts) -> PointFacts {
    PointFacts {
        legal: a.legal.merge(&b.legal),
        passage_m: match (a.passage_m, b.passage_m) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        },
        barred: a.barred || b.barred,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buckets_find_what_a_binary_search_finds() {
        let lists: [&[i64]; 6] = [
            &[],
            &[5],
            &[i64::MIN, -1, 0, i64::MAX],
            &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10],
            &[1, 2, 3, 4, 5, 6, 7, 8, 9, 1 << 40],
            &[-3, 7, 8, 9, 100, 101, 102, 4_000, 4_001, 90_000],
        ];
        for ids in lists {
            let nodes: Vec<NodeId> = ids.iter().copied().map(NodeId::new).collect();
            let buckets = Buckets::new(&nodes);
            let near = ids.iter().flat_map(|&id| [id.saturating_sub(1), id, id.saturating_add(1)]);
            for id in near.chain([i64::MIN, 0, i64::MAX]) {
                let expected = ids.binary_search(&id).ok().map(|i| i as u32);
                assert_eq!(buckets.find(&nodes, NodeId::new(id)), expected, "{id} in {ids:?}");
            }
        }
    }
}
