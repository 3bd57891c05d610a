//! From stations to spans: least leeway, its place, and SHRINK.

use std::ops::{Range, RangeInclusive};

use netcert_base::corridor::Side;
use netcert_base::leeway::known_m;

pub(super) use netcert_base::leeway::NOTHING_M;

use super::block::{BARELY_CLOSED_RAD, BLOCK, Minima, NOT_CLOSED_RAD, UNVISITED_M};
use super::group::{SHRINK_STEPS, gamma};
use super::model::{Model, POINT_SPACING_M};
use super::results::{Limiting, SpanResult};
use super::tag::{carried, unit_and_point};
use super::track::Track;

/// Stations that a span takes beyond each end. A foot moves up to two stations per station of the steer axle, rounding
/// included. A side's least leeway may also be a little beside the point where it is noted.
const STEP_STATIONS: usize = 3;
/// Least length of these stations, metres. A point may be pushed this far along, and stations may be centimetres apart.
const BESIDE_M: f64 = 0.6;

/// A point of the vehicle is never farther behind the steer axle than twice the vehicle's length or this, whichever is less, metres.
/// A vehicle longer than this counts by its length.
const LONG_M: f64 = 56.0;

/// A span's numbers as the sweep has them. [`NOTHING_M`] and [`NOT_CLOSED_RAD`] mark missing numbers.
#[derive(Debug, Clone)]
pub(super) struct Least {
    pub(super) rsc_m: f64,
    published_m: f64,
    hinge_rad: f64,
    hinge_unit: usize,
    shrink: f64,
    limiting: Limiting,
}

impl Least {
    /// Whether the bounds close.
    fn closes(&self) -> bool {
        self.hinge_rad > NOT_CLOSED_RAD + 1.0 && known_m(self.rsc_m).is_some()
    }

    /// Whether a leeway or a hinge margin is negative, or missing.
    pub(super) fn fails(&self) -> bool {
        self.rsc_m < 0.0 || self.hinge_rad < 0.0
    }

    /// Whether a hinge margin is negative, and no leeway.
    pub(super) fn too_far_only(&self) -> bool {
        self.rsc_m >= 0.0 && self.hinge_rad < 0.0
    }

    /// The numbers where areas were left out: the leeway is less than any, and not known to be enough.
    pub(super) fn unmeasured(self) -> Self {
        Self { rsc_m: self.rsc_m.min(-f64::MIN_POSITIVE), ..self }
    }

    /// The result with `None` for missing numbers. If one of RSC and margin is missing, the other one means nothing.
    pub(super) fn result(self) -> SpanResult {
        let bounded = self.closes();
        SpanResult {
            rsc_m: bounded.then_some(self.rsc_m),
            rsc_published_m: self.published_m,
            hinge_margin_rad: bounded.then_some(self.hinge_rad),
            hinge_unit: self.hinge_unit,
            shrink: self.shrink,
            limiting: self.limiting,
        }
    }
}

fn beside(track: &Track) -> usize {
    STEP_STATIONS.max((BESIDE_M / track.spacing).ceil() as usize)
}

/// Extended stations whose body points a span of corridor stations rests on.
pub(super) fn stations(track: &Track, span: &Range<usize>) -> RangeInclusive<usize> {
    let own = own(track, span);
    own.start() - beside(track)..=own.end() + beside(track)
}

/// Stations of a span at which the leeway between two points of a side counts. These are its ends, or all stations of a
/// span that may lie inside one gap between points.
pub(super) fn marks(spacing_m: f64, span: &Range<usize>) -> impl Iterator<Item = usize> {
    let last = span.end.max(span.start + 1) - 1;
    let inside = (last - span.start) as f64 * spacing_m <= POINT_SPACING_M;
    (span.start..=last).filter(move |&k| inside || k == span.start || k == last)
}

/// The foot of a limiting point: its extended station, and whether an area limits there.
#[derive(Clone, Copy)]
struct Foot {
    station: usize,
    in_area: bool,
}

/// The leeways of two sweeps that a span rests on, pairwise: at the points whose feet are on the span, and at marked
/// stations between two points.
fn leeways<'a>(
    track: &'a Track,
    model: &'a Model,
    span: &Range<usize>,
    [one, other]: [&'a Minima; 2],
) -> impl Iterator<Item = (Foot, Side, [f64; 2])> {
    let points = stations(track, span).map(move |k| (k, [&one.left, &one.right], [&other.left, &other.right]));
    let marks = marks(track.spacing, span).map(|k| track.lead + k);
    let between = move |k: usize| (k, [&one.mark_left, &one.mark_right], [&other.mark_left, &other.mark_right]);
    let edges = points.chain(marks.map(between)).flat_map(|(k, one, other)| {
        let foot = Foot { station: k, in_area: false };
        [(Side::Left, 0), (Side::Right, 1)].map(|(side, i)| (foot, side, [one[i][k], other[i][k]]))
    });
    let heads = heads(track, model, span, one).filter(|_| !track.areas.is_empty());
    let areas = heads.flat_map(move |head| {
        [(Side::Left, 0), (Side::Right, 1)].map(|(side, i)| {
            let foot = Foot { station: one.area_foot[i][head] as usize, in_area: true };
            let [f, l] = [one.area[i][head], other.area[i][head]];
            // Leeway is concave in γ, and so is the lesser of it and what is not noted.
            let both = if (f < UNVISITED_M) == (l < UNVISITED_M) {
                [f, l]
            } else {
                [f.min(one.unnoted()), l.min(other.unnoted())]
            };
            (foot, side, both)
        })
    });
    edges.chain(areas)
}

/// Stations of the steer axle at which any body point is on the span. The points' own feet say which, and so does the vehicle's
/// length when straight, in case feet were lost.
fn heads<'a>(
    track: &'a Track,
    model: &'a Model,
    span: &Range<usize>,
    full: &'a Minima,
) -> impl Iterator<Item = usize> + 'a {
    let (first, last) = stations(track, span).into_inner();
    let stations = |metres: f64| (metres / track.spacing).ceil() as usize;
    let straight = straight(track, model, span);
    // A foot falls behind by at most the arc of a quarter turn instead of its chord (proof, section 7, Feet).
    let near =
        straight.start.saturating_sub(stations(model.front))..full.hinge.len().min(last + 2 * stations(model.length));
    let on = move |k: &usize| {
        straight.contains(k) || full.under[*k][0] as usize <= last && full.under[*k][1] as usize >= first
    };
    near.filter(on)
}

/// Stations of the steer axle at which the vehicle is on the span, by its length when straight.
pub(super) fn straight(track: &Track, model: &Model, span: &Range<usize>) -> Range<usize> {
    let (first, last) = stations(track, span).into_inner();
    let stations = |metres: f64| (metres / track.spacing).ceil() as usize;
    first.saturating_sub(stations(model.front))..last + stations(model.length) + 1
}

/// Stations of the steer axle at which a vehicle may be on the span, feet that fall behind in a bend included, and a block more.
pub(super) fn touching(track: &Track, model: &Model, span: &Range<usize>) -> Range<usize> {
    let stations_of = |metres: f64| (metres / track.spacing).ceil() as usize;
    let touched = stations(track, span);
    // No unit falls behind by its whole length, and those of long vehicles by little of it.
    let behind_m = (2.0 * model.length).min(model.length.max(LONG_M));
    let ahead = stations_of(model.front) + BLOCK;
    touched.start().saturating_sub(ahead)..touched.end() + stations_of(behind_m) + BLOCK + 1
}

/// Extended stations of a span of corridor stations.
fn own(track: &Track, span: &Range<usize>) -> RangeInclusive<usize> {
    let first = track.lead + span.start;
    first..=first + span.len().max(1) - 1
}

/// The least leeway of each station of a span, as of a span of that station alone.
pub(super) fn alone(track: &Track, span: &Range<usize>, points: &[f64], marks: &[f64]) -> Vec<f64> {
    let least = |k: usize| points[stations(track, &(k..k + 1))].iter().copied().fold(marks[track.lead + k], f64::min);
    span.clone().map(least).collect()
}

/// Lowers columns of leeways, left and right, by the least leeway in areas of each step, at the station of its foot.
pub(super) fn lower_by_areas(track: &Track, columns: [&mut [f64]; 2], minima: &Minima) {
    for (side, column) in columns.into_iter().enumerate() {
        for (foot, leeway) in minima.area_foot[side].iter().zip(&minima.area[side]) {
            if let Some(least) = (*foot as usize).checked_sub(track.lead).and_then(|k| column.get_mut(k)) {
                *least = least.min(*leeway);
            }
        }
    }
}

/// The numbers of a span at γ = 1.
pub(super) fn least(track: &Track, model: &Model, span: &Range<usize>, full: &Minima) -> Least {
    let mut least = f64::INFINITY;
    let mut limiting = Limiting { station: span.start, unit: 0, side: Side::Left, point_m: 0.0, in_area: false };
    let (mut offset, mut half_width) = (0.0_f64, f64::INFINITY);
    // Not a loop: the chain of iterators is several times faster from within.
    leeways(track, model, span, [full; 2]).for_each(|(foot, side, [value, _])| {
        // A NaN, which no input should cause, counts as the least value.
        if value < least || value.is_nan() {
            least = if value.is_nan() { NOTHING_M } else { value.max(NOTHING_M) };
            limiting = place(track, model, foot, side, value);
        }
    });
    for k in own(track, span) {
        offset = offset.max(full.offset[k]);
        half_width = half_width.min(track.fields.left[k].min(track.fields.right[k]));
    }
    let mut hinge = hinge(track, model, span, full);
    let hinge_unit = if hinge < UNVISITED_M { unit_and_point(carried(hinge)).0 } else { 0 };
    // If the bounds do not close while the vehicle is on the span, nothing is known of the span.
    if hinge < BARELY_CLOSED_RAD {
        least = NOTHING_M;
    }
    // After a torn station nothing is known of the units until it no longer matters how they stood there.
    let heads = straight(track, model, span);
    let fading = (model.fading / track.spacing).ceil() as usize;
    if track.torn.iter().any(|k| (heads.start.saturating_sub(fading)..heads.end).contains(k)) {
        (least, hinge) = (NOTHING_M, hinge.min(NOT_CLOSED_RAD));
    }
    // If no point passed, nothing is known.
    if least >= UNVISITED_M || hinge >= UNVISITED_M {
        (least, hinge) = (NOTHING_M, NOT_CLOSED_RAD);
    }
    Least {
        rsc_m: least,
        published_m: half_width - (offset + model.published_radius),
        hinge_rad: hinge,
        hinge_unit,
        shrink: 1.0,
        limiting,
    }
}

/// The least hinge margin while any body point is on the span.
fn hinge(track: &Track, model: &Model, span: &Range<usize>, full: &Minima) -> f64 {
    heads(track, model, span, full).map(|k| full.hinge[k]).fold(f64::INFINITY, f64::min)
}

/// The place of a tagged leeway at an extended station.
fn place(track: &Track, model: &Model, foot: Foot, side: Side, leeway: f64) -> Limiting {
    let (unit, point) = unit_and_point(carried(leeway));
    let point_m = model.units.get(unit).and_then(|u| u.points.get(point)).copied().unwrap_or(0.0);
    let station = foot.station.saturating_sub(track.lead).min(track.count - 1);
    Limiting { station, unit, side, point_m, in_area: foot.in_area }
}

/// SHRINK: the largest γ (in thousandths) for which no station of the span has negative leeway and no hinge a negative margin.
/// Only γ = 1 and γ_min were swept. Every bound grows with γ as a sum of convex terms, so the chord between the two values is never
/// above the value. The limiting place is where the chord is least; another place may gain most by shrinking. If γ_min does
/// not suffice, the result is that of γ_min. If the bounds do not close at γ = 1, nothing is claimed.
pub(super) fn shrunk(
    track: &Track,
    model: &Model,
    span: &Range<usize>,
    full: &Minima,
    at_least: &Minima,
    at_full: &Least,
) -> Least {
    let floor = gamma(model, 0.0);
    let lowest = Least { published_m: at_full.published_m, shrink: floor, ..least(track, model, span, at_least) };
    if !at_full.closes() {
        return Least { hinge_rad: at_full.hinge_rad, hinge_unit: at_full.hinge_unit, ..lowest };
    }
    if lowest.fails() || floor >= 1.0 {
        return lowest;
    }
    let all = || leeways(track, model, span, [full, at_least]);
    let fails = all().filter(|(_, _, [f, _])| *f < 0.0);
    let part = fails.fold(1.0_f64, |part, (_, _, [f, l])| part.min(l / (l - f)));
    let (f, l) = (at_full.hinge_rad, lowest.hinge_rad);
    let part = if f < 0.0 { part.min(l / (l - f)) } else { part };
    let shrink = ((floor + (1.0 - floor) * part) * SHRINK_STEPS).floor() / SHRINK_STEPS;
    if shrink <= floor {
        return lowest;
    }
    let part = (shrink - floor) / (1.0 - floor);
    let (mut rsc_m, mut limiting) = (f64::INFINITY, at_full.limiting);
    all().for_each(|(foot, side, [f, l])| {
        let chord = l + (f - l) * part;
        if chord < rsc_m {
            (rsc_m, limiting) = (chord, place(track, model, foot, side, f));
        }
    });
    let rsc_m = rsc_m.min(full.unnoted()).min(at_least.unnoted());
    let hinge_rad = (l + (f - l) * part).min(l);
    Least { rsc_m, shrink, limiting, hinge_rad, hinge_unit: at_full.hinge_unit, ..lowest }
}
