//! Whole roads: the ways of one name, or of one ref, that lie near each other, directly or through other ways of the same road. So the
//! `Hauptstraße` of each village is a road of its own.

use std::collections::BTreeMap;

use super::fold;
use crate::network::{EdgeNo, Network};
use crate::osm::StringId;
use crate::rows::Bounds;

/// Ways of one name that are closer than this belong to one road, degrees. 0.01° is 1.1 km of latitude.
const NEAR_DEG: f64 = 0.01;
/// The same for ways of one ref. Such roads are longer, and change their ref in towns.
const NEAR_REF_DEG: f64 = 0.05;

/// A road of one name or ref.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct WholeRoad {
    /// The text that its ways have in common: a name, or one of several refs.
    pub(in super::super) text: Box<str>,
    /// Whether that is a ref.
    pub(in super::super) by_ref: bool,
    /// Its ways, as indices into [`Network::roads`]; sorted.
    pub(in super::super) ways: Box<[u32]>,
    pub(in super::super) bounds: Bounds,
    /// Number of its edges.
    pub(in super::super) pieces: u32,
    /// Length of its edges, each direction by itself, metres.
    pub(in super::super) length_m: f32,
}

impl WholeRoad {
    /// The road's edges, in order of the network.
    pub(in super::super) fn edges<'r>(&'r self, network: &'r Network) -> impl Iterator<Item = EdgeNo> + 'r {
        self.ways.iter().flat_map(|&way| edges_of(network, way))
    }
}

/// The edges of a way. [`Network::edges`] are sorted by way.
pub(in super::super) fn edges_of(network: &Network, way: u32) -> impl ExactSizeIterator<Item = EdgeNo> + use<> {
    let first = network.edges.partition_point(|edge| edge.road < way);
    let end = network.edges.partition_point(|edge| edge.road <= way);
    (first..end).map(EdgeNo::at)
}

/// A way that has edges.
#[derive(Debug, Clone, Copy)]
struct Way {
    index: u32,
    bounds: Bounds,
    pieces: u32,
    length_m: f64,
}

/// The parts of a ref: `I 405;US 30` are two.
pub(super) fn refs(text: &str) -> impl Iterator<Item = &str> {
    text.split(';').map(str::trim).filter(|text| !text.is_empty())
}

/// All roads of the network that have a name or a ref, in the order of their names and then of their ways.
pub(super) fn whole_roads(network: &Network) -> Vec<WholeRoad> {
    // By folded text, names before refs.
    let mut groups: BTreeMap<(bool, String), (Box<str>, Vec<Way>)> = BTreeMap::new();
    let folded: Vec<String> = network.strings.texts().map(|text| fold::words(text).join(" ")).collect();
    for of_way in network.edges.chunk_by(|a, b| a.road == b.road) {
        let Some(first) = of_way.first() else { continue };
        let road = network.road(first);
        let positions = of_way.iter().flat_map(|edge| network.positions(edge));
        let Some(bounds) = Bounds::around(positions) else { continue };
        let length_m = of_way.iter().map(|edge| network.length_m(edge)).sum();
        let way = Way { index: first.road, bounds, pieces: of_way.len() as u32, length_m };
        let mut add = |by_ref, text: &str, folded: String| {
            if !folded.is_empty() {
                groups.entry((by_ref, folded)).or_insert_with(|| (text.into(), Vec::new())).1.push(way);
            }
        };
        if let Some(StringId(id)) = road.name {
            add(false, network.strings.text(StringId(id)), folded.get(id as usize).cloned().unwrap_or_default());
        }
        for text in road.reference.into_iter().flat_map(|id| refs(network.strings.text(id))) {
            add(true, text, fold::reference(text));
        }
    }
    let roads = groups.into_iter().flat_map(|((by_ref, _), (text, ways))| {
        let near_deg = if by_ref { NEAR_REF_DEG } else { NEAR_DEG };
        clusters(&ways, near_deg).into_iter().filter_map(move |ways| {
            let bounds = ways.iter().map(|way| way.bounds).reduce(Bounds::union)?;
            Some(WholeRoad {
                text: text.clone(),
                by_ref,
                ways: ways.iter().map(|way| way.index).collect(),
                bounds,
                pieces: ways.iter().map(|way| way.pieces).sum(),
                length_m: ways.iter().map(|way| way.length_m).sum::<f64>() as f32,
            })
        })
    });
    roads.collect()
}

/// Groups of ways whose boxes are near each other. A sweep from west to east, so that the many `Main Street` of a country do not cost
/// the square of their number.
fn clusters(ways: &[Way], near_deg: f64) -> Vec<Vec<Way>> {
    let mut order: Vec<usize> = (0..ways.len()).collect();
    order.sort_by(|&a, &b| ways[a].bounds.west.total_cmp(&ways[b].bounds.west));
    let mut group: Vec<usize> = (0..ways.len()).collect();
    let mut open: Vec<usize> = Vec::new();
    for &i in &order {
        let own = ways[i].bounds;
        open.retain(|&j| ways[j].bounds.east + near_deg > own.west);
        for &j in &open {
            let other = ways[j].bounds;
            if own.south - other.north < near_deg && other.south - own.north < near_deg {
                let (a, b) = (root(&mut group, i), root(&mut group, j));
                // The smallest index stands for a group, so groups are in the order of the network.
                group[a.max(b)] = a.min(b);
            }
        }
        open.push(i);
    }
    let mut found: BTreeMap<usize, Vec<Way>> = BTreeMap::new();
    for (i, way) in ways.iter().enumerate() {
        found.entry(root(&mut group, i)).or_default().push(*way);
    }
    found.into_values().collect()
}

fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    fn way(index: u32, west: f64, south: f64) -> Way {
        let bounds = Bounds { west, south, east: west + 0.005, north: south + 0.005 };
        Way { index, bounds, pieces: 1, length_m: 1.0 }
    }

    #[test]
    fn ways_near_each_other_are_one_road_and_others_are_not() {
        // A chain of three in any order, one far north of it, one far east.
        let ways = [way(0, 8.02, 49.0), way(1, 8.0, 49.0), way(2, 8.01, 49.0), way(3, 8.01, 49.5), way(4, 9.0, 49.0)];
        let found: Vec<Vec<u32>> =
            clusters(&ways, NEAR_DEG).iter().map(|ways| ways.iter().map(|way| way.index).collect()).collect();
        assert_eq!(found, [vec![0, 1, 2], vec![3], vec![4]]);
    }

    #[test]
    fn a_ref_may_be_several() {
        assert_eq!(refs("I 405; US 30;").collect::<Vec<_>>(), ["I 405", "US 30"]);
    }
}
