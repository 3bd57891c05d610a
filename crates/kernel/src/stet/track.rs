//! A corridor prepared for the sweep: extended straight at both ends, with derivatives, and with half-widths that hold
//! between samples.

use std::cell::OnceCell;

use super::lanes::{LANES, V};
use super::model::POINT_SPACING_M as MOST_GAP_M;
use super::plane::{Areas, Grounds};
use netcert_base::corridor::Corridor;

/// Half-width of the straight extensions beyond a body gap from the corridor: they are driven, not certified.
const OPEN_M: f64 = 1e6;

/// Convexity of a half-width, 1/m, above which each place of a side is examined by itself (`leeway`).
pub(super) const BULGE_MOST: f64 = 0.005;

/// Half-widths are read by a station's slope up to this far from it, metres. Nothing is certified farther away.
pub(super) const READ_M: f64 = 6.0;

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
    pub(super) areas: Areas,
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
        let tangents: Vec<(f64, f64)> = corridor.heading.iter().map(|heading| heading.sin_cos()).collect();
        let at = |k: usize| Place::of(corridor, &tangents, k as isize - lead as isize);
        let places: Vec<Place> = (0..total).map(at).collect();
        let slope = |value: &dyn Fn(&Place) -> f64| -> Vec<f64> {
            (0..total)
                .map(|k| {
                    // One-sided at the corridor's ends, zero beyond them: the extension does not belong to the
                    // corridor.
                    let inside = |k: usize| k >= lead && k < lead + count;
                    let a = if k > 0 && inside(k - 1) { k - 1 } else { k };
                    let b = if inside(k + 1) { k + 1 } else { k };
                    if !inside(k) || a == b {
                        0.0
                    } else {
                        (value(&places[b]) - value(&places[a])) / ((b - a) as f64 * h)
                    }
                })
                .collect()
        };
        let column = |value: &dyn Fn(&Place) -> f64| -> Vec<f64> { places.iter().map(value).collect() };
        let (left_dips, right_dips) = (dips(&places, |p| p.left), dips(&places, |p| p.right));
        let fields = Fields {
            x: column(&|p| p.x),
            y: column(&|p| p.y),
            tangent_x: column(&|p| p.tangent[0]),
            tangent_y: column(&|p| p.tangent[1]),
            curvature: column(&|p| p.curvature),
            curvature_slope: slope(&|p| p.curvature),
            left: sampled_width(&places, &left_dips, |p| p.left, 1.0),
            right: sampled_width(&places, &right_dips, |p| p.right, -1.0),
            left_slope: slope(&|p| p.left),
            right_slope: slope(&|p| p.right),
            bulge: bulge(&left_dips, &right_dips, h),
            left_excess: Vec::new(),
            right_excess: Vec::new(),
            rounding: Vec::new(),
        };
        let left = excess(&places, h, |p| p.left, &fields.left_slope);
        let right = excess(&places, h, |p| p.right, &fields.right_slope);
        let fields = Fields {
            rounding: left.iter().zip(&right).map(|(l, r)| l[1].max(r[1])).collect(),
            left_excess: left.into_iter().map(|[excess, _]| excess).collect(),
            right_excess: right.into_iter().map(|[excess, _]| excess).collect(),
            ..fields
        };
        let torn = corridor.torn().into_iter().map(|k| lead + k).collect();
        let next_mark = vec![u32::MAX; fields.x.len() + 1];
        let areas = Areas::new(corridor, lead, grounds);
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

/// Δ²w of each station's half-width where it is positive: twice how far the half-width lies below the mean of its
/// neighbours.
fn dips(places: &[Place], width: impl Fn(&Place) -> f64) -> Vec<f64> {
    (0..places.len())
        .map(|k| {
            let (a, b) = (&places[k.saturating_sub(1)], &places[(k + 1).min(places.len() - 1)]);
            if a.open || places[k].open || b.open {
                return 0.0;
            }
            (width(a) - 2.0 * width(&places[k]) + width(b)).max(0.0)
        })
        .collect()
}

/// Bounds `[e, q]` on how much a half-width read by a station's slope exceeds the true one, which is linear between
/// stations. The excess divided by the way σ is greatest at a station. It is at most e up to the first station on
/// either side, and at most e + q(j − 1)h up to the j-th, so at most e + qσ.
fn excess(places: &[Place], spacing: f64, width: fn(&Place) -> f64, slope: &[f64]) -> Vec<[f64; 2]> {
    let last = places.len() - 1;
    let most = (READ_M / spacing).ceil() as usize;
    // A half-width that does not change within reach is read exactly.
    let alike = alike(places, most, width);
    let of = |(k, own): (usize, &Place)| {
        let mut at = [0.0_f64; 2];
        if alike[k] && slope[k] == 0.0 {
            return at;
        }
        for j in (1..=most).filter(|_| !own.open) {
            let way = j as f64 * spacing;
            for (other, slope) in [(k.checked_sub(j), -slope[k]), (Some(k + j).filter(|&o| o <= last), slope[k])] {
                let Some(other) = other.map(|o| &places[o]).filter(|other| !other.open) else { continue };
                let over = (width(own) - width(other)) / way + slope;
                if j == 1 {
                    at[0] = at[0].max(over);
                } else {
                    at[1] = at[1].max((over - at[0]) / (way - spacing));
                }
            }
        }
        // Values up to 1e-9 are rounding errors.
        at.map(|x| if x > 1e-9 { x } else { 0.0 })
    };
    places.iter().enumerate().map(of).collect()
}

/// Whether all stations up to `most` before and after a station have its half-width.
fn alike(places: &[Place], most: usize, width: fn(&Place) -> f64) -> Vec<bool> {
    let mut out = vec![true; places.len()];
    let changes = places.windows(2).enumerate().filter(|(_, pair)| width(&pair[0]) != width(&pair[1]));
    for (k, _) in changes {
        let end = (k + most + 1).min(out.len());
        out[(k + 1).saturating_sub(most)..end].fill(false);
    }
    out
}

/// A half-width that may be read anywhere within one station. If the width dips between two samples of a body point (a
/// kink of slope change Δ²w), the samples miss at most Δ²w/4 of the dip. On the inside of a curve the half-width ends
/// before the centre of curvature.
fn sampled_width(places: &[Place], dips: &[f64], width: impl Fn(&Place) -> f64, side: f64) -> Vec<f64> {
    (0..places.len())
        .map(|k| {
            let worst = dips[k.saturating_sub(1)].max(dips[k]).max(dips[(k + 1).min(places.len() - 1)]);
            let inward = places[k].curvature * side;
            let reach = if inward > 0.0 { REACH / inward } else { f64::INFINITY };
            (width(&places[k]) - worst / 4.0).min(reach)
        })
        .collect()
}

/// The greatest dip of either side within a body gap of each station, as a second derivative.
fn bulge(left: &[f64], right: &[f64], spacing: f64) -> Vec<f64> {
    let around = (MOST_GAP_M / spacing).ceil() as usize + 1;
    let mut out = vec![0.0; left.len()];
    for k in 0..left.len() {
        let dip = left[k].max(right[k]) / (spacing * spacing);
        // Dips up to 1e-6 1/m are rounding errors.
        if dip > 1e-6 {
            let end = (k + around + 1).min(out.len());
            for o in &mut out[k.saturating_sub(around)..end] {
                *o = dip.max(*o);
            }
        }
    }
    out
}

struct Place {
    x: f64,
    y: f64,
    /// Along the corridor.
    tangent: [f64; 2],
    curvature: f64,
    left: f64,
    right: f64,
    open: bool,
}

impl Place {
    /// Station `k` of the corridor, or of its straight extension before 0 and after the last. `tangents` holds the sine and the cosine of
    /// each station's heading.
    fn of(corridor: &Corridor, tangents: &[(f64, f64)], k: isize) -> Self {
        let last = corridor.len() as isize - 1;
        let i = k.clamp(0, last);
        let beyond = (k - i) as f64 * corridor.spacing_m;
        let i = i as usize;
        let (sin, cos) = tangents[i];
        // A side that straddles an end is bounded by both its points, so the end's half-width continues under the point
        // beyond.
        let open = beyond.abs() > MOST_GAP_M + 1.5 * corridor.spacing_m;
        Self {
            x: corridor.x[i] + beyond * cos,
            y: corridor.y[i] + beyond * sin,
            tangent: [cos, sin],
            curvature: if beyond != 0.0 { 0.0 } else { corridor.curvature[i] },
            left: if open { OPEN_M } else { corridor.left_m[i] },
            right: if open { OPEN_M } else { corridor.right_m[i] },
            open,
        }
    }
}

impl Fields<Vec<f64>> {
    /// Eight consecutive stations from `first`, which must be at most the number of stations less eight.
    #[inline(always)]
    pub(super) fn run(&self, first: usize) -> Fields<V> {
        let of = |column: &[f64]| -> V {
            let mut out = [0.0; LANES];
            out.copy_from_slice(&column[first..first + LANES]);
            V(out)
        };
        self.each(of)
    }

    /// Eight stations anywhere.
    #[inline(always)]
    pub(super) fn gather(&self, at: &[usize; LANES]) -> Fields<V> {
        let of = |column: &[f64]| -> V {
            let mut out = [0.0; LANES];
            for (o, &k) in out.iter_mut().zip(at) {
                *o = column[k];
            }
            V(out)
        };
        self.each(of)
    }

    #[inline(always)]
    fn each(&self, of: impl Fn(&[f64]) -> V) -> Fields<V> {
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
