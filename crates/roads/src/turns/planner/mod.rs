//! The search for the path with the most room for a vehicle, in the plane.
//!
//! It begins with a family of paths, keeps the best few and varies their parameters. It decides nothing: paths are
//! certified afterwards. The same turn and vehicle always give the same paths.

mod field;
mod score;

use field::Field;
use score::{Score, Scorer};

use super::LengthClass;
use super::code::{PARAMETERS, PathCode};
use super::corridors::TurnCorridors;
use crate::vehicle::Vehicle;

/// Paths told at most, and seeds that are refined.
const KEPT: usize = 3;
/// A path with this score is good enough, metres.
const EASY_M: f64 = 0.3;
/// Turns whose best seed scores less are given up, metres: for vehicles up to 20 m, and for longer ones. On Sydney and Heidelberg no turn
/// became safe whose best seed scored less than -0.84 m, and -1.42 m for a B-double.
const HOPELESS_M: [f64; 2] = [-1.1, -1.5];
/// Seeds that score even less by this are kept only where none scores more, metres.
const FAR_M: f64 = 0.5;
/// Distances between the moments at which seeds and refined paths are scored, metres.
const COARSE_M: f64 = 2.0;
const FINE_M: f64 = 1.0;
/// Paths that are scored to refine a seed.
const TRIES: usize = 160;
/// Failures in a row after which steps are halved.
const PATIENCE: usize = 14;
/// First steps of the parameters, in steps of the code's grid.
const FIRST_STEPS: [i16; PARAMETERS] = [8, 8, 4, 4, 8, 8, 2, 2, 2, 2];
/// Beyond the node and the roads' meeting place, metres: how far the field reaches.
const AROUND_M: f64 = 80.0;

/// A path that the search found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedPath {
    /// Its code.
    pub code: i64,
    /// Its score, metres: about the leeway that a certificate may find, less what steering and hinges lack.
    pub score_m: f64,
    /// About the leeway that a certificate may find, metres.
    pub room_m: f64,
}

impl PlannedPath {
    const fn new(code: i64, Score { score_m, room_m }: Score) -> Self {
        Self { code, score_m, room_m }
    }
}

/// Plans paths of one turn, for any vehicles of its length class.
pub struct TurnPlanner<'a> {
    made: &'a TurnCorridors,
    field: Field,
}

impl<'a> TurnPlanner<'a> {
    /// Prepares a turn.
    #[must_use]
    pub fn new(made: &'a TurnCorridors) -> Self {
        let [from, to] = made.arms();
        let (a, b) = (from.point(from.node), to.point(to.node));
        let centre = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let apart_m = 0.5 * (a[0] - b[0]).hypot(a[1] - b[1]);
        let field = Field::new(&made.opened(), centre, apart_m + AROUND_M + made.length_class().longest_m());
        Self { made, field }
    }

    /// Up to three paths, the best one first. None if no seed can be driven at all.
    pub fn plan(&mut self, vehicle: &Vehicle) -> Vec<PlannedPath> {
        let made = self.made;
        let mut scorer = Scorer::new(made, vehicle);
        let mut best = self.seeds(&mut scorer, KEPT, self.hopeless_m() - FAR_M);
        let Some(first) = best.first().copied() else { return best };
        if first.score_m >= EASY_M || first.score_m < self.hopeless_m() || PathCode::decode(first.code).is_none() {
            return best;
        }
        let mut draw = Draw(0x9e37_79b9_7f4a_7c15);
        for planned in &mut best {
            self.refine(&mut scorer, planned, &mut draw);
            if planned.score_m >= EASY_M {
                break;
            }
        }
        best.sort_by(|a, b| b.score_m.total_cmp(&a.score_m).then(a.code.cmp(&b.code)));
        best.dedup_by_key(|planned| planned.code);
        best
    }

    fn hopeless_m(&self) -> f64 {
        match self.made.length_class() {
            LengthClass::Short => HOPELESS_M[0],
            LengthClass::Long => HOPELESS_M[1],
        }
    }

    /// The `count` seeds with the best scores, the best one first.
    #[must_use]
    pub fn best_seeds(&mut self, vehicle: &Vehicle, count: usize) -> Vec<PlannedPath> {
        let made = self.made;
        self.seeds(&mut Scorer::new(made, vehicle), count, f64::NEG_INFINITY)
    }

    /// The `count` seeds with the best scores, the best one first. Only the best one may score less than `least_m`.
    fn seeds(&mut self, scorer: &mut Scorer<'_>, count: usize, least_m: f64) -> Vec<PlannedPath> {
        let mut best: Vec<PlannedPath> = Vec::new();
        for code in self.made.seeds() {
            let first_m = best.first().map_or(f64::NEG_INFINITY, |first| first.score_m);
            let last_m = if best.len() < count { f64::NEG_INFINITY } else { best[count - 1].score_m };
            let floor_m = last_m.max(first_m.min(least_m));
            let Some(score) = scorer.score(&mut self.field, code, COARSE_M, floor_m) else { continue };
            let place = best.partition_point(|known| known.score_m >= score.score_m);
            best.insert(place, PlannedPath::new(code, score));
            best.truncate(count);
        }
        let others = best.partition_point(|known| known.score_m >= least_m).max(1);
        best.truncate(others);
        for planned in &mut best {
            if let Some(fine) = scorer.score(&mut self.field, planned.code, FINE_M, f64::NEG_INFINITY) {
                *planned = PlannedPath::new(planned.code, fine);
            }
        }
        best.sort_by(|a, b| b.score_m.total_cmp(&a.score_m).then(a.code.cmp(&b.code)));
        best
    }

    /// Varies a few parameters at a time, in steps that become smaller.
    fn refine(&mut self, scorer: &mut Scorer<'_>, planned: &mut PlannedPath, draw: &mut Draw) {
        let Some(mut at) = PathCode::decode(planned.code).filter(|code| !code.shift) else { return };
        let mut steps = FIRST_STEPS;
        let mut failed = 0;
        let mut way = draw.way();
        for _ in 0..TRIES {
            let mut other = at;
            for (to, (step, sign)) in other.steps.iter_mut().zip(steps.iter().zip(way)) {
                *to += step * sign;
            }
            let other = other.clamped();
            let better = || scorer.score(&mut self.field, other.encode(), FINE_M, planned.score_m);
            if let Some(score) = (other != at).then(better).flatten() {
                // What helped once is tried again, but not the way back.
                (at, failed) = (other, 1);
                *planned = PlannedPath::new(at.encode(), score);
                if planned.score_m >= EASY_M {
                    return;
                }
                continue;
            }
            failed += 1;
            way = if failed % 2 == 1 { way.map(|sign| -sign) } else { draw.way() };
            if failed >= PATIENCE {
                if steps.iter().all(|step| *step == 1) {
                    return;
                }
                steps = steps.map(|step| (step / 2).max(1));
                failed = 0;
            }
        }
    }
}

/// A fixed sequence that looks random (xorshift).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Directions of one to three parameters; the others stay.
    fn way(&mut self) -> [i16; PARAMETERS] {
        let mut way = [0; PARAMETERS];
        for _ in 0..=self.next() % 3 {
            let draw = self.next();
            way[(draw >> 8) as usize % PARAMETERS] = if draw & 1 == 0 { 1 } else { -1 };
        }
        way
    }
}
