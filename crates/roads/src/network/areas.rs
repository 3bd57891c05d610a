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
use crate::osm::{LonLat, NodeId, NodeTable, RoadArea};

/// Islands farther from every road than this are left out, metres. Roads and measured surfaces reach less far from their lines.
const NEAR_ROAD_M: f64 = 100.0;
/// Islands taller than this, 1e-7 degree (1.1 km), have a list of their own: each search would have to begin as far in the south.
const TALL_E7: i32 = 100_000;
/// Rings of more corners are not tested for crossings of their own, which takes a time that grows with the square. OpenStreetMap allows 2,000.
const MOST_CORNERS: usize = 10_000;

/// The surface of roads at a junction, or an island.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct MappedArea {
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
    all: Vec<MappedArea>,
    /// By node of the network: indices into `all` of the surfaces around it.
    around: FxHashMap<NodeId, Vec<u32>>,
    /// Islands from south to north without tall ones: their extents, and indices into `all`.
    islands: Vec<(Extent, u32)>,
    /// The greatest extent of one of `islands` from south to north, 1e-7 degree.
    tallest: i32,
    /// The islands taller than [`TALL_E7`]: no real ones.
    tall: Vec<(Extent, u32)>,
}

impl Areas {
    /// Finds the nodes of the network that each area surrounds. `all` is sorted by way id.
    #[must_use]
    pub fn new(all: Vec<MappedArea>, network: &Network) -> Self {
        if all.is_empty() {
            return Self::default();
        }
        let mut nodes: Vec<(i32, i32, NodeId)> = ends(network).map(|(id, at)| (at.lat_e7, at.lon_e7, id)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let (mut around, mut islands) = (FxHashMap::<NodeId, Vec<u32>>::default(), Vec::new());
        for (index, area) in (0..).zip(&all) {
            let Some(extent) = Extent::of(area.ring.iter().copied()) else { continue };
            if area.kind == AreaKind::Island {
                islands.push((extent, index));
                continue;
            }
            let first = nodes.partition_point(|node| node.0 < extent.south);
            let end = nodes.partition_point(|node| node.0 <= extent.north);
            for &(lat_e7, lon_e7, id) in &nodes[first..end] {
                if (extent.west..=extent.east).contains(&lon_e7) && contains(&area.ring, LonLat { lon_e7, lat_e7 }) {
                    around.entry(id).or_default().push(index);
                }
            }
        }
        islands.sort_unstable_by_key(|&(extent, index)| (extent.south, index));
        let (tall, islands): (Vec<_>, Vec<_>) = islands.into_iter().partition(|(extent, _)| height(extent) > TALL_E7);
        let tallest = islands.iter().map(|(extent, _)| height(extent)).max().unwrap_or(0);
        Self { all, around, islands, tallest, tall }
    }

    /// All areas, sorted by way id.
    #[must_use]
    pub fn all(&self) -> &[MappedArea] {
        &self.all
    }

    /// The surfaces around a node.
    pub fn around(&self, node: NodeId) -> impl Iterator<Item = &MappedArea> {
        self.around.get(&node).into_iter().flatten().filter_map(|&index| self.all.get(index as usize))
    }

    /// Whether there are no islands at all.
    #[must_use]
    pub fn without_islands(&self) -> bool {
        self.islands.is_empty() && self.tall.is_empty()
    }

    /// The islands that may lie within the box around the given places, from south to north.
    pub fn islands(&self, places: &[LonLat]) -> impl Iterator<Item = &MappedArea> {
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
        let mut found: Vec<(Extent, u32)> = self.islands[range].iter().filter(meets).copied().collect();
        if !self.tall.is_empty() {
            found.extend(self.tall.iter().filter(meets));
            found.sort_unstable_by_key(|&(extent, index)| (extent.south, index));
        }
        found.into_iter().map(|island| island.1)
    }
}

fn height(extent: &Extent) -> i32 {
    extent.north.saturating_sub(extent.south)
}

/// The areas of an extract with a usable ring, sorted by way id.
pub(super) fn usable(areas: Vec<RoadArea>, nodes: &NodeTable, account: &mut NetworkAccount) -> Vec<MappedArea> {
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
                usable.push(MappedArea { way_id, kind, ring });
            }
            None if cut => account.areas_cut += 1,
            None => account.areas_invalid += 1,
        }
    }
    usable
}

/// Keeps the surfaces that lie around the network's nodes, and the islands near its roads. `usable` is sorted by way id.
pub(super) fn keep(network: &mut Network, usable: Vec<MappedArea>) {
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

/// The convex hull of places as a closed ring. `None` if they enclose nothing. A hull of very many corners is simple by its nature.
fn hull(places: &[LonLat]) -> Option<Vec<LonLat>> {
    let points: MultiPoint<f64> =
        places.iter().map(|at| Point::new(f64::from(at.lon_e7), f64::from(at.lat_e7))).collect();
    let corner = |at: &geo::Coord| LonLat { lon_e7: at.x as i32, lat_e7: at.y as i32 };
    let ring: Vec<LonLat> = points.convex_hull().exterior().coords().map(corner).collect();
    let whole = if ring.len() > MOST_CORNERS { encloses(&ring) } else { is_simple(&ring) };
    whole.then_some(ring)
}

/// Node and position of both ends of every edge.
fn ends(network: &Network) -> impl Iterator<Item = (NodeId, LonLat)> + '_ {
    network.edges.iter().flat_map(|edge| {
        let mut positions = network.positions(edge);
        let (first, last) = (positions.next(), positions.next_back());
        first.map(|at| (edge.from_node, at)).into_iter().chain(last.map(|at| (edge.to_node, at)))
    })
}

/// Whether a ring encloses an area and does not touch itself. One of more than [`MOST_CORNERS`] counts as none.
fn is_simple(ring: &[LonLat]) -> bool {
    if ring.len() > MOST_CORNERS || !encloses(ring) {
        return false;
    }
    let corners: LineString = ring.iter().map(|at| at.degrees()).collect();
    Polygon::new(corners, Vec::new()).is_valid()
}

/// Whether the signed area of a ring is not 0.
fn encloses(ring: &[LonLat]) -> bool {
    let twice = |w: &[LonLat]| {
        i128::from(w[0].lon_e7) * i128::from(w[1].lat_e7) - i128::from(w[1].lon_e7) * i128::from(w[0].lat_e7)
    };
    ring.windows(2).map(twice).sum::<i128>() != 0
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
#[allow(clippy::unwrap_used)]
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

    fn rectangle(way_id: i64, [west, south]: [i32; 2], [wide, tall]: [i32; 2]) -> MappedArea {
        let (east, north) = (west + wide, south + tall);
        let ring = vec![at(west, south), at(east, south), at(east, north), at(west, north), at(west, south)];
        MappedArea { way_id, kind: AreaKind::Island, ring }
    }

    /// A mistaken tag on an area of a degree must not make each search read all islands of a degree.
    #[test]
    fn a_tall_island_is_found_in_order_and_does_not_widen_the_search() {
        let mut all: Vec<MappedArea> = (0..2_000).map(|k| rectangle(k.into(), [0, 10_000 * k], [50, 100])).collect();
        all.push(rectangle(5_000, [-10, -70], [20, 10_000_000]));
        all.push(rectangle(5_001, [900, 0], [20, 20_000_000]));
        let areas = Areas::new(all.clone(), &Network::default());
        assert_eq!((areas.tallest, areas.tall.len(), areas.islands.len()), (100, 2, 2_000));
        let found = |south: i32, north: i32| -> Vec<i64> {
            areas.islands(&[at(0, south), at(20, north)]).map(|area| area.way_id).collect()
        };
        assert_eq!(found(50, 10_050), [5_000, 0, 1]);
        assert_eq!(found(-80, -75), Vec::<i64>::new());
        assert_eq!(found(12_000_000, 12_000_001), [1_200]);
        // As if each island were looked at.
        for (south, north) in [(-100, 100), (0, 0), (9_999_900, 10_000_100), (5, 20_000_000)] {
            let asked = Extent::of([at(0, south), at(20, north)].into_iter()).unwrap();
            let mut each: Vec<(i32, i64)> = all
                .iter()
                .filter_map(|area| Some((Extent::of(area.ring.iter().copied())?, area.way_id)))
                .filter(|(extent, _)| asked.meets(*extent))
                .map(|(extent, id)| (extent.south, id))
                .collect();
            each.sort_unstable();
            assert_eq!(found(south, north), each.into_iter().map(|(_, id)| id).collect::<Vec<_>>(), "{south} {north}");
        }
        let only = Areas::new(vec![rectangle(1, [0, 0], [9, 1_000_000])], &Network::default());
        assert!(!only.without_islands() && only.islands(&[at(5, 5)]).count() == 1);
    }

    /// A circle of a million corners takes 10^12 pairs of sides.
    #[test]
    fn a_ring_of_very_many_corners_is_no_surface_and_as_an_island_its_hull() {
        let circle = |corners: u32| {
            let on = |k: u32| (f64::from(k % corners) / f64::from(corners) * std::f64::consts::TAU).sin_cos();
            let corner = |k: u32| at((1e8 * on(k).1) as i32, (1e8 * on(k).0) as i32);
            (0..=corners).map(corner).collect::<Vec<LonLat>>()
        };
        let ring = circle(1_000_000);
        assert!(!is_simple(&ring) && is_simple(&circle(300)));
        let whole = hull(&ring).unwrap();
        assert!(whole.len() > MOST_CORNERS && whole.first() == whole.last());
        assert!(contains(&whole, at(0, 99_000_000)) && !contains(&whole, at(72_000_000, 72_000_000)));
        let nodes = NodeTable {
            ids: (0..1_000_000).map(NodeId::new).collect(),
            places: ring[..1_000_000].iter().copied().map(Some).collect(),
        };
        let refs: Vec<NodeId> = (0..1_000_000).chain([0]).map(NodeId::new).collect();
        let area = |id, kind| RoadArea { id, kind, refs: refs.clone() };
        let road = AreaKind::Road(crate::osm::facts::RoadClass::Primary);
        let mut account = NetworkAccount::default();
        let kept = usable(vec![area(1, road), area(2, AreaKind::Island)], &nodes, &mut account);
        assert_eq!(kept.iter().map(|area| area.way_id).collect::<Vec<_>>(), [2]);
        assert_eq!((account.areas_invalid, account.islands_widened), (1, 1));
    }
}
