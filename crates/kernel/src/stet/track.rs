//! A corridor prepared for the sweep: extended straight at both ends, with derivatives, and with half-widths that hold
//! between samples.

use std::cell::OnceCell;
use std::ops::Range;

use super::areas::{Grounds, PreparedAreas};
use super::lanes::{LANES, Vector};
use super::model::POINT_SPACING_M as MOST_GAP_M;
use netcert_base::corridor::Corridor;

/// Half-width of the straight extensions beyond a body gap from the corridor: they are driven, not certified.
const OPEN_M: f64 = 1e6;

/// Convexity of a half-width, 1/m, above which each place of a side is examined by itself (`leeway`).
pub(super) const BULGE_MOST: f64 = 0.005;

/// Half-widths are read by a station's slope up to this far from it, metres. Nothing is certified farther away.
pub(super) const READ_M: f64 = 6.0;

/// Excesses up to this (per metre and per square metre) and dips up to that (1/m) are rounding errors.
const ROUNDING: f64 = 1e-9;
const DIP_ROUNDING: f64 = 1e-6;

/// The end's half-width goes on over a body gap and this many stations: half of one because a foot may be half a station from its point,
/// and one because they are counted from one.
const END_STATIONS: f64 = 1.5;

/// Points are trusted to lie at their foot station while |κ·lateral| stays below this.
const REACH: f64 = 0.9;

/// Stations of the extended corridor, one array per field, and their place in the original.
pub(super) struct Track {
    pub(super) spacing: f64,
    /// Number of extended stations before the corridor's first.
    pub(super) lead: usize,
    /// The steer axle's first station. No body point is on the corridor yet.
    pub(super) first_head: usize,
    /// Number of stations of the corridor itself.
    pub(super) count: usize,
    pub(super) fields: Fields<Vec<f64>>,
    /// Stations that do not fit their neighbours: nothing is certified there.
    pub(super) torn: Vec<usize>,
    /// Areas that stand in for the half-widths.
    pub(super) areas: PreparedAreas,
    /// The next marked station from each station on. At marked stations the leeway between two points of a side counts.
    next_mark: Vec<u32>,
    coarse: OnceCell<Box<Track>>,
}

/// Lengths of the extensions, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extensions {
    pub(super) lead_m: f64,
    pub(super) tail_m: f64,
    /// Largest distance from a steer axle to the vehicle's front.
    pub(super) front_m: f64,
}

/// Fields of the corridor at the foot of a body point.
pub(super) struct Fields<T> {
    pub(super) x: T,
    pub(super) y: T,
    pub(super) tangent_x: T,
    pub(super) tangent_y: T,
    pub(super) curvature: T,
    pub(super) curvature_slope: T,
    pub(super) left: T,
    pub(super) right: T,
    pub(super) left_slope: T,
    pub(super) right_slope: T,
    /// Greatest convexity of either half-width within a body gap, 1/m.
    pub(super) bulge: T,
    /// A half-width read σ from the station by its slope is too great by at most `excess`·σ + `rounding`·σ², for σ up
    /// to [`READ_M`]. `rounding` serves both sides.
    pub(super) left_excess: T,
    pub(super) right_excess: T,
    pub(super) rounding: T,
}

impl Track {
    /// Extends `corridor` by `lead_m` and `tail_m` for vehicles that reach `front_m` ahead of their steer axles.
    pub(super) fn new(corridor: &Corridor, extensions: Extensions) -> Self {
        Self::on(corridor, extensions, &Grounds::default())
    }

    /// As [`Self::new`], with areas that may be prepared already.
    pub(super) fn on(
        corridor: &Corridor,
        Extensions { lead_m, tail_m, front_m }: Extensions,
        grounds: &Grounds,
    ) -> Self {
        let h = corridor.spacing_m;
        let count = corridor.len();
        let lead = (lead_m / h).ceil() as usize + LANES;
        let first_head = lead - (front_m / h).ceil() as usize - 2;
        let total = lead + count + (tail_m / h).ceil() as usize + LANES;
        let places = Places::of(corridor, lead, total);
        let inside = lead..lead + count;
        let Places { left, right, curvature, .. } = &places;
        let [left_slope, right_slope, curvature_slope] =
            [left, right, curvature].map(|values| slopes(values, &inside, h));
        let (left_excess, left_rounding) = excess(&places.closed(left), h, &left_slope);
        let (right_excess, right_rounding) = excess(&places.closed(right), h, &right_slope);
        let (left_dips, right_dips) = (places.dips(left), places.dips(right));
        let fields = Fields {
            curvature_slope,
            left: sampled_width(left, &left_dips, curvature, 1.0),
            right: sampled_width(right, &right_dips, curvature, -1.0),
            left_slope,
            right_slope,
            bulge: bulge(&left_dips, &right_dips, h),
            left_excess,
            right_excess,
            rounding: left_rounding.iter().zip(&right_rounding).map(|(left, right)| left.max(*right)).collect(),
            x: places.x,
            y: places.y,
            tangent_x: places.tangent_x,
            tangent_y: places.tangent_y,
            curvature: places.curvature,
        };
        let torn = corridor.torn().into_iter().map(|k| lead + k).collect();
        let next_mark = vec![u32::MAX; fields.x.len() + 1];
        let areas = PreparedAreas::new(corridor, lead, grounds);
        Self { spacing: h, lead, first_head, count, fields, torn, areas, next_mark, coarse: OnceCell::new() }
    }

    /// Every second station, the corridor's first among them, for planning. Torn stations do not matter there.
    pub(super) fn coarse(&self) -> &Self {
        self.coarse.get_or_init(|| Box::new(self.coarsened()))
    }

    fn coarsened(&self) -> Self {
        let first = self.lead % 2;
        let of = |column: &Vec<f64>| column.iter().skip(first).step_by(2).copied().collect::<Vec<f64>>();
        let f = &self.fields;
        let fields = Fields {
            x: of(&f.x),
            y: of(&f.y),
            tangent_x: of(&f.tangent_x),
            tangent_y: of(&f.tangent_y),
            curvature: of(&f.curvature),
            curvature_slope: of(&f.curvature_slope),
            left: of(&f.left),
            right: of(&f.right),
            left_slope: of(&f.left_slope),
            right_slope: of(&f.right_slope),
            bulge: of(&f.bulge),
            left_excess: of(&f.left_excess),
            right_excess: of(&f.right_excess),
            rounding: of(&f.rounding),
        };
        Self {
            spacing: 2.0 * self.spacing,
            lead: self.lead / 2,
            first_head: (self.first_head - first).div_euclid(2),
            count: self.count.div_ceil(2),
            fields,
            torn: Vec::new(),
            areas: self.areas.coarse(first),
            next_mark: Vec::new(),
            coarse: OnceCell::new(),
        }
    }

    /// Marks stations of the corridor.
    pub(super) fn mark(&mut self, stations: impl Iterator<Item = usize>) {
        stations.for_each(|k| self.next_mark[self.lead + k] = (self.lead + k) as u32);
        for k in (1..self.next_mark.len()).rev() {
            self.next_mark[k - 1] = self.next_mark[k - 1].min(self.next_mark[k]);
        }
    }

    /// The marked stations between two stations, both included.
    pub(super) fn marks(&self, from: usize, to: usize) -> impl Iterator<Item = usize> {
        let next = move |k: usize| Some(self.next_mark[k] as usize).filter(|&mark| mark <= to);
        std::iter::successors(next(from), move |&mark| next(mark + 1))
    }

    /// Number of extended stations.
    pub(super) fn len(&self) -> usize {
        self.fields.x.len()
    }
}

/// Slopes of values between a station's neighbours. They are one-sided at the ends of `inside` and zero beyond: the extension does not belong
/// to the corridor.
fn slopes(values: &[f64], inside: &Range<usize>, spacing: f64) -> Vec<f64> {
    let mut out = vec![0.0; values.len()];
    for k in inside.clone() {
        let (a, b) = (inside.start.max(k.saturating_sub(1)), (k + 1).min(inside.end - 1));
        if a < b {
            out[k] = (values[b] - values[a]) / ((b - a) as f64 * spacing);
        }
    }
    out
}

/// Bounds `e` and `q` on how much a half-width read by a station's slope exceeds the true one, which is linear between
/// stations. The excess divided by the way σ is greatest at a station. It is at most e up to the first station on
/// either side, and at most e + q(j − 1)h up to the j-th, so at most e + qσ. Half-widths that are not a number bound nothing.
fn excess(widths: &[f64], spacing: f64, slopes: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = widths.len();
    let most = (READ_M / spacing).ceil() as usize;
    let nothing = || std::iter::repeat_n(f64::NAN, most);
    let padded: Vec<f64> = nothing().chain(widths.iter().copied()).chain(nothing()).collect();
    let (mut e, mut q) = (vec![0.0_f64; n], vec![0.0_f64; n]);
    for j in 1..=most {
        let way = j as f64 * spacing;
        let (before, after) = (&padded[most - j..][..n], &padded[most + j..][..n]);
        let others = before.iter().zip(after).zip(widths.iter().zip(slopes));
        // `max` takes the other value where one is not a number.
        let over = others.map(|((before, after), (own, slope))| {
            let [before, after] = [(own - before) / way - slope, (own - after) / way + slope];
            before.max(after)
        });
        if j == 1 {
            e.iter_mut().zip(over).for_each(|(e, over)| *e = e.max(over));
        } else {
            let rest = 1.0 / (way - spacing);
            q.iter_mut().zip(&e).zip(over).for_each(|((q, e), over)| *q = q.max((over - e) * rest));
        }
    }
    e.iter_mut().chain(&mut q).for_each(|x| *x = if *x > ROUNDING { *x } else { 0.0 });
    (e, q)
}

/// A half-width that may be read anywhere within one station. If the width dips between two samples of a body point (a
/// kink of slope change Δ²w), the samples miss at most Δ²w/4 of the dip. On the inside of a curve the half-width ends
/// before the centre of curvature.
fn sampled_width(widths: &[f64], dips: &[f64], curvature: &[f64], side: f64) -> Vec<f64> {
    let last = widths.len() - 1;
    (0..widths.len())
        .map(|k| {
            let worst = dips[k.saturating_sub(1)].max(dips[k]).max(dips[(k + 1).min(last)]);
            let inward = curvature[k] * side;
            let reach = if inward > 0.0 { REACH / inward } else { f64::INFINITY };
            (widths[k] - worst / 4.0).min(reach)
        })
        .collect()
}

/// The greatest dip of either side within a body gap of each station, as a second derivative.
fn bulge(left: &[f64], right: &[f64], spacing: f64) -> Vec<f64> {
    let around = (MOST_GAP_M / spacing).ceil() as usize + 1;
    let mut out = vec![0.0; left.len()];
    for k in 0..left.len() {
        let dip = left[k].max(right[k]) / (spacing * spacing);
        if dip > DIP_ROUNDING {
            let end = (k + around + 1).min(out.len());
            for o in &mut out[k.saturating_sub(around)..end] {
                *o = dip.max(*o);
            }
        }
    }
    out
}

/// The corridor with its straight extensions, one column per field.
struct Places {
    x: Vec<f64>,
    y: Vec<f64>,
    tangent_x: Vec<f64>,
    tangent_y: Vec<f64>,
    curvature: Vec<f64>,
    left: Vec<f64>,
    right: Vec<f64>,
    /// Stations whose half-widths belong to the corridor. All others are open.
    bounded: Range<usize>,
}

impl Places {
    /// `lead` stations before the corridor's first, `total` in all.
    fn of(corridor: &Corridor, lead: usize, total: usize) -> Self {
        let (h, last) = (corridor.spacing_m, corridor.len() - 1);
        // A side that straddles an end is bounded by both its points, so the end's half-width continues under the point
        // beyond.
        let under = (0..lead).take_while(|&k| (k + 1) as f64 * h <= MOST_GAP_M + END_STATIONS * h).count();
        let bounded = lead - under..(lead + last + under + 1).min(total);
        let mut places = Self {
            x: vec![0.0; total],
            y: vec![0.0; total],
            tangent_x: vec![0.0; total],
            tangent_y: vec![0.0; total],
            curvature: vec![0.0; total],
            left: vec![OPEN_M; total],
            right: vec![OPEN_M; total],
            bounded: bounded.clone(),
        };
        let own = lead..lead + last + 1;
        for (k, heading) in own.clone().zip(&corridor.heading) {
            (places.tangent_y[k], places.tangent_x[k]) = heading.sin_cos();
        }
        let columns = [
            (&mut places.x, &corridor.x),
            (&mut places.y, &corridor.y),
            (&mut places.curvature, &corridor.curvature),
            (&mut places.left, &corridor.left_m),
            (&mut places.right, &corridor.right_m),
        ];
        columns.into_iter().for_each(|(to, from)| to[own.clone()].copy_from_slice(from));
        for (beyond, end) in [(0..lead, lead), (lead + last + 1..total, lead + last)] {
            let tangent = [places.tangent_x[end], places.tangent_y[end]];
            for k in beyond {
                let way = (k as f64 - end as f64) * h;
                places.x[k] = places.x[end] + way * tangent[0];
                places.y[k] = places.y[end] + way * tangent[1];
                [places.tangent_x[k], places.tangent_y[k]] = tangent;
                if bounded.contains(&k) {
                    (places.left[k], places.right[k]) = (places.left[end], places.right[end]);
                }
            }
        }
        places
    }

    /// Half-widths, not a number where the place is open.
    fn closed(&self, widths: &[f64]) -> Vec<f64> {
        let mut closed = vec![f64::NAN; widths.len()];
        closed[self.bounded.clone()].copy_from_slice(&widths[self.bounded.clone()]);
        closed
    }

    /// Δ²w of each station's half-width where it is positive: twice how far the half-width lies below the mean of its
    /// neighbours.
    fn dips(&self, widths: &[f64]) -> Vec<f64> {
        let mut dips = vec![0.0; widths.len()];
        let bounded = &self.bounded;
        let inner = dips[bounded.clone()].iter_mut().skip(1);
        for (dip, w) in inner.zip(widths[bounded.clone()].windows(3)) {
            *dip = (w[0] - 2.0 * w[1] + w[2]).max(0.0);
        }
        dips
    }
}

impl Fields<Vec<f64>> {
    /// Eight consecutive stations from `first`, which must be at most the number of stations less eight.
    #[inline(always)]
    pub(super) fn run<V: Vector>(&self, first: usize) -> Fields<V> {
        let of = |column: &[f64]| -> V {
            let mut out = [0.0; LANES];
            out.copy_from_slice(&column[first..first + LANES]);
            V::from(out)
        };
        self.each(of)
    }

    /// Eight stations anywhere.
    #[inline(always)]
    pub(super) fn gather<V: Vector>(&self, at: &[usize; LANES]) -> Fields<V> {
        let of = |column: &[f64]| -> V {
            let mut out = [0.0; LANES];
            for (o, &k) in out.iter_mut().zip(at) {
                *o = column[k];
            }
            V::from(out)
        };
        self.each(of)
    }

    #[inline(always)]
    fn each<V: Vector>(&self, of: impl Fn(&[f64]) -> V) -> Fields<V> {
        Fields {
            x: of(&self.x),
            y: of(&self.y),
            tangent_x: of(&self.tangent_x),
            tangent_y: of(&self.tangent_y),
            curvature: of(&self.curvature),
            curvature_slope: of(&self.curvature_slope),
            left: of(&self.left),
            right: of(&self.right),
            left_slope: of(&self.left_slope),
            right_slope: of(&self.right_slope),
            bulge: of(&self.bulge),
            left_excess: of(&self.left_excess),
            right_excess: of(&self.right_excess),
            rounding: of(&self.rounding),
        }
    }
}
