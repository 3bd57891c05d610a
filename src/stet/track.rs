//! A corridor made ready for the sweep: extended straight at both ends, with derivatives, and with the widths that
//! the sampling may rely on.

use super::lanes::{LANES, V};
use crate::corridor::Corridor;

/// Half-width of the straight extensions: they are driven, not certified.
const OPEN_M: f64 = 1e6;

/// Points are trusted to lie at their foot station while |κ·lateral| stays below this.
const REACH: f64 = 0.9;

/// Stations of the extended corridor, one array a field, and how it lies in the original.
pub(super) struct Track {
    pub(super) spacing: f64,
    /// Extended stations before the corridor's first.
    pub(super) lead: usize,
    /// Stations of the corridor itself.
    pub(super) count: usize,
    pub(super) fields: Fields<Vec<f64>>,
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
}

impl Track {
    /// `lead_m` and `tail_m` are the lengths of the straight extensions.
    pub(super) fn new(corridor: &Corridor, lead_m: f64, tail_m: f64) -> Self {
        let h = corridor.spacing_m;
        let count = corridor.len();
        let lead = (lead_m / h).ceil() as usize + LANES;
        let total = lead + count + (tail_m / h).ceil() as usize + LANES;
        let at = |k: usize| Place::of(corridor, k as isize - lead as isize);
        let places: Vec<Place> = (0..total).map(at).collect();
        let slope = |value: &dyn Fn(&Place) -> f64| -> Vec<f64> {
            (0..total)
                .map(|k| {
                    let (a, b) = (&places[k.saturating_sub(1)], &places[(k + 1).min(total - 1)]);
                    // No slope into the open: the extension's width is not a width.
                    if a.open != b.open { 0.0 } else { (value(b) - value(a)) / (2.0 * h) }
                })
                .collect()
        };
        let column = |value: &dyn Fn(&Place) -> f64| -> Vec<f64> { places.iter().map(value).collect() };
        let fields = Fields {
            x: column(&|p| p.x),
            y: column(&|p| p.y),
            tangent_x: column(&|p| p.heading.cos()),
            tangent_y: column(&|p| p.heading.sin()),
            curvature: column(&|p| p.curvature),
            curvature_slope: slope(&|p| p.curvature),
            left: sampled_width(&places, |p| p.left, 1.0),
            right: sampled_width(&places, |p| p.right, -1.0),
            left_slope: slope(&|p| p.left),
            right_slope: slope(&|p| p.right),
        };
        Self { spacing: h, lead, count, fields }
    }

    /// Number of extended stations.
    pub(super) fn len(&self) -> usize {
        self.fields.x.len()
    }
}

/// A half-width that may be read anywhere within one station of where it stands: where the width dips between the
/// places a body point is sampled at (a kink of slope change Δ²w), at most Δ²w/4 of the dip is missed. On the inside of
/// a curve it ends before the centre of curvature.
fn sampled_width(places: &[Place], width: impl Fn(&Place) -> f64, side: f64) -> Vec<f64> {
    let total = places.len();
    let dip = |k: usize| {
        if k == 0 || k + 1 >= total || places[k - 1].open || places[k].open || places[k + 1].open {
            return 0.0;
        }
        (width(&places[k - 1]) - 2.0 * width(&places[k]) + width(&places[k + 1])).max(0.0)
    };
    (0..total)
        .map(|k| {
            let worst = dip(k.saturating_sub(1)).max(dip(k)).max(dip((k + 1).min(total - 1)));
            let inward = places[k].curvature * side;
            let reach = if inward > 0.0 { REACH / inward } else { f64::INFINITY };
            (width(&places[k]) - worst / 4.0).min(reach)
        })
        .collect()
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
        let open = beyond != 0.0;
        Self {
            x: corridor.x[i] + beyond * heading.cos(),
            y: corridor.y[i] + beyond * heading.sin(),
            heading,
            curvature: if open { 0.0 } else { corridor.curvature[i] },
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
        }
    }
}
