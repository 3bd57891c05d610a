//! One unit's step: what it adds to the bounds of the unit ahead (docs/proof.md, sections 3 and 5).

use super::lanes::Vector;
use super::model::MAX_UNITS;

/// Bounds beyond this (metres, radians) bound nothing any more.
pub(super) const MOST: f64 = 100.0;
/// Largest curvature of a coupling's path times the coupling's deviation.
const CURLED: f64 = 0.8;

/// Largest angle between a unit's heading and its axle's motion (docs/proof.md, A3). The series of the tangent needs it.
const MOST_SLIP_RAD: f64 = 0.6;
/// In the series of tan x − x, this many x⁷ cover all terms from 17x⁷/315 on, up to [`MOST_SLIP_RAD`].
const TANGENT_SEVENTH: f64 = 0.07;
/// Each growth of a bound is less than the one before. This many times the last one covers the rest of a series that at least halves, and a
/// little more.
const REST_OF_SERIES: f64 = 1.5;
/// Stands for the way of a vehicle that does not move in a denominator, metres.
const NO_WAY_M: f64 = 1e-12;

/// Constants of one unit across the vehicles. A vehicle without this unit has a harmless stand-in.
#[derive(Clone, Copy)]
pub(super) struct UnitLanes<V> {
    /// 1 where the vehicle has this unit, else 0.
    pub(super) present: V,
    pub(super) length: V,
    pub(super) inverse_length: V,
    /// L + d
    pub(super) reach: V,
    /// |d|
    pub(super) hitch: V,
    /// d/L
    pub(super) ratio: V,
    pub(super) sway: V,
    pub(super) max_articulation: V,
    /// At the group's γ, on the straight: bounds of heading error, axle deviation and (hinge by hinge) coupling
    /// deviation.
    pub(super) heading: V,
    pub(super) axle: V,
    pub(super) coupling: V,
    /// What the second order adds to `axle` on a straight.
    pub(super) settled: V,
}

/// One unit's step, as its tubes need it.
#[derive(Clone, Copy)]
pub(super) struct Step<V> {
    pub(super) moved: V,
    /// Arc length of the axle, metres.
    pub(super) advance: V,
    /// |sin|, cos, |tan| and 1/cos of the angle from the heading to the chord, before the step.
    pub(super) sine: V,
    pub(super) cosine: V,
    pub(super) tangent: V,
    pub(super) secant: V,
    /// tan δ halfway through the step, signed.
    pub(super) mid_tangent: V,
    pub(super) hitch_cosine: V,
    pub(super) path_curvature: V,
    /// Assumed deviation of the coupling for what [`chord_lag`] leaves, metres.
    pub(super) chord_rest: V,
}

impl<V: Vector> Step<V> {
    pub(super) const NONE: Step<V> = Step {
        moved: V::ZERO,
        advance: V::ZERO,
        sine: V::ZERO,
        cosine: V::ZERO,
        tangent: V::ZERO,
        secant: V::ZERO,
        mid_tangent: V::ZERO,
        hitch_cosine: V::ZERO,
        path_curvature: V::ZERO,
        chord_rest: V::ZERO,
    };

    /// A metre straight on.
    pub(super) const STRAIGHT: Step<V> =
        Step { moved: V::ONE, advance: V::ONE, cosine: V::ONE, secant: V::ONE, hitch_cosine: V::ONE, ..Self::NONE };
}

/// The recursion of what curvature adds (docs/proof.md, section 5) over one step, front to rear.
pub(super) struct Filter<V> {
    /// E − E⁰ of the next coupling.
    pub(super) coupling: V,
    hitch_cosine: V,
    /// 1 over the reference arc length, which is halfway between the fastest axle's and the slowest axle's.
    per_reference: V,
}

/// Bounds at a unit's coupling in a step.
pub(super) struct Coupled<V> {
    /// Y − Y⁰ when the step begins.
    y: V,
    /// Ẽ − E⁰
    pub(super) extra: V,
    /// A
    pub(super) heading: V,
}

impl<V: Vector> Filter<V> {
    #[inline(always)]
    pub(super) fn begin(chain: &[UnitLanes<V>], steps: &[Step<V>; MAX_UNITS]) -> Self {
        let (mut least, mut most) = (steps[0].advance, steps[0].advance);
        for (step, of) in steps.iter().zip(chain).skip(1) {
            // A stand-in must not count: a certificate depends on no other vehicle of the group.
            let advance = steps[0].advance + of.present * (step.advance - steps[0].advance);
            least = least.min(advance);
            most = most.max(advance);
        }
        Self {
            coupling: chord_bulge(&steps[0]),
            hitch_cosine: V::splat(1.0),
            per_reference: V::splat(2.0) / (least + most).max(V::splat(NO_WAY_M)),
        }
    }

    /// `y` is the unit's Y − Y⁰ when the step begins.
    #[inline(always)]
    pub(super) fn coupled(&self, of: &UnitLanes<V>, step: &Step<V>, y: V) -> Coupled<V> {
        // η: relative growth of the coupling's deviation against the straight.
        let eta = (step.secant - 1.0).max((self.hitch_cosine * step.secant - 1.0).abs());
        let extra = (self.coupling + eta * (of.coupling + self.coupling)).min(V::splat(MOST));
        let heading = (of.heading + (extra + y) * of.inverse_length).min(V::splat(MOST));
        Coupled { y, extra, heading }
    }

    /// Y − Y⁰ at the end of the step, from the remainder z.
    #[inline(always)]
    pub(super) fn grown(&self, of: &UnitLanes<V>, step: &Step<V>, coupled: &Coupled<V>, z: V) -> V {
        let rho = (step.advance * self.per_reference - 1.0).abs();
        let input = coupled.extra + z + rho * of.length * (coupled.heading + of.sway);
        // y' = (input − y)/L. Growth uses the coupling's arc length, decay the axle's, which is shorter.
        let (pn, pd) = decay(step.moved * of.inverse_length);
        let change = (input - coupled.y) * (V::splat(1.0) - pn / pd);
        (coupled.y + change.max(change * step.cosine.max(V::ZERO))).min(V::splat(MOST))
    }

    /// Continues at the next coupling.
    #[inline(always)]
    pub(super) fn pass_on(&mut self, of: &UnitLanes<V>, step: &Step<V>, coupled: &Coupled<V>, y: V, zh: V) {
        let next = (of.ratio + 1.0).abs() * y + of.ratio.abs() * coupled.extra + zh;
        self.coupling = next.min(V::splat(MOST));
        self.hitch_cosine = step.hitch_cosine;
    }

    /// A unit's whole step with known second order and bounded heading. Returns Y − Y⁰ at its end.
    #[inline(always)]
    pub(super) fn step(&mut self, of: &UnitLanes<V>, step: &Step<V>, mut coupled: Coupled<V>, a: V, z: V, zh: V) -> V {
        coupled.heading = coupled.heading.min(a);
        let coupled = &coupled;
        let extra = self.grown(of, step, coupled, z);
        self.pass_on(of, step, coupled, coupled.y.max(extra), zh);
        extra
    }
}

/// Share of the chords' turn by which a unit turns less along chords than along the curve through their ends. `x` is
/// chord over unit length. The share is x²/12 with its next order (docs/proof.md, section 2).
#[inline(always)]
pub(super) fn chord_lag<V: Vector>(x: V) -> V {
    x * x / (x * 6.0 + 12.0)
}

/// Largest distance of the plan from its chord, κℓ²/8: the plan is a smooth curve through the vertices.
#[inline(always)]
pub(super) fn chord_bulge<V: Vector>(step: &Step<V>) -> V {
    step.path_curvature * step.moved * step.moved * 0.125
}

/// Second-order remainders of the coupling's relation (R1) and of the axle's motion (z). `a` bounds the heading, `axle`
/// the axle's deviation, `coupled` the coupling's deviation over cos δ.
#[inline(always)]
pub(super) fn remainder<V: Vector>(of: &UnitLanes<V>, step: &Step<V>, a: V, axle: V, coupled: V) -> (V, V) {
    let r1 = coupling_remainder(of, step, a, axle, coupled);
    let slip = a + of.sway;
    let slip3 = slip_tangent_excess(slip);
    (r1, r1 + step.tangent * axle * (slip + slip3) + of.length * slip3)
}

/// R1 alone. `y + Lα` equals the coupling's deviation, except for the remainder itself.
#[inline(always)]
fn coupling_remainder<V: Vector>(of: &UnitLanes<V>, step: &Step<V>, a: V, axle: V, coupled: V) -> V {
    let a2 = a * a;
    let lean = of.length * a;
    let own = step.tangent * of.length * a2 * 0.5 + of.length * a2 * a * (1.0 / 6.0);
    let across = axle + lean;
    let nearer = across.min(coupled + bent(step, own, lean * a, across));
    bent(step, own, lean * a, nearer)
}

/// R1 of a coupling that deviates by `across`, from the part `own` without the bend of its path.
#[inline(always)]
fn bent<V: Vector>(step: &Step<V>, own: V, lean_a: V, across: V) -> V {
    let swing = across * step.sine + lean_a * 0.5;
    own + step.path_curvature * step.secant * swing * swing * 0.5
}

/// A bound of the heading with R1 (`L α = e/cos δ − y + R`), from its first-order bound. The second value is negative
/// if the bound does not reproduce itself.
#[inline(always)]
pub(super) fn heading<V: Vector>(of: &UnitLanes<V>, step: &Step<V>, first_order: V, axle: V, coupled: V) -> (V, V) {
    let first = implied_heading(of, step, first_order, axle, coupled);
    let second = implied_heading(of, step, first_order + first, axle, coupled);
    let third = implied_heading(of, step, first_order + second, axle, coupled);
    let more = third + (third - second) * REST_OF_SERIES;
    let bound = first_order + more;
    (bound.min(V::splat(MOST)), more - implied_heading(of, step, bound, axle, coupled))
}

/// What R1 adds to a heading that is bounded by `a`.
#[inline(always)]
fn implied_heading<V: Vector>(of: &UnitLanes<V>, step: &Step<V>, a: V, axle: V, coupled: V) -> V {
    coupling_remainder(of, step, a.min(V::splat(MOST)), axle, coupled) * of.inverse_length
}

/// Second-order remainder of the next coupling, with the foot shift against its follower.
#[inline(always)]
pub(super) fn hitch_remainder<V: Vector>(
    of: &UnitLanes<V>,
    step: &Step<V>,
    follower: Option<(&UnitLanes<V>, &Step<V>)>,
    a: V,
    axle: V,
    r1: V,
    straying: &Straying<V>,
) -> V {
    let ratio = of.ratio.abs();
    let hitch_tangent = step.tangent * ratio;
    let hitch_sine = hitch_tangent * step.hitch_cosine;
    let reach = axle + of.hitch * a;
    let swing = reach * hitch_sine;
    let own = ratio * r1
        + hitch_sine * of.hitch * a * a * 0.5
        + step.path_curvature.max(step.tangent * of.inverse_length) * swing * swing * 0.5;
    let Some((next, behind)) = follower else { return own };
    own + behind.chord_rest
        + reach * (behind.tangent + hitch_tangent) * (straying.slope + straying.rough * next.inverse_length * 2.0)
}

/// How fast a coupling's deviation may change along its path: the slope of the part that has passed through axles, and
/// the size of the steer axle's deviation that has passed through none.
#[derive(Clone, Copy)]
pub(super) struct Straying<V> {
    slope: V,
    rough: V,
}

impl<V: Vector> Straying<V> {
    #[inline(always)]
    pub(super) fn of_the_steer_axle(rough: V) -> Self {
        Self { slope: V::ZERO, rough }
    }

    #[inline(always)]
    pub(super) fn next(self, of: &UnitLanes<V>, step: &Step<V>, a: V) -> Self {
        let through = of.ratio.abs() * step.secant;
        Self { slope: (of.ratio + 1.0).abs() * (a + of.sway) + through * self.slope, rough: through * self.rough }
    }
}

/// Negative where the bounds do not hold. They hold while |δ| + A + σ < 90°, so cos δ > sin(A + σ), and while A + σ ≤
/// [`MOST_SLIP_RAD`], which the series of the tangent needs. They hold while the coupling's deviation is less than the radius of its path;
/// beyond, the deviating coupling would turn back. [`CURLED`] leaves room for what the path bends more between stations.
#[inline(always)]
pub(super) fn validity<V: Vector>(of: &UnitLanes<V>, step: &Step<V>, a: V, coupling: V) -> V {
    let slip = a + of.sway;
    (step.cosine - slip).min(V::splat(MOST_SLIP_RAD) - slip).min(V::splat(CURLED) - step.path_curvature * coupling)
}

/// Largest heading difference of a path between a unit's own foot and its coupling's foot, if the coupling deviates by
/// `coupling`.
#[inline(always)]
pub(super) fn foot_shift<V: Vector>(of: &UnitLanes<V>, step: &Step<V>, coupling: V) -> V {
    coupling * step.sine * step.tangent * of.inverse_length
}

/// Margin to the limit of the hinge ahead of a unit, less nominal articulation (`joint`), heading errors and foot
/// shifts.
#[inline(always)]
pub(super) fn hinge_margin<V: Vector>(of: &UnitLanes<V>, joint: V, ahead: V, own_shift: V) -> V {
    of.max_articulation - joint - ahead - own_shift
}

/// exp(−x) as a fraction, by the square of the Padé form (3,3) at x/2. The error is 3e-8 at x = 0.8; the form is
/// monotone up to x = 9.
#[inline(always)]
pub(super) fn decay<V: Vector>(x: V) -> (V, V) {
    let x = x * 0.5;
    let x2 = x * x;
    let even = x2 * 12.0 + 120.0;
    let odd = x * (x2 + 60.0);
    let (n, d) = (even - odd, even + odd);
    (n * n, d * d)
}

/// tan x − x for 0 ≤ x ≤ [`MOST_SLIP_RAD`], never too small.
#[inline(always)]
fn slip_tangent_excess<V: Vector>(x: V) -> V {
    let x2 = x * x;
    x * x2 * ((x2 * TANGENT_SEVENTH + 2.0 / 15.0) * x2 + 1.0 / 3.0)
}
