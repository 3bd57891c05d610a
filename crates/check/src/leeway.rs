//! From tubes to leeway (proof, section 7), compared with the claims by branch and bound.
//!
//! A cell is one side of one body, from `a0` to `a1` ahead of its axle, during part of a step. Its leeway is at least
//! that of its four corners less what second derivatives along the body and in time can take away. If that is too
//! little, the cell is halved, or the adjoint's bounds replace its tubes. Nothing is sampled: each cell ends with a
//! bound not below the claim, or with a place where the bound is below the claim.

use std::ops::{Range, RangeInclusive};

use crate::cell::{Cell, Corner};
use crate::feet::{Hint, point};
use crate::gains::Knots;
use crate::motion::Pose;
use crate::swept_vehicle::{ABOUT, KNOT_M, SweptVehicle};
use crate::targets::{Shortfalls, Targets};
use netcert_base::watch;

/// Decisions closer than this are repeated in intervals, metres.
pub(crate) const CLOSE_M: f64 = 1e-6;
/// Most halvings of a cell: from 15 m of body to 1 mm.
const MOST_HALVINGS: u32 = 16;
/// So often a cell is halved in any case, because bounds differ along a body.
const LEAST_HALVINGS: u32 = 4;
/// A cell that has been halved more often than this is sharpened, even if halving would help.
const DULL_HALVINGS: u32 = 5;
/// The part of the allowances that goes when a cell is halved: what is left is a quarter.
const HALVING_SAVES: f64 = 0.75;
/// A cell this many times longer than the way of its coupling is halved along its body, whatever takes away more.
const LONG: f64 = 4.0;
/// The adjoint runs only for pieces of a body no longer than this, metres. One run costs as much as some hundred
/// halvings.
const SHARP_M: f64 = 1.0;
/// Most halvings of a cell with a corner without foot. The remaining cell touches every normal that passes within
/// `NEAR_M`, but no road farther along than `FOOTLESS_M` (metres).
const FOOTLESS_HALVINGS: u32 = 5;
const FOOTLESS_M: f64 = 6.0;
const NEAR_M: f64 = 0.1;
/// Least square of a cosine in a quotient. A corner has a greater one (`cell`).
const LEAST_SQUARE: f64 = 0.01;
/// No body is so short, metres; it only keeps a quotient finite.
const TINY_M: f64 = 1e-9;

/// What a cell turns out to be.
enum Fate {
    /// Its bound is not below the claim, or nothing is claimed of it.
    Kept,
    /// The adjoint may improve its bounds at these knots. Then it is decided again.
    Dull(Range<usize>),
    /// Only its halves can be decided.
    Halved([Cell; 2]),
    /// Its bound is so far below the greatest claim on these stretches, metres.
    Short(f64, RangeInclusive<usize>),
}

impl SweptVehicle<'_> {
    /// Decides a cell by exact corners.
    pub(crate) fn cell(&mut self, cell: &Cell, hints: [Hint; 2], targets: &Targets, found: &mut Shortfalls) {
        watch::poll();
        let poses = cell.t.map(|t| self.pose(cell.step, cell.unit, t));
        let Some(all) = self.cell_corners(cell, &poses, hints) else {
            return self.footless(cell, &poses, targets, found);
        };
        match self.fate(cell, &poses, &all, targets, found) {
            Fate::Kept => {}
            Fate::Dull(knots) => {
                self.sharpen(cell.step, cell.unit, knots);
                self.cell(cell, [all[0].hint(), all[1].hint()], targets, found);
            }
            Fate::Halved(halves) => {
                for half in &halves {
                    self.cell(half, hints_of(half, cell, &all), targets, found);
                }
            }
            Fate::Short(short_m, stretches) => {
                let less =
                    |least: Corner, c: &Corner| if c.clear - c.dev < least.clear - least.dev { *c } else { least };
                let least = all.iter().fold(all[0], less);
                let point_m = if least.s == all[0].s || least.s == all[2].s { cell.a[0] } else { cell.a[1] };
                found.add(cell, least.s - self.road.lead as f64, point_m, short_m, stretches, targets);
            }
        }
    }

    /// The corners of a cell, rear before front, at its start and then at its end.
    fn cell_corners(&self, cell: &Cell, poses: &[Pose; 2], hints: [Hint; 2]) -> Option<[Corner; 4]> {
        // Rough feet: the hint, or the place on a straight road.
        let guess = |k: usize| {
            if hints[k].s.is_nan() { Hint::at(self.rough_foot(cell.step, cell.unit, cell.a[k])) } else { hints[k] }
        };
        let mut feet = [guess(0), guess(1)];
        let mut corners = [[None; 2]; 2];
        for (t, pose) in poses.iter().enumerate() {
            for k in 0..2 {
                corners[t][k] = self.corner(cell, *pose, cell.a[k], feet[k]);
                if let Some(corner) = corners[t][k] {
                    feet[k] = corner.hint();
                }
            }
        }
        let [[c00, c01], [c10, c11]] = corners;
        Some([c00?, c01?, c10?, c11?])
    }

    /// A corner has no foot or no bound, so claims about any stretch that the cell may touch are not proved.
    fn footless(&mut self, cell: &Cell, poses: &[Pose; 2], targets: &Targets, found: &mut Shortfalls) {
        if self.tubes.get(cell.step, cell.unit).is_none() || cell.halvings >= FOOTLESS_HALVINGS {
            return found.unbounded(cell, &self.touched(cell, poses), targets);
        }
        let middle = f64::midpoint(cell.a[0], cell.a[1]);
        for a in [[cell.a[0], middle], [middle, cell.a[1]]] {
            let half = Cell { a, halvings: cell.halvings + 1, ..*cell };
            self.cell(&half, [Hint::NONE; 2], targets, found);
        }
    }

    /// What becomes of a cell with all of its corners.
    fn fate(&self, cell: &Cell, poses: &[Pose; 2], all: &[Corner; 4], targets: &Targets, found: &Shortfalls) -> Fate {
        let range = all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], c| [lo.min(c.s), hi.max(c.s)]);
        let (first, last) = self.range([range[0] - ABOUT, range[1] + ABOUT]);
        let Some(target) = found.target(targets, cell.side, first, last) else { return Fate::Kept };
        let base = all.iter().map(|c| c.clear - c.dev).fold(f64::INFINITY, f64::min);
        let (time, body) = self.allowances(cell, all, range);
        let bound = base - time - body;
        if bound >= target + CLOSE_M || bound >= target && self.sure(cell, poses, all, time + body, target) {
            return Fate::Kept;
        }
        let slack = bound - target;
        // Halving divides the allowances by four, so it helps while the allowances are what is missing.
        let halving_helps = slack + HALVING_SAVES * (time + body) >= 0.0 && time + body > 0.0;
        let knots = self.knots(cell, all);
        let wants = !halving_helps || cell.halvings > DULL_HALVINGS;
        let dull = wants && self.worth(cell.step, cell.unit) && !self.sharp(cell.step, cell.unit, &knots);
        if dull && (cell.a[1] - cell.a[0]).abs() <= SHARP_M {
            return Fate::Dull(knots);
        }
        // A cell over several stretches may be tested for another stretch's claim. Nothing is claimed beyond the corridor's ends.
        let ends = [self.road.lead as f64, (self.road.lead + self.road.count - 1) as f64];
        let spread = last > first || all.iter().any(|corner| corner.s < ends[0] || corner.s > ends[1]);
        let halve = halving_helps || spread || dull || cell.halvings < LEAST_HALVINGS;
        if cell.halvings < MOST_HALVINGS && halve {
            let along = dull || body > time || self.is_long(cell);
            return Fate::Halved(if along { halves_along(cell) } else { halves_in_time(cell) });
        }
        Fate::Short(-slack, first..=last)
    }

    /// Whether a cell is long for the time that it takes.
    fn is_long(&self, cell: &Cell) -> bool {
        let [[a0, a1], [t0, t1]] = [cell.a, cell.t];
        (a1 - a0).abs() > LONG * self.tubes.step_m * (t1 - t0)
    }

    /// Stretches of the corridor whose normals may pass through a cell: it lies ahead of the stretch's first station
    /// and not ahead of its second.
    fn touched(&self, cell: &Cell, poses: &[Pose; 2]) -> Vec<usize> {
        let sign = if cell.side == 0 { 1.0 } else { -1.0 };
        let b = sign * self.chain.links[cell.unit].half_width;
        let points: Vec<[f64; 2]> = poses.iter().flat_map(|pose| cell.a.map(|a| point(*pose, a, b))).collect();
        let ahead = |k: usize| {
            let place = self.road.place(k as f64);
            points.iter().map(move |x| (x[0] - place.c[0]) * place.t[0] + (x[1] - place.c[1]) * place.t[1])
        };
        let middle = self.rough_foot(cell.step, cell.unit, f64::midpoint(cell.a[0], cell.a[1]));
        let reach = (0.5 * (cell.a[1] - cell.a[0]) + FOOTLESS_M) / self.road.spacing;
        let from = ((middle - reach).max(self.road.lead as f64)) as usize;
        let to = ((middle + reach).max(0.0) as usize).min(self.road.lead + self.road.count - 1);
        (from..to)
            .filter(|&k| ahead(k).any(|x| x > -NEAR_M) && ahead(k + 1).any(|x| x < NEAR_M))
            .map(|k| k - self.road.lead)
            .collect()
    }

    /// The knots that a cell's bounds rest on.
    fn knots(&self, cell: &Cell, all: &[Corner; 4]) -> Range<usize> {
        let link = &self.chain.links[cell.unit];
        let slide = all.iter().map(|c| link.half_width * c.sin.abs() / (1.0 - c.sin * c.sin).max(LEAST_SQUARE).sqrt());
        let slide = slide.fold(0.0, f64::max);
        Knots::new(link, KNOT_M).about([cell.a[0] - slide, cell.a[1] + slide])
    }
}

/// The halves of a cell along its body.
fn halves_along(cell: &Cell) -> [Cell; 2] {
    let mut halves = [Cell { halvings: cell.halvings + 1, ..*cell }; 2];
    let middle = f64::midpoint(cell.a[0], cell.a[1]);
    (halves[0].a[1], halves[1].a[0]) = (middle, middle);
    halves
}

/// The halves of a cell in time.
fn halves_in_time(cell: &Cell) -> [Cell; 2] {
    let mut halves = [Cell { halvings: cell.halvings + 1, ..*cell }; 2];
    let middle = f64::midpoint(cell.t[0], cell.t[1]);
    (halves[0].t[1], halves[1].t[0]) = (middle, middle);
    halves
}

/// Where the feet of a half's ends are searched from: known feet, or the place between them.
fn hints_of(half: &Cell, cell: &Cell, all: &[Corner; 4]) -> [Hint; 2] {
    let [a0, a1] = cell.a;
    half.a.map(|a| match a {
        _ if a == a0 => all[0].hint(),
        _ if a == a1 => all[1].hint(),
        _ => Hint::at(all[0].s + (all[1].s - all[0].s) * (a - a0) / (a1 - a0).max(TINY_M)),
    })
}
