//! The corridor along a path: the road driven before it, the path itself and the road driven after it, with the area
//! that counts meanwhile.

use std::ops::Range;
use std::sync::Arc;

use geo::Polygon;

use super::arm::Arm;
use super::islands;
use super::path::{self, STEP_M};
use super::rays::Widths;
use super::{Joint, LengthClass, TurnPath};
use crate::corridor::{AreaSpan, Corridor, PlaneArea, open_ends};

/// Turns tighter than the first value (metres) have stations as close as the second (metres). Bounds are then as tight
/// as in wider turns.
const TIGHT_M: [(f64, f64); 2] = [(6.0, 0.25), (25.0, 0.5)];
/// How often station spacing may be halved where stations step over transitions and would not form a curve. A carter's
/// corner has transitions of half a metre.
const HALVINGS: usize = 2;
/// The area counts from this far before a path leaves its road, metres. Where half-widths open at the joint, a certificate along the
/// corridor deducts a part of the kink. The area has no such kink, so it should count as soon as a front reaches the joint.
const BEFORE_M: f64 = 8.0;
/// The area counts until the longest vehicle's rear is this far on the road that it joins, metres.
const BEYOND_M: f64 = 5.0;

/// The places where a path leaves one road and joins the other.
pub(super) struct Ends<'a> {
    pub(super) arms: [&'a Arm; 2],
    pub(super) strokes: [u32; 2],
    /// One station per arm.
    pub(super) stations: [usize; 2],
    pub(super) length_class: LengthClass,
    /// Islands that the turn's area lacks.
    pub(super) islands: &'a [Polygon],
}

impl Ends<'_> {
    /// The corridor along one path, with the road driven before and after it.
    pub(super) fn path(
        &self,
        code: i64,
        points: &[[f64; 2]],
        mut widths: Widths,
        area: &Arc<PlaneArea>,
    ) -> Option<TurnPath> {
        let [from, to] = self.arms;
        let [leave, join] = self.stations;
        // No steps at the joints.
        widths.gentle(
            points,
            [from.before_joint(leave, leave, self.length_class), to.after_joint(join, join, self.length_class)],
        );
        let before =
            ((self.length_class.run_in_m() + self.length_class.counted_before_m()) / from.line.spacing_m) as usize;
        let after = (self.length_class.counted_after_m() / to.line.spacing_m) as usize;
        let lead = leave.saturating_sub(before)..leave;
        let tail = join + 1..(join + 1 + after).min(to.len());
        let mut line = Line::default();
        for k in lead.clone() {
            let [left_m, right_m] = from.before_joint(k, leave, self.length_class);
            line.push(from.point(k), left_m, right_m);
        }
        let begins = line.length_m;
        for (k, &p) in points.iter().enumerate() {
            line.push(p, widths.left_m[k], widths.right_m[k]);
        }
        let ends = line.length_m;
        for k in tail.clone() {
            let [left_m, right_m] = to.after_joint(k, join, self.length_class);
            line.push(to.point(k), left_m, right_m);
        }
        let min_radius_m = 1.0 / path::sharpest(points).max(1e-9);
        let tight = TIGHT_M.into_iter().find(|(radius_m, _)| min_radius_m < *radius_m);
        let spacing_m = tight.map_or(from.line.spacing_m, |(_, spacing_m)| spacing_m);
        let sampled = |halvings: usize| {
            let spacing_m = spacing_m / (1 << halvings) as f64;
            let corridor =
                crate::corridor::from_centreline(&line.points, &line.left_m, &line.right_m, 0.0, spacing_m).ok()?;
            let last = corridor.len() - 1;
            let station = |m: f64| (m / corridor.spacing_m).round().clamp(0.0, last as f64) as usize;
            let turn = nearest(&corridor, from.point(leave), station(begins))
                ..nearest(&corridor, to.point(join), station(ends)) + 1;
            let counted = station(begins - self.length_class.counted_before_m())..last + 1;
            let whole = !corridor.torn().iter().any(|k| turn.contains(k));
            whole.then_some((corridor, turn, counted))
        };
        let (mut corridor, turn, counted) = (0..=HALVINGS).find_map(sampled)?;
        let span = self.area(&corridor, &turn, area);
        corridor.areas.extend(span.clone());
        // A road may end with the corridor: its area ends there, too.
        open_ends(&mut corridor, [from.complete[0] && lead.start == 0, to.complete[1] && tail.end == to.len()]);
        islands::cut_out(&mut corridor.areas, self.islands);
        Some(TurnPath {
            code,
            area: span,
            turn,
            counted,
            approach: Joint { stroke: self.strokes[0], station: from.first + leave },
            departure: Joint { stroke: self.strokes[1], station: to.first + join },
            min_radius_m,
            corridor,
        })
    }

    /// The stations at which the junction's area counts: from shortly before the path leaves its road until all of the
    /// vehicle has joined the other one. `None` if the corridor ends at once.
    fn area(&self, corridor: &Corridor, turn: &Range<usize>, area: &Arc<PlaneArea>) -> Option<AreaSpan> {
        let stations = |m: f64| (m / corridor.spacing_m).ceil() as usize;
        let joined = turn.end.saturating_sub(1);
        let start = turn.start.saturating_sub(stations(BEFORE_M));
        let end =
            (joined + stations(self.length_class.longest_m() + BEYOND_M) + 1).min(corridor.len().saturating_sub(1));
        (end >= start + 2).then(|| AreaSpan { heads: start..end, area: Arc::clone(area) })
    }
}

/// The station nearest to a point, searched from a close guess. (Chords are shorter than the corridor.)
fn nearest(corridor: &Corridor, p: [f64; 2], guess: usize) -> usize {
    let far = |k: usize| (corridor.x[k] - p[0]).hypot(corridor.y[k] - p[1]);
    let around = guess.saturating_sub(8)..(guess + 9).min(corridor.len());
    around.min_by(|&a, &b| far(a).total_cmp(&far(b))).unwrap_or(guess)
}

/// A centreline's points with half-widths, without repeated points.
#[derive(Default)]
struct Line {
    points: Vec<[f64; 2]>,
    left_m: Vec<f64>,
    right_m: Vec<f64>,
    length_m: f64,
}

impl Line {
    fn push(&mut self, p: [f64; 2], left_m: f64, right_m: f64) {
        if let Some(last) = self.points.last() {
            let step = (p[0] - last[0]).hypot(p[1] - last[1]);
            if step < 0.2 * STEP_M {
                let k = self.points.len() - 1;
                self.narrow(k, left_m, right_m);
                return;
            }
            self.length_m += step;
        }
        self.points.push(p);
        self.left_m.push(left_m);
        self.right_m.push(right_m);
    }

    fn narrow(&mut self, k: usize, left_m: f64, right_m: f64) {
        if let (Some(left), Some(right)) = (self.left_m.get_mut(k), self.right_m.get_mut(k)) {
            (*left, *right) = (left.min(left_m), right.min(right_m));
        }
    }
}
