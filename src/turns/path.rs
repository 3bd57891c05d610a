//! Reference paths of a turn: from one pose to another by transition, arc and transition. If the lanes only shift, the
//! path is a curve of minimal jerk.
//!
//! Every path is tangent to both centrelines and has zero curvature at its ends. `rank` and the certificate judge the
//! paths.

/// A place, and the heading there in radians from x towards y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub(super) at: [f64; 2],
    pub(super) heading: f64,
}

impl Pose {
    pub(super) fn forward(&self) -> [f64; 2] {
        let (sin, cos) = self.heading.sin_cos();
        [cos, sin]
    }
}

/// Distance between a path's points, metres.
pub(super) const STEP_M: f64 = 0.5;
/// Integration steps per point.
const FINE: usize = 8;
/// Smallest radius, metres. No vehicle of the catalogue turns more tightly.
const LEAST_RADIUS_M: f64 = 3.0;
/// Lanes that meet at a smaller angle are shifted, not turned, radians.
const LEAST_CORNER_RAD: f64 = 0.12;
/// Larger angles are U-turns, radians.
const MOST_CORNER_RAD: f64 = 2.9;
/// Largest curvature of a lane shift, 1/m.
const MOST_SHIFT_CURVATURE: f64 = 0.12;

/// Wraps an angle into −π..π.
pub(super) fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

/// The turn from `a` to `b`. Its arc has `1 − 2·share` of the angle, and each transition has `share`. It is as wide as
/// the shorter tangent allows, and straight along the rest of the longer tangent. `None` if the tangents do not meet
/// between `a` and `b`.
pub(super) fn corner(a: Pose, b: Pose, share: f64) -> Option<Vec<[f64; 2]>> {
    let turned = wrapped(b.heading - a.heading);
    if !(LEAST_CORNER_RAD..=MOST_CORNER_RAD).contains(&turned.abs()) {
        return None;
    }
    let (u, v) = (a.forward(), b.forward());
    let gap = [b.at[0] - a.at[0], b.at[1] - a.at[1]];
    let sine = u[0] * v[1] - u[1] * v[0];
    let before = (gap[0] * v[1] - gap[1] * v[0]) / sine;
    let after = (u[0] * gap[1] - u[1] * gap[0]) / sine;
    let tangent = before.min(after);
    if tangent.is_nan() || tangent <= 1.0 {
        return None;
    }
    let unit = UnitTurn::new(turned.abs(), share);
    let radius = tangent / unit.tangent;
    if radius.is_nan() || radius < LEAST_RADIUS_M {
        return None;
    }
    let mut points = straight(a.at, u, before - tangent);
    let from = *points.last()?;
    let curve = unit.points(radius);
    let sign = turned.signum();
    let (sin, cos) = a.heading.sin_cos();
    points.extend(curve.iter().skip(1).map(|p| {
        let (x, y) = (p[0], sign * p[1]);
        [from[0] + x * cos - y * sin, from[1] + x * sin + y * cos]
    }));
    let end = *points.last()?;
    let rest = straight(end, v, after - tangent);
    points.extend(rest.into_iter().skip(1));
    Some(points)
}

/// Points from `from` along `u` over `length_m`. The last point is exactly at the end.
fn straight(from: [f64; 2], u: [f64; 2], length_m: f64) -> Vec<[f64; 2]> {
    let steps = (length_m / STEP_M).round().max(0.0) as usize;
    let length_m = if steps == 0 { 0.0 } else { length_m };
    (0..=steps).map(|i| super::area::along(from, u, length_m * i as f64 / steps.max(1) as f64)).collect()
}

/// Transition, arc and transition to the left with radius 1, from the origin along x.
struct UnitTurn {
    transition: f64,
    arc: f64,
    /// Distance from the start to where the tangents at both ends meet.
    tangent: f64,
}

impl UnitTurn {
    fn new(turned: f64, share: f64) -> Self {
        // A transition from 0 to curvature 1 over length L turns by L/2.
        let mut unit = Self { transition: 2.0 * share * turned, arc: (1.0 - 2.0 * share) * turned, tangent: 0.0 };
        let end = unit.integrate(256).last().copied().unwrap_or_default();
        // The end lies at the end of the second tangent, of length `tangent`: y = tangent · sin(turned).
        unit.tangent = if turned.sin().abs() > 0.05 { end[1] / turned.sin() } else { end[0] / (1.0 + turned.cos()) };
        unit
    }

    fn length(&self) -> f64 {
        2.0 * self.transition + self.arc
    }

    fn heading(&self, s: f64) -> f64 {
        let (l, arc) = (self.transition, self.arc);
        let rising = |s: f64| if l > 0.0 { 0.5 * s * s / l } else { 0.0 };
        if s <= l {
            rising(s)
        } else if s <= l + arc {
            0.5 * l + (s - l)
        } else {
            let left = (self.length() - s).max(0.0);
            l + arc - rising(left)
        }
    }

    /// `n + 1` points, by Simpson's rule on the heading.
    fn integrate(&self, n: usize) -> Vec<[f64; 2]> {
        let h = self.length() / n as f64;
        let mut p = [0.0; 2];
        let mut out = vec![p];
        for i in 0..n {
            let s = i as f64 * h;
            for (at, weight) in [(s, 1.0), (s + 0.5 * h, 4.0), (s + h, 1.0)] {
                let (sin, cos) = self.heading(at).sin_cos();
                p = [p[0] + h / 6.0 * weight * cos, p[1] + h / 6.0 * weight * sin];
            }
            out.push(p);
        }
        out
    }

    /// Points about [`STEP_M`] apart, scaled to a radius.
    fn points(&self, radius: f64) -> Vec<[f64; 2]> {
        let steps = ((self.length() * radius / STEP_M).ceil() as usize).max(4);
        self.integrate(steps * FINE).into_iter().step_by(FINE).map(|p| [p[0] * radius, p[1] * radius]).collect()
    }
}

/// The quintic from `a` to `b` with zero curvature at its ends. `None` if it would bend as sharply as a corner.
pub(super) fn shift(a: Pose, b: Pose) -> Option<Vec<[f64; 2]>> {
    let chord = (b.at[0] - a.at[0]).hypot(b.at[1] - a.at[1]);
    let ahead = (b.at[0] - a.at[0]) * a.forward()[0] + (b.at[1] - a.at[1]) * a.forward()[1];
    if !(chord > 4.0 && ahead > 0.7 * chord && wrapped(b.heading - a.heading).abs() < 1.0) {
        return None;
    }
    let (u, v) = (a.forward(), b.forward());
    let steps = (chord / STEP_M).ceil() as usize;
    let blend = |t: f64| {
        let (t3, t4, t5) = (t * t * t, t.powi(4), t.powi(5));
        let to = 10.0 * t3 - 15.0 * t4 + 6.0 * t5;
        let leaves = t - 6.0 * t3 + 8.0 * t4 - 3.0 * t5;
        let arrives = -4.0 * t3 + 7.0 * t4 - 3.0 * t5;
        [0, 1].map(|k| a.at[k] + to * (b.at[k] - a.at[k]) + chord * (leaves * u[k] + arrives * v[k]))
    };
    let points: Vec<[f64; 2]> = (0..=steps).map(|i| blend(i as f64 / steps as f64)).collect();
    (sharpest(&points) <= MOST_SHIFT_CURVATURE).then_some(points)
}

/// Largest curvature of the circles through three successive points, 1/m.
pub(super) fn sharpest(points: &[[f64; 2]]) -> f64 {
    points.windows(3).map(|w| bend(w).abs()).fold(0.0, f64::max)
}

/// Curvature of the circle through three points, 1/m, positive left.
pub(super) fn bend(w: &[[f64; 2]]) -> f64 {
    let (a, b) = ([w[1][0] - w[0][0], w[1][1] - w[0][1]], [w[2][0] - w[1][0], w[2][1] - w[1][1]]);
    let (la, lb) = (a[0].hypot(a[1]), b[0].hypot(b[1]));
    let lc = (a[0] + b[0]).hypot(a[1] + b[1]);
    2.0 * (a[0] * b[1] - a[1] * b[0]) / (la * lb * lc).max(1e-12)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_corner_ends_where_and_as_it_shall() {
        for turned in [0.2, 0.8, FRAC_PI_2, 2.0, 2.8] {
            for sign in [1.0, -1.0] {
                let a = Pose { at: [3.0, -2.0], heading: 0.4 };
                let (before, after) = (32.0, 41.0);
                let v = super::super::area::along(a.at, a.forward(), before);
                let mut b = Pose { at: v, heading: a.heading + sign * turned };
                b.at = super::super::area::along(v, b.forward(), after);
                let points = corner(a, b, 0.25).unwrap();
                let end = points.last().unwrap();
                assert!((end[0] - b.at[0]).hypot(end[1] - b.at[1]) < 1e-3, "{turned}: {end:?} {b:?}");
                let n = points.len();
                let first = bend(&points[..3]).abs();
                assert!(first < sharpest(&points) && bend(&points[n - 3..]).abs() < sharpest(&points));
            }
        }
    }

    #[test]
    fn a_right_angle_without_transitions_is_a_quarter_of_a_circle() {
        let a = Pose { at: [0.0; 2], heading: 0.0 };
        let b = Pose { at: [12.0, 12.0], heading: FRAC_PI_2 };
        for p in corner(a, b, 0.0).unwrap() {
            assert!((p[0].hypot(p[1] - 12.0) - 12.0).abs() < 1e-4, "{p:?}");
        }
    }

    #[test]
    fn lanes_that_do_not_meet_ahead_have_no_corner() {
        let a = Pose { at: [0.0; 2], heading: 0.0 };
        assert!(corner(a, Pose { at: [-5.0, 5.0], heading: FRAC_PI_2 }, 0.2).is_none());
        assert!(corner(a, Pose { at: [20.0, 1.0], heading: 0.0 }, 0.2).is_none());
        let shifted = shift(a, Pose { at: [40.0, 2.0], heading: 0.0 }).unwrap();
        assert!(sharpest(&shifted) < 0.01);
    }
}
