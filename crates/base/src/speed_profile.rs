//! Converts arc length to time. The paper's tubes are functions of time, and a corridor knows arc length only.
//!
//! Times grow along the corridor. The vehicle keeps to a speed limit and, in bends, to a lateral acceleration. Braking
//! and accelerating between the two are ignored, because no certificate depends on these times.

use crate::corridor::Corridor;

/// v(s) = min(limit, √(a_lat / |κ(s)|)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedProfile {
    /// Speed limit, m/s, > 0.
    pub limit_m_s: f64,
    /// Largest lateral acceleration, m/s², > 0.
    pub lateral_m_s2: f64,
}

/// The limit is 80 km/h, which heavy vehicles must keep on rural roads in most of Europe. The lateral acceleration is 2
/// m/s², which drivers of loaded heavy vehicles keep in bends. The least stable heavy vehicles roll over at 3.4 m/s²
/// (0.35 g).
impl Default for SpeedProfile {
    fn default() -> Self {
        Self { limit_m_s: 80.0 / 3.6, lateral_m_s2: 2.0 }
    }
}

impl SpeedProfile {
    /// Speed (m/s) where the path has curvature `curvature` (1/m).
    #[must_use]
    pub fn speed_m_s(&self, curvature: f64) -> f64 {
        (self.lateral_m_s2 / curvature.abs()).sqrt().min(self.limit_m_s)
    }

    /// Seconds from the first station to each station. Between two stations the speed is the mean of the speeds at
    /// both.
    #[must_use]
    pub fn times_s(&self, corridor: &Corridor) -> Vec<f64> {
        let mut times = Vec::with_capacity(corridor.len());
        let (mut now, mut before) = (0.0, None);
        for &curvature in &corridor.curvature {
            let here = self.speed_m_s(curvature);
            now += before.map_or(0.0, |before: f64| 2.0 * corridor.spacing_m / (before + here));
            before = Some(here);
            times.push(now);
        }
        times
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bends_take_longer_than_straights() {
        let profile = SpeedProfile::default();
        let curvature = vec![0.0, 0.0, 0.02, 0.02];
        let t = profile.times_s(&Corridor { spacing_m: 1.0, x: vec![0.0; 4], curvature, ..Corridor::default() });
        let in_the_bend = (profile.lateral_m_s2 / 0.02).sqrt();
        assert!((t[1] - 1.0 / profile.limit_m_s).abs() < 1e-12);
        assert!((t[3] - t[2] - 1.0 / in_the_bend).abs() < 1e-12);
        assert_eq!(t[0], 0.0);
    }

    #[test]
    fn neither_bound_is_exceeded() {
        let profile = SpeedProfile { limit_m_s: 15.0, lateral_m_s2: 1.5 };
        for i in 0..200 {
            let curvature = f64::from(i - 100) * 1e-3;
            let v = profile.speed_m_s(curvature);
            assert!(v <= profile.limit_m_s && v * v * curvature.abs() <= profile.lateral_m_s2 + 1e-12);
        }
    }
}
