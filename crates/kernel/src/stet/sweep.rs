//! One sweep of a group of vehicles along a track: nominal motion and curved tubes with vehicles in lanes, then leeway
//! at the body points with stations in lanes (design sections 3 to 5; the layout is the one measured to be fastest).
//!
//! Promises: no leeway left here is above what any bounded disturbance leaves, up to the model of the design page. Knows
//! nothing of edges, corrections or shrinking.

use super::adjoint::{self, Refined, Trail, first_loose};
use super::body::{self, Body, Feet};
use super::group::{Group, UnitLanes};
use super::lanes::{LANES, V, by_instruction_set, select_negative};
use super::leeway;
use super::model::MAX_UNITS;
use super::track::{Extensions, Track};
use netcert_base::stop::{Stop, Stopped};

/// Head stations a block.
pub(super) const BLOCK: usize = 32;
/// Blocks behind a bend in which the filter still has much of it.
const FADING_BLOCKS: usize = 3;
/// Hinge margin where the bounds' recursion does not close.
pub(super) const NOT_CLOSED_RAD: f64 = -9.0;
/// What the motion hands to the points: one row a field.
pub(super) const FIELDS: usize = 11;
/// Bounds beyond this (metres, radians) bound nothing any more.
pub(super) const MOST: f64 = 100.0;
/// Leeway at a station that no body point visits.
pub(super) const UNVISITED_M: f64 = 1e9;

/// Least leeways and margins at every extended station, for one vehicle.
#[derive(Debug, Clone, Default)]
pub(super) struct Minima {
    /// Tagged (see [`super::lanes::V::tagged`]) with `unit · 16 + point`.
    pub(super) left: Vec<f64>,
    pub(super) right: Vec<f64>,
    /// The same of sides between two of their points, at marked stations only.
    pub(super) mark_left: Vec<f64>,
    pub(super) mark_right: Vec<f64>,
    /// Least hinge margin by station of the steer axle, radians, tagged with the unit.
    pub(super) hinge: Vec<f64>,
    /// By station of the steer axle: first and last station under any body point.
    pub(super) under: Vec<[u32; 2]>,
    /// Lateral distance of the last axle from the steer path, metres.
    pub(super) offset: Vec<f64>,
    /// By block of head stations: the first unit for which the adjoint is worth its time there.
    pub(super) loose: Vec<usize>,
}

impl Minima {
    fn new(stations: usize) -> Self {
        Self {
            left: vec![UNVISITED_M; stations],
            right: vec![UNVISITED_M; stations],
            mark_left: vec![UNVISITED_M; stations],
            mark_right: vec![UNVISITED_M; stations],
            hinge: vec![UNVISITED_M; stations],
            under: vec![[u32::MAX, 0]; stations],
            offset: vec![0.0; stations],
            loose: vec![usize::MAX; stations / BLOCK + 2],
        }
    }

    /// Of a sweep that was told to stop: nothing fits anywhere, so that whoever does not ask is not told that something does.
    fn lost(stations: usize) -> Self {
        let mut lost = Self::new(stations);
        (0..stations).for_each(|k| lost.lose(k));
        lost
    }

    fn lose(&mut self, k: usize) {
        self.hinge[k] = V::splat(NOT_CLOSED_RAD).tagged(0).0[0];
        [self.left[k], self.right[k]] = [V::splat(body::LOST_M).tagged(0).0[0]; 2];
    }

    /// The stations under a body point at eight stations of the steer axle, from `head` on.
    #[inline(always)]
    pub(super) fn pass(&mut self, head: usize, feet: Feet) {
        for (lane, [first, last]) in self.under[head..head + LANES].iter_mut().enumerate() {
            let foot = feet.station(lane) as u32;
            (*first, *last) = ((*first).min(foot), (*last).max(foot));
        }
    }

    /// A bend counts for some blocks that follow it, too: what the filter has gathered in it takes as long to fade.
    fn note_loose(&mut self, head: usize, first: usize) {
        for block in self.loose.iter_mut().skip(head / BLOCK).take(1 + FADING_BLOCKS) {
            *block = first.min(*block);
        }
    }
}

/// Vehicles up to this length and front overhang get the same extensions, so the same bits, beside whichever others: sums
/// that run along the track round differently from another start. The longest of the catalogue has 52 m and 3 m.
const LEAST_LENGTH_M: f64 = 56.0;
const LEAST_FRONT_M: f64 = 4.0;

/// How far the group's vehicles are taken to reach behind and ahead of their steer axles, metres.
pub(super) fn reach_m(group: &Group<'_>) -> (f64, f64) {
    (group.length().max(LEAST_LENGTH_M), group.front().max(LEAST_FRONT_M))
}

/// Extensions that a track needs before and after the corridor for this group.
pub(super) fn extensions(group: &Group<'_>, spacing: f64) -> Extensions {
    let slack = (BLOCK + 2 * LANES) as f64 * spacing;
    let (length, front_m) = reach_m(group);
    Extensions { lead_m: length + front_m + slack, tail_m: length + 2.0 * front_m + 2.0 * slack + 10.0, front_m }
}

/// Which leeways a sweep is to give, by vehicle and head station: a vehicle's are left out while its head is in a block
/// that is not wanted, and come from the adjoint in one that is to be refined.
pub(super) struct Wanted<'w> {
    pub(super) blocks: &'w dyn Fn(usize, usize) -> bool,
    /// The first unit to be refined.
    pub(super) refined: Option<&'w dyn Fn(usize, usize) -> usize>,
    /// Without `CERTIFY`: not even the straight gains deducted.
    pub(super) plain: bool,
}

impl Wanted<'_> {
    /// Everything, by the filter alone.
    pub(super) const ALL: Wanted<'static> = Wanted { blocks: &|_, _| true, refined: None, plain: false };
    /// What is left of everything when nothing disturbs.
    pub(super) const PLAIN: Wanted<'static> = Wanted { plain: true, ..Self::ALL };
}

/// Sweeps the steer path `shift` (metres left of the centreline at each extended station, vehicles in lanes).
/// `CERTIFY`: all bounds deducted, hinges checked; otherwise the nominal leeway of a few points less their
/// straight gains, for planning. Asks at each block whether to stop; then everything is lost.
pub(super) fn sweep<const CERTIFY: bool>(
    track: &Track,
    group: &Group<'_>,
    shift: &[V],
    wanted: &Wanted<'_>,
    stop: &Stop,
) -> Vec<Minima> {
    let swept = match wanted.refined {
        Some(refined) if CERTIFY => sweep_blocks::<CERTIFY, true>(track, group, shift, wanted, refined, stop),
        _ => sweep_blocks::<CERTIFY, false>(track, group, shift, wanted, &|_, _| usize::MAX, stop),
    };
    swept.unwrap_or_else(|_| vec![Minima::lost(track.len()); group.models.len()])
}

fn sweep_blocks<const CERTIFY: bool, const REFINE: bool>(
    track: &Track,
    group: &Group<'_>,
    shift: &[V],
    wanted: &Wanted<'_>,
    refined: &dyn Fn(usize, usize) -> usize,
    stop: &Stop,
) -> Result<Vec<Minima>, Stopped> {
    let mut minima = vec![Minima::new(track.len()); group.models.len()];
    let mut rows = vec![0.0; group.units * LANES * FIELDS * BLOCK];
    let mut motion = Motion::new(track, group);
    let mut trail = Trail::new(group, REFINE);
    let mut tight = Refined::new();
    let mut bodies: Vec<Vec<Body>> =
        group.models.iter().map(|m| body::bodies::<CERTIFY>(m, track, group.shrink)).collect();
    if wanted.plain && !CERTIFY {
        bodies.iter_mut().flatten().for_each(Body::forget_gains);
    }
    // The rear of the longest vehicle has left the corridor when the head is this far beyond.
    let ahead = ((group.front() + 4.0) / track.spacing).ceil() as usize + LANES;
    let last = track.len() - ahead - BLOCK;
    let mut head = track.first_head;
    while head < last {
        stop.check()?;
        drive::<CERTIFY, REFINE>(&mut motion, track, group, shift, head, &mut rows, &mut trail);
        for (lane, (bodies, minima)) in bodies.iter_mut().zip(&mut minima).enumerate() {
            let wanted = (wanted.blocks)(lane, head);
            let tight_from = if REFINE && wanted { refined(lane, head) } else { usize::MAX };
            if tight_from < bodies.len() {
                adjoint::refine(&mut trail, group, lane, tight_from, &mut motion, &mut rows, &mut tight);
            }
            if REFINE {
                trail.close(lane, bodies.len());
            }
            if !wanted {
                bodies.iter_mut().for_each(|body| body::skip(track, body, head));
                continue;
            }
            if CERTIFY && !REFINE {
                minima.note_loose(head, first_loose(group, lane, &rows));
            }
            for (unit, body) in bodies.iter_mut().enumerate() {
                let start = (unit * LANES + lane) * FIELDS * BLOCK;
                let block = &rows[start..start + FIELDS * BLOCK];
                if unit >= tight_from {
                    leeway::points::<CERTIFY, true>(track, body, block, tight.unit(unit), shift, lane, head, minima);
                } else {
                    leeway::points::<CERTIFY, false>(track, body, block, &[], shift, lane, head, minima);
                }
            }
        }
        head += BLOCK;
    }
    for (bodies, minima) in bodies.iter().zip(&mut minima) {
        bodies.iter().for_each(|body| body::finish(track, body, minima));
        track.torn.iter().for_each(|&k| minima.lose(k));
    }
    Ok(minima)
}

/// State of the chain between two head stations, vehicles in lanes.
pub(super) struct Motion {
    heading_x: [V; MAX_UNITS],
    heading_y: [V; MAX_UNITS],
    /// Last displacement of each front coupling, over its length.
    along_x: [V; MAX_UNITS],
    along_y: [V; MAX_UNITS],
    /// Last turn of each front coupling's chord, radians.
    bend: [V; MAX_UNITS],
    /// Last heading change of each unit, radians.
    turned: [V; MAX_UNITS],
    turned_change: [V; MAX_UNITS],
    /// Last change of each hinge's angle, radians, and how much that differed from the one before.
    folding: [V; MAX_UNITS],
    folding_change: [V; MAX_UNITS],
    /// What curvature adds to the bound on each axle's deviation.
    pub(super) extra: [V; MAX_UNITS],
}

/// One unit's step, as far as its tubes need it.
#[derive(Clone, Copy)]
pub(super) struct Step {
    pub(super) moved: V,
    /// Arc length of the axle.
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
    /// By how much the coupling is taken to be off, metres, for what [`chord_lag`] leaves.
    pub(super) chord_rest: V,
}

impl Step {
    pub(super) const NONE: Step = Step {
        moved: ZERO,
        advance: ZERO,
        sine: ZERO,
        cosine: ZERO,
        tangent: ZERO,
        secant: ZERO,
        mid_tangent: ZERO,
        hitch_cosine: ZERO,
        path_curvature: ZERO,
        chord_rest: ZERO,
    };

    /// A metre straight on.
    pub(super) const STRAIGHT: Step =
        Step { moved: ONE, advance: ONE, cosine: ONE, secant: ONE, hitch_cosine: ONE, ..Self::NONE };
}

pub(super) const ZERO: V = V([0.0; LANES]);
const ONE: V = V([1.0; LANES]);

by_instruction_set! {
    /// Drives [`BLOCK`] stations from `head` and leaves every unit's rows.
    pub(super) fn drive<const CERTIFY: bool, const REFINE: bool>(
        motion: &mut Motion,
        track: &Track,
        group: &Group<'_>,
        shift: &[V],
        head: usize,
        rows: &mut [f64],
        trail: &mut Trail,
    ) {
        if REFINE {
            trail.enter(&motion.extra);
        }
        let mut place = steer(track, shift, head);
        let mut next = steer(track, shift, head + 1);
        for k in 0..BLOCK {
            let after = steer(track, shift, head + k + 2);
            motion.station::<CERTIFY, REFINE>(group, [place, next, after], track.spacing, k, rows, trail);
            (place, next) = (next, after);
        }
    }
}

impl Motion {
    /// All units stand behind the steer axle's first station, along the corridor's first heading; they have come straight.
    #[inline(always)]
    pub(super) fn new(track: &Track, group: &Group<'_>) -> Self {
        let (x, y) = (V::splat(track.fields.tangent_x[track.lead]), V::splat(track.fields.tangent_y[track.lead]));
        Self {
            heading_x: [x; MAX_UNITS],
            heading_y: [y; MAX_UNITS],
            along_x: [x; MAX_UNITS],
            along_y: [y; MAX_UNITS],
            bend: [ZERO; MAX_UNITS],
            turned: [ZERO; MAX_UNITS],
            turned_change: [ZERO; MAX_UNITS],
            folding: [ZERO; MAX_UNITS],
            folding_change: [ZERO; MAX_UNITS],
            extra: std::array::from_fn(|unit| group.chain[unit].settled),
        }
    }

    /// One head station: rows of every unit there, then the step to the next. `plan`: the steer axle's place there, and at the
    /// next two.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // One call, in the innermost loop: a struct would be taken apart at once.
    fn station<const CERTIFY: bool, const REFINE: bool>(
        &mut self,
        group: &Group<'_>,
        plan: [(V, V); 3],
        spacing: f64,
        k: usize,
        rows: &mut [f64],
        trail: &mut Trail,
    ) {
        let [place, next, after] = plan;
        let (mut x, mut y) = place;
        let (mut vx, mut vy) = (next.0 - place.0, next.1 - place.1);
        // The plan may bend more after the step than before it, at the corridor's first station most of all.
        let (later_x, later_y) = (after.0 - next.0, after.1 - next.1);
        let mut bend_after = (vx * later_y - vy * later_x).abs() / (vx * vx + vy * vy + 1e-30);
        let mut steps = [Step::NONE; MAX_UNITS];
        let mut joints = [ZERO; MAX_UNITS];
        let (mut ahead_x, mut ahead_y) = (ZERO, ZERO);
        let mut turned_ahead = ZERO;
        for unit in 0..group.units {
            let of = &group.chain[unit];
            let (ux, uy) = (self.heading_x[unit], self.heading_y[unit]);
            // Axle, then the next coupling.
            x = x - ux * of.length;
            y = y - uy * of.length;
            let mut store = |field: usize, value: V| store(rows, unit, field, k, value);
            store(row::X, x);
            store(row::Y, y);
            store(row::UX, ux);
            store(row::UY, uy);
            x = x - ux * (of.reach - of.length);
            y = y - uy * (of.reach - of.length);

            // The exact chord step: N/D = tan(β/2)·exp(−ℓ/L).
            let sine = ux * vy - uy * vx;
            let cosine = ux * vx + uy * vy;
            let moved = (vx * vx + vy * vy + 1e-30).sqrt();
            let (pn, pd) = decay(moved * of.inverse_length);
            let n = sine * pn;
            let d = (moved + cosine).max(V::splat(1e-12)) * pd;
            let (nn, dd, nd2) = (n * n, d * d, n * d * 2.0);
            let norm = V::splat(1.0) / ((nn + dd) * moved);
            let (c, s) = ((dd - nn) * norm, nd2 * norm);
            let (mut wx, mut wy) = (vx * c + vy * s, vy * c - vx * s);
            if CERTIFY {
                let inverse = V::splat(1.0) / (moved * (moved + cosine));
                let half_tangent = if unit == 0 {
                    sine.abs() * (inverse * moved)
                } else {
                    let cross = (ahead_x * uy - ahead_y * ux).abs();
                    let dot = ahead_x * ux + ahead_y * uy;
                    cross / (dot + 1.0).max(V::splat(1e-12))
                };
                let bounded = cosine.max(moved * 0.05);
                let both = V::splat(1.0) / (moved * bounded);
                let (inverse_moved, inverse_cosine) = (bounded * both, moved * both);
                let tangent = sine * inverse_cosine;
                let hitch_tangent = tangent * of.ratio;
                let (ax, ay) = (vx * inverse_moved, vy * inverse_moved);
                let bend = self.along_x[unit] * ay - self.along_y[unit] * ax;
                // What a curve turns the unit more than its chords do.
                let lengths = moved * of.inverse_length;
                let more = bend * chord_lag(lengths);
                let swerve = (bend - self.bend[unit]).abs();
                self.bend[unit] = bend;
                (wx, wy) = (wx - more * wy, wy + more * wx);
                let after = vx * wx + vy * wy;
                let mid_tangent = if REFINE { (sine + wx * vy - wy * vx) / (cosine + after) } else { ZERO };
                steps[unit] = Step {
                    moved,
                    advance: (cosine + after) * 0.5,
                    mid_tangent,
                    sine: sine.abs() * inverse_moved,
                    cosine: cosine * inverse_moved,
                    tangent: tangent.abs(),
                    secant: moved * inverse_cosine,
                    hitch_cosine: V::splat(1.0) / (hitch_tangent * hitch_tangent + 1.0).sqrt(),
                    path_curvature: bend.abs().max(bend_after) * inverse_moved,
                    chord_rest: moved * (bend.abs() * (lengths * 0.025 + 0.004) + swerve * (1.0 / 24.0))
                        + bend * bend * (sine.abs() * inverse_moved * of.length * (1.0 / 24.0)),
                };
                bend_after = ZERO;
                self.along_x[unit] = ax;
                self.along_y[unit] = ay;
                let turned = ux * wy - uy * wx;
                // The plan's chord has turned at the station, the unit ahead during the step.
                let folding = if unit == 0 { bend - self.turned[0] } else { turned_ahead - turned };
                joints[unit] = double_atan(half_tangent) + self.overshoot(unit, folding);
                turned_ahead = turned;
                let change = (turned - self.turned[unit]).abs();
                store(row::CURVATURE, tangent * of.inverse_length);
                store(row::WAY2, steps[unit].advance * steps[unit].advance);
                store(row::JERK, change.max(self.turned_change[unit]) * (1.0 / (spacing * spacing)));
                self.turned[unit] = turned;
                self.turned_change[unit] = change;
            }
            (ahead_x, ahead_y) = (ux, uy);
            vx = vx - of.reach * (wx - ux);
            vy = vy - of.reach * (wy - uy);
            self.heading_x[unit] = wx;
            self.heading_y[unit] = wy;
        }
        if CERTIFY {
            self.tubes::<REFINE>(group, &steps, &joints, k, rows, trail);
        }
    }

    /// By how much a hinge may fold farther between two head stations than at either: an eighth of the change's change, and what sines
    /// of a step's turn are short of its angle.
    #[inline(always)]
    fn overshoot(&mut self, unit: usize, folding: V) -> V {
        let change = (folding - self.folding[unit]).abs();
        let most = change.max(self.folding_change[unit]);
        self.folding[unit] = folding;
        self.folding_change[unit] = change;
        most * 0.14
    }

    /// What curvature adds to the straight gains (design section 4, "Curved part and remainder"), and hinge margins.
    #[inline(always)]
    fn tubes<const REFINE: bool>(
        &mut self,
        group: &Group<'_>,
        steps: &[Step; MAX_UNITS],
        joints: &[V; MAX_UNITS],
        k: usize,
        rows: &mut [f64],
        trail: &mut Trail,
    ) {
        let one = V::splat(1.0);
        let bulge = chord_bulge(&steps[0]);
        let mut filter = Filter::begin(group, steps);
        let mut straying = Straying::of_the_steer_axle(group.tolerance + bulge);
        let (mut heading_ahead, mut shift_ahead) = (group.course, ZERO);
        // Negative from the first unit on whose bounds do not close.
        let mut closed = one;
        if REFINE {
            trail.begin(k, steps, joints, group.tolerance + bulge);
        }
        for unit in 0..group.units {
            let of = &group.chain[unit];
            let step = &steps[unit];
            let y = self.extra[unit];
            let mut coupled = filter.coupled(of, step, y);
            let axle = of.axle + y;
            let coupling = of.coupling + coupled.extra;
            let (a, short) = heading(of, step, coupled.heading, axle, coupling);
            coupled.heading = a;
            let extra_coupling = coupled.extra;
            let (r1, z) = remainder(of, step, a, axle, coupling);
            let extra = filter.grown(of, step, &coupled, z);
            // Where it does not close, nothing is certified while the vehicle stands here; a vehicle that is certified further
            // on did not come through here, so that its bounds begin anew, as after a straight. A stand-in closes: it is nobody's.
            closed = closed.min(select_negative(of.present - V::splat(0.5), one, validity(of, step, a).min(short)));
            self.extra[unit] = select_negative(closed, of.settled, extra);
            let y = y.max(extra);

            let mut store = |field: usize, value: V| store(rows, unit, field, k, value);
            store(row::EXTRA_AXLE, select_negative(closed, V::splat(MOST), y));
            store(row::EXTRA_COUPLING, extra_coupling);
            store(row::REMAINDER, r1 * of.inverse_length);
            let own_shift = foot_shift(of, step, of.coupling + extra_coupling);
            let margin = hinge_margin(
                of,
                joints[unit],
                heading_ahead + a + shift_ahead,
                if unit == 0 { ZERO } else { own_shift },
            );
            store(row::HINGE, select_negative(closed, V::splat(NOT_CLOSED_RAD), margin));
            (heading_ahead, shift_ahead) = (a, own_shift);

            // On to the next coupling.
            straying = straying.next(of, step, a);
            let follower = (unit + 1 < group.units).then(|| (&group.chain[unit + 1], &steps[unit + 1]));
            let zh = hitch_remainder(of, step, follower, a, axle, r1, &straying);
            if REFINE {
                trail.record(group, unit, step, z, zh, of.axle + y, closed);
            }
            filter.pass_on(of, step, &coupled, y, zh);
            filter.coupling = select_negative(closed, ZERO, filter.coupling);
        }
    }
}

/// The recursion of what curvature adds (docs/proof.md, section 5) over one step, front to rear.
pub(super) struct Filter {
    /// Beyond the straight bound, of the next coupling.
    pub(super) coupling: V,
    hitch_cosine: V,
    /// 1 over the arc length halfway between the fastest axle's and the slowest's: paces are counted against that.
    per_reference: V,
}

/// A unit's coupling in a step.
pub(super) struct Coupled {
    /// Y − Y⁰ when the step begins.
    y: V,
    /// Ẽ − E⁰
    extra: V,
    /// A
    heading: V,
}

impl Filter {
    #[inline(always)]
    pub(super) fn begin(group: &Group<'_>, steps: &[Step; MAX_UNITS]) -> Self {
        let (mut least, mut most) = (steps[0].advance, steps[0].advance);
        for (step, of) in steps.iter().zip(&group.chain).take(group.units).skip(1) {
            // A stand-in must not count: a certificate depends on no other vehicle of the group.
            let advance = steps[0].advance + of.present * (step.advance - steps[0].advance);
            least = least.min(advance);
            most = most.max(advance);
        }
        Self {
            coupling: chord_bulge(&steps[0]),
            hitch_cosine: V::splat(1.0),
            per_reference: V::splat(2.0) / (least + most).max(V::splat(1e-12)),
        }
    }

    /// `y`: Y − Y⁰ of the unit when the step begins.
    #[inline(always)]
    pub(super) fn coupled(&self, of: &UnitLanes, step: &Step, y: V) -> Coupled {
        // η: how much more than on the straight the coupling's deviation counts.
        let eta = (step.secant - 1.0).max((self.hitch_cosine * step.secant - 1.0).abs());
        let extra = (self.coupling + eta * (of.coupling + self.coupling)).min(V::splat(MOST));
        let heading = (of.heading + (extra + y) * of.inverse_length).min(V::splat(MOST));
        Coupled { y, extra, heading }
    }

    /// Y − Y⁰ at the step's end, with z.
    #[inline(always)]
    fn grown(&self, of: &UnitLanes, step: &Step, coupled: &Coupled, z: V) -> V {
        let rho = (step.advance * self.per_reference - 1.0).abs();
        let input = coupled.extra + z + rho * of.length * (coupled.heading + of.sway);
        // y' = (input − y)/L: grow by the coupling's arc length, decay by the axle's, which is the shorter.
        let (pn, pd) = decay(step.moved * of.inverse_length);
        let change = (input - coupled.y) * (V::splat(1.0) - pn / pd);
        (coupled.y + change.max(change * step.cosine.max(ZERO))).min(V::splat(MOST))
    }

    /// On to the next coupling.
    #[inline(always)]
    fn pass_on(&mut self, of: &UnitLanes, step: &Step, coupled: &Coupled, y: V, zh: V) {
        let next = (of.ratio + 1.0).abs() * y + of.ratio.abs() * coupled.extra + zh;
        self.coupling = next.min(V::splat(MOST));
        self.hitch_cosine = step.hitch_cosine;
    }

    /// A unit's whole step, its second order known and its heading bounded: Y − Y⁰ at its end.
    #[inline(always)]
    pub(super) fn step(&mut self, of: &UnitLanes, step: &Step, mut coupled: Coupled, a: V, z: V, zh: V) -> V {
        coupled.heading = coupled.heading.min(a);
        let coupled = &coupled;
        let extra = self.grown(of, step, coupled, z);
        self.pass_on(of, step, coupled, coupled.y.max(extra), zh);
        extra
    }
}

/// What a unit turns less along chords than along the curve through their ends, a part of the chords' own turn, the chord being `x` of
/// its lengths: x²/12 and its next order (docs/proof.md, section 2).
#[inline(always)]
fn chord_lag(x: V) -> V {
    x * x / (x * 6.0 + 12.0)
}

/// The plan is a smooth curve through the vertices: it leaves the chord by κℓ²/8 at most.
#[inline(always)]
pub(super) fn chord_bulge(step: &Step) -> V {
    step.path_curvature * step.moved * step.moved * 0.125
}

/// Second-order remainders at bounds `a` of the heading, `axle` of the axle's deviation and `coupled` of the coupling's over cos δ: of the
/// coupling's relation (R1), and of the axle's motion (z).
#[inline(always)]
pub(super) fn remainder(of: &UnitLanes, step: &Step, a: V, axle: V, coupled: V) -> (V, V) {
    let a2 = a * a;
    let lean = of.length * a;
    let own = step.tangent * of.length * a2 * 0.5 + of.length * a2 * a * (1.0 / 6.0);
    let bent = |across: V| {
        let swing = across * step.sine + lean * a * 0.5;
        own + step.path_curvature * step.secant * swing * swing * 0.5
    };
    // y + Lα is what the coupling is off, but for the remainder itself.
    let across = axle + lean;
    let r1 = bent(across.min(coupled + bent(across)));
    let slip = a + of.sway;
    let slip3 = slip_tangent_excess(slip);
    (r1, r1 + step.tangent * axle * (slip + slip3) + of.length * slip3)
}

/// A bound of the heading, R1 included (`L α = e/cos δ − y + R`), from what it is without; negative in the second place where that
/// does not bear itself out.
#[inline(always)]
pub(super) fn heading(of: &UnitLanes, step: &Step, first_order: V, axle: V, coupled: V) -> (V, V) {
    let with = |more: V| (first_order + more).min(V::splat(MOST));
    let implied = |more: V| remainder(of, step, with(more), axle, coupled).0 * of.inverse_length;
    let first = implied(ZERO);
    let second = implied(first);
    let third = implied(second);
    // Each growth is less than the one before: the rest of a series that halves, and a little.
    let more = third + (third - second) * 1.5;
    (with(more), more - implied(more))
}

/// Second-order remainder of the next coupling, the foot shift against its follower included.
#[inline(always)]
pub(super) fn hitch_remainder(
    of: &UnitLanes,
    step: &Step,
    follower: Option<(&UnitLanes, &Step)>,
    a: V,
    axle: V,
    r1: V,
    straying: &Straying,
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

/// How fast a coupling's deviation may change along its path: the slope of what has passed through axles, and how much of
/// the steer axle's deviation has passed through none.
#[derive(Clone, Copy)]
pub(super) struct Straying {
    slope: V,
    rough: V,
}

impl Straying {
    #[inline(always)]
    pub(super) fn of_the_steer_axle(rough: V) -> Self {
        Self { slope: ZERO, rough }
    }

    #[inline(always)]
    pub(super) fn next(self, of: &UnitLanes, step: &Step, a: V) -> Self {
        let through = of.ratio.abs() * step.secant;
        Self { slope: (of.ratio + 1.0).abs() * (a + of.sway) + through * self.slope, rough: through * self.rough }
    }
}

/// Negative where the bounds do not hold: valid while |δ| + A + σ < 90°, so cos δ > sin(A + σ), and the series of the
/// tangent needs A + σ ≤ 0.6.
#[inline(always)]
pub(super) fn validity(of: &UnitLanes, step: &Step, a: V) -> V {
    let slip = a + of.sway;
    (step.cosine - slip).min(V::splat(0.6) - slip)
}

/// By how much the heading of a path may differ between a unit's own foot and its coupling's, `coupling` off.
#[inline(always)]
pub(super) fn foot_shift(of: &UnitLanes, step: &Step, coupling: V) -> V {
    coupling * step.sine * step.tangent * of.inverse_length
}

/// What is left to the limit of the hinge ahead of a unit: nominal articulation (`joint`), heading errors, foot shifts.
#[inline(always)]
pub(super) fn hinge_margin(of: &UnitLanes, joint: V, ahead: V, own_shift: V) -> V {
    of.max_articulation - joint - ahead - own_shift
}

/// Rows of a unit's block.
pub(super) mod row {
    /// Axle position and heading.
    pub(crate) const X: usize = 0;
    pub(crate) const Y: usize = 1;
    pub(crate) const UX: usize = 2;
    pub(crate) const UY: usize = 3;
    /// Curvature of the axle's path, signed.
    pub(crate) const CURVATURE: usize = 4;
    /// Change of the heading rate, 1/m².
    pub(crate) const JERK: usize = 5;
    /// Y − Y⁰ and Ẽ − E⁰ of the design page.
    pub(crate) const EXTRA_AXLE: usize = 6;
    pub(crate) const EXTRA_COUPLING: usize = 7;
    /// R1/L
    pub(crate) const REMAINDER: usize = 8;
    pub(crate) const HINGE: usize = 9;
    /// Square of the way of the axle over the step, m²: behind a hitch that swings it is more than the spacing's.
    pub(crate) const WAY2: usize = 10;
}

/// Spreads a value of vehicles in lanes to the vehicles' own rows.
#[inline(always)]
fn store(rows: &mut [f64], unit: usize, field: usize, k: usize, value: V) {
    for lane in 0..LANES {
        rows[((unit * LANES + lane) * FIELDS + field) * BLOCK + k] = value.0[lane];
    }
}

/// The steer path at an extended station.
#[inline(always)]
fn steer(track: &Track, shift: &[V], k: usize) -> (V, V) {
    let f = &track.fields;
    let q = shift[k];
    (V::splat(f.x[k]) - q * f.tangent_y[k], V::splat(f.y[k]) + q * f.tangent_x[k])
}

/// exp(−x) as a fraction, by the square of the Padé form (3,3) at x/2: 3e-8 at x = 0.8, monotone to x = 9.
#[inline(always)]
pub(super) fn decay(x: V) -> (V, V) {
    let x = x * 0.5;
    let x2 = x * x;
    let even = x2 * 12.0 + 120.0;
    let odd = x * (x2 + 60.0);
    let (n, d) = (even - odd, even + odd);
    (n * n, d * d)
}

/// tan x − x for 0 ≤ x ≤ 0.6, never too small.
#[inline(always)]
fn slip_tangent_excess(x: V) -> V {
    let x2 = x * x;
    x * x2 * ((x2 * 0.07 + 2.0 / 15.0) * x2 + 1.0 / 3.0)
}

/// 2·atan t for 0 ≤ t ≤ 1, never too small (Abramowitz and Stegun 4.4.47, error 1e-5, and an allowance of twice that); beyond
/// 1, an angle over 90°, four radians, which no hinge allows.
#[inline(always)]
fn double_atan(t: V) -> V {
    let t2 = t * t;
    let p = t * ((((t2 * 0.020_835_1 - 0.085_133_0) * t2 + 0.180_141_0) * t2 - 0.330_299_5) * t2 + 0.999_866_0);
    select_negative(V::splat(1.0) - t, V::splat(4.0), p * 2.0 + 4e-5)
}
