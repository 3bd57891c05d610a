//! The nominal motion (proof, section 2), in four steps a station: every unit's front coupling goes from vertex to vertex
//! of its polygon, and tan(β/2) decays by exp(−ℓ/L).
//!
//! Four steps, because a curve leaves its chord by κℓ²/8, which is added to what the coupling may be off – at every
//! hitch, not just at the steer axle: at quarter stations that is 0.4 mm at 20 m of radius.

use crate::chain::{Chain, Link};
use crate::road::Road;

/// Steps a station.
pub(crate) const STEPS: usize = 4;
/// More slip than the vehicle's own, for what rounding does to headings: they are right to 1e-13 a step of a centimetre and more.
pub(crate) const DEFECT_RAD: f64 = 1e-9;
/// The same for places of couplings, metres: coordinates count from the corridor's first station.
pub(crate) const DEFECT_M: f64 = 1e-8;

/// Where a unit stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pose {
    /// Its axle.
    pub(crate) p: [f64; 2],
    /// Its heading.
    pub(crate) u: [f64; 2],
}

/// One step of one unit.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Swing {
    /// The chord of its front coupling: direction and length.
    pub(crate) c: [f64; 2],
    pub(crate) len: f64,
    /// tan(δ/2) when it begins and when it ends; it shrinks.
    pub(crate) before: f64,
    pub(crate) after: f64,
    /// Most by which the coupling's curve leaves the chord, metres, and its curvature there.
    pub(crate) bulge: f64,
    pub(crate) curvature: f64,
}

impl Swing {
    /// tan δ and 1/cos δ for a half-angle's tangent.
    pub(crate) fn tan_sec(half: f64) -> (f64, f64) {
        let q = half * half;
        // A quarter turn and more has no tangent that means anything here.
        if q >= 1.0 { (f64::INFINITY, f64::INFINITY) } else { (2.0 * half / (1.0 - q), (1.0 + q) / (1.0 - q)) }
    }

    /// How much a unit behind another is led astray by its chord, as if its coupling were so far off, metres: `led` leaves that of the bulge.
    pub(crate) fn rest(&self, link: &Link) -> f64 {
        self.bulge * (0.03 + 0.2 * self.len / link.l).min(1.0) + DEFECT_M
    }

    /// The pose after `share` of the step.
    pub(crate) fn pose(&self, link: &Link, from: Pose, share: f64) -> Pose {
        let coupling = [from.p[0] + link.l * from.u[0], from.p[1] + link.l * from.u[1]];
        let half = self.before * (-share * self.len / link.l).exp();
        turned(link, along(coupling, share * self.len, self.c), self.c, half)
    }
}

/// All poses at all nodes and all steps between them; node j is j/STEPS stations along the road.
pub(crate) struct Motion {
    pub(crate) units: usize,
    poses: Vec<Pose>,
    swings: Vec<Swing>,
}

impl Motion {
    /// The motion along the plan: `shift(s)` metres left of the centreline at `s` stations. The vehicle begins straight.
    /// `None` where it is no motion (a number that is none).
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
        // Where the road itself may be off, so may the plan.
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
            let len = chord[0].hypot(chord[1]);
            let c = if len > 1e-6 { [chord[0] / len, chord[1] / len] } else { u };
            let (sin, cos) = (u[0] * c[1] - u[1] * c[0], u[0] * c[0] + u[1] * c[1]);
            // Beyond a quarter turn nothing is bounded; the motion goes on, for the road behind it.
            let before = (sin / (1.0 + cos)).clamp(-9.0, 9.0);
            if !(len.is_finite() && before.is_finite()) {
                return None;
            }
            let after = before * (-len / link.l).exp();
            // The unit follows a curve through the vertices; by its chords alone it turns less (proof, section 2).
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

    /// A step's curvature is the greater of the turns at its two ends, over its length.
    fn bulges(&mut self) {
        let turn = |a: &Swing, b: &Swing| cross(a.c, b.c).abs();
        for k in 0..self.swings.len() {
            let own = self.swings[k];
            let before = k.checked_sub(self.units).map_or(0.0, |b| turn(&self.swings[b], &own));
            let after = self.swings.get(k + self.units).map_or(0.0, |a| turn(&own, a));
            let swing = &mut self.swings[k];
            swing.curvature = before.max(after) / own.len.max(1e-6);
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

/// A unit whose coupling is at `h` and moves along `c`, at an angle of which `half` is the tangent of the half.
fn turned(link: &Link, h: [f64; 2], c: [f64; 2], half: f64) -> Pose {
    let q = 1.0 + half * half;
    let (sin, cos) = (2.0 * half / q, (1.0 - half * half) / q);
    let u = [c[0] * cos + c[1] * sin, c[1] * cos - c[0] * sin];
    Pose { p: along(h, -link.l, u), u }
}

/// A unit whose coupling is at `h`, its heading `u` turned on by a small angle.
fn led(link: &Link, h: [f64; 2], u: [f64; 2], by: f64) -> Pose {
    let [x, y] = along(u, by, [-u[1], u[0]]);
    let length = x.hypot(y);
    let u = [x / length, y / length];
    Pose { p: along(h, -link.l, u), u }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn along(p: [f64; 2], by: f64, u: [f64; 2]) -> [f64; 2] {
    [p[0] + by * u[0], p[1] + by * u[1]]
}

fn planned(road: &Road, shift: &impl Fn(f64) -> f64, s: f64) -> [f64; 2] {
    let place = road.place(s);
    along(place.c, shift(s), [-place.t[1], place.t[0]])
}
