//! Leeway at the body points (docs/proof.md, section 7), for eight consecutive head stations at a time.
//!
//! The plain distance to the edge is reduced by the tube of the point, by its second-order terms, by what may happen
//! between two body points (inside of a curve), and by what may happen between two head stations.

use super::block::{BLOCK, FIELDS, Feet, LOST_M, Minima, row};
use super::body::{Body, NEAR_M, Seen, Spot, follow, foot, least, least as least_of, narrow, near, next_foot, place};
use super::lanes::{LANES, Vector, by_instruction_set, tagged};
use super::plane;
use super::track::{BULGE_MOST, Fields, READ_M, Track};

/// Where half-widths bulge, a side between two body points is examined in parts no longer than this, metres. At a
/// radius of 16 m the sagitta of a part is 2 cm.
const PART_M: f64 = 1.4;
/// The feet of a side's places are not spaced as evenly as the places. A place and its foot may therefore lie at
/// different shares of the way between two points. The difference is at most `UNEVEN` on a straight. A bend adds
/// `UNEVEN_ASIDE` times the lateral distance and `UNEVEN_ALONG` times the gap, both times the curvature. If the ratio
/// of road to side is outside `EVEN_ENOUGH`, any share is possible.
const UNEVEN: f64 = 0.05;
const UNEVEN_ASIDE: f64 = 0.5;
const UNEVEN_ALONG: f64 = 0.15;
const EVEN_ENOUGH: std::ops::Range<f64> = 0.75..1.35;
/// Over parallels that bend more than this (1/m), parts are no longer than `BENT_PART_M`.
const BENT: f64 = 0.08;
const BENT_PART_M: f64 = 0.9;
/// A gap between two body points that costs more than this is covered in parts, metres.
const SAG_M: f64 = 0.03;
/// If half-widths leave their own slope by less than this (per metre and per square metre), they are read at the
/// station of the axis.
const ROUGH: f64 = 0.01;

/// The states of a unit at eight head stations.
struct States<V> {
    x: V,
    y: V,
    ux: V,
    uy: V,
    curvature: V,
    jerk: V,
    way2: V,
    extra_axle: V,
    extra_coupling: V,
    remainder: V,
}

/// A body point at eight head stations, before it lowers the minima.
struct Sample<V> {
    feet: Feet,
    tag: u64,
    /// Leeway at the point, and leeway reduced by what may happen next to the point.
    left: V,
    right: V,
    lowered_left: V,
    lowered_right: V,
    curvature: V,
    /// Curvature of the corridor's parallels through the point's left and right side, 1/m.
    parallel: [V; 2],
    bulge: V,
    /// The place on the axis relative to its foot's station, along the corridor and across it.
    along: V,
    lateral: V,
}

by_instruction_set! {
    /// Lowers `minima` by all points of one unit over one block. With `REFINED`, `refined` holds a block of bounds per
    /// body point, which replace the gains and what curvature adds to them.
    #[allow(clippy::too_many_arguments)] // One call per unit and block, in the second innermost loop.
    pub(super) fn points<V, const CERTIFY: bool, const REFINED: bool>(
        track: &Track,
        body: &mut Body,
        block: &[f64],
        refined: &[f64],
        shift: &[f64],
        head: usize,
        minima: &mut Minima,
    ) {
        let mut alone = false;
        for group in 0..BLOCK / LANES {
            let first = head + group * LANES;
            if track.areas.touch(first - 1, first + LANES) {
                alone = track.areas.replace(first, first + LANES - 1);
                plane::pass::<CERTIFY, REFINED>(track, body, block, refined, head, first, alone, minima);
            } else {
                alone = false;
            }
            let load = |field: usize| -> V {
                let start = field * BLOCK + group * LANES;
                let mut out = [0.0; LANES];
                out.copy_from_slice(&block[start..start + LANES]);
                V::from(out)
            };
            let s = States {
                x: load(row::X),
                y: load(row::Y),
                ux: load(row::UX),
                uy: load(row::UY),
                curvature: load(row::CURVATURE),
                jerk: load(row::JERK),
                way2: load(row::WAY2),
                extra_axle: load(row::EXTRA_AXLE),
                extra_coupling: load(row::EXTRA_COUPLING),
                remainder: load(row::REMAINDER),
            };
            if alone {
                if CERTIFY && let Some(axle) = &mut body.last_axle {
                    axle.follow(track, [s.x, s.y], shift, minima);
                }
                continue;
            }
            let mut before: Option<Sample<V>> = None;
            let bounds = |index: usize| -> V {
                let start = index * BLOCK + group * LANES;
                V::from(std::array::from_fn(|i| refined[start + i]))
            };
            let mut knots = Knots { ahead: V::ZERO, own: V::ZERO, behind: V::ZERO, gap_ahead: 0.0, gap_behind: 0.0 };
            for index in 0..body.points.len() {
                if REFINED {
                    let next = index + 1 < body.points.len();
                    knots = Knots {
                        ahead: knots.own,
                        own: if index == 0 { bounds(0) } else { knots.behind },
                        behind: if next { bounds(index + 1) } else { V::ZERO },
                        gap_ahead: body.points[index].gap,
                        gap_behind: if next { body.points[index + 1].gap } else { 0.0 },
                    };
                }
                let mut sample = sample::<V, CERTIFY, REFINED>(track, body, index, &s, &knots);
                body.points[index].cover(sample.feet, minima);
                if CERTIFY {
                    minima.pass(head + group * LANES, sample.feet);
                    match &mut before {
                        Some(before) => {
                            let gap = body.points[index].gap;
                            let parts = if bulges(before, &sample) {
                                (gap / part_m(before, &sample)).ceil().max(1.0)
                            } else {
                                1.0
                            };
                            if parts == 1.0 && gap > PART_M && sags(before, &sample, &s, gap) {
                                piecewise::<V, REFINED>(track, body, index, &s, &knots, (before, &mut sample), minima);
                            } else {
                                if parts > 1.0 {
                                    inside::<V, REFINED>(track, body, index, &s, &knots, (before, &sample), parts, minima);
                                } else {
                                    at_marks(track, (before, &sample), &s, gap, minima);
                                }
                                between_points(before, &mut sample, &s, gap, parts);
                            }
                        }
                        None => {
                            let heads = Feet::Run(head + group * LANES);
                            lower(&mut minima.hinge, heads, load(row::HINGE).tagged(sample.tag));
                        }
                    }
                }
                if let Some(before) = before.replace(sample) {
                    before.lower(minima);
                }
            }
            if let Some(last) = before {
                last.lower(minima);
            }
            if CERTIFY && let Some(axle) = &mut body.last_axle {
                axle.follow(track, [s.x, s.y], shift, minima);
            }
        }
        if let Some(axle) = &mut body.last_axle {
            axle.foot = axle.way.kept(track, head + BLOCK, axle.foot);
        }
        if alone {
            return;
        }
        for point in &mut body.points {
            point.keep_on_the_way(track, head + BLOCK, minima);
        }
    }
}

/// One body point at eight head stations. The point's foot moves on to the next eight.
#[inline(always)]
fn sample<V: Vector, const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    body: &mut Body,
    index: usize,
    s: &States<V>,
    knots: &Knots<V>,
) -> Sample<V> {
    let (ahead, tag, first) = {
        let point = &body.points[index];
        (point.spot.ahead, point.tag, point.foot)
    };
    let (x, y) = (s.x + s.ux * ahead, s.y + s.uy * ahead);
    let last = LANES - 1;
    let seen = place(track.fields.run(first), x, y);
    if near(seen.along) {
        body.points[index].foot = next_foot(track, first + last, seen.along.lane(last));
        let feet = Feet::Run(first);
        let spot = &body.points[index].spot;
        let sides = leeways::<V, CERTIFY, REFINED>(track, feet, &seen, s, knots, body, spot);
        return Sample::new(&seen, feet, tag, sides);
    }
    sample_apart::<V, CERTIFY, REFINED>(track, body, index, s, knots)
}

by_instruction_set! {
    /// As [`sample`], with each point at its own nearest station. A function of its own leaves the registers to the common case.
    fn sample_apart<V, const CERTIFY: bool, const REFINED: bool>(
        track: &Track,
        body: &mut Body,
        index: usize,
        s: &States<V>,
        knots: &Knots<V>,
    ) -> Sample<V> {
        let point = &body.points[index];
        let (tag, spot) = (point.tag, point.spot);
        let (x, y) = (s.x + s.ux * spot.ahead, s.y + s.uy * spot.ahead);
        let feet = follow(track, point.foot, x, y);
        let (sample, seen) = sample_at::<V, CERTIFY, REFINED>(track, body, &spot, s, knots, feet, tag);
        let last = LANES - 1;
        body.points[index].foot = next_foot(track, feet[last], seen.along.lane(last));
        sample
    }
}

/// A place of a body at eight head stations with given feet.
#[inline(always)]
fn sample_at<V: Vector, const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    body: &Body,
    spot: &Spot,
    s: &States<V>,
    knots: &Knots<V>,
    feet: [usize; LANES],
    tag: u64,
) -> (Sample<V>, Seen<V>) {
    let (x, y) = (s.x + s.ux * spot.ahead, s.y + s.uy * spot.ahead);
    let seen = place(track.fields.gather(&feet), x, y);
    let sides = leeways::<V, CERTIFY, REFINED>(track, Feet::Each(feet), &seen, s, knots, body, spot);
    let found = |side: V| {
        let one = |i: usize| if seen.along.lane(i).abs() <= 1.5 * NEAR_M { side.lane(i) } else { LOST_M };
        V::from(std::array::from_fn(one))
    };
    (
        Sample::new(
            &seen,
            Feet::Each(feet),
            tag,
            Sides { left: found(sides.left), right: found(sides.right), ..sides },
        ),
        seen,
    )
}

by_instruction_set! {
    /// Examines the side between a body point and the previous one in `parts` parts, where half-widths bulge.
    #[allow(clippy::too_many_arguments)] // As above.
    fn inside<V, const REFINED: bool>(
        track: &Track,
        body: &Body,
        index: usize,
        s: &States<V>,
        knots: &Knots<V>,
        ends: (&Sample<V>, &Sample<V>),
        parts: f64,
        minima: &mut Minima,
    ) {
        let (before, after) = ends;
        let part_m = body.points[index].gap / parts;
        let mut last: Option<Sample<V>> = None;
        for number in 1..parts as usize {
            let mut sample = inner::<V, REFINED>(track, body, index, s, knots, (before, after), number as f64 / parts);
            let [most, least] = bends(&[before, &sample, after], s, part_m);
            sample.lowered_left = sample.left - whole_sagitta(most, part_m);
            sample.lowered_right = sample.right - whole_sagitta(-least, part_m);
            sample.lower(minima);
            at_marks(track, (last.as_ref().unwrap_or(before), &sample), s, part_m, minima);
            last = Some(sample);
        }
        at_marks(track, (last.as_ref().unwrap_or(before), after), s, part_m, minima);
    }
}

/// Whether the bound between two body points would take more than [`SAG_M`] off either side.
#[inline(always)]
fn sags<V: Vector>(before: &Sample<V>, sample: &Sample<V>, s: &States<V>, gap: f64) -> bool {
    let [most, least] = bends(&[before, sample], s, gap);
    // The sagitta of the whole gap is never less, and costs no division.
    let whole = whole_sagitta(most, gap).max(whole_sagitta(-least, gap));
    if whole.all_below(0.999 * SAG_M) {
        return false;
    }
    let left = lowest_between(sharpest(most, gap), gap, (before.left - sample.left).abs());
    let right = lowest_between(sharpest(-least, gap), gap, (before.right - sample.right).abs());
    left.max(right).any_above(SAG_M)
}

by_instruction_set! {
    /// Covers the side between a body point and the previous one in parts of at most [`PART_M`]. The bound between two points counts
    /// the sharpest parallel under either of them; where a side is half in a bend, that is much for the whole gap.
    fn piecewise<V, const REFINED: bool>(
        track: &Track,
        body: &Body,
        index: usize,
        s: &States<V>,
        knots: &Knots<V>,
        ends: (&mut Sample<V>, &mut Sample<V>),
        minima: &mut Minima,
    ) {
        let (before, after) = ends;
        let parts = (body.points[index].gap / PART_M).ceil();
        let part_m = body.points[index].gap / parts;
        let mut last: Option<Sample<V>> = None;
        for number in 1..parts as usize {
            let mut inner = inner::<V, REFINED>(track, body, index, s, knots, (before, after), number as f64 / parts);
            let previous = last.as_mut().unwrap_or(before);
            between_points(previous, &mut inner, s, part_m, 1.0);
            at_marks(track, (previous, &inner), s, part_m, minima);
            if let Some(passed) = last.replace(inner) {
                passed.lower(minima);
            }
        }
        let previous = last.as_mut().unwrap_or(before);
        between_points(previous, after, s, part_m, 1.0);
        at_marks(track, (previous, after), s, part_m, minima);
        if let Some(passed) = last {
            passed.lower(minima);
        }
    }
}

/// A place of the side between a body point and the previous one, at a share of the gap.
#[inline(always)]
fn inner<V: Vector, const REFINED: bool>(
    track: &Track,
    body: &Body,
    index: usize,
    s: &States<V>,
    knots: &Knots<V>,
    (before, after): (&Sample<V>, &Sample<V>),
    part: f64,
) -> Sample<V> {
    let (ahead, point) = (&body.points[index - 1], &body.points[index]);
    let spot = ahead.spot.between(point.spot, part);
    let inner = Knots {
        ahead: knots.ahead,
        own: knots.ahead + (knots.own - knots.ahead) * part,
        behind: knots.own,
        gap_ahead: part * point.gap,
        gap_behind: (1.0 - part) * point.gap,
    };
    let (x, y) = (s.x + s.ux * spot.ahead, s.y + s.uy * spot.ahead);
    let from = before.feet.station(0) as f64;
    let guess = (from + (after.feet.station(0) as f64 - from) * part).round() as usize;
    let feet = follow(track, guess, x, y);
    let tag = if part < 0.5 { before.tag } else { after.tag };
    sample_at::<V, true, REFINED>(track, body, &spot, s, &inner, feet, tag).0
}

/// Lowers the leeway at marked stations between two points of a side, `gap` metres apart. The leeway is no less than
/// the chord between the points, less the bend of the corridor and the bulge of its width.
#[inline(always)]
fn at_marks<V: Vector>(
    track: &Track,
    (before, after): (&Sample<V>, &Sample<V>),
    s: &States<V>,
    gap: f64,
    minima: &mut Minima,
) {
    let [from, to] = [after.feet.range().0, before.feet.range().1];
    if track.marks(from, to).next().is_some() {
        note_marks(track, (before, after), s, gap, minima);
    }
}

by_instruction_set! {
    #[cold]
    fn note_marks<V>(track: &Track, ends: (&Sample<V>, &Sample<V>), s: &States<V>, gap: f64, minima: &mut Minima) {
        let (before, after) = ends;
        let bulge = before.bulge.max(after.bulge);
        let [most, least] = bends(&[before, after], s, gap);
        let bend_left = most.max(V::ZERO) * 1.1 + bulge;
        let bend_right = (-least).max(V::ZERO) * 1.1 + bulge;
        // Two marked stations may lie in one gap: this covers the sag of the side between them.
        let between = track.spacing * track.spacing / 8.0;
        for i in 0..LANES {
            let foot = |sample: &Sample<V>| sample.feet.station(i) as f64 + sample.along.lane(i) / track.spacing;
            let (rear, front) = (foot(after), foot(before));
            let aside = before.lateral.lane(i).abs().max(after.lateral.lane(i).abs());
            let curvature = before.curvature.lane(i).abs().max(after.curvature.lane(i).abs());
            let even = EVEN_ENOUGH.contains(&((front - rear) * track.spacing / gap));
            let uneven = if even { UNEVEN + curvature * (UNEVEN_ASIDE * aside + UNEVEN_ALONG * gap) } else { 1.0 };
            for mark in track.marks(after.feet.station(i), before.feet.station(i)) {
                let share = (mark as f64 - rear) / (front - rear).max(1e-9);
                let shares = [share - uneven, share + uneven].map(|share| share.clamp(0.0, 1.0));
                let tag = if share < 0.5 { after.tag } else { before.tag };
                let leeway = |behind: V, ahead: V, bend: V| {
                    let low = sagging([behind.lane(i), ahead.lane(i)], 0.5 * bend.lane(i) * gap * gap, shares);
                    tagged(low - bend.lane(i) * between, tag)
                };
                minima.mark_left[mark] = least_of(minima.mark_left[mark], leeway(after.left, before.left, bend_left));
                minima.mark_right[mark] = least_of(minima.mark_right[mark], leeway(after.right, before.right, bend_right));
            }
        }
    }
}

/// The least value between two shares of the parabola that lies `whole`·w(1 − w) below the chord between its ends.
fn sagging([behind, ahead]: [f64; 2], whole: f64, [from, to]: [f64; 2]) -> f64 {
    let at = |w: f64| behind + (ahead - behind) * w - whole * w * (1.0 - w);
    let lowest = if whole > 0.0 { 0.5 - 0.5 * (ahead - behind) / whole } else { from };
    least_of(least_of(at(from), at(to)), at(lowest.clamp(from, to)))
}

impl<V: Vector> Sample<V> {
    #[inline(always)]
    fn new(seen: &Seen<V>, feet: Feet, tag: u64, Sides { left, right, parallel }: Sides<V>) -> Self {
        let (curvature, bulge) = (seen.at.curvature, seen.at.bulge);
        Self {
            feet,
            tag,
            parallel,
            left,
            right,
            lowered_left: left,
            lowered_right: right,
            curvature,
            bulge,
            along: seen.along,
            lateral: seen.lateral,
        }
    }

    #[inline(always)]
    fn lower(&self, minima: &mut Minima) {
        lower(&mut minima.left, self.feet, self.lowered_left.tagged(self.tag));
        lower(&mut minima.right, self.feet, self.lowered_right.tagged(self.tag));
    }
}

/// Whether half-widths near two body points bulge so much that no parabola between the points bounds them.
#[inline(always)]
fn bulges<V: Vector>(before: &Sample<V>, sample: &Sample<V>) -> bool {
    before.bulge.max(sample.bulge).any_above(BULGE_MOST)
}

/// Length of the parts in which a bulging side is examined, metres.
#[inline(always)]
fn part_m<V: Vector>(before: &Sample<V>, sample: &Sample<V>) -> f64 {
    let before = before.parallel[0].abs().max(before.parallel[1].abs());
    let here = sample.parallel[0].abs().max(sample.parallel[1].abs());
    if before.max(here).any_above(BENT) { BENT_PART_M } else { PART_M }
}

/// Greatest and least curvature of the corridor relative to a straight side, under the given points and between them: the
/// greatest on the left, the least on the right. What counts is the parallel through the point, which bends more than the
/// centreline on the inside. The points pass a station one after the other, at most `gap` metres apart.
#[inline(always)]
fn bends<V: Vector>(samples: &[&Sample<V>], s: &States<V>, gap: f64) -> [V; 2] {
    let sway = s.jerk * gap;
    let most = samples.iter().fold(s.curvature, |most, sample| most.max(sample.parallel[0])) + sway;
    let least = samples.iter().fold(s.curvature, |least, sample| least.min(sample.parallel[1])) - sway;
    [most, least]
}

/// The curvature under a side of length `gap` whose ends are over parallels of curvature `bend`. Between its ends the side
/// comes closer to the centre, where parallels bend more.
#[inline(always)]
fn sharpest<V: Vector>(bend: V, gap: f64) -> V {
    let bend = bend.max(V::ZERO);
    let q = bend * bend * (gap * gap);
    bend * (q * q * 0.028 + q * 0.03 + 1.1)
}

/// Greatest distance of a straight side of length `gap` below both its ends, over a corridor that bends by `bend`.
#[inline(always)]
fn whole_sagitta<V: Vector>(bend: V, gap: f64) -> V {
    sharpest(bend, gap) * (gap * gap / 8.0)
}

/// How far leeway may fall below its lesser end value along a side of length `gap`, if the ends differ by `apart` and its second
/// derivative is at most c(1 − d′²), c being `bend` (docs/proof.md, section 7). The lowest place is x from the lesser end.
/// The parabola gives x ≤ gap/2 − apart/(c·gap). The equation's own solution, ln cosh(cx)/c, gives
/// x ≤ (ln cosh(c·gap)/c − apart)/tanh(c·gap).
#[inline(always)]
fn lowest_between<V: Vector>(bend: V, gap: f64, apart: V) -> V {
    let c = bend + 1e-9;
    let z = c * gap;
    let z2 = z * z;
    let per_z = V::splat(1.0) / z;
    // Up to z = 2, ln cosh z ≤ (z²/2)/(1 + z²/8), and tanh z ≥ z/(1 + z²/3).
    let rise = z * (0.5 * gap) / (z2 * 0.125 + 1.0);
    let solved = (rise - apart) * (z2 * (1.0 / 3.0) + 1.0) * per_z;
    let parabola = V::splat(0.5 * gap) - apart * per_z;
    let nearer = (V::splat(2.0) - z).if_negative(parabola, parabola.min(solved)).max(V::ZERO);
    c * nearer * nearer * 0.5
}

/// Covers the side between two body points: the side is straight while the corridor bends. Along the side, leeway lies
/// above the parabola through both ends whose second derivative is the bend plus the bulge of the width. The least
/// value of that parabola counts at both ends.
///
/// If the width bulges more than [`BULGE_MOST`], the places of the side count one by one. A station sees both ends of
/// each of the `parts` pass. Leeway between them is lower by at most the sagitta of one part.
#[inline(always)]
fn between_points<V: Vector>(before: &mut Sample<V>, sample: &mut Sample<V>, s: &States<V>, gap: f64, parts: f64) {
    let bulge = before.bulge.max(sample.bulge);
    let ends = [&*before, &*sample];
    let [most, least] = bends(&ends, s, gap);
    let [part_most, part_least] = bends(&ends, s, gap / parts);
    let side = Between { bulge, gap, part_m: gap / parts };
    let left = side.sag(most, part_most, before.left, sample.left);
    let right = side.sag(-least, -part_least, before.right, sample.right);
    before.lowered_left = before.lowered_left.min(before.left - left);
    before.lowered_right = before.lowered_right.min(before.right - right);
    sample.lowered_left = sample.left - left;
    sample.lowered_right = sample.right - right;
}

/// A side between two body points `gap` apart, examined in parts where half-widths bulge. Metres.
struct Between<V> {
    bulge: V,
    gap: f64,
    part_m: f64,
}

impl<V: Vector> Between<V> {
    /// How far leeway may fall between the ends, where it is `f` and `g`.
    #[inline(always)]
    fn sag(&self, bend: V, part_bend: V, f: V, g: V) -> V {
        let side = lowest_between(sharpest(bend, self.gap) + self.bulge, self.gap, (f - g).abs());
        (V::splat(BULGE_MOST) - self.bulge).if_negative(whole_sagitta(part_bend, self.part_m), side)
    }
}

/// Bounds at a body point and at its neighbours, and the distances to the neighbours (0: no neighbour).
struct Knots<V> {
    ahead: V,
    own: V,
    behind: V,
    gap_ahead: f64,
    gap_behind: f64,
}

impl<V: Vector> Knots<V> {
    /// Rise of the bound `by`/cos φ metres ahead of the point, times cos φ. The bound is convex along the body: it lies
    /// below its chords between points, and its slope is nowhere greater than the bound of the heading.
    #[inline(always)]
    fn lean(&self, by: V, cos: V, heading: V) -> V {
        let ahead = self.to(self.ahead, self.gap_ahead, by, cos, heading);
        by.if_negative(self.to(self.behind, self.gap_behind, by, cos, heading), ahead) * by.abs()
    }

    /// The slope of the bound towards a neighbour.
    #[inline(always)]
    fn to(&self, other: V, gap: f64, by: V, cos: V, heading: V) -> V {
        let chord = (other - self.own) * (1.0 / gap.max(1e-9));
        // Negative beyond the neighbour, or without a neighbour.
        (cos * gap - by.abs()).if_negative(heading, chord.min(heading))
    }
}

/// Leeway at the two side points of one place on the axis, and the curvature of the corridor's parallels through them.
struct Sides<V> {
    left: V,
    right: V,
    parallel: [V; 2],
}

/// Leeway to the left and to the right, at the two side points of one place on the axis.
#[inline(always)]
fn leeways<V: Vector, const CERTIFY: bool, const REFINED: bool>(
    track: &Track,
    feet: Feet,
    seen: &Seen<V>,
    s: &States<V>,
    knots: &Knots<V>,
    body: &Body,
    spot: &Spot,
) -> Sides<V> {
    let at = &seen.at;
    let cos = at.tangent_x * s.ux + at.tangent_y * s.uy;
    let sin = at.tangent_x * s.uy - at.tangent_y * s.ux;
    let (across, askew) = (cos * body.half_width, sin * body.half_width);
    let (left_along, left_at) = (seen.along - askew, seen.lateral + across);
    let (right_along, right_at) = (seen.along + askew, seen.lateral - across);
    let spread = spread([at, at], [left_at, right_at]);
    let mut edges = [Edge::left(at, left_along, left_at, spread[0]), Edge::right(at, right_along, right_at, spread[1])];
    if CERTIFY && rough(at) {
        edges = apart(track, feet, s, spot.ahead, body.half_width, &edges);
    }
    let [left, right] = [edges[0].room, edges[1].room];
    let lean_left = (askew * -spot.slope_ahead).max(askew * spot.slope_behind);
    let lean_right = (askew * spot.slope_ahead).max(askew * -spot.slope_behind);
    if !CERTIFY {
        let gain = cos * spot.gain;
        let parallel = [at.curvature; 2];
        return Sides { left: left - gain - lean_left, right: right - gain - lean_right, parallel };
    }
    let reach = spot.ahead.abs();
    let (c, t) = (cos.abs(), sin.abs());
    let extras = (s.extra_axle + s.extra_coupling) * body.inverse_length;
    let a = extras + body.heading + s.remainder;
    let axle = s.extra_axle + body.axle;
    let a2 = a * a;
    // First order: |cos φ|·(the bound at a ∓ (b/2) tan φ).
    let (base, lean_left, lean_right) = if REFINED {
        (c * knots.own, knots.lean(-askew, c, a), knots.lean(askew, c, a))
    } else {
        // g is convex, and neither `extra` nor g is steeper than its heading bound.
        let base = c * (s.extra_axle * spot.from_axle + s.extra_coupling * spot.from_coupling + spot.gain)
            + t * extras * body.half_width
            + (t - c).max(V::splat(0.0)) * a * body.half_width;
        (base, lean_left, lean_right)
    };
    // Second order: `along` is how far the point may slide along the corridor. Its foot slides farther where normals
    // crowd.
    let along = c * a * body.half_width + t * (axle + a * reach);
    let second = (c * s.remainder + t * a2 * 0.5) * reach;
    let common = base + second;
    let parallel = [at.curvature * edges[0].spread, at.curvature * edges[1].spread];
    let passing = Passing { s, at, cos, sin, ahead: spot.ahead, step2: track.spacing * track.spacing };
    Sides {
        left: passing.left_over(&edges[0], [common, lean_left, along], body.half_width),
        right: passing.left_over(&edges[1], [common, lean_right, along], -body.half_width),
        parallel,
    }
}

/// A place on a unit's axis as the vehicle passes from one head station to the next.
struct Passing<'a, V> {
    s: &'a States<V>,
    at: &'a Fields<V>,
    cos: V,
    sin: V,
    ahead: f64,
    step2: f64,
}

impl<V: Vector> Passing<'_, V> {
    /// The room of one side point less its bounds: what both sides have in common, what the lean of the body adds, and what a slide
    /// by `along` costs.
    #[inline(always)]
    fn left_over(&self, edge: &Edge<V>, [common, lean, along]: [V; 3], aside: f64) -> V {
        let bend = self.at.curvature.abs();
        let crowd = edge.spread.max(V::splat(1.0));
        let slide = crowd * along;
        // Terms of the foot's series beyond third order: κ³σ⁴/8, times 1 + |κb| on the outside.
        let on2 = edge.on * edge.on;
        let bent = bend * slide * along * 0.5 + bend * bend * bend * on2 * on2 * 0.3;
        edge.room - common - lean - bent - edge.excess(slide) - self.sag(edge, aside)
    }

    /// How far the clearance of the side point `aside` metres to the left may lie below its chord between two head stations:
    /// an eighth of its second derivative, where that is positive (docs/proof.md, section 7, "between head stations"). Per metre of
    /// the axle, the unit turns by `w`, and the point moves by `along` along the road.
    #[inline(always)]
    fn sag(&self, edge: &Edge<V>, aside: f64) -> V {
        let Self { s, at, cos, sin, ahead, step2 } = *self;
        let (c, t) = (cos.abs(), sin.abs());
        let w = s.curvature;
        let own = V::splat(1.0) - w * aside;
        let along = own * cos - w * sin * ahead;
        let across = w * own * cos - w * w * sin * ahead;
        let away = (at.curvature * edge.spread * along * along - across) * aside.signum();
        // The half-width's slope counts where the foot runs faster or slower.
        let lever = w.abs() * ahead.abs();
        let foot = (w.abs() * (lever + 1.0)
            + at.curvature.abs() * (t + lever) * 2.0
            + at.curvature_slope.abs() * (at.curvature.abs() * 4.0 + 0.5))
            * edge.spread
            * edge.spread;
        // Both curvatures may change within the step.
        let change = (at.curvature_slope.abs() * edge.spread * edge.spread + s.jerk) * 0.25;
        let way2 = s.way2.max(V::splat(step2));
        let turning = s.jerk * (c * ahead.abs() + t * aside.abs()) * step2;
        (away.max(V::ZERO) * 1.2 * way2 + (edge.slope.abs() * foot + change) * way2 + turning) * 0.125
    }
}

/// Metres a foot moves along the corridor while its point moves a metre, left and right: 1 over [`narrow`].
#[inline(always)]
fn spread<V: Vector>(at: [&Fields<V>; 2], lateral: [V; 2]) -> [V; 2] {
    let (left, right) = (narrow(at[0], lateral[0]), narrow(at[1], lateral[1]));
    let both = V::splat(1.0) / (left * right);
    [both * right, both * left]
}

/// One side's point and the edge beside it, read at a station.
#[derive(Clone, Copy)]
struct Edge<V> {
    /// Half-width at the foot less lateral place, metres.
    room: V,
    /// See [`spread`].
    spread: V,
    /// Arc length from the station to the foot, metres.
    on: V,
    slope: V,
    /// Bounds on how much the reading is too great, per metre from the station and per square metre.
    excess: V,
    rounding: V,
}

impl<V: Vector> Edge<V> {
    #[inline(always)]
    fn left(at: &Fields<V>, along: V, lateral: V, spread: V) -> Self {
        let (on, lateral) = foot(at, along, lateral, spread);
        let room = at.left + at.left_slope * on - lateral;
        Self { room, spread, on, slope: at.left_slope, excess: at.left_excess, rounding: at.rounding }
    }

    #[inline(always)]
    fn right(at: &Fields<V>, along: V, lateral: V, spread: V) -> Self {
        let (on, lateral) = foot(at, along, lateral, spread);
        let room = at.right + at.right_slope * on + lateral;
        Self { room, spread, on, slope: at.right_slope, excess: at.right_excess, rounding: at.rounding }
    }

    /// How much less the half-width may be at the point than read, if the point is up to `slide` from its nominal foot.
    #[inline(always)]
    fn excess(&self, slide: V) -> V {
        let way = self.on.abs() + slide;
        let lost = (V::splat(READ_M) - way).if_negative(V::splat(-LOST_M), V::ZERO);
        self.slope.abs() * slide + (self.excess + self.rounding * way) * way + lost
    }
}

/// Whether half-widths change so much that each side needs a station of its own.
#[inline(always)]
fn rough<V: Vector>(at: &Fields<V>) -> bool {
    let excess = at.left_excess.max(at.right_excess).max(at.rounding);
    excess.any_above(ROUGH)
}

by_instruction_set! {
    /// Reads each side's point at the station of its own foot. In a bend, or with the body askew, that foot is metres from
    /// the foot of the axis.
    #[cold]
    fn apart<V>(track: &Track, feet: Feet, s: &States<V>, ahead: f64, half_width: f64, edges: &[Edge<V>; 2]) -> [Edge<V>; 2] {
        let (left, right) = (
            aside(track, feet, s, [ahead, half_width], &edges[0]),
            aside(track, feet, s, [ahead, -half_width], &edges[1]),
        );
        let [of_left, of_right] = spread([&left.at, &right.at], [left.lateral, right.lateral]);
        [
            Edge::left(&left.at, left.along, left.lateral, of_left),
            Edge::right(&right.at, right.along, right.lateral, of_right),
        ]
    }
}

/// The place `ahead` of the axle and `left` of the axis, as its own foot sees it; `edge` is the place seen from the foot of the axis.
#[inline(always)]
fn aside<V: Vector>(track: &Track, feet: Feet, s: &States<V>, [ahead, left]: [f64; 2], edge: &Edge<V>) -> Seen<V> {
    let on = edge.on.array();
    let own: [usize; LANES] = std::array::from_fn(|i| {
        let k = feet.station(i);
        let by = (on[i] / track.spacing + 64.5).clamp(0.0, 128.0) as usize;
        (k + by).saturating_sub(64).min(track.len() - 1)
    });
    let (x, y) = (s.x + s.ux * ahead - s.uy * left, s.y + s.uy * ahead + s.ux * left);
    place(track.fields.gather(&own), x, y)
}

#[inline(always)]
fn lower<V: Vector>(minima: &mut [f64], feet: Feet, by: V) {
    match feet {
        Feet::Run(first) => {
            for (m, b) in minima[first..first + LANES].iter_mut().zip(by.array()) {
                *m = least(*m, b);
            }
        }
        Feet::Each(feet) => {
            for (foot, b) in feet.into_iter().zip(by.array()) {
                minima[foot] = least(minima[foot], b);
            }
        }
    }
}

const _: () = assert!(FIELDS == row::WAY2 + 1);
