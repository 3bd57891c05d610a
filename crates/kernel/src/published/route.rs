//! Def. 2: the route corridor 𝓡(t), as functions of time on the corridor's stations.

use super::plane::{V2, along, dot, minus, perp, unit_or};
use netcert_base::corridor::Corridor;
use netcert_base::speed_profile::SpeedProfile;

/// (c(·), w(·)) of Def. 2, with t from a speed profile. All vectors have one entry per instant.
///
/// Def. 2 has one width, centred. Where a corridor has two half-widths, the lesser one counts on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedRoute {
    /// t, seconds, growing.
    pub t_s: Vec<f64>,
    /// c(t), metres.
    pub centre: Vec<V2>,
    /// Direction of travel along the centre, unit vectors; n̂(t) is a quarter turn to its left.
    pub tangent: Vec<V2>,
    /// 0.5 w(t), metres.
    pub half_width_m: Vec<f64>,
    /// Arc length between instants, metres.
    pub spacing_m: f64,
}

impl TimedRoute {
    /// The route along `corridor`, driven at `speeds`.
    #[must_use]
    pub fn new(corridor: &Corridor, speeds: &SpeedProfile) -> Self {
        let sides = corridor.left_m.iter().zip(&corridor.right_m);
        Self {
            t_s: speeds.times_s(corridor),
            centre: corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect(),
            tangent: corridor.heading.iter().map(|h| [h.cos(), h.sin()]).collect(),
            half_width_m: sides.map(|(l, r)| l.min(*r)).collect(),
            spacing_m: corridor.spacing_m,
        }
    }

    /// Number of instants.
    #[must_use]
    pub fn len(&self) -> usize {
        self.centre.len()
    }

    /// Whether there is no instant.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.centre.is_empty()
    }

    /// The instant before t (seconds) and the share of the way to the next instant, 0 to 1. `None` outside [0, T].
    #[must_use]
    pub fn instant(&self, t_s: f64) -> Option<(usize, f64)> {
        let (first, last) = (*self.t_s.first()?, *self.t_s.last()?);
        if !(first..=last).contains(&t_s) {
            return None;
        }
        let i = self.t_s.partition_point(|&t| t <= t_s).saturating_sub(1).min(self.len().saturating_sub(2));
        let next = self.t_s.get(i + 1).copied().unwrap_or(last);
        let fraction = if next > self.t_s[i] { (t_s - self.t_s[i]) / (next - self.t_s[i]) } else { 0.0 };
        Some((i, fraction))
    }

    /// n̂(t) at instant `i`.
    #[must_use]
    pub fn normal(&self, i: usize) -> V2 {
        perp(self.tangent[i])
    }

    /// Eq. 3 to the letter: whether p ∈ 𝓡(t) at instant `i`. The set is a strip across the road at c(t), endless along
    /// the tangent.
    #[must_use]
    pub fn holds(&self, i: usize, p: V2) -> bool {
        dot(minus(p, self.centre[i]), self.normal(i)).abs() < self.half_width_m[i]
    }

    /// Eq. 4a: 𝒫_l(t) at instant `i`.
    #[must_use]
    pub fn left(&self, i: usize) -> V2 {
        along(self.centre[i], self.half_width_m[i], self.normal(i))
    }

    /// Eq. 4b: 𝒫_r(t) at instant `i`.
    #[must_use]
    pub fn right(&self, i: usize) -> V2 {
        along(self.centre[i], -self.half_width_m[i], self.normal(i))
    }

    /// w_min = min 0.5 w(t) of the Corollary, metres.
    #[must_use]
    pub fn narrowest_m(&self) -> f64 {
        self.half_width_m.iter().fold(f64::INFINITY, |least, &w| least.min(w))
    }

    /// The foot of `p` on the centreline, searched from station `near`. The route continues straight beyond both ends.
    #[must_use]
    pub fn foot(&self, p: V2, near: usize) -> Foot {
        let last = self.len() - 1;
        let ahead = |k: usize| dot(minus(p, self.centre[k]), self.tangent[k]);
        let lateral = |k: usize| dot(minus(p, self.centre[k]), self.normal(k));
        let mut k = near.min(last);
        while k > 0 && ahead(k) < 0.0 {
            k -= 1;
        }
        while k < last && ahead(k + 1) >= 0.0 {
            k += 1;
        }
        let a = ahead(k);
        if k == last || a < 0.0 {
            return Foot { station: k, fraction: 0.0, lateral_m: lateral(k), normal: self.normal(k) };
        }
        // Between two stations the fraction follows from both distances, and the normal turns evenly.
        let fraction = a / (a - ahead(k + 1)).max(1e-12);
        let (n0, n1) = (self.normal(k), self.normal(k + 1));
        let normal = unit_or(along(n0, fraction, minus(n1, n0)), n0);
        let lateral_m = (1.0 - fraction) * lateral(k) + fraction * lateral(k + 1);
        // Seen along either station's tangent, the curve deviates by κx²/2.
        let bend = dot(minus(self.tangent[k + 1], self.tangent[k]), n0) / self.spacing_m;
        let sag = 0.5 * bend * fraction * (1.0 - fraction) * self.spacing_m * self.spacing_m;
        Foot { station: k, fraction, lateral_m: lateral_m - sag, normal }
    }

    /// 0.5 w at a foot, metres.
    #[must_use]
    pub fn half_width_at_m(&self, foot: &Foot) -> f64 {
        let next = (foot.station + 1).min(self.len() - 1);
        self.half_width_m[foot.station] * (1.0 - foot.fraction) + self.half_width_m[next] * foot.fraction
    }
}

/// A foot on the centreline and the point's offset from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Station before the foot.
    pub station: usize,
    /// Share of the way to the next station, 0 to 1.
    pub fraction: f64,
    /// Lateral offset, metres, positive left.
    pub lateral_m: f64,
    /// n̂ at the foot.
    pub normal: V2,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_lie_half_a_width_to_either_side_and_bound_the_strip() {
        let route = TimedRoute::new(&Corridor::straight(50.0, 3.0, 2.5), &SpeedProfile::default());
        let near = |a: V2, b: V2| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12;
        assert!(near(route.left(10), [10.0, 2.5]) && near(route.right(10), [10.0, -2.5]));
        assert!(
            route.holds(10, [10.0, 2.4]) && !route.holds(10, [10.0, 2.5]),
            "the lesser half-width, and an open set"
        );
        assert_eq!(route.narrowest_m(), 2.5);
    }

    #[test]
    fn feet_on_a_circle_are_where_the_radius_says() {
        let corridor = Corridor::from_curvature(1.0, [0.0; 2], 0.0, &[1.0 / 40.0; 61], 3.0, 3.0);
        let route = TimedRoute::new(&corridor, &SpeedProfile::default());
        for i in 0..400 {
            let (angle, lateral) = (0.003 * f64::from(i) + 0.05, 0.01 * f64::from(i) - 2.0);
            let p = [(40.0 - lateral) * angle.sin(), 40.0 - (40.0 - lateral) * angle.cos()];
            let foot = route.foot(p, 0);
            assert!((foot.lateral_m - lateral).abs() < 3e-4, "{i}: {} for {lateral}", foot.lateral_m);
            let s = foot.station as f64 + foot.fraction;
            assert!((s - 40.0 * angle).abs() < 0.01, "{i}: {s}");
            assert!((dot(foot.normal, [-angle.sin(), angle.cos()]) - 1.0).abs() < 1e-6);
        }
    }
}
