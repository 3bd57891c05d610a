//! A survey for given pairs of places: the conditions of their routes, ranked by the pairs that they complete.

use std::collections::BTreeMap;

use super::joints::Joints;
use super::{Opens, Step, Survey};
use crate::evidence::Quantity;
use crate::reporter::Reporter;
use crate::route::conditions::{Condition, ConditionAt};
use crate::route::plan::{Planner, Question, Unanswered};
use crate::route::snap::Position;
use crate::stop::Stop;

/// Two places, from one to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Where the route begins.
    pub from: Position,
    /// Where it ends.
    pub to: Position,
}

/// The pairs, and how routes are looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// The pairs.
    pub all: Vec<Pair>,
    /// The greatest distance from each place to a road, metres.
    pub snap_m: f64,
    /// How many ways of a pair may fail before it is given up.
    pub tries: usize,
}

/// What has to be measured: a quantity at an edge, a corner or a junction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Spot {
    Edge(Quantity, u32),
    Corner(i64, [u32; 2]),
    Junction(i64),
}

/// The conditions of one pair's route.
struct Wanted {
    conditions: Vec<Condition>,
    done: bool,
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
    (reporter, stop): (&dyn Reporter, &Stop),
) -> Result<Survey, crate::stop::Stopped> {
    let mut survey = Survey {
        opens: Opens::Pairs,
        all: pairs.all.len() as f64,
        before: 0.0,
        steps: Vec::new(),
        hopeless: 0,
        gave_up: false,
    };
    let mut wanted: Vec<Wanted> = Vec::new();
    reporter.begin("survey", pairs.all.len() as u64);
    for (number, pair) in (1..).zip(&pairs.all) {
        match conditions(planner, pair, pairs, stop)? {
            None => survey.hopeless += 1,
            Some(conditions) if conditions.is_empty() => survey.before += 1.0,
            Some(conditions) => wanted.push(Wanted { conditions, done: false }),
        }
        reporter.advance(number);
    }
    reporter.end();
    let roads = std::sync::Arc::clone(planner.roads());
    let joints = Joints::of(&roads, &planner.driver().model.vehicle);
    let mut needed: BTreeMap<Spot, f64> = BTreeMap::new();
    for condition in wanted.iter().flat_map(|wanted| &wanted.conditions) {
        for spot in spots(condition) {
            let known_m = needed.entry(spot).or_insert(condition.needed_m);
            *known_m = known_m.max(condition.needed_m);
        }
    }
    let mut reachable = survey.before;
    while survey.steps.len() < limit {
        let best = wanted.iter().filter(|pair| !pair.done).map(|pair| {
            let conditions = open(&pair.conditions, &needed);
            let step = Step::new(&roads, &joints, conditions, 0.0, 0.0);
            let mut then = needed.clone();
            step.conditions().flat_map(spots).for_each(|spot| {
                then.remove(&spot);
            });
            let completes = wanted.iter().filter(|pair| !pair.done && complete(&pair.conditions, &then)).count();
            (completes as f64, step, then)
        });
        let worth = |step: &(f64, Step, BTreeMap<Spot, f64>)| step.0 / step.1.places.len().max(1) as f64;
        // Of equal ones the first pair counts.
        let best = best.reduce(|best, next| if worth(&next) > worth(&best) { next } else { best });
        let Some((completes, step, then)) = best else { break };
        needed = then;
        reachable += completes;
        wanted.iter_mut().for_each(|pair| pair.done |= complete(&pair.conditions, &needed));
        survey.steps.push(Step { opens: completes, reachable, ..step });
    }
    Ok(survey)
}

/// The conditions of a pair's route; none if it is certified. `None` if there is no route even under conditions.
fn conditions(
    planner: &mut Planner,
    pair: &Pair,
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

fn spots(condition: &Condition) -> Vec<Spot> {
    match &condition.at {
        ConditionAt::Road(edges) => edges.iter().map(|&edge| Spot::Edge(condition.quantity, edge)).collect(),
        ConditionAt::Corner { node, between } => vec![Spot::Corner(*node, *between)],
        ConditionAt::Junction(node) => vec![Spot::Junction(*node)],
    }
}

/// Whether nothing of a route has still to be measured.
fn complete(conditions: &[Condition], needed: &BTreeMap<Spot, f64>) -> bool {
    conditions.iter().flat_map(spots).all(|spot| !needed.contains_key(&spot))
}

/// What of a route has still to be measured, with the greatest value that any route asks for there. Edges that need the same stay together.
fn open(conditions: &[Condition], needed: &BTreeMap<Spot, f64>) -> Vec<Condition> {
    let mut open: Vec<Condition> = Vec::new();
    for condition in conditions {
        match &condition.at {
            ConditionAt::Road(edges) => {
                let mut run: Option<(f64, Vec<u32>)> = None;
                let mut close = |run: Option<(f64, Vec<u32>)>| {
                    if let Some((needed_m, edges)) = run {
                        open.push(Condition { needed_m, at: ConditionAt::Road(edges), ..condition.clone() });
                    }
                };
                for &edge in edges {
                    let value_m = needed.get(&Spot::Edge(condition.quantity, edge)).copied();
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
                let value_m = spots(condition).first().and_then(|spot| needed.get(spot)).copied();
                open.extend(value_m.map(|needed_m| Condition { needed_m, ..condition.clone() }));
            }
        }
    }
    open
}
