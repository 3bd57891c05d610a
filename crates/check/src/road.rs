//! The corridor as a curve, read strictly.
//!
//! Between stations curvature and half-widths are linear. Before the first and after the last station the road
//! continues straight (proof, section 8). A corridor whose stations do not fit each other is refused.

use crate::areas::Areas;
use crate::curve::{CurvePoint, curve};
use crate::fit::{RoadError, StationReading, misfits};
use crate::vector::length;
use netcert_base::corridor::Corridor;

/// Roads of less curvature are straight, 1/m.
const BENT: f64 = 1e-3;
/// Least length of the course's direction, which is 1 but for what stations are off.
const LEAST_LENGTH: f64 = 0.1;
/// A half-width lies below its chord by at most this part of the growth of its slope, times the length.
pub(crate) const DIP_PART: f64 = 0.25;
/// Rounding of the sums of that growth, metres a station.
const ROUNDING: f64 = 1e-9;

/// The road between some stations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section {
    /// Greatest curvature to the left and to the right, 1/m, not below 0.
    pub(crate) bent: [f64; 2],
    /// Greatest change of the curvature per metre.
    pub(crate) rate: f64,
    /// Greatest error bound of a curve, metres, and greatest heading difference at a station, radians.
    pub(crate) slack: f64,
    pub(crate) jump: f64,
    /// Sums of both. They add up along a body.
    pub(crate) slacks: f64,
    pub(crate) jumps: f64,
    /// Greatest slope of the half-width.
    pub(crate) steepest: f64,
    /// Sum by which that slope grows, metres a station.
    pub(crate) growth: f64,
}

/// A corridor, extended straight at both ends, in metres relative to its first station.
#[derive(Debug, Clone)]
pub(crate) struct Road {
    /// Metres between stations.
    pub(crate) spacing: f64,
    /// Stations before the corridor's first, and stations of the corridor itself.
    pub(crate) lead: usize,
    pub(crate) count: usize,
    pub(crate) stations: Vec<CurvePoint>,
    /// Curvature at the start and the end of the stretch after each station.
    bends: Vec<[f64; 2]>,
    /// Error bound of the curve after each station against the next station, metres. Sampling a smooth line leaves such
    /// errors.
    slack: Vec<f64>,
    /// Heading difference between the end of the stretch after each station and the next station, radians.
    jumps: Vec<f64>,
    /// Half-widths, left and right, metres.
    pub(crate) widths: Vec<[f64; 2]>,
    /// Sums, over all stations before each, by which the slopes of the half-widths grow, metres a station.
    growth: Vec<[f64; 2]>,
    /// Areas that stand in for the half-widths.
    pub(crate) areas: Areas,
}

impl Road {
    /// Tests that the stations fit each other, and extends the corridor by `lead_m` and `tail_m`.
    ///
    /// # Errors
    /// [`RoadError`] with the first station that does not fit. If read leniently, such a station is no error, and
    /// nothing is known of the stretch before it. Areas must be well-formed even so.
    pub(crate) fn new(
        corridor: &Corridor,
        lead_m: f64,
        tail_m: f64,
        reading: StationReading,
    ) -> Result<Self, RoadError> {
        let misfits = misfits(corridor, reading)?;
        let (n, spacing) = (corridor.len(), corridor.spacing_m);
        let (lead, tail) = ((lead_m / spacing).ceil() as usize, (tail_m / spacing).ceil() as usize);
        let origin = [corridor.x[0], corridor.y[0]];
        let own = |k: usize| CurvePoint {
            c: [corridor.x[k] - origin[0], corridor.y[k] - origin[1]],
            t: [corridor.heading[k].cos(), corridor.heading[k].sin()],
            curvature: corridor.curvature[k],
        };
        let all = lead + n + tail;
        let mut road = Self {
            spacing,
            lead,
            count: n,
            stations: Vec::with_capacity(all),
            bends: Vec::with_capacity(all),
            widths: Vec::with_capacity(all),
            slack: Vec::with_capacity(all),
            jumps: Vec::with_capacity(all),
            growth: Vec::with_capacity(all),
            areas: Areas::new(corridor, lead)?,
        };
        for k in 0..all {
            let inner = k.saturating_sub(lead).min(n - 1);
            let place = own(inner);
            let beyond = (k as f64 - (lead + inner) as f64) * spacing;
            let c = [place.c[0] + beyond * place.t[0], place.c[1] + beyond * place.t[1]];
            let inside = k >= lead && inner + 1 < n;
            let bend = if inside { [corridor.curvature[inner], corridor.curvature[inner + 1]] } else { [0.0; 2] };
            let [slack, jump] = if inside { misfits[inner] } else { [0.0; 2] };
            road.stations.push(CurvePoint { c, ..place });
            road.bends.push(bend);
            road.slack.push(slack);
            road.jumps.push(jump);
            road.widths.push([corridor.left_m[inner], corridor.right_m[inner]]);
        }
        let mut sums = [0.0; 2];
        for k in 0..road.len() {
            road.growth.push(sums);
            sums = [0, 1].map(|side| sums[side] + road.growth_at(side, k));
        }
        Ok(road)
    }

    /// Number of stations, extensions included.
    pub(crate) fn len(&self) -> usize {
        self.stations.len()
    }

    /// The stretch at `s` (in stations) and the metres along it. The road continues straight beyond both ends.
    fn split(&self, s: f64) -> (usize, f64) {
        let k = (s.max(0.0) as usize).min(self.len() - 1);
        (k, (s - k as f64) * self.spacing)
    }

    /// Error bound of the curve at `s`, metres. Infinite where the stations do not fit.
    pub(crate) fn slack(&self, s: f64) -> f64 {
        self.slack[self.split(s).0]
    }

    /// The last of some stations (extensions included) that does not fit its neighbours.
    pub(crate) fn torn(&self, stations: std::ops::Range<usize>) -> Option<usize> {
        let end = stations.end.min(self.slack.len());
        (stations.start..end).rev().find(|&k| self.slack[k].is_infinite())
    }

    /// Largest heading difference where the stretch at `s` meets its neighbours, radians.
    pub(crate) fn jump(&self, s: f64) -> f64 {
        let k = self.split(s).0;
        self.jumps[k.saturating_sub(1)..=k].iter().copied().fold(0.0, f64::max)
    }

    /// The centreline at `s` (in stations, extensions included).
    pub(crate) fn place(&self, s: f64) -> CurvePoint {
        let (k, x) = self.split(s);
        curve(self.stations[k], self.bends[k], self.spacing, x)
    }

    /// Place and direction at `s` on the centreline as the plan takes it. It meets the next station in place and direction (A1), by a
    /// cubic over the whole stretch. Otherwise the course would jump at the station.
    pub(crate) fn course(&self, s: f64) -> ([f64; 2], [f64; 2]) {
        let (k, x) = self.split(s);
        let CurvePoint { c, t, .. } = curve(self.stations[k], self.bends[k], self.spacing, x);
        let Some(next) = self.stations.get(k + 1) else { return (c, t) };
        let end = curve(self.stations[k], self.bends[k], self.spacing, self.spacing);
        let turn = end.t[0] * next.t[1] - end.t[1] * next.t[0];
        let aside = [-turn * next.t[1], turn * next.t[0]];
        let share = x / self.spacing;
        let (moved, bent) = (share * share * (3.0 - 2.0 * share), share * share * (share - 1.0) * self.spacing);
        let (rate, bending) = (6.0 * share * (1.0 - share) / self.spacing, share * (3.0 * share - 2.0));
        let met = |from: [f64; 2], by: f64, bend: f64| {
            [0, 1].map(|i| from[i] + by * (next.c[i] - end.c[i]) + bend * aside[i])
        };
        let direction = met(t, rate, bending);
        let length = length(direction).max(LEAST_LENGTH);
        (met(c, moved, bent), direction.map(|part| part / length))
    }

    /// Half-width on a side (0 left, 1 right) at `s`, metres, and its slope per metre.
    pub(crate) fn width(&self, side: usize, s: f64) -> (f64, f64) {
        let (k, x) = self.split(s.max(0.0));
        let (w0, w1) = (self.widths[k][side], self.widths[(k + 1).min(self.len() - 1)][side]);
        let slope = (w1 - w0) / self.spacing;
        (w0 + slope * x, slope)
    }

    /// The least half-width on a side between `from` and `to` (stations).
    pub(crate) fn narrowest(&self, side: usize, from: f64, to: f64) -> f64 {
        let first = (from.max(0.0) as usize + 1).min(self.len());
        let end = up(to).clamp(first, self.len().max(first));
        let ends = self.width(side, from).0.min(self.width(side, to).0);
        self.widths[first..end].iter().fold(ends, |least, widths| least.min(widths[side]))
    }

    /// Bounds a dip of the half-width between `from` and `to` (stations). Let w(s) be the least half-width within
    /// `reach` of s. w lies below the straight line between any two of its values by at most a quarter of the growth of
    /// the slope times the length. Taking the least around a place moves and splits that growth but adds nothing.
    pub(crate) fn dip(&self, side: usize, from: f64, to: f64, reach: f64) -> f64 {
        let first = ((from - reach).max(0.0) as usize + 1).min(self.len());
        let end = up(to + reach).min(self.len() - 1);
        DIP_PART * self.grown(side, first, end.max(first)) * (to - from)
    }

    /// By how much the slope of the half-width grows at a station, metres a station.
    fn growth_at(&self, side: usize, k: usize) -> f64 {
        let [a, b, c] = self.widths_about(side, k);
        (a - 2.0 * b + c).max(0.0)
    }

    /// By how much the slope of the half-width grows at stations `first..end`, metres a station. The sums are rounded.
    fn grown(&self, side: usize, first: usize, end: usize) -> f64 {
        let before = |k: usize| self.growth[k.min(self.len() - 1)][side];
        before(end) - before(first) + ROUNDING
    }

    /// The half-widths at a station and at its neighbours. Beyond both ends they do not change.
    pub(crate) fn widths_about(&self, side: usize, k: usize) -> [f64; 3] {
        let last = self.len() - 1;
        [k.saturating_sub(1), k, k + 1].map(|k| self.widths[k.min(last)][side])
    }

    /// The road from station `first` to station `last`, with half-widths on a side. `None` beyond its ends.
    pub(crate) fn section(&self, side: usize, first: usize, last: usize) -> Option<Section> {
        let mut section = Section {
            bent: [0.0; 2],
            rate: 0.0,
            slack: 0.0,
            jump: 0.0,
            slacks: 0.0,
            jumps: 0.0,
            steepest: 0.0,
            growth: 0.0,
        };
        for ([a, b], (slack, jump)) in self
            .bends
            .get(first..last)?
            .iter()
            .zip(self.slack.get(first..last)?.iter().zip(self.jumps.get(first..last)?))
        {
            section.bent = [section.bent[0].max(*a).max(*b), section.bent[1].max(-a).max(-b)];
            section.slack = section.slack.max(*slack);
            section.slacks += slack;
            section.jump = section.jump.max(*jump);
            section.jumps += jump;
        }
        for pair in self.widths.get(first..=last)?.windows(2) {
            section.steepest = section.steepest.max((pair[1][side] - pair[0][side]).abs());
        }
        section.rate = most_change(&self.bends[first..last]) / self.spacing;
        section.steepest /= self.spacing;
        section.growth = self.grown(side, first, last);
        Some(section)
    }

    /// Sums of the errors of place (metres) and heading (radians) at the stations between `from` and `to` (stations).
    pub(crate) fn errors(&self, from: f64, to: f64) -> [f64; 2] {
        let (first, last) = (self.split(from).0, self.split(to).0);
        [&self.slack, &self.jumps].map(|errors| errors[first..last.max(first)].iter().sum())
    }

    /// How far half-widths at the given stations lie at most below the straight line between their neighbours.
    pub(crate) fn kink(&self, side: usize, stations: std::ops::Range<usize>) -> f64 {
        let below = |k: usize| {
            let [a, b, c] = [k - 1, k, k + 1].map(|k| self.widths[k][side]);
            0.5 * (a + c) - b
        };
        (stations.start.max(1)..stations.end.min(self.len() - 1)).map(below).fold(0.0, f64::max)
    }

    /// Whether some stretches of the corridor, counted from its first station, reach an end of it that lies in a bend.
    pub(crate) fn ends_in_a_bend(&self, stretches: &std::ops::Range<usize>) -> bool {
        let last = self.count - 1;
        let bent = |k: usize, end: usize| self.bends.get(self.lead + k).is_some_and(|bend| bend[end].abs() > BENT);
        stretches.start == 0 && bent(0, 0) || stretches.end == last && last > 0 && bent(last - 1, 1)
    }

    /// The greatest slope of the half-width on the stretches between `from` and `to` (stations).
    pub(crate) fn steepest(&self, side: usize, from: f64, to: f64) -> f64 {
        let (first, last) = (self.split(from).0, self.split(to).0);
        let end = (last + 2).min(self.len());
        let rises = self.widths[first..end].windows(2).map(|pair| (pair[1][side] - pair[0][side]).abs());
        rises.fold(0.0, f64::max) / self.spacing
    }

    /// On the stretches between `from` and `to` (stations): the greatest curvature towards a side (0 left, 1 right),
    /// and the greatest change of the curvature per metre.
    pub(crate) fn sharpest(&self, side: usize, from: f64, to: f64) -> (f64, f64) {
        let first = from.max(0.0) as usize;
        let last = (to.max(0.0) as usize).min(self.len() - 1);
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let bends = &self.bends[first.min(last)..=last];
        let sharp = bends.iter().flatten().fold(0.0, |most: f64, bend| most.max(sign * bend));
        (sharp, most_change(bends) / self.spacing)
    }
}

/// The greatest change of the curvature on some stretches or from one to the next, 1/m. A corridor may begin or end in a bend.
fn most_change(bends: &[[f64; 2]]) -> f64 {
    let within = bends.iter().map(|[from, to]| (to - from).abs());
    let between = bends.windows(2).map(|pair| (pair[1][0] - pair[0][1]).abs());
    within.chain(between).fold(0.0, f64::max)
}

/// The first station at or after `s`. The library's `ceil` is a call for old processors.
fn up(s: f64) -> usize {
    let whole = s.max(0.0) as usize;
    whole.saturating_add(usize::from(whole as f64 != s.max(0.0)))
}
