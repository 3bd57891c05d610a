//! The line of a segment, and places on it by linear reference: shares of its geodesic length on WGS 84
//! (<https://docs.overturemaps.org/guides/transportation/linear-referencing>).

use geo::{Distance as _, Geodesic, Point};
use rustc_hash::FxHashMap;

use super::ids::FeatureKey;
use crate::osm::{LonLat, NodeId};

/// A place this near to a vertex is that vertex, metres. A vertex beside it would bend the line.
pub(super) const SNAP_M: f64 = 0.1;
/// A connector this far from its place on the line is not on it, metres.
const OFF_LINE_M: f64 = 0.5;

/// No node: connectors have positive numbers.
const NO_NODE: NodeId = NodeId::new(0);

/// A line with numbered vertices.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) places: Vec<LonLat>,
    /// [`NO_NODE`] for a vertex without a number yet.
    pub(super) nodes: Vec<NodeId>,
    /// Metres from the begin to each vertex.
    along_m: Vec<f64>,
}

impl Line {
    /// The line without repeats, or `None` if it has no two places.
    pub(super) fn new(mut places: Vec<LonLat>) -> Option<Self> {
        places.dedup();
        if places.len() < 2 {
            return None;
        }
        let mut along_m = vec![0.0];
        let mut so_far_m = 0.0;
        for pair in places.windows(2) {
            so_far_m += distance_m(pair[0], pair[1]);
            along_m.push(so_far_m);
        }
        Some(Self { nodes: vec![NO_NODE; places.len()], places, along_m })
    }

    /// The share of a vertex.
    pub(super) fn share(&self, vertex: usize) -> f64 {
        let whole_m = self.along_m.last().copied().unwrap_or_default();
        self.along_m.get(vertex).map_or(0.0, |m| if whole_m > 0.0 { m / whole_m } else { 0.0 })
    }

    /// The share of a length in metres; 1 if the line is no longer.
    pub(super) fn share_of(&self, length_m: f64) -> f64 {
        let whole_m = self.along_m.last().copied().unwrap_or_default();
        if whole_m > length_m { length_m / whole_m } else { 1.0 }
    }

    /// The vertex at a share, which is added if none is near.
    pub(super) fn vertex_at(&mut self, share: f64) -> usize {
        let at_m = share.clamp(0.0, 1.0) * self.along_m.last().copied().unwrap_or_default();
        let after = self.along_m.partition_point(|m| *m < at_m).min(self.places.len() - 1);
        let before = after.saturating_sub(1);
        let (left_m, right_m) = (self.along_m[before], self.along_m[after]);
        let nearest = if at_m - left_m < right_m - at_m { before } else { after };
        if (self.along_m[nearest] - at_m).abs() <= SNAP_M || before == after {
            return nearest;
        }
        let part = (at_m - left_m) / (right_m - left_m);
        let (a, b) = (self.places[before], self.places[after]);
        let between = |a: i32, b: i32| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as i32;
        let place = LonLat { lon_e7: between(a.lon_e7, b.lon_e7), lat_e7: between(a.lat_e7, b.lat_e7) };
        self.places.insert(after, place);
        self.nodes.insert(after, NO_NODE);
        self.along_m.insert(after, at_m);
        after
    }

    /// Puts a connector on the line: on the vertex at its place, else at its share. `false` if it lies elsewhere, or another
    /// connector is there.
    pub(super) fn join(&mut self, node: NodeId, place: Option<LonLat>, at: Option<f64>) -> bool {
        let same: Vec<usize> = (0..self.places.len()).filter(|&i| place == Some(self.places[i])).collect();
        let vertex = match (same.as_slice(), at) {
            ([vertex], _) | ([vertex, ..], None) => *vertex,
            ([], Some(at)) => {
                let whole = self.places.len();
                let vertex = self.vertex_at(at);
                let Some(place) = place else { return self.number(vertex, node) };
                if distance_m(place, self.places[vertex]) > OFF_LINE_M {
                    if self.places.len() > whole {
                        self.remove(vertex);
                    }
                    return false;
                }
                self.move_to(vertex, place);
                vertex
            }
            ([], None) => return false,
            (several, Some(at)) => {
                let far = |i: &&usize| (self.share(**i) - at).abs();
                let Some(nearest) = several.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else { return false };
                *nearest
            }
        };
        self.number(vertex, node)
    }

    fn number(&mut self, vertex: usize, node: NodeId) -> bool {
        let free = self.nodes[vertex] == NO_NODE || self.nodes[vertex] == node;
        if free {
            self.nodes[vertex] = node;
        }
        free
    }

    fn move_to(&mut self, vertex: usize, place: LonLat) {
        if self.nodes[vertex] == NO_NODE {
            self.places[vertex] = place;
        }
    }

    fn remove(&mut self, vertex: usize) {
        self.places.remove(vertex);
        self.nodes.remove(vertex);
        self.along_m.remove(vertex);
    }

    /// Numbers all other vertices: by segment and place, so they stay the same when the segment changes elsewhere.
    pub(super) fn number_rest(&mut self, key: FeatureKey) {
        // Counted, not searched: searching takes minutes for a line of a million vertices, and hours for one of ten millions.
        let mut known: FxHashMap<LonLat, u64> = FxHashMap::default();
        for vertex in 0..self.places.len() {
            let earlier = known.entry(self.places[vertex]).or_default();
            if self.nodes[vertex] == NO_NODE {
                let LonLat { lon_e7, lat_e7 } = self.places[vertex];
                let place = u64::from(lon_e7.cast_unsigned()) << 32 | u64::from(lat_e7.cast_unsigned());
                self.nodes[vertex] = NodeId::new(key.of_part([place, *earlier]));
            }
            *earlier += 1;
        }
    }
}

fn distance_m(a: LonLat, b: LonLat) -> f64 {
    Geodesic.distance(Point::from(a.degrees()), Point::from(b.degrees()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn at(lon_e7: i32) -> LonLat {
        LonLat { lon_e7, lat_e7: 0 }
    }

    /// Some 11 m between vertices.
    fn line() -> Line {
        Line::new(vec![at(0), at(1000), at(1000), at(2000), at(4000)]).unwrap()
    }

    #[test]
    fn a_share_is_a_vertex_where_one_is_near() {
        let mut line = line();
        assert_eq!(line.places.len(), 4);
        assert_eq!((line.vertex_at(0.2501), line.vertex_at(0.0), line.vertex_at(1.0)), (1, 0, 3));
        assert_eq!((line.vertex_at(0.75), line.places[3]), (3, at(3000)));
        assert!((line.share(3) - 0.75).abs() < 1e-9);
        assert_eq!(line.places.len(), 5);
    }

    #[test]
    fn a_connector_joins_where_it_lies() {
        let mut line = line();
        assert!(line.join(NodeId::new(7), Some(at(2000)), Some(0.1)) && line.nodes == [0, 0, 7, 0].map(NodeId::new));
        assert!(line.join(NodeId::new(8), None, Some(0.75)) && line.nodes == [0, 0, 7, 8, 0].map(NodeId::new));
        let far = LonLat { lon_e7: 500, lat_e7: 1000 };
        assert!(!line.join(NodeId::new(9), Some(far), Some(0.125)) && line.nodes.len() == 5);
        let near = LonLat { lon_e7: 500, lat_e7: 20 };
        assert!(line.join(NodeId::new(9), Some(near), Some(0.125)) && line.places[1] == near);
        assert!(!line.join(NodeId::new(10), Some(at(2000)), None));
        line.number_rest(FeatureKey::segment("s"));
        assert!(line.nodes.iter().all(|node| node.get() > 0));
    }

    #[test]
    fn a_line_that_meets_itself_joins_at_the_nearer_share() {
        let mut ring = Line::new(vec![at(0), at(1000), LonLat { lon_e7: 500, lat_e7: 900 }, at(0)]).unwrap();
        assert!(
            ring.join(NodeId::new(7), Some(at(0)), Some(1.0))
                && ring.nodes[3] == NodeId::new(7)
                && ring.nodes[0] == NodeId::new(0)
        );
        assert!(ring.join(NodeId::new(7), Some(at(0)), Some(0.0)) && ring.nodes[0] == NodeId::new(7));
    }

    #[test]
    fn a_vertex_is_numbered_by_its_place_and_by_how_often_the_line_was_there() {
        let mut line = Line::new((0..50_000).map(|i| at(i % 2 * 1000)).collect()).unwrap();
        assert!(line.number(3, NodeId::new(7)));
        let key = FeatureKey::segment("s");
        line.number_rest(key);
        for vertex in [0, 1, 2, 4, 5, 49_999] {
            let place = u64::from(line.places[vertex].lon_e7.cast_unsigned()) << 32;
            assert_eq!(line.nodes[vertex].get(), key.of_part([place, vertex as u64 / 2]));
        }
        assert_eq!(line.nodes[3].get(), 7);
    }
}
