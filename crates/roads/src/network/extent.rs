//! Boxes around places, in the units of the map.

use super::EARTH_RADIUS_M;
use crate::osm::LonLat;

/// A box that is closed on all sides, 1e-7 degree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) struct Extent {
    pub(super) west: i32,
    pub(super) south: i32,
    pub(super) east: i32,
    pub(super) north: i32,
}

impl Extent {
    /// The extent of some places. `None` if there are none.
    pub(super) fn of(places: impl Iterator<Item = LonLat>) -> Option<Self> {
        let at =
            |place: LonLat| Self { west: place.lon_e7, south: place.lat_e7, east: place.lon_e7, north: place.lat_e7 };
        places.map(at).reduce(|a, b| Self {
            west: a.west.min(b.west),
            south: a.south.min(b.south),
            east: a.east.max(b.east),
            north: a.north.max(b.north),
        })
    }

    /// The extent with this much around it.
    pub(super) fn wider_by(self, metres: f64) -> Self {
        let north = (metres / EARTH_RADIUS_M).to_degrees() * 1e7;
        let lat = f64::from(self.south).abs().max(f64::from(self.north).abs()) * 1e-7;
        let east = (north / lat.to_radians().cos().max(1e-6)).min(3.6e9);
        let (east, north) = (east as i32, north as i32);
        Self {
            west: self.west.saturating_sub(east),
            south: self.south.saturating_sub(north),
            east: self.east.saturating_add(east),
            north: self.north.saturating_add(north),
        }
    }

    /// Whether two boxes have a place in common. A box may reach over the 180th meridian, beyond which it counts on.
    pub(super) fn meets(self, other: Self) -> bool {
        const TURN_E7: i64 = 3_600_000_000;
        let [west, east, other_west, other_east] = [self.west, self.east, other.west, other.east].map(i64::from);
        let meets = |by: i64| west + by <= other_east && other_west <= east + by;
        self.south <= other.north && other.south <= self.north && (meets(0) || meets(TURN_E7) || meets(-TURN_E7))
    }
}
