//! A survey for given pairs of places: the conditions of their routes, ranked by the pairs that they complete.

use std::collections::{BTreeMap, BTreeSet};

use super::joints::Joints;
use super::{Opens, Survey, SurveyStep};
use crate::conditions::{Condition, ConditionAt};
use crate::evidence::Quantity;
use crate::network::EdgeNo;
use crate::osm::NodeId;
use crate::plan::{Planner, Question, Unanswered};
use crate::reporter::Reporter;
use crate::snap::Position;
use crate::stop::Stop;

/// Two places, from one to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacePair {
    /// Where the route begins.
    pub from: Position,
    /// Where it ends.
    pub to: Position,
}

/// The pairs, and how routes are looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// The pairs.
    pub all: Vec<PlacePair>,
    /// The greatest distance from each place to a road, metres.
    pub snap_m: f64,
    /// How many ways of a pair may fail before it is given up.
    pub tries: usize,
}

/// What has to be measured: a quantity at an edge, a corner or a junction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Measurand {
    Edge(Quantity, EdgeNo),
    Corner(NodeId, [EdgeNo; 2]),
    Junction(NodeId),
}

/// The measurements that complete most pairs, the best first. Each pair has the conditions of its route under conditions. Where routes of
/// several pairs ask for different values at one place, the greatest is named.
///
/// # Errors
/// `stop` was told.
pub fn survey_pairs(
    planner: &mut Planner,
    pairs: &Pairs,
    limit: usize,
    reporter: &dyn Reporter,
    stop: &Stop,
) -> Result<Survey, crate::stop::Stopped> {
    let mut survey = Survey {
        opens: Opens::Pairs,
        all: pairs.all.len() as f64,
        before: 0.0,
        steps: Vec::new(),
        hopeless: 0,
        gave_up: false,
    };
    let mut wanted: Vec<Vec<Condition>> = Vec::new();
    reporter.begin("survey", pairs.all.len() as u64);
    for (number, pair) in (1..).zip(&pairs.all) {
        match conditions(planner, pair, pairs, stop)? {
            None => survey.hopeless += 1,
            Some(conditions) if conditions.is_empty() => survey.before += 1.0,
            Some(conditions) => wanted.push(conditions),
        }
        reporter.advance(number);
    }
    reporter.end();
    let roads = std::sync::Arc::clone(planner.roads());
    let joints = Joints::of(&roads, &planner.driver().model.vehicle);
    let made = |conditions| SurveyStep::new(&roads, &joints, conditions, 0.0, 0.0);
    let mut reachable = survey.before;
    for (completes, step) in ranked(&wanted, limit, &made, stop)? {
        reachable += completes as f64;
        survey.steps.push(SurveyStep { opens: completes as f64, reachable, ..step });
    }
    Ok(survey)
}

/// The steps that complete most pairs for their places, and how many each one completes; `wanted` are the conditions of each pair.
fn ranked(
    wanted: &[Vec<Condition>],
    limit: usize,
    made: &dyn Fn(Vec<Condition>) -> SurveyStep,
    stop: &Stop,
) -> Result<Vec<(usize, SurveyStep)>, crate::stop::Stopped> {
    let mut needed: BTreeMap<Measurand, f64> = BTreeMap::new();
    for condition in wanted.iter().flatten() {
        for measurand in measurands(condition) {
            let known_m = needed.entry(measurand).or_insert(condition.needed_m);
            *known_m = known_m.max(condition.needed_m);
        }
    }
    let mut left = Left::of(wanted);
    let mut places: Vec<Option<usize>> = vec![None; wanted.len()];
    let mut steps = Vec::new();
    while steps.len() < limit {
        // Of equal ones the first pair counts.
        let mut best: Option<(f64, usize, usize)> = None;
        for pair in 0..wanted.len() {
            stop.check()?;
            if left.done[pair] {
                continue;
            }
            let count = || made(open(&wanted[pair], &needed)).places.len();
            let places = *places[pair].get_or_insert_with(count);
            let completes = left.completed_by(pair);
            let worth = completes as f64 / places.max(1) as f64;
            if best.is_none_or(|best| worth > best.0) {
                best = Some((worth, completes, pair));
            }
        }
        let Some((_, completes, pair)) = best else { break };
        steps.push((completes, made(open(&wanted[pair], &needed))));
        let measured = left.measurands[pair].clone();
        needed.retain(|measurand, _| !measured.contains(measurand));
        left.measure(&measured).into_iter().for_each(|pair| places[pair] = None);
    }
    Ok(steps)
}

/// What has still to be measured for each pair.
struct Left {
    /// By pair.
    measurands: Vec<BTreeSet<Measurand>>,
    done: Vec<bool>,
    /// By measurand: the pairs that need it.
    of_measurand: BTreeMap<Measurand, Vec<usize>>,
    /// By pair: for a count of measurands. All are 0 between two counts.
    counts: Vec<usize>,
    /// Pairs that are not done and need no measurand. They are complete with the first step, whatever it is.
    idle: usize,
}

impl Left {
    fn of(wanted: &[Vec<Condition>]) -> Self {
        let measurands: Vec<BTreeSet<Measurand>> =
            wanted.iter().map(|pair| pair.iter().flat_map(measurands).collect()).collect();
        let mut of_measurand: BTreeMap<Measurand, Vec<usize>> = BTreeMap::new();
        for (pair, measurands) in measurands.iter().enumerate() {
            measurands.iter().for_each(|measurand| of_measurand.entry(*measurand).or_default().push(pair));
        }
        let idle = measurands.iter().filter(|measurands| measurands.is_empty()).count();
        Self { done: vec![false; measurands.len()], counts: vec![0; measurands.len()], idle, measurands, of_measurand }
    }

    /// How many pairs are complete once all measurands of one are measured. Only pairs that share a measurand with it are looked at.
    fn completed_by(&mut self, pair: usize) -> usize {
        let mut met = Vec::new();
        for &other in self.measurands[pair].iter().filter_map(|measurand| self.of_measurand.get(measurand)).flatten() {
            if self.counts[other] == 0 {
                met.push(other);
            }
            self.counts[other] += 1;
        }
        let whole = met.iter().filter(|&&other| self.counts[other] == self.measurands[other].len()).count();
        met.into_iter().for_each(|other| self.counts[other] = 0);
        self.idle + whole
    }

    /// Takes out what is measured. Returns the pairs that needed some of it.
    fn measure(&mut self, measured: &BTreeSet<Measurand>) -> BTreeSet<usize> {
        let mut met = BTreeSet::new();
        for measurand in measured {
            for pair in self.of_measurand.remove(measurand).unwrap_or_default() {
                self.measurands[pair].remove(measurand);
                met.insert(pair);
            }
        }
        self.idle = 0;
        self.done.iter_mut().zip(&self.measurands).for_each(|(done, measurands)| *done |= measurands.is_empty());
        met
    }
}

/// The conditions of a pair's route; none if it is certified. `None` if there is no route even under conditions.
fn conditions(
    planner: &mut Planner,
    pair: &PlacePair,
    pairs: &Pairs,
    stop: &Stop,
) -> Result<Option<Vec<Condition>>, crate::stop::Stopped> {
    let places = vec![pair.from, pair.to];
    let question = Question { places, snap_m: pairs.snap_m, alternatives: 0, tries: pairs.tries };
    let refuted = match planner.answer(&question, stop) {
        Ok(answer) if !answer.routes.is_empty() => return Ok(Some(Vec::new())),
        Ok(answer) => answer.refuted,
        Err(Unanswered::Stopped(stopped)) => return Err(stopped),
        // A place that is near no safe road may be near a lawful one.
        Err(Unanswered::Place(_)) => Vec::new(),
    };
    match planner.under_conditions(&question, &refuted, stop) {
        Ok(found) => Ok(found.ok().map(|conditional| conditional.conditions)),
        Err(Unanswered::Stopped(stopped)) => Err(stopped),
        Err(Unanswered::Place(_)) => Ok(None),
    }
}

fn measurands(condition: &Condition) -> Vec<Measurand> {
    match &condition.at {
        ConditionAt::Road(edges) => edges.iter().map(|&edge| Measurand::Edge(condition.quantity, edge)).collect(),
        ConditionAt::Corner { node, between } => vec![Measurand::Corner(*node, *between)],
        ConditionAt::Junction(node) => vec![Measurand::Junction(*node)],
    }
}

/// What of a route has still to be measured, with the greatest value that any route asks for there. Edges that need the same stay together.
fn open(conditions: &[Condition], needed: &BTreeMap<Measurand, f64>) -> Vec<Condition> {
    let mut open: Vec<Condition> = Vec::new();
    for condition in conditions {
        match &condition.at {
            ConditionAt::Road(edges) => {
                let mut run: Option<(f64, Vec<EdgeNo>)> = None;
                let mut close = |run: Option<(f64, Vec<EdgeNo>)>| {
                    if let Some((needed_m, edges)) = run {
                        open.push(Condition { needed_m, at: ConditionAt::Road(edges), ..condition.clone() });
                    }
                };
                for &edge in edges {
                    let value_m = needed.get(&Measurand::Edge(condition.quantity, edge)).copied();
                    run = match (run.take(), value_m) {
                        (Some((needed_m, mut edges)), Some(value_m)) if needed_m == value_m => {
                            edges.push(edge);
                            Some((needed_m, edges))
                        }
                        (before, value_m) => {
                            close(before);
                            value_m.map(|value_m| (value_m, vec![edge]))
                        }
                    };
                }
                close(run);
            }
            _ => {
                let value_m = measurands(condition).first().and_then(|measurand| needed.get(measurand)).copied();
                open.extend(value_m.map(|needed_m| Condition { needed_m, ..condition.clone() }));
            }
        }
    }
    open
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn along(edges: impl IntoIterator<Item = u32>, needed_m: f64) -> Condition {
        let at = ConditionAt::Road(edges.into_iter().map(EdgeNo::new).collect());
        Condition { quantity: Quantity::CarriagewayWidth, at, assumed_m: None, needed_m, attested_by: None }
    }

    fn made(conditions: Vec<Condition>) -> SurveyStep {
        SurveyStep { places: conditions.into_iter().map(|one| vec![one]).collect(), opens: 0.0, reachable: 0.0 }
    }

    /// Each pair overlaps the next ones: 10^10 comparisons of pairs, and as many copies of what is needed, if each step were looked at anew.
    #[test]
    fn many_pairs_along_one_road_are_ranked_in_few_steps() {
        let wanted: Vec<Vec<Condition>> = (0..2_000).map(|k| vec![along(k..k + 5, 3.0)]).collect();
        let calls = std::cell::Cell::new(0);
        let counted = |conditions| {
            calls.set(calls.get() + 1);
            made(conditions)
        };
        let steps = ranked(&wanted, usize::MAX, &counted, &Stop::never()).unwrap();
        assert_eq!(steps.iter().map(|step| step.0).sum::<usize>(), 2_000);
        assert!(calls.get() < 20_000, "{}", calls.get());
    }

    #[test]
    fn the_ranking_can_be_stopped() {
        let wanted: Vec<Vec<Condition>> = (0..2_000).map(|k| vec![along(k..k + 5, 3.0)]).collect();
        assert!(ranked(&wanted, usize::MAX, &made, &Stop::after(10_000)).is_err());
    }

    /// The definition: each step of each pair is tried on all pairs.
    fn one_by_one(wanted: &[Vec<Condition>], limit: usize) -> Vec<(usize, SurveyStep)> {
        let mut needed: BTreeMap<Measurand, f64> = BTreeMap::new();
        for condition in wanted.iter().flatten() {
            for measurand in measurands(condition) {
                let known_m = needed.entry(measurand).or_insert(condition.needed_m);
                *known_m = known_m.max(condition.needed_m);
            }
        }
        let complete = |pair: &Vec<Condition>, needed: &BTreeMap<Measurand, f64>| {
            pair.iter().flat_map(measurands).all(|measurand| !needed.contains_key(&measurand))
        };
        let (mut done, mut steps) = (vec![false; wanted.len()], Vec::new());
        while steps.len() < limit {
            let best = (0..wanted.len()).filter(|&pair| !done[pair]).map(|pair| {
                let step = made(open(&wanted[pair], &needed));
                let mut then = needed.clone();
                step.conditions().flat_map(measurands).for_each(|measurand| {
                    then.remove(&measurand);
                });
                let completes = (0..wanted.len()).filter(|&k| !done[k] && complete(&wanted[k], &then)).count();
                (completes, step, then)
            });
            let worth = |step: &(usize, SurveyStep, BTreeMap<Measurand, f64>)| {
                step.0 as f64 / step.1.places.len().max(1) as f64
            };
            let best = best.reduce(|best, next| if worth(&next) > worth(&best) { next } else { best });
            let Some((completes, step, then)) = best else { break };
            needed = then;
            done.iter_mut().zip(wanted).for_each(|(done, pair)| *done |= complete(pair, &needed));
            steps.push((completes, step));
        }
        steps
    }

    proptest! {
        #[test]
        fn the_ranking_is_as_one_by_one(
            pairs in prop::collection::vec(prop::collection::vec((0..12_u32, 0..4_u32, 0..3_u8, 0..3_u8), 1..4), 0..12),
            limit in 0..15_usize
        ) {
            let condition = |&(edge, long, kind, metres): &(u32, u32, u8, u8)| {
                let needed_m = 3.0 + f64::from(metres);
                match kind {
                    0 => Condition { at: ConditionAt::Junction(NodeId::new(edge.into())), ..along([], needed_m) },
                    _ => along(edge..edge + long, needed_m),
                }
            };
            let wanted: Vec<Vec<Condition>> = pairs.iter().map(|pair| pair.iter().map(condition).collect()).collect();
            let steps = ranked(&wanted, limit, &made, &Stop::never()).unwrap();
            prop_assert_eq!(steps, one_by_one(&wanted, limit));
        }
    }
}
