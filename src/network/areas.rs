//! Mapped surfaces of junctions: the closed ways around each node, and the islands on them.
//!
//! An area is kept only if it is whole: every node is in the file, and the ring does not cross itself. Areas around no
//! junction are left out. A node on an area's edge is outside the area.

use geo::{LineString, Polygon, Validation};
use rustc_hash::{FxHashMap, FxHashSet};

use super::{Network, NetworkAccount};
use crate::osm::facts::AreaKind;
use crate::osm::{LonLat, NodeTable, RoadArea};

/// The surface of roads at a junction, or an island on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Area {
    /// OSM way id.
    pub way_id: i64,
    /// Surface or island.
    pub kind: AreaKind,
    /// Corners in order; the first one is repeated at the end.
    pub ring: Vec<LonLat>,
}

/// The areas of a network.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Areas {
    /// Sorted by way id.
    all: Vec<Area>,
    /// By node of the network: indices into `all` of the surfaces around it.
    around: FxHashMap<i64, Vec<u32>>,
    /// Islands: indices into `all`.
    islands: Vec<u32>,
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
            if area.kind == AreaKind::Island {
                islands.push(index);
                continue;
            }
            let Some(extent) = Extent::of(&area.ring) else { continue };
            let first = nodes.partition_point(|node| node.0 < extent.south);
            let end = nodes.partition_point(|node| node.0 <= extent.north);
            for &(lat_e7, lon_e7, id) in &nodes[first..end] {
                if contains(&area.ring, LonLat { lon_e7, lat_e7 }) {
                    around.entry(id).or_default().push(index);
                }
            }
        }
        Self { all, around, islands }
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

    /// The islands that may lie on a surface.
    pub fn islands<'a>(&'a self, surface: &Area) -> impl Iterator<Item = &'a Area> {
        let extent = Extent::of(&surface.ring);
        let near = move |area: &&Area| match (extent, Extent::of(&area.ring)) {
            (Some(a), Some(b)) => a.meets(b),
            _ => false,
        };
        self.islands.iter().filter_map(|&index| self.all.get(index as usize)).filter(near)
    }
}

/// Keeps the areas of an extract that lie around the network's nodes.
pub(super) fn resolve(network: &mut Network, areas: Vec<RoadArea>, nodes: &NodeTable, account: &mut NetworkAccount) {
    account.areas_read = areas.len() as u64;
    let mut whole = Vec::new();
    for RoadArea { id: way_id, kind, refs } in areas {
        let Some(ring) = refs.iter().map(|&node| nodes.place(node)).collect::<Option<Vec<LonLat>>>() else {
            account.areas_cut += 1;
            continue;
        };
        if is_simple(&ring) {
            whole.push(Area { way_id, kind, ring });
        } else {
            account.areas_invalid += 1;
        }
    }
    let found = Areas::new(whole, network);
    let mut used: FxHashSet<u32> = found.around.values().flatten().copied().collect();
    let surfaces: Vec<u32> = used.iter().copied().collect();
    for surface in surfaces.iter().filter_map(|&index| found.all.get(index as usize)) {
        let extent = Extent::of(&surface.ring);
        let on_it = |&index: &u32| {
            let other = found.all.get(index as usize).and_then(|island| Extent::of(&island.ring));
            extent.zip(other).is_some_and(|(a, b)| a.meets(b))
        };
        used.extend(found.islands.iter().copied().filter(on_it));
    }
    let kept = (0..).zip(found.all).filter(|(index, _)| used.contains(index)).map(|(_, area)| area).collect::<Vec<_>>();
    account.areas_kept = kept.len() as u64;
    network.areas = Areas::new(kept, network);
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
    Polygon::new(corners, Vec::new()).is_valid()
}

#[derive(Debug, Clone, Copy)]
struct Extent {
    west: i32,
    south: i32,
    east: i32,
    north: i32,
}

impl Extent {
    fn of(ring: &[LonLat]) -> Option<Self> {
        let (lons, lats) = (ring.iter().map(|at| at.lon_e7), ring.iter().map(|at| at.lat_e7));
        Some(Self { west: lons.clone().min()?, south: lats.clone().min()?, east: lons.max()?, north: lats.max()? })
    }

    fn meets(self, other: Self) -> bool {
        self.west <= other.east && other.west <= self.east && self.south <= other.north && other.south <= self.north
    }
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
