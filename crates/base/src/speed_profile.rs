//! When a vehicle is where: the paper's tubes are functions of time, a corridor only of arc length.
//!
//! Promises times that grow along the corridor, of a vehicle that keeps to a limit and, in bends, to a lateral
//! acceleration. Leaves out braking and accelerating between the two: no certificate depends on it.

use crate::corridor::Corridor;

/// v(s) = min(limit, √(a_lat / |κ(s)|)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedProfile {
    /// Speed limit, m/s, > 0.
    pub limit_m_s: f64,
    /// Lateral acceleration that is not exceeded, m/s², > 0.
    pub lateral_m_s2: f64,
}

/// 80 km/h, the limit for heavy vehicles on rural roads in most of Europe; 2 m/s², what drivers of loaded heavy vehicles keep
/// to in bends: a third to a half of what rolls the worst of them over (0.35 g, 3.4 m/s²).
impl Default for SpeedProfile {
    fn default() -> Self {
        Self { limit_m_s: 80.0 / 3.6, lateral_m_s2: 2.0 }
    }
}

impl SpeedProfile {
    /// Speed where the path's curvature is `curvature` (1/m), m/s.
    #[must_use]
    pub fn speed_m_s(&self, curvature: f64) -> f64 {
        (self.lateral_m_s2 / curvature.abs()).sqrt().min(self.limit_m_s)
    }

    /// Seconds from the corridor's first station to each; between stations the mean of the speeds at both.
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
