//! A box on the map.

use crate::osm::LonLat;

/// A box in degrees.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Bounds {
    /// Least longitude.
    pub west: f64,
    /// Least latitude.
    pub south: f64,
    /// Greatest longitude.
    pub east: f64,
    /// Greatest latitude.
    pub north: f64,
}

impl Bounds {
    /// The box around some positions; `None` if there are none.
    pub fn around(positions: impl IntoIterator<Item = LonLat>) -> Option<Self> {
        positions.into_iter().map(LonLat::degrees).fold(None, |bounds, (lon, lat)| {
            let point = Self { west: lon, south: lat, east: lon, north: lat };
            Some(bounds.map_or(point, |b: Self| b.union(point)))
        })
    }

    /// The smallest box that contains both boxes.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            west: self.west.min(other.west),
            south: self.south.min(other.south),
            east: self.east.max(other.east),
            north: self.north.max(other.north),
        }
    }

    /// Whether the boxes have a point in common, their borders included.
    #[must_use]
    pub fn touches(self, other: Self) -> bool {
        self.west <= other.east && self.east >= other.west && self.south <= other.north && self.north >= other.south
    }
}
