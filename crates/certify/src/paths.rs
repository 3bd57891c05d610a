//! The best path of one turn: certifies the paths that are planned, until one is safe or none is left that may be.

use netcert_kernel::stet::{Course, Grounds, Model, Options, Plan, SpanResult};
use netcert_roads::turns::{PlannedPath, TurnCorridors, TurnPath, TurnPlanner};

/// Planned paths that score less than minus this, metres, are certified as they are, for the record: corrections do not make up for
/// more.
const HOPELESS_M: f64 = 0.4;
/// A safe path with this RSC is good enough; no corrections are tried, metres.
const ENOUGH_M: f64 = 0.2;
/// If no more than this is missing, more paths are tried, metres; and how many. They are the best of so many seeds. On Heidelberg the
/// first five made 19 turns safe, the others none.
const NEARLY_M: f64 = 0.3;
const MORE_PATHS: usize = 5;
const MORE_SEEDS: usize = 8;
/// A certificate hardly ever finds more leeway than the room that the planner found, and this, metres.
const BELIEF_M: f64 = 0.3;
/// How many seeds [`fits`] certifies.
const SEEDS: usize = 2;

/// For each vehicle the path with the best certificate, and its result.
#[must_use]
pub fn best_of(made: &TurnCorridors, models: &[&Model], options: &Options) -> Vec<Option<(TurnPath, SpanResult)>> {
    let best = best_planned(made, models, options).into_iter();
    best.map(|best| best.map(|Best { path, result, .. }| (path, result))).collect()
}

/// The best certificate of a turn.
pub(super) struct Best {
    pub(super) path: TurnPath,
    pub(super) result: SpanResult,
    pub(super) plan: Plan,
}

impl Best {
    /// Whether little is missing, so another path may fit.
    pub(super) fn nearly_fits(&self) -> bool {
        !self.result.safe() && self.result.rsc_m.is_some_and(|m| m >= -NEARLY_M)
    }

    /// No result with less room than this is better, metres.
    fn beaten_above_m(&self) -> f64 {
        match self.result.rsc_m {
            Some(rsc_m) if self.result.safe() => rsc_m,
            Some(rsc_m) if self.result.closes() => rsc_m.min(0.0),
            _ => f64::NEG_INFINITY,
        }
    }

    fn suffices(&self) -> bool {
        self.result.safe() && self.result.rsc_m.is_some_and(|m| m >= ENOUGH_M)
    }
}

/// The corridors of a turn, with the grounds that the certificates of its paths share.
pub(super) struct LaidTurn<'m> {
    made: &'m TurnCorridors,
    grounds: Grounds,
}

impl<'m> LaidTurn<'m> {
    pub(super) fn new(made: &'m TurnCorridors) -> Self {
        Self { made, grounds: Grounds::default() }
    }

    /// Certifies a path as planned, then with the options `corrected`, whose corrections may steer more sharply. Keeps the better result.
    /// Paths that are known to have less leeway than `above_m` may be left out.
    pub(super) fn try_path(
        &self,
        planned: PlannedPath,
        model: &Model,
        corrected: Option<&Options>,
        above_m: f64,
        best: &mut Option<Best>,
    ) {
        let Some(path) = self.made.path(planned.code) else { return };
        let Some(course) = Course::new(&path.corridor, model, &path.counted, &self.grounds) else { return };
        let plain = Options { max_shift_m: 0.0, correction_sweeps: 0 };
        let believed_m = planned.room_m + BELIEF_M;
        for options in [Some(&plain), corrected].into_iter().flatten() {
            let above_m = best.as_ref().map_or(above_m, |best| best.beaten_above_m().max(above_m));
            let Some(row) = course.certify(options, above_m, believed_m) else { continue };
            let Some(result) = row.spans.into_iter().next() else { continue };
            if best.as_ref().is_none_or(|known| better(&result, &known.result)) {
                *best = Some(Best { path: path.clone(), result, plan: row.plan });
            }
            if best.as_ref().is_some_and(Best::suffices) {
                return;
            }
        }
    }

    /// Certifies the path of a plan, with its corrections, on other roads.
    pub(super) fn follow_path(&self, known: &Best, model: &Model, best: &mut Option<Best>) {
        let Some(path) = self.made.path(known.path.code) else { return };
        let Some(course) = Course::new(&path.corridor, model, &path.counted, &self.grounds) else { return };
        let Some(row) = course.follow(&known.plan) else { return };
        *best = row.spans.into_iter().next().map(|result| Best { path: path.clone(), result, plan: row.plan });
    }
}

/// As [`best_of`], with the plan.
pub(super) fn best_planned(made: &TurnCorridors, models: &[&Model], options: &Options) -> Vec<Option<Best>> {
    let (mut planner, turn) = (TurnPlanner::new(made), LaidTurn::new(made));
    models.iter().map(|model| best_path(&turn, &mut planner, model, options)).collect()
}

fn best_path(turn: &LaidTurn<'_>, planner: &mut TurnPlanner<'_>, model: &Model, options: &Options) -> Option<Best> {
    let mut best: Option<Best> = None;
    let mut tried: Vec<i64> = Vec::new();
    for planned in planner.plan(&model.vehicle) {
        let hope = planned.score_m >= -HOPELESS_M;
        if !hope && best.is_some() {
            break;
        }
        tried.push(planned.code);
        turn.try_path(planned, model, hope.then_some(options), f64::NEG_INFINITY, &mut best);
        // Paths come by their score. On Heidelberg a later one was better for a fifth of the safe turns, by 1.4 cm for one in ten.
        if best.as_ref().is_some_and(|best| best.result.safe()) {
            return best;
        }
    }
    if best.as_ref().is_some_and(Best::nearly_fits) {
        let seeds = planner.best_seeds(&model.vehicle, MORE_SEEDS);
        for planned in seeds.iter().filter(|p| !tried.contains(&p.code)).take(MORE_PATHS) {
            // A path without room does not help any more.
            turn.try_path(*planned, model, Some(options), 0.0, &mut best);
            if best.as_ref().is_some_and(|best| best.result.safe()) {
                break;
            }
        }
    }
    best
}

/// Whether one of the seeds with the most room is safe. A cheap look: `true` is certified, `false` may be a path that was not tried.
#[must_use]
pub fn fits(made: &TurnCorridors, model: &Model, options: &Options) -> bool {
    let seeds = TurnPlanner::new(made).best_seeds(&model.vehicle, SEEDS);
    let (mut best, turn) = (None, LaidTurn::new(made));
    seeds.iter().filter(|seed| seed.score_m >= -NEARLY_M).any(|seed| {
        turn.try_path(*seed, model, Some(options), 0.0, &mut best);
        best.as_ref().is_some_and(|best| best.result.safe())
    })
}

/// Orders results: safe first, then closed bounds, then the greater RSC. Ties keep the first one.
fn better(a: &SpanResult, b: &SpanResult) -> bool {
    let key = |r: &SpanResult| (r.safe(), r.closes());
    match key(a).cmp(&key(b)) {
        std::cmp::Ordering::Equal => a.rsc_m > b.rsc_m,
        order => order.is_gt(),
    }
}
