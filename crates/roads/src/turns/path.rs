//! Reference paths of a turn: from one pose to another by transition, arc and transition. If the lanes only shift, the
//! path is a curve of minimal jerk.
//!
//! Every path is tangent to both centrelines and has zero curvature at its ends. The planner and the certificate judge the
//! paths.

use super::vector::along;

/// A place, and the heading there in radians from x towards y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PathPose {
    pub(super) at: [f64; 2],
    pub(super) heading: f64,
}

impl PathPose {
    pub(super) fn forward(&self) -> [f64; 2] {
        let (sin, cos) = self.heading.sin_cos();
        [cos, sin]
    }
}

/// Distance between a path's points, metres.
pub(super) const STEP_M: f64 = 0.5;
/// Shorter straight lines are points, metres.
const LEAST_STRAIGHT_M: f64 = 1e-6;
/// Simpson's steps per transition, to find where a turn ends.
const FINE: usize = 12;
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

/// The turn from `a` to `b`. Each transition has its share of the angle, and the arc has the rest. It is as wide as the
/// shorter tangent allows, and straight along the rest of the longer tangent. Points are about `step_m` apart. `None`
/// if the tangents do not meet between `a` and `b`.
pub(super) fn corner(a: PathPose, b: PathPose, shares: [f64; 2], step_m: f64) -> Option<Vec<[f64; 2]>> {
    let turned = wrapped(b.heading - a.heading);
    if !(LEAST_CORNER_RAD..=MOST_CORNER_RAD).contains(&turned.abs()) || shares[0] + shares[1] > 1.0 + 1e-9 {
        return None;
    }
    let (u, v) = (a.forward(), b.forward());
    let gap = [b.at[0] - a.at[0], b.at[1] - a.at[1]];
    let sine = u[0] * v[1] - u[1] * v[0];
    let before = (gap[0] * v[1] - gap[1] * v[0]) / sine;
    let after = (u[0] * gap[1] - u[1] * gap[0]) / sine;
    let unit = UnitTurn::new(turned.abs(), shares);
    let radius = (before / unit.tangents[0]).min(after / unit.tangents[1]);
    if radius.is_nan() || radius < LEAST_RADIUS_M {
        return None;
    }
    let mut points = straight(a.at, u, before - radius * unit.tangents[0], step_m);
    let from = *points.last()?;
    let sign = turned.signum();
    points.extend(unit.points(radius, step_m).iter().skip(1).map(|p| {
        let (x, y) = (p[0], sign * p[1]);
        [from[0] + x * u[0] - y * u[1], from[1] + x * u[1] + y * u[0]]
    }));
    let end = *points.last()?;
    let rest = straight(end, v, after - radius * unit.tangents[1], step_m);
    points.extend(rest.into_iter().skip(1));
    Some(points)
}

/// Points from `from` along `u` over `length_m`. The last point is exactly at the end, however short the line is: a path
/// that left out a few centimetres would miss the place where it goes on.
fn straight(from: [f64; 2], u: [f64; 2], length_m: f64, step_m: f64) -> Vec<[f64; 2]> {
    if length_m < LEAST_STRAIGHT_M {
        return vec![from];
    }
    let steps = (length_m / step_m).round().max(1.0);
    (0..=steps as usize).map(|i| along(from, u, length_m * i as f64 / steps)).collect()
}

/// Transition, arc and transition to the left with radius 1, from the origin along x.
struct UnitTurn {
    transitions: [f64; 2],
    arc: f64,
    /// Distances from both ends to where the tangents there meet.
    tangents: [f64; 2],
}

impl UnitTurn {
    fn new(turned: f64, shares: [f64; 2]) -> Self {
        // A transition from 0 to curvature 1 over length L turns by L/2.
        let transitions = shares.map(|share| 2.0 * share * turned);
        let arc = (turned - 0.5 * (transitions[0] + transitions[1])).max(0.0);
        let mut unit = Self { transitions, arc, tangents: [0.0; 2] };
        let mut end = [0.0; 2];
        let mut from = 0.0;
        for length in [transitions[0], arc, transitions[1]] {
            let h = length / FINE as f64;
            for i in 0..FINE {
                end = unit.step(end, from + i as f64 * h, h);
            }
            from += length;
        }
        // The end lies at the end of the second tangent: y = tangent · sin(turned).
        let (sin, cos) = turned.sin_cos();
        let second = end[1] / sin;
        unit.tangents = [end[0] - second * cos, second];
        unit
    }

    fn length(&self) -> f64 {
        self.transitions[0] + self.arc + self.transitions[1]
    }

    fn heading(&self, s: f64) -> f64 {
        let ([before, after], arc) = (self.transitions, self.arc);
        let rising = |s: f64, l: f64| if l > 0.0 { 0.5 * s * s / l } else { 0.0 };
        if s <= before {
            rising(s, before)
        } else if s <= before + arc {
            0.5 * before + (s - before)
        } else {
            let left = (self.length() - s).max(0.0);
            0.5 * (before + after) + arc - rising(left, after)
        }
    }

    /// The place a length `h` on from `p` at `s`, by Simpson's rule on the heading.
    fn step(&self, p: [f64; 2], s: f64, h: f64) -> [f64; 2] {
        [(s, 1.0), (s + 0.5 * h, 4.0), (s + h, 1.0)].into_iter().fold(p, |p, (at, weight)| {
            let (sin, cos) = self.heading(at).sin_cos();
            [p[0] + h / 6.0 * weight * cos, p[1] + h / 6.0 * weight * sin]
        })
    }

    /// Points about `step_m` apart, scaled to a radius.
    fn points(&self, radius: f64, step_m: f64) -> Vec<[f64; 2]> {
        let steps = ((self.length() * radius / step_m).ceil() as usize).max(4);
        let h = self.length() / steps as f64;
        let mut p = [0.0; 2];
        let mut out = Vec::with_capacity(steps + 1);
        out.push(p);
        for i in 0..steps {
            for half in [0.0, 0.5] {
                p = self.step(p, (i as f64 + half) * h, 0.5 * h);
            }
            out.push([p[0] * radius, p[1] * radius]);
        }
        out
    }
}

/// The quintic from `a` to `b` with zero curvature at its ends. `None` if it would bend as sharply as a corner.
pub(super) fn shift(a: PathPose, b: PathPose, step_m: f64) -> Option<Vec<[f64; 2]>> {
    let chord = (b.at[0] - a.at[0]).hypot(b.at[1] - a.at[1]);
    let ahead = (b.at[0] - a.at[0]) * a.forward()[0] + (b.at[1] - a.at[1]) * a.forward()[1];
    if !(chord > 4.0 && ahead > 0.7 * chord && wrapped(b.heading - a.heading).abs() < 1.0) {
        return None;
    }
    let (u, v) = (a.forward(), b.forward());
    let steps = (chord / step_m).ceil() as usize;
    let blend = |t: f64| {
        let (t3, t4, t5) = (t * t * t, t * t * t * t, t * t * t * t * t);
        let to = 10.0 * t3 - 15.0 * t4 + 6.0 * t5;
        let leaves = t - 6.0 * t3 + 8.0 * t4 - 3.0 * t5;
        let arrives = -4.0 * t3 + 7.0 * t4 - 3.0 * t5;
        [0, 1].map(|k| a.at[k] + to * (b.at[k] - a.at[k]) + chord * (leaves * u[k] + arrives * v[k]))
    };
    let points: Vec<[f64; 2]> = (0..=steps).map(|i| blend(i as f64 / steps as f64)).collect();
    (sharpest(&points) <= MOST_SHIFT_CURVATURE).then_some(points)
}

/// The cubic between two places with directions.
pub(super) fn hermite([p, q]: [[f64; 2]; 2], [u, v]: [[f64; 2]; 2], chord: f64, t: f64) -> [f64; 2] {
    let (t2, t3) = (t * t, t * t * t);
    let to = 3.0 * t2 - 2.0 * t3;
    [0, 1].map(|i| p[i] + to * (q[i] - p[i]) + chord * ((t - 2.0 * t2 + t3) * u[i] + (t3 - t2) * v[i]))
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
            for (sign, shares) in [(1.0, [0.25; 2]), (-1.0, [0.25; 2]), (1.0, [0.1, 0.5]), (-1.0, [0.6, 0.3])] {
                let a = PathPose { at: [3.0, -2.0], heading: 0.4 };
                let (before, after) = (32.0, 41.0);
                let v = along(a.at, a.forward(), before);
                let mut b = PathPose { at: v, heading: a.heading + sign * turned };
                b.at = along(v, b.forward(), after);
                let points = corner(a, b, shares, STEP_M).unwrap();
                let end = points.last().unwrap();
                assert!((end[0] - b.at[0]).hypot(end[1] - b.at[1]) < 1e-3, "{turned}: {end:?} {b:?}");
                let n = points.len();
                let first = bend(&points[..3]).abs();
                assert!(first < sharpest(&points) && bend(&points[n - 3..]).abs() < sharpest(&points));
            }
        }
    }

    #[test]
    fn a_corner_with_a_short_straight_line_ends_where_it_shall() {
        let a = PathPose { at: [0.0; 2], heading: 0.0 };
        for unequal_m in [0.001, 0.05, 0.1, 0.2, 0.24, 0.26] {
            for tangents in [[20.0 + unequal_m, 20.0], [20.0, 20.0 + unequal_m]] {
                let b = PathPose { at: tangents, heading: FRAC_PI_2 };
                let points = corner(a, b, [0.2; 2], STEP_M).unwrap();
                let end = points.last().unwrap();
                assert!((end[0] - b.at[0]).hypot(end[1] - b.at[1]) < 1e-3, "{tangents:?}: {end:?}");
            }
        }
    }

    #[test]
    fn a_right_angle_without_transitions_is_a_quarter_of_a_circle() {
        let a = PathPose { at: [0.0; 2], heading: 0.0 };
        let b = PathPose { at: [12.0, 12.0], heading: FRAC_PI_2 };
        for p in corner(a, b, [0.0; 2], STEP_M).unwrap() {
            assert!((p[0].hypot(p[1] - 12.0) - 12.0).abs() < 1e-4, "{p:?}");
        }
    }

    #[test]
    fn lanes_that_do_not_meet_ahead_have_no_corner() {
        let a = PathPose { at: [0.0; 2], heading: 0.0 };
        assert!(corner(a, PathPose { at: [-5.0, 5.0], heading: FRAC_PI_2 }, [0.2; 2], STEP_M).is_none());
        assert!(corner(a, PathPose { at: [20.0, 1.0], heading: 0.0 }, [0.2; 2], STEP_M).is_none());
        let shifted = shift(a, PathPose { at: [40.0, 2.0], heading: 0.0 }, STEP_M).unwrap();
        assert!(sharpest(&shifted) < 0.01);
    }
}
