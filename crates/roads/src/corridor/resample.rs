//! From a centreline and a profile about it to stations at uniform arc length.
//!
//! The corridor's centreline is an offset curve of the way's line, as the profile says. Heading and curvature come from
//! derivatives in closed form, not from differences of positions.

use super::Corridor;
use super::profile::MIDDLE;
use super::spline::{Cubics, Interpolant, Jet};
use crate::watch;

/// Below this factor 1 − κ·o the offset curve is about to fold, and the edge is unknown.
pub(crate) const LEAST_OFFSET_FACTOR: f64 = 0.3;

/// Most stations of a corridor from a given line: a metre apart, round the earth and more.
pub(crate) const MOST_STATIONS: f64 = 5e7;

/// A plane curve over a parameter.
pub(crate) trait Curve {
    /// Position and derivatives.
    fn at(&self, u: f64) -> Jet<2>;

    /// First and second derivative.
    fn bend(&self, u: f64) -> [[f64; 2]; 2] {
        let [_, first, second, _] = self.at(u);
        [first, second]
    }

    /// Within steps of this length arc length is nearly a cubic of the parameter, metres.
    fn step_m(&self) -> f64;
}

impl Curve for Cubics<2> {
    fn at(&self, u: f64) -> Jet<2> {
        self.at(u)
    }

    fn bend(&self, u: f64) -> [[f64; 2]; 2] {
        self.bend(u)
    }

    /// Where the line follows a sharp corner, knots are close, and the speed changes within a metre.
    fn step_m(&self) -> f64 {
        (0.25 * self.knot_m()).clamp(0.5, 1.0)
    }
}

impl Curve for Interpolant {
    fn at(&self, u: f64) -> Jet<2> {
        self.at(u)
    }

    fn step_m(&self) -> f64 {
        0.5
    }
}

/// A parametrised curve with edges across it.
pub(crate) struct EdgedCurve<'c, C> {
    /// Position and derivatives of the curve.
    pub(crate) curve: &'c C,
    /// Edges and centreline across the curve, over the same parameter.
    pub(crate) profile: &'c Cubics<3>,
}

/// One point of the corridor's centreline.
#[derive(Debug, Clone, Copy)]
struct Point {
    position: [f64; 2],
    /// Derivative of the position by the parameter.
    velocity: [f64; 2],
    curvature: f64,
    left_m: f64,
    right_m: f64,
}

impl<C: Curve> EdgedCurve<'_, C> {
    /// The offset curve is C = c + o·n, with t and n the unit tangent and normal of c. Let v = |c′| be the speed, a =
    /// v(1 − κo) and b = o′. Then C′ = a·t + b·n and C″ = (a′ − bκv)·t + (aκv + b′)·n.
    fn at(&self, u: f64) -> Point {
        let [p, d1, d2, d3] = self.curve.at(u);
        let [[left, right, o], [.., b], [.., b1], _] = self.profile.at(u);
        let speed = (d1[0] * d1[0] + d1[1] * d1[1]).sqrt().max(1e-9);
        let t = [d1[0] / speed, d1[1] / speed];
        let speed1 = t[0] * d2[0] + t[1] * d2[1];
        let kappa = (t[0] * d2[1] - t[1] * d2[0]) / (speed * speed);
        let kappa1 = (t[0] * d3[1] - t[1] * d3[0]) / (speed * speed) - 3.0 * kappa * speed1 / speed;
        let a = speed * (1.0 - kappa * o);
        let a1 = speed1 * (1.0 - kappa * o) - speed * (kappa1 * o + kappa * b);
        let squared = a * a + b * b;
        let turning = a * (a * kappa * speed + b1) - b * (a1 - b * kappa * speed);
        Point {
            position: [p[0] - o * t[1], p[1] + o * t[0]],
            velocity: [a * t[0] - b * t[1], a * t[1] + b * t[0]],
            curvature: turning / (squared * squared.sqrt()).max(1e-12),
            left_m: left - o,
            right_m: o - right,
        }
    }

    fn speed(&self, u: f64) -> f64 {
        let [d1, d2] = self.curve.bend(u);
        let [o, b] = self.profile.component(MIDDLE, u);
        let squared = (d1[0] * d1[0] + d1[1] * d1[1]).max(1e-18);
        let speed = squared.sqrt();
        let kappa = (d1[0] * d2[1] - d1[1] * d2[0]) / (squared * speed);
        let along = speed * (1.0 - kappa * o);
        (along * along + b * b).sqrt()
    }

    /// Stations about `spacing_m` apart for parameters `from..=to`, and the arc length at steps of the parameter. A curve with too many
    /// of them, or without a length, has stations that are not finite.
    pub(crate) fn resample(&self, from: f64, to: f64, spacing_m: f64) -> (Corridor, ArcLength) {
        let arc = ArcLength::measure(from, to, self.curve.step_m(), |u| self.speed(u));
        let stations = arc.total() / spacing_m;
        let usable = stations <= 2.0 * MOST_STATIONS;
        let steps = if usable { (stations.round() as usize).max(1) } else { 1 };
        let n = steps + 1;
        let spacing_m = if usable { arc.total() / steps as f64 } else { f64::NAN };
        let mut c = Corridor {
            spacing_m,
            x: Vec::with_capacity(n),
            y: Vec::with_capacity(n),
            heading: Vec::with_capacity(n),
            curvature: Vec::with_capacity(n),
            left_m: Vec::with_capacity(n),
            right_m: Vec::with_capacity(n),
            areas: Vec::new(),
        };
        let (mut hint, mut heading) = (0, 0.0_f64);
        let mut before = [1.0, 0.0];
        for i in 0..n {
            watch::poll();
            let p = self.at(arc.parameter(i as f64 * spacing_m, &mut hint));
            let v = p.velocity;
            // The turn since the last station, so that the heading never jumps by 2π.
            heading += (before[0] * v[1] - before[1] * v[0]).atan2(before[0] * v[0] + before[1] * v[1]);
            before = v;
            c.x.push(p.position[0]);
            c.y.push(p.position[1]);
            c.heading.push(heading);
            c.curvature.push(p.curvature);
            c.left_m.push(p.left_m);
            c.right_m.push(p.right_m);
        }
        (c, arc)
    }
}

/// Arc length as a function of a parameter, and its inverse, from a table ([`Curve::step_m`]). Stations at a wrong arc length would not
/// follow from each other.
#[derive(Debug, Clone)]
pub(crate) struct ArcLength {
    from: f64,
    step: f64,
    /// Arc length and speed at the nodes.
    nodes: Vec<(f64, f64)>,
}

impl ArcLength {
    fn measure(from: f64, to: f64, step_m: f64, speed: impl Fn(f64) -> f64) -> Self {
        let steps = (((to - from) / step_m).ceil() as usize).max(1);
        let step = (to - from) / steps as f64;
        let mut before = speed(from);
        let mut nodes = Vec::with_capacity(steps + 1);
        nodes.push((0.0, before));
        let mut sum = 0.0;
        for i in 1..=steps {
            watch::poll();
            let u = from + i as f64 * step;
            let (middle, end) = (speed(u - 0.5 * step), speed(u));
            sum += step / 6.0 * (before + 4.0 * middle + end);
            nodes.push((sum, end));
            before = end;
        }
        Self { from, step, nodes }
    }

    pub(crate) fn total(&self) -> f64 {
        self.nodes.last().map_or(0.0, |n| n.0)
    }

    /// Arc length at a parameter, by the cubic with the table's values and speeds.
    pub(crate) fn at(&self, u: f64) -> f64 {
        let scaled = ((u - self.from) / self.step).clamp(0.0, (self.nodes.len() - 1) as f64);
        let i = (scaled as usize).min(self.nodes.len() - 2);
        let (a, b) = (self.nodes[i], self.nodes[i + 1]);
        hermite(scaled - i as f64, a.0, b.0, a.1 * self.step, b.1 * self.step)
    }

    /// Parameter at an arc length. `hint` moves forward with it.
    pub(crate) fn parameter(&self, s: f64, hint: &mut usize) -> f64 {
        while *hint + 2 < self.nodes.len() && self.nodes[*hint + 1].0 <= s {
            *hint += 1;
        }
        let (a, b) = (self.nodes[*hint], self.nodes[*hint + 1]);
        let length = b.0 - a.0;
        let along = (s - a.0) / length.max(1e-12);
        let inner = hermite(along, 0.0, self.step, length / a.1.max(1e-9), length / b.1.max(1e-9));
        self.from + *hint as f64 * self.step + inner.clamp(0.0, self.step)
    }
}

/// The cubic on 0..=1 with the given end values and slopes.
fn hermite(t: f64, from: f64, to: f64, slope_from: f64, slope_to: f64) -> f64 {
    let chord = to - from;
    from + t * (chord + (1.0 - t) * ((1.0 - t) * (slope_from - chord) - t * (slope_to - chord)))
}

#[cfg(test)]
mod tests {
    use super::super::profile::Profile;
    use super::*;

    /// A straight curve over 0..=1 of any length.
    struct Straight(f64);

    impl Curve for Straight {
        fn at(&self, u: f64) -> Jet<2> {
            [[u * self.0, 0.0], [self.0, 0.0], [0.0; 2], [0.0; 2]]
        }

        fn step_m(&self) -> f64 {
            0.5
        }
    }

    #[test]
    fn a_curve_without_a_usable_length_has_two_stations_that_are_not_finite() {
        let profile = Profile { knot_m: 1.0, coefficients: vec![[1.0, -1.0, 0.0]; 4] }.cubics();
        let stations =
            |length_m| EdgedCurve { curve: &Straight(length_m), profile: &profile }.resample(0.0, 1.0, 1.0).0;
        let usual = stations(200.0);
        assert!(usual.len() == 201 && usual.x.iter().all(|x| x.is_finite()));
        for length_m in [1e9, 1e18, f64::INFINITY, f64::NAN] {
            let corridor = stations(length_m);
            assert!(corridor.len() == 2 && corridor.x.iter().all(|x| !x.is_finite()), "{length_m}");
        }
    }
}
