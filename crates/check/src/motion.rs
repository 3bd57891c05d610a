//! The nominal motion (proof, section 2), in four steps per station. Every unit's front coupling moves from vertex to
//! vertex of its polygon, and tan(β/2) decays by exp(−ℓ/L).
//!
//! A curve deviates from its chord by κℓ²/8. At every hitch, not only at the steer axle, this is added to the
//! coupling's deviation. With four steps per station it is 0.4 mm at a radius of 20 m.

use crate::STEPS;
use crate::chain::Chain;
use crate::link::Link;
use crate::road::Road;
use crate::vector::{along, cross, length};

/// Deviation added for rounding of the couplings' places, metres. Coordinates count from the corridor's first station.
pub(crate) const DEFECT_M: f64 = 1e-8;
/// What `led` leaves of a chord's effect on a unit, as parts of the bulge: a constant, and a part per length of the unit
/// (proof, section 2).
const LEFT: f64 = 0.03;
const LEFT_A_LENGTH: f64 = 0.2;
/// A chord shorter than this has no direction, metres.
const STANDING_M: f64 = 1e-6;
/// Largest tangent of half an angle that is followed. Beyond a quarter turn, where it is 1, nothing is bounded.
const MOST_HALF: f64 = 9.0;

/// The pose of a unit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pose {
    /// Place of the axle, metres.
    pub(crate) p: [f64; 2],
    /// Heading, a unit vector.
    pub(crate) u: [f64; 2],
}

/// One step of one unit.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Swing {
    /// The chord of the front coupling: direction, and length in metres.
    pub(crate) c: [f64; 2],
    pub(crate) len: f64,
    /// tan(δ/2) at the start and at the end of the step; it shrinks.
    pub(crate) before: f64,
    pub(crate) after: f64,
    /// Largest deviation of the coupling's curve from the chord, metres, and the curvature there.
    pub(crate) bulge: f64,
    pub(crate) curvature: f64,
}

impl Swing {
    /// tan δ and 1/cos δ from `half`, which is tan(δ/2).
    pub(crate) fn tan_sec(half: f64) -> (f64, f64) {
        let q = half * half;
        // From a quarter turn on the tangent is meaningless here.
        if q >= 1.0 { (f64::INFINITY, f64::INFINITY) } else { (2.0 * half / (1.0 - q), (1.0 + q) / (1.0 - q)) }
    }

    /// Deviation of the coupling, metres, that counts as much as what `led` leaves of the chord's effect on the unit.
    pub(crate) fn rest(&self, link: &Link) -> f64 {
        self.bulge * (LEFT + LEFT_A_LENGTH * self.len / link.l).min(1.0) + DEFECT_M
    }

    /// The pose after `share` of the step.
    pub(crate) fn pose(&self, link: &Link, from: Pose, share: f64) -> Pose {
        let coupling = [from.p[0] + link.l * from.u[0], from.p[1] + link.l * from.u[1]];
        let half = self.before * (-share * self.len / link.l).exp();
        turned(link, along(coupling, share * self.len, self.c), self.c, half)
    }
}

/// All poses at all nodes, and all steps between them. Node j is j/STEPS stations along the road.
pub(crate) struct Motion {
    pub(crate) units: usize,
    poses: Vec<Pose>,
    swings: Vec<Swing>,
}

impl Motion {
    /// The motion along the plan: `shift(s)` is in metres left of the centreline at `s` stations. The vehicle starts
    /// straight. `None` if a number is not finite.
    pub(crate) fn new(chain: &Chain, road: &Road, shift: impl Fn(f64) -> f64) -> Option<Self> {
        let units = chain.links.len();
        let nodes = (road.len() - 1) * STEPS + 1;
        let mut motion =
            Self { units, poses: Vec::with_capacity(nodes * units), swings: Vec::with_capacity((nodes - 1) * units) };
        let plan: Vec<[f64; 2]> = (0..nodes).map(|j| planned(road, &shift, j as f64 / STEPS as f64)).collect();
        let u = road.place(0.0).t;
        let mut coupling = plan[0];
        for link in &chain.links {
            let p = along(coupling, -link.l, u);
            motion.poses.push(Pose { p, u });
            coupling = along(p, -link.d, u);
        }
        for j in 1..nodes {
            motion.step(chain, plan[j - 1], plan[j])?;
        }
        motion.bulges();
        // The road's error bound applies to the plan too.
        for (k, swing) in motion.swings.iter_mut().enumerate().step_by(units) {
            swing.bulge += road.slack((k / units) as f64 / STEPS as f64);
        }
        Some(motion)
    }

    fn step(&mut self, chain: &Chain, mut from: [f64; 2], mut to: [f64; 2]) -> Option<()> {
        let first = self.poses.len() - self.units;
        for (i, link) in chain.links.iter().enumerate() {
            let Pose { p, u } = self.poses[first + i];
            let chord = [to[0] - from[0], to[1] - from[1]];
            let len = length(chord);
            let c = if len > STANDING_M { [chord[0] / len, chord[1] / len] } else { u };
            let (sin, cos) = (u[0] * c[1] - u[1] * c[0], u[0] * c[0] + u[1] * c[1]);
            // Nothing is bounded beyond a quarter turn. The motion continues for the road behind it.
            let before = (sin / (1.0 + cos)).clamp(-MOST_HALF, MOST_HALF);
            if !(len.is_finite() && before.is_finite()) {
                return None;
            }
            let after = before * (-len / link.l).exp();
            // The unit follows a curve through the vertices. Along chords alone it would turn less (proof, section 2).
            let bend = self.swings.len().checked_sub(self.units).map_or(0.0, |k| cross(self.swings[k].c, c));
            let x = len / link.l;
            let pose = led(link, to, turned(link, to, c, after).u, bend * x * x / (12.0 + 6.0 * x));
            from = along(p, -link.d, u);
            to = along(pose.p, -link.d, pose.u);
            self.poses.push(pose);
            self.swings.push(Swing { c, len, before, after, bulge: 0.0, curvature: 0.0 });
        }
        Some(())
    }

    /// Sets each step's curvature to the greater of the turns at its two ends, over its length.
    fn bulges(&mut self) {
        let turn = |a: &Swing, b: &Swing| cross(a.c, b.c).abs();
        for k in 0..self.swings.len() {
            let own = self.swings[k];
            let before = k.checked_sub(self.units).map_or(0.0, |b| turn(&self.swings[b], &own));
            let after = self.swings.get(k + self.units).map_or(0.0, |a| turn(&own, a));
            let swing = &mut self.swings[k];
            swing.curvature = before.max(after) / own.len.max(STANDING_M);
            swing.bulge = swing.curvature * own.len * own.len / 8.0 + DEFECT_M;
        }
    }

    /// Number of steps.
    pub(crate) fn steps(&self) -> usize {
        self.swings.len() / self.units
    }

    pub(crate) fn pose(&self, node: usize, unit: usize) -> Pose {
        self.poses[node * self.units + unit]
    }

    pub(crate) fn swing(&self, step: usize, unit: usize) -> &Swing {
        &self.swings[step * self.units + unit]
    }
}

/// The pose of a unit whose coupling is at `h` and moves along `c`. `half` is the tangent of half the angle between
/// them.
fn turned(link: &Link, h: [f64; 2], c: [f64; 2], half: f64) -> Pose {
    let q = 1.0 + half * half;
    let (sin, cos) = (2.0 * half / q, (1.0 - half * half) / q);
    let u = [c[0] * cos + c[1] * sin, c[1] * cos - c[0] * sin];
    Pose { p: along(h, -link.l, u), u }
}

/// The pose of a unit whose coupling is at `h` and whose heading `u` is turned by a small angle.
fn led(link: &Link, h: [f64; 2], u: [f64; 2], by: f64) -> Pose {
    let [x, y] = along(u, by, [-u[1], u[0]]);
    let size = length([x, y]);
    let u = [x / size, y / size];
    Pose { p: along(h, -link.l, u), u }
}

fn planned(road: &Road, shift: &impl Fn(f64) -> f64, s: f64) -> [f64; 2] {
    let (place, t) = road.course(s);
    along(place, shift(s), [-t[1], t[0]])
}
