//! Edges near the border of their file are marked: roads that meet them beyond it are not in the file.
//!
//! Their junctions, approaches and turns may differ in a larger file. A file says where it ends by the box in its header. Some files have a
//! box that is too small, such as that of the first download of several. Every road of a file that ends at a box has a part inside; where many
//! have none, the box is not believed.

use super::geometry::offset_m;
use super::{Edge, Network};
use crate::osm::LonLat;

/// How far roads matter to an edge, metres: the approach of its stroke (250 m), a junction of several nodes, and the window of a turn.
const REACH_M: f64 = 500.0;

/// A box is believed if at most one road in so many lies outside. Some files keep whole relations, which reach beyond.
const ONE_OUTSIDE_IN: usize = 20;

/// The border of a file, and how many roads speak for it.
pub(super) struct Border {
    whole: Inset,
    inner: Inset,
    roads: usize,
    outside: usize,
}

impl Border {
    /// The border of a box (west, south, east, north; degrees). `None` for a box that is no part of the world.
    pub(super) fn of(bbox_deg: Option<[f64; 4]>) -> Option<Self> {
        let bbox_deg = bbox_deg?;
        let (whole, inner) = (Inset::of(bbox_deg, 0.0)?, Inset::of(bbox_deg, REACH_M)?);
        Some(Self { whole, inner, roads: 0, outside: 0 })
    }

    /// Counts the roads of a network that lie in the box.
    pub(super) fn count(&mut self, network: &Network) {
        let inside = |edge: &Edge| positions(&network.shapes, edge).iter().any(|&at| self.whole.has(at));
        let roads = || network.edges.chunk_by(|a, b| a.road == b.road);
        self.outside += roads().filter(|road| !road.iter().any(inside)).count();
        self.roads += roads().count();
    }

    /// Marks the edges that come within reach of the border or leave the box, if the roads that were counted speak for it.
    pub(super) fn mark(&self, network: &mut Network) {
        if self.outside * ONE_OUTSIDE_IN > self.roads {
            return;
        }
        let Network { edges, shapes, .. } = network;
        for edge in edges.iter_mut().filter(|edge| !edge.cut) {
            edge.cut = positions(shapes, edge).iter().any(|&position| !self.inner.has(position));
        }
    }
}

fn positions<'s>(shapes: &'s [LonLat], edge: &Edge) -> &'s [LonLat] {
    shapes.get(edge.shape.start as usize..edge.shape.end as usize).unwrap_or_default()
}

/// The part of a box that is farther from its border than some metres.
struct Inset {
    lon_e7: [i32; 2],
    lat_e7: [i32; 2],
}

impl Inset {
    /// `None` for a box that is no part of the world.
    fn of([west, south, east, north]: [f64; 4], within_m: f64) -> Option<Self> {
        let e7 = |degrees: f64, most: f64| (degrees.abs() <= most).then(|| (degrees * 1e7).round() as i32);
        let [west, east] = [e7(west, 180.0)?, e7(east, 180.0)?];
        let [south, north] = [e7(south, 90.0)?, e7(north, 90.0)?];
        // The metres of a degree of longitude are fewest at the latitude that is farthest from the equator.
        let far = if south.abs() > north.abs() { south } else { north };
        let degree =
            |lon_e7, lat_e7| offset_m(LonLat { lon_e7: 0, lat_e7: far }, LonLat { lon_e7, lat_e7: far + lat_e7 });
        let steps = |metres: f64| (1e5 * within_m / metres.abs().max(1.0)).ceil() as i32;
        let [lon, lat] = [steps(degree(100_000, 0)[0]), steps(degree(0, 100_000)[1])];
        Some(Self { lon_e7: [west.saturating_add(lon), east.saturating_sub(lon)], lat_e7: [south + lat, north - lat] })
    }

    fn has(&self, position: LonLat) -> bool {
        let within = |at: i32, [least, most]: [i32; 2]| (least..=most).contains(&at);
        within(position.lon_e7, self.lon_e7) && within(position.lat_e7, self.lat_e7)
    }
}
