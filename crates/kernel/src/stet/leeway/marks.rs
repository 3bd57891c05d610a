//! Leeway of a side at stations between two of its points (docs/proof.md, section 8).

use std::ops::Range;

use crate::stet::block::Minima;
use crate::stet::body::least;
use crate::stet::lanes::{LANES, Vector, by_instruction_set, tagged};
use crate::stet::track::Track;

use super::bend::{SHARPER_AT_LEAST, bends};
use super::sample::Sample;
use super::states::States;

/// The feet of a side's places are not spaced as evenly as the places. A place and its foot may therefore lie at
/// different shares of the way between two points. The difference is at most `UNEVEN` on a straight. A bend adds
/// `UNEVEN_ASIDE` times the lateral distance and `UNEVEN_ALONG` times the gap, both times the curvature. If the ratio
/// of road to side is outside `EVEN_ENOUGH`, any share is possible.
const UNEVEN: f64 = 0.05;
const UNEVEN_ASIDE: f64 = 0.5;
const UNEVEN_ALONG: f64 = 0.15;
const EVEN_ENOUGH: Range<f64> = 0.75..1.35;
/// Stands for feet at the same place in a denominator, stations.
const NO_STATIONS: f64 = 1e-9;

/// Lowers the leeway at marked stations between two points of a side, `gap` metres apart. The leeway is no less than
/// the chord between the points, less the bend of the corridor and the bulge of its width.
#[inline(always)]
pub(super) fn at_marks<V: Vector>(
    track: &Track,
    before: &Sample<V>,
    after: &Sample<V>,
    s: &States<V>,
    gap: f64,
    minima: &mut Minima,
) {
    let [from, to] = [after.feet.range().0, before.feet.range().1];
    if track.marks(from, to).next().is_some() {
        note_marks(track, before, after, s, gap, minima);
    }
}

by_instruction_set! {
    /// As [`at_marks`], where there are any.
    #[cold]
    fn note_marks<V>(
        track: &Track,
        before: &Sample<V>,
        after: &Sample<V>,
        s: &States<V>,
        gap: f64,
        minima: &mut Minima,
    ) {
        let bulge = before.bulge.max(after.bulge);
        let [most_bend, least_bend] = bends(&[before, after], s, gap);
        let bend_left = most_bend.max(V::ZERO) * SHARPER_AT_LEAST + bulge;
        let bend_right = (-least_bend).max(V::ZERO) * SHARPER_AT_LEAST + bulge;
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
                let share = (mark as f64 - rear) / (front - rear).max(NO_STATIONS);
                let shares = [share - uneven, share + uneven].map(|share| share.clamp(0.0, 1.0));
                let tag = if share < 0.5 { after.tag } else { before.tag };
                let leeway = |behind: V, ahead: V, bend: V| {
                    let low = sagging([behind.lane(i), ahead.lane(i)], 0.5 * bend.lane(i) * gap * gap, shares);
                    tagged(low - bend.lane(i) * between, tag)
                };
                minima.mark_left[mark] = least(minima.mark_left[mark], leeway(after.left, before.left, bend_left));
                minima.mark_right[mark] = least(minima.mark_right[mark], leeway(after.right, before.right, bend_right));
            }
        }
    }
}

/// The least value between two shares of the parabola that lies `whole`·w(1 − w) below the chord between its ends.
fn sagging([behind, ahead]: [f64; 2], whole: f64, [from, to]: [f64; 2]) -> f64 {
    let at = |w: f64| behind + (ahead - behind) * w - whole * w * (1.0 - w);
    let lowest = if whole > 0.0 { 0.5 - 0.5 * (ahead - behind) / whole } else { from };
    least(least(at(from), at(to)), at(lowest.clamp(from, to)))
}
