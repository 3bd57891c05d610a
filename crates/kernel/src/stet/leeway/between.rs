//! The side between two body points: it is straight while the corridor bends away under it (docs/proof.md, section 7).

use crate::stet::block::Minima;
use crate::stet::body::{Body, follow};
use crate::stet::lanes::{Vector, by_instruction_set};
use crate::stet::track::{BULGE_MOST, Track};

use super::bend::{bends, lowest_between, sharpest, whole_sagitta};
use super::marks::at_marks;
use super::sample::{Sample, sample_at};
use super::sides::Knots;
use super::states::States;

/// Where half-widths bulge, a side between two body points is examined in parts no longer than this, metres. At a
/// radius of 16 m the sagitta of a part is 2 cm.
const PART_M: f64 = 1.4;
/// Over parallels that bend more than this (1/m), parts are no longer than `BENT_PART_M`.
const BENT: f64 = 0.08;
const BENT_PART_M: f64 = 0.9;
/// A gap between two body points that costs more than this is covered in parts, metres.
const SAG_M: f64 = 0.03;
/// A sagitta below this costs no more than [`SAG_M`], whatever rounding does.
const NO_SAG_M: f64 = 0.999 * SAG_M;

/// The side between a body point and the previous one, at eight head stations.
pub(super) struct Gap<'a, V> {
    pub(super) track: &'a Track,
    pub(super) body: &'a Body,
    /// The body point.
    pub(super) index: usize,
    pub(super) s: &'a States<V>,
    /// The bounds at the body point.
    pub(super) knots: &'a Knots<V>,
}

impl<V: Vector> Gap<'_, V> {
    /// Its length, metres.
    #[inline(always)]
    fn gap(&self) -> f64 {
        self.body.points[self.index].gap
    }

    /// Covers the side between the previous point and this one: lowers `minima` by what lies between them, and both samples by what may
    /// lie beside them.
    #[inline(always)]
    pub(super) fn cover<const REFINED: bool>(
        &self,
        before: &mut Sample<V>,
        sample: &mut Sample<V>,
        minima: &mut Minima,
    ) {
        let gap = self.gap();
        let parts = if bulges(before, sample) { (gap / part_m(before, sample)).ceil().max(1.0) } else { 1.0 };
        if parts == 1.0 && gap > PART_M && sags(before, sample, self.s, gap) {
            return piecewise::<V, REFINED>(self, before, sample, minima);
        }
        if parts > 1.0 {
            inside::<V, REFINED>(self, before, sample, parts, minima);
        } else {
            at_marks(self.track, before, sample, self.s, gap, minima);
        }
        between_points(before, sample, self.s, gap, parts);
    }

    /// A place of the side, at a share of the gap.
    #[inline(always)]
    fn inner<const REFINED: bool>(&self, before: &Sample<V>, after: &Sample<V>, part: f64) -> Sample<V> {
        let Self { track, body, index, s, knots } = *self;
        let (ahead, point) = (&body.points[index - 1], &body.points[index]);
        let on_axis = ahead.on_axis.between(point.on_axis, part);
        let inner = Knots {
            ahead: knots.ahead,
            own: knots.ahead + (knots.own - knots.ahead) * part,
            behind: knots.own,
            gap_ahead: part * point.gap,
            gap_behind: (1.0 - part) * point.gap,
        };
        let (x, y) = s.ahead(on_axis.ahead);
        let from = before.feet.station(0) as f64;
        let guess = (from + (after.feet.station(0) as f64 - from) * part).round() as usize;
        let feet = follow(track, guess, x, y);
        let tag = if part < 0.5 { before.tag } else { after.tag };
        sample_at::<V, true, REFINED>(track, body, &on_axis, s, &inner, feet, tag).0
    }
}

by_instruction_set! {
    /// Examines the side between a body point and the previous one in `parts` parts, where half-widths bulge.
    fn inside<V, const REFINED: bool>(
        side: &Gap<'_, V>,
        before: &Sample<V>,
        after: &Sample<V>,
        parts: f64,
        minima: &mut Minima,
    ) {
        let Gap { track, s, .. } = *side;
        let part_m = side.gap() / parts;
        let mut last: Option<Sample<V>> = None;
        for number in 1..parts as usize {
            let mut sample = side.inner::<REFINED>(before, after, number as f64 / parts);
            let [most, least] = bends(&[before, &sample, after], s, part_m);
            sample.lowered_left = sample.left - whole_sagitta(most, part_m);
            sample.lowered_right = sample.right - whole_sagitta(-least, part_m);
            sample.lower(minima);
            at_marks(track, last.as_ref().unwrap_or(before), &sample, s, part_m, minima);
            last = Some(sample);
        }
        at_marks(track, last.as_ref().unwrap_or(before), after, s, part_m, minima);
    }
}

by_instruction_set! {
    /// Covers the side between a body point and the previous one in parts of at most [`PART_M`]. The bound between two points counts
    /// the sharpest parallel under either of them; where a side is half in a bend, that is much for the whole gap.
    fn piecewise<V, const REFINED: bool>(
        side: &Gap<'_, V>,
        before: &mut Sample<V>,
        after: &mut Sample<V>,
        minima: &mut Minima,
    ) {
        let Gap { track, s, .. } = *side;
        let parts = (side.gap() / PART_M).ceil();
        let part_m = side.gap() / parts;
        let mut last: Option<Sample<V>> = None;
        for number in 1..parts as usize {
            let mut inner = side.inner::<REFINED>(before, after, number as f64 / parts);
            let previous = last.as_mut().unwrap_or(before);
            between_points(previous, &mut inner, s, part_m, 1.0);
            at_marks(track, previous, &inner, s, part_m, minima);
            if let Some(passed) = last.replace(inner) {
                passed.lower(minima);
            }
        }
        let previous = last.as_mut().unwrap_or(before);
        between_points(previous, after, s, part_m, 1.0);
        at_marks(track, previous, after, s, part_m, minima);
        if let Some(passed) = last {
            passed.lower(minima);
        }
    }
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

/// Whether the bound between two body points would take more than [`SAG_M`] off either side.
#[inline(always)]
fn sags<V: Vector>(before: &Sample<V>, sample: &Sample<V>, s: &States<V>, gap: f64) -> bool {
    let [most, least] = bends(&[before, sample], s, gap);
    // The sagitta of the whole gap is never less, and costs no division.
    let whole = whole_sagitta(most, gap).max(whole_sagitta(-least, gap));
    if whole.all_below(NO_SAG_M) {
        return false;
    }
    let left = lowest_between(sharpest(most, gap), gap, (before.left - sample.left).abs());
    let right = lowest_between(sharpest(-least, gap), gap, (before.right - sample.right).abs());
    left.max(right).any_above(SAG_M)
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
