//! Finds the edges nearest to a place that may be used, within a given distance.
//!
//! Distances are computed as in the network, on a locally flat sphere. A road on the other side of the antimeridian is not
//! found.

use std::sync::Arc;

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::roads::Roads;
use super::search::Goal;
use crate::network::{EARTH_RADIUS_M, EdgeNo, offset_m};
use crate::osm::LonLat;
use crate::osm::facts::Direction;

/// The greatest distance at which a road is searched, to report the distance of the nearest one, metres.
const FARTHEST_M: f64 = 200_000.0;

/// A place nearer than this to a road was not given with longitude and latitude exchanged, metres.
const EXCHANGED_M: f64 = 10_000.0;

/// A place on the earth, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// Longitude, −180..=180.
    pub lon: f64,
    /// Latitude, −90..=90.
    pub lat: f64,
}

impl From<Position> for LonLat {
    /// Rounds to 1e-7 degree.
    fn from(place: Position) -> Self {
        let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
        Self { lon_e7: e7(place.lon), lat_e7: e7(place.lat) }
    }
}

/// A point of a road, on the edge of each direction that may be used.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapped {
    /// The edges, each with the share of it before the point; sorted by edge.
    pub on: Vec<Goal>,
    /// The point on the road.
    pub position: Position,
    /// Distance from the requested place, metres.
    pub distance_m: f64,
}

/// Why no road was found for a place.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SnapError {
    /// The nearest road is too far away.
    #[error(
        "{lon:.5},{lat:.5}: the nearest road that may be used is {distance_m:.0} m away, at {at_lon:.5},{at_lat:.5}; \
         the most allowed is {most_m:.0} m",
        lon = place.lon, lat = place.lat, at_lon = nearest.lon, at_lat = nearest.lat
    )]
    TooFar {
        /// The requested place.
        place: Position,
        /// The nearest point on a road.
        nearest: Position,
        /// Its distance, metres.
        distance_m: f64,
        /// The allowed distance, metres.
        most_m: f64,
    },
    /// No road is near, and one is near the place with longitude and latitude exchanged.
    #[error(
        "{lon:.5},{lat:.5}: no road that may be used is near, but one is at {lat:.5},{lon:.5}; give the longitude first, then the latitude",
        lon = place.lon, lat = place.lat
    )]
    Exchanged {
        /// The requested place.
        place: Position,
        /// The point on the road near the exchanged place.
        nearest: Position,
        /// Its distance from the exchanged place, metres.
        distance_m: f64,
    },
    /// There is no road within 200 km.
    #[error("{lon:.5},{lat:.5}: no road that may be used within 200 km", lon = place.lon, lat = place.lat)]
    Nothing {
        /// The requested place.
        place: Position,
    },
}

type Segment = GeomWithData<Rectangle<[f64; 2]>, (EdgeNo, u32)>;

/// A spatial index of all pieces of road, by their segments.
pub struct Snapper {
    roads: Arc<Roads>,
    tree: RTree<Segment>,
    /// The first edge and another edge of each piece; sorted.
    twins: Vec<(EdgeNo, EdgeNo)>,
}

impl Snapper {
    /// Indexes every piece of road once, also if it has two directions.
    #[must_use]
    pub fn new(roads: &Arc<Roads>) -> Self {
        let network = &roads.network;
        let mut segments = Vec::new();
        let mut twins = Vec::new();
        let mut before: Option<EdgeNo> = None;
        for (index, edge) in network.numbered_edges() {
            let same = |&b: &EdgeNo| {
                let b = &network.edges[b.index()];
                b.road == edge.road && b.shape == edge.shape
            };
            if let Some(first) = before.filter(same) {
                twins.push((first, index));
                continue;
            }
            before = Some(index);
            let shape = &network.shapes[edge.shape.start as usize..edge.shape.end as usize];
            for (vertex, pair) in (0_u32..).zip(shape.windows(2)) {
                let corner = |p: LonLat| [p.degrees().0, p.degrees().1];
                let bounds = Rectangle::from_corners(corner(pair[0]), corner(pair[1]));
                segments.push(GeomWithData::new(bounds, (index, vertex)));
            }
        }
        Self { roads: Arc::clone(roads), tree: RTree::bulk_load(segments), twins }
    }

    /// The nearest point on a road with a direction that is `usable`.
    ///
    /// # Errors
    /// There is no such road within `most_m` metres.
    pub fn snap(&self, place: Position, most_m: f64, usable: impl Fn(EdgeNo) -> bool) -> Result<Snapped, SnapError> {
        let mut reach_m = most_m.max(50.0);
        loop {
            if let Some(snapped) = self.nearest_within(place, reach_m, &usable) {
                if snapped.distance_m <= most_m {
                    return Ok(snapped);
                }
                let (nearest, distance_m) = (snapped.position, snapped.distance_m);
                let too_far = SnapError::TooFar { place, nearest, distance_m, most_m };
                let exchanged = (distance_m > EXCHANGED_M).then(|| self.exchanged(place, most_m, &usable));
                return Err(exchanged.flatten().unwrap_or(too_far));
            }
            if reach_m >= FARTHEST_M {
                let nothing = SnapError::Nothing { place };
                return Err(self.exchanged(place, most_m, &usable).unwrap_or(nothing));
            }
            reach_m *= 4.0;
        }
    }

    /// What to say of a place whose longitude and latitude were exchanged: no road is near it, and one is near the other place.
    fn exchanged(&self, place: Position, most_m: f64, usable: &impl Fn(EdgeNo) -> bool) -> Option<SnapError> {
        let other = Position { lon: place.lat, lat: place.lon };
        let near = (other.lat.abs() <= 90.0).then(|| self.nearest_within(other, most_m.max(50.0), usable))??;
        Some(SnapError::Exchanged { place, nearest: near.position, distance_m: near.distance_m })
    }

    fn nearest_within(&self, place: Position, reach_m: f64, usable: &impl Fn(EdgeNo) -> bool) -> Option<Snapped> {
        let cos = place.lat.to_radians().cos().max(0.01);
        let dy = (reach_m / EARTH_RADIUS_M).to_degrees();
        let dx = dy / cos;
        let here = LonLat::from(place);
        let around = AABB::from_corners([place.lon - dx, place.lat - dy], [place.lon + dx, place.lat + dy]);
        let mut best: Option<(f64, EdgeNo, u32, f64)> = None;
        for segment in self.tree.locate_in_envelope_intersecting(&around) {
            let (edge, vertex) = segment.data;
            let shape = &self.roads.network.shapes[self.roads.network.edges[edge.index()].shape.start as usize..];
            let ends = [0, 1].map(|i| offset_m(here, shape[vertex as usize + i]));
            let (distance_m, along) = foot(ends);
            let better = best.is_none_or(|(d, e, v, _)| (distance_m, edge, vertex) < (d, e, v));
            if distance_m <= reach_m && better && self.directions(edge).iter().any(|&e| usable(e)) {
                best = Some((distance_m, edge, vertex, along));
            }
        }
        let (distance_m, edge, vertex, along) = best?;
        Some(self.snapped(edge, vertex, along, distance_m, usable))
    }

    fn snapped(
        &self,
        edge: EdgeNo,
        vertex: u32,
        along: f64,
        distance_m: f64,
        usable: &impl Fn(EdgeNo) -> bool,
    ) -> Snapped {
        let facts = &self.roads.network.edges[edge.index()];
        let shape = &self.roads.network.shapes[facts.shape.start as usize..facts.shape.end as usize];
        let origin = shape[vertex as usize].degrees();
        let origin = Position { lon: origin.0, lat: origin.1 };
        let length_m = |pair: &[LonLat]| {
            let [east, north] = offset_m(pair[0], pair[1]);
            east.hypot(north)
        };
        let lengths: Vec<f64> = shape.windows(2).map(length_m).collect();
        let before: f64 = lengths[..vertex as usize].iter().sum::<f64>() + along * lengths[vertex as usize];
        let share = (before / lengths.iter().sum::<f64>().max(1e-9)).clamp(0.0, 1.0);
        let on = |&edge: &EdgeNo| {
            let backward = self.roads.network.edges[edge.index()].direction == Direction::Backward;
            Goal { edge, share: if backward { 1.0 - share } else { share } }
        };
        let end = shape[vertex as usize + 1].degrees();
        let position =
            Position { lon: origin.lon + along * (end.0 - origin.lon), lat: origin.lat + along * (end.1 - origin.lat) };
        let on = self.directions(edge).iter().filter(|&&edge| usable(edge)).map(on).collect();
        Snapped { on, position, distance_m }
    }

    /// The edges of a piece of road, given the first of them.
    fn directions(&self, first: EdgeNo) -> Vec<EdgeNo> {
        let start = self.twins.partition_point(|twin| twin.0 < first);
        let twins = self.twins[start..].iter().take_while(|twin| twin.0 == first);
        std::iter::once(first).chain(twins.map(|twin| twin.1)).collect()
    }
}

/// The distance of the origin from a segment, and the share of the segment before the foot.
pub fn foot([a, b]: [[f64; 2]; 2]) -> (f64, f64) {
    let u = [b[0] - a[0], b[1] - a[1]];
    let squared = u[0] * u[0] + u[1] * u[1];
    let along = if squared > 0.0 { (-(a[0] * u[0] + a[1] * u[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    ((a[0] + along * u[0]).hypot(a[1] + along * u[1]), along)
}
