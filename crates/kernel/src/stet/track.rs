//! A corridor made ready for the sweep: extended straight at both ends, with derivatives, and with the widths that
//! the sampling may rely on.

use super::lanes::{LANES, V};
use super::model::POINT_SPACING_M as MOST_GAP_M;
use netcert_base::corridor::Corridor;

/// Half-width of the straight extensions, a body gap away from the corridor: they are driven, not certified.
const OPEN_M: f64 = 1e6;

/// Convexity of a half-width, 1/m, above which each of its places counts for itself (`leeway`).
pub(super) const BULGE_MOST: f64 = 0.005;

/// Widths are read by the slope of a station up to so far from it, metres; farther, nothing is certified.
pub(super) const READ_M: f64 = 6.0;

/// Points are trusted to lie at their foot station while |κ·lateral| stays below this.
const REACH: f64 = 0.9;

/// Stations of the extended corridor, one array a field, and how it lies in the original.
pub(super) struct Track {
    pub(super) spacing: f64,
    /// Extended stations before the corridor's first.
    pub(super) lead: usize,
    /// The steer axle's first station: no body point is on the corridor yet.
    pub(super) first_head: usize,
    /// Stations of the corridor itself.
    pub(super) count: usize,
    pub(super) fields: Fields<Vec<f64>>,
    /// Stations that do not fit their neighbours: nothing is certified there.
    pub(super) torn: Vec<usize>,
    /// The next station from each one on at which a span begins or ends; what a side leaves there between two of its points counts.
    next_mark: Vec<u32>,
}

/// How far a track goes beyond its corridor, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extensions {
    pub(super) lead_m: f64,
    pub(super) tail_m: f64,
    /// How far ahead of its steer axle a vehicle reaches at most.
    pub(super) front_m: f64,
}

/// What the foot of a body point needs of the corridor.
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
    /// By how much a half-width read by its slope is too great at most, σ from the station: by `excess`·σ + `rounding`·σ², up to
    /// [`READ_M`]; `rounding` serves both sides.
    pub(super) left_excess: T,
    pub(super) right_excess: T,
    pub(super) rounding: T,
}

impl Track {
    /// For vehicles that reach `front_m` ahead of their steer axles and need so much road before and behind the corridor.
    pub(super) fn new(corridor: &Corridor, Extensions { lead_m, tail_m, front_m }: Extensions) -> Self {
        let h = corridor.spacing_m;
        let count = corridor.len();
        let lead = (lead_m / h).ceil() as usize + LANES;
        let first_head = lead - (front_m / h).ceil() as usize - 2;
        let total = lead + count + (tail_m / h).ceil() as usize + LANES;
        let at = |k: usize| Place::of(corridor, k as isize - lead as isize);
        let places: Vec<Place> = (0..total).map(at).collect();
        let slope = |value: &dyn Fn(&Place) -> f64| -> Vec<f64> {
            (0..total)
                .map(|k| {
                    // One-sided at the corridor's ends, none beyond them: the extension is not the corridor's.
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
            tangent_x: column(&|p| p.heading.cos()),
            tangent_y: column(&|p| p.heading.sin()),
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
        Self { spacing: h, lead, first_head, count, fields, torn, next_mark }
    }

    /// Every second station, for planning, which does not ask whether they fit; the corridor's first is among them.
    pub(super) fn coarse(&self) -> Self {
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
            next_mark: Vec::new(),
        }
    }

    /// Marks stations of the corridor.
    pub(super) fn mark(&mut self, stations: impl Iterator<Item = usize>) {
        stations.for_each(|k| self.next_mark[self.lead + k] = (self.lead + k) as u32);
        for k in (1..self.next_mark.len()).rev() {
            self.next_mark[k - 1] = self.next_mark[k - 1].min(self.next_mark[k]);
        }
    }

    /// The marked stations between two, both included.
    pub(super) fn marks(&self, from: usize, to: usize) -> impl Iterator<Item = usize> {
        let next = move |k: usize| Some(self.next_mark[k] as usize).filter(|&mark| mark <= to);
        std::iter::successors(next(from), move |&mark| next(mark + 1))
    }

    /// Number of extended stations.
    pub(super) fn len(&self) -> usize {
        self.fields.x.len()
    }
}

/// How much each station's half-width lies below the mean of its neighbours', doubled: Δ²w where it is positive.
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

/// How fast a half-width read by the slope of a station leaves the true one at most, which is linear between stations: what the reading
/// is over, divided by the way σ, is greatest at a station. Up to the first on either side it is e at most, up to the j-th
/// no more than e + q(j − 1)h, so e + qσ before: `[e, q]`.
fn excess(places: &[Place], spacing: f64, width: fn(&Place) -> f64, slope: &[f64]) -> Vec<[f64; 2]> {
    let last = places.len() - 1;
    let most = (READ_M / spacing).ceil() as usize;
    let of = |(k, own): (usize, &Place)| {
        let mut at = [0.0_f64; 2];
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
        // A billionth is rounding.
        at.map(|x| if x > 1e-9 { x } else { 0.0 })
    };
    places.iter().enumerate().map(of).collect()
}

/// A half-width that may be read anywhere within one station of where it stands: where the width dips between the
/// places a body point is sampled at (a kink of slope change Δ²w), at most Δ²w/4 of the dip is missed. On the inside of
/// a curve it ends before the centre of curvature.
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

/// The greatest dip of either side within a gap between body points of each station, as a second derivative.
fn bulge(left: &[f64], right: &[f64], spacing: f64) -> Vec<f64> {
    let around = (MOST_GAP_M / spacing).ceil() as usize + 1;
    let mut out = vec![0.0; left.len()];
    for k in 0..left.len() {
        let dip = left[k].max(right[k]) / (spacing * spacing);
        // A thousandth of a millimetre of roundness is rounding.
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
    heading: f64,
    curvature: f64,
    left: f64,
    right: f64,
    open: bool,
}

impl Place {
    /// Station `k` of the corridor, or of its straight extension before 0 and after the last.
    fn of(corridor: &Corridor, k: isize) -> Self {
        let last = corridor.len() as isize - 1;
        let i = k.clamp(0, last);
        let beyond = (k - i) as f64 * corridor.spacing_m;
        let i = i as usize;
        let heading = corridor.heading[i];
        // A side that straddles an end is bounded from both its points: the end's width goes on under the one beyond.
        let open = beyond.abs() > MOST_GAP_M + 1.5 * corridor.spacing_m;
        Self {
            x: corridor.x[i] + beyond * heading.cos(),
            y: corridor.y[i] + beyond * heading.sin(),
            heading,
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
