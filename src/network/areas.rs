//! Mapped surfaces of junctions: the closed ways around each node; and traffic islands near roads.
//!
//! A surface is kept only if it is whole: every node is in the file, and the ring does not cross itself. Surfaces around no
//! junction are left out. A node on a surface's edge is outside the surface. An island takes road away, so one that is not whole
//! is kept as the convex hull of what is known of it.

use geo::{ConvexHull, LineString, MultiPoint, Point, Polygon, Validation};
use rustc_hash::{FxHashMap, FxHashSet};

use super::extent::Extent;
use super::{Network, NetworkAccount};
use crate::osm::facts::AreaKind;
use crate::osm::{LonLat, NodeTable, RoadArea};

/// Islands farther from every road than this are left out, metres. Roads and measured surfaces reach less far from their lines.
const NEAR_ROAD_M: f64 = 100.0;

/// The surface of roads at a junction, or an island.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Area {
    /// OSM way id.
    pub way_id: i64,
    /// Surface or island.
    pub kind: AreaKind,
    /// Corners in order; the first one is repeated at the end.
    pub ring: Vec<LonLat>,
}

/// The areas of a network.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Areas {
    /// Sorted by way id.
    all: Vec<Area>,
    /// By node of the network: indices into `all` of the surfaces around it.
    around: FxHashMap<i64, Vec<u32>>,
    /// Islands from south to north: their extents, and indices into `all`.
    islands: Vec<(Extent, u32)>,
    /// The greatest extent of an island from south to north, 1e-7 degree.
    tallest: i32,
}

impl Areas {
    /// Finds the nodes of the network that each area surrounds. `all` is sorted by way id.
    #[must_use]
    pub fn new(all: Vec<Area>, network: &Network) -> Self {
        if all.is_empty() {
            return Self::default();
        }
        let mut nodes: Vec<(i32, i32, i64)> = ends(network).map(|(id, at)| (at.lat_e7, at.lon_e7, id)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let (mut around, mut islands) = (FxHashMap::<i64, Vec<u32>>::default(), Vec::new());
        for (index, area) in (0..).zip(&all) {
            let Some(extent) = Extent::of(area.ring.iter().copied()) else { continue };
            if area.kind == AreaKind::Island {
                islands.push((extent, index));
                continue;
            }
            let first = nodes.partition_point(|node| node.0 < extent.south);
            let end = nodes.partition_point(|node| node.0 <= extent.north);
            for &(lat_e7, lon_e7, id) in &nodes[first..end] {
                if contains(&area.ring, LonLat { lon_e7, lat_e7 }) {
                    around.entry(id).or_default().push(index);
                }
            }
        }
        islands.sort_unstable_by_key(|&(extent, index)| (extent.south, index));
        let tallest = islands.iter().map(|(extent, _)| extent.north.saturating_sub(extent.south)).max().unwrap_or(0);
        Self { all, around, islands, tallest }
    }

    /// All areas, sorted by way id.
    #[must_use]
    pub fn all(&self) -> &[Area] {
        &self.all
    }

    /// The surfaces around a node.
    pub fn around(&self, node: i64) -> impl Iterator<Item = &Area> {
        self.around.get(&node).into_iter().flatten().filter_map(|&index| self.all.get(index as usize))
    }

    /// Whether there are no islands at all.
    #[must_use]
    pub fn without_islands(&self) -> bool {
        self.islands.is_empty()
    }

    /// The islands that may lie within the box around the given places, from south to north.
    pub fn islands(&self, places: &[LonLat]) -> impl Iterator<Item = &Area> {
        let around = Extent::of(places.iter().copied());
        self.islands_in(around).filter_map(|index| self.all.get(index as usize))
    }

    fn islands_in(&self, around: Option<Extent>) -> impl Iterator<Item = u32> {
        let range = around.map_or(0..0, |around| {
            let lowest = around.south.saturating_sub(self.tallest);
            self.islands.partition_point(|island| island.0.south < lowest)
                ..self.islands.partition_point(|island| island.0.south <= around.north)
        });
        let meets = move |island: &&(Extent, u32)| around.is_some_and(|around| around.meets(island.0));
        self.islands[range].iter().filter(meets).map(|island| island.1)
    }
}

/// The areas of an extract with a usable ring, sorted by way id.
pub(super) fn usable(areas: Vec<RoadArea>, nodes: &NodeTable, account: &mut NetworkAccount) -> Vec<Area> {
    account.areas_read = areas.len() as u64;
    let mut usable = Vec::new();
    for RoadArea { id: way_id, kind, refs } in areas {
        let known: Vec<LonLat> = refs.iter().filter_map(|&node| nodes.place(node)).collect();
        let (cut, simple) = (known.len() < refs.len(), is_simple(&known));
        let ring = match kind {
            _ if !cut && simple => Some(known),
            AreaKind::Island => hull(&known),
            AreaKind::Road(_) => None,
        };
        match ring {
            Some(ring) => {
                account.islands_widened += u64::from(cut || !simple);
                usable.push(Area { way_id, kind, ring });
            }
            None if cut => account.areas_cut += 1,
            None => account.areas_invalid += 1,
        }
    }
    usable
}

/// Keeps the surfaces that lie around the network's nodes, and the islands near its roads. `usable` is sorted by way id.
pub(super) fn keep(network: &mut Network, usable: Vec<Area>) {
    let found = Areas::new(usable, network);
    let mut used: FxHashSet<u32> = found.around.values().flatten().copied().collect();
    if !found.without_islands() {
        used.extend(near_roads(&found, network));
    }
    let kept = (0..).zip(found.all).filter(|(index, _)| used.contains(index)).map(|(_, area)| area).collect();
    network.areas = Areas::new(kept, network);
}

/// The islands near any segment of any road.
fn near_roads(areas: &Areas, network: &Network) -> FxHashSet<u32> {
    let mut near = FxHashSet::default();
    for edge in &network.edges {
        let line: Vec<LonLat> = network.positions(edge).collect();
        for segment in line.windows(2) {
            near.extend(
                areas.islands_in(Extent::of(segment.iter().copied()).map(|extent| extent.wider_by(NEAR_ROAD_M))),
            );
        }
    }
    near
}

/// The convex hull of places as a closed ring. `None` if they enclose nothing.
fn hull(places: &[LonLat]) -> Option<Vec<LonLat>> {
    let points: MultiPoint<f64> =
        places.iter().map(|at| Point::new(f64::from(at.lon_e7), f64::from(at.lat_e7))).collect();
    let corner = |at: &geo::Coord| LonLat { lon_e7: at.x as i32, lat_e7: at.y as i32 };
    let ring: Vec<LonLat> = points.convex_hull().exterior().coords().map(corner).collect();
    is_simple(&ring).then_some(ring)
}

/// Node and position of both ends of every edge.
fn ends(network: &Network) -> impl Iterator<Item = (i64, LonLat)> + '_ {
    network.edges.iter().flat_map(|edge| {
        let mut positions = network.positions(edge);
        let (first, last) = (positions.next(), positions.next_back());
        first.map(|at| (edge.from_node, at)).into_iter().chain(last.map(|at| (edge.to_node, at)))
    })
}

/// Whether a ring encloses an area and does not touch itself.
fn is_simple(ring: &[LonLat]) -> bool {
    let corners: LineString = ring.iter().map(|at| at.degrees()).collect();
    let twice = |w: &[LonLat]| {
        i128::from(w[0].lon_e7) * i128::from(w[1].lat_e7) - i128::from(w[1].lon_e7) * i128::from(w[0].lat_e7)
    };
    ring.windows(2).map(twice).sum::<i128>() != 0 && Polygon::new(corners, Vec::new()).is_valid()
}

/// Whether a place is inside a closed ring, in integer arithmetic. A place on the ring is outside.
fn contains(ring: &[LonLat], at: LonLat) -> bool {
    let offset =
        |p: LonLat| (i128::from(p.lon_e7) - i128::from(at.lon_e7), i128::from(p.lat_e7) - i128::from(at.lat_e7));
    let mut inside = false;
    for side in ring.windows(2) {
        let ((ax, ay), (bx, by)) = (offset(side[0]), offset(side[1]));
        let cross = ax * by - ay * bx;
        let beside = ax.min(bx) <= 0 && ax.max(bx) >= 0 && ay.min(by) <= 0 && ay.max(by) >= 0;
        if cross == 0 && beside {
            return false;
        }
        // The side crosses the place's latitude east of the place.
        if (ay > 0) != (by > 0) && (cross > 0) == (by > ay) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lon_e7: i32, lat_e7: i32) -> LonLat {
        LonLat { lon_e7, lat_e7 }
    }

    #[test]
    fn a_place_is_inside_outside_or_on_the_edge() {
        // An L, in both orientations.
        let mut ring = vec![at(0, 0), at(40, 0), at(40, 20), at(20, 20), at(20, 40), at(0, 40), at(0, 0)];
        for _ in 0..2 {
            for (place, inside) in [
                (at(10, 10), true),
                (at(30, 10), true),
                (at(10, 30), true),
                (at(30, 30), false),
                (at(-1, 10), false),
                (at(50, 10), false),
                (at(10, 50), false),
                (at(0, 0), false),
                (at(20, 30), false),
                (at(30, 20), false),
                (at(19, 20), true),
            ] {
                assert_eq!(contains(&ring, place), inside, "{place:?}");
            }
            ring.reverse();
        }
    }

    #[test]
    fn rings_that_cross_themselves_are_none() {
        assert!(is_simple(&[at(0, 0), at(400, 0), at(400, 400), at(0, 400), at(0, 0)]));
        assert!(!is_simple(&[at(0, 0), at(400, 400), at(400, 0), at(0, 400), at(0, 0)]));
        assert!(!is_simple(&[at(0, 0), at(400, 0), at(0, 0), at(0, 0)]));
    }
}
