//! Positions of the map.

/// A position on WGS 84 in units of 1e-7 degree, the file's own resolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct LonLat {
    /// Longitude, 1e-7 degree, −180°..=180°.
    pub lon_e7: i32,
    /// Latitude, 1e-7 degree, −90°..=90°.
    pub lat_e7: i32,
}

impl LonLat {
    /// Longitude and latitude in degrees.
    #[must_use]
    pub fn degrees(self) -> (f64, f64) {
        (f64::from(self.lon_e7) * 1e-7, f64::from(self.lat_e7) * 1e-7)
    }
}

/// Rounds longitude and latitude in degrees to the map's precision, 1e-7 degree (about a centimetre).
#[must_use]
pub fn rounded(degrees: [f64; 2]) -> [f64; 2] {
    degrees.map(|degrees| (degrees * 1e7).round() / 1e7)
}
