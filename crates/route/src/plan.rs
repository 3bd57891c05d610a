//! Plans certified routes between places, or finds what blocks them.
//!
//! A route is returned only with a `safe` certificate over the whole route. If the whole fails although its parts passed, the
//! turn nearest to the limiting place is tried on its other paths. If all paths fail, the turn is left out and the search goes
//! on, up to the requested number of tries. The answer lists the failures. If no route is left, the answer names the obstacles
//! (`obstacles`).

use std::sync::Arc;

use super::assemble::{AssemblyError, DrivenWay, PartKind};
use super::conditions::{Conditional, Fitter};
use super::drive::{Drive, Join};
use super::driver::Driver;
use super::graph::{Access, BARRED, Graph};
use super::ladder::Ladder;
use super::obstacles::{self, BlockedWay, Obstacle, Refutation};
use super::pieces::Turns;
use super::roads::Roads;
use super::route::Route;
use super::rung_prices::RungPrices;
use super::search::{FoundWay, Goal, Start, search_over};
use super::snap::{Position, SnapError, Snapped, Snapper};
use super::speeds::{Measure, Speeds};
use super::turning::MadeTurns;
use super::whole::{CertifiedWay, Whole};
use crate::network::{EdgeNo, MovementKind, Network};
use crate::stop::{Stop, Stopped};

/// The greatest share of its length that an alternative may have in common with an earlier route.
const MOST_SHARED: f64 = 0.75;
/// The greatest ratio of an alternative's cost to that of the first route.
const MOST_LONGER: f64 = 2.0;
/// How often the edges of earlier routes are made dearer, by half their cost each time, to find one alternative.
const DEARER: u32 = 6;

/// A request for routes.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The beginning, the places between, and the end. There are at least two.
    pub places: Vec<Position>,
    /// The greatest distance of each place from a road, metres.
    pub snap_m: f64,
    /// Number of routes beside the best one.
    pub alternatives: usize,
    /// Number of whole routes that may fail to certify.
    pub tries: usize,
}

/// The answer.
#[derive(Debug, Clone, Default)]
pub struct Answer {
    /// The certified routes, the best first.
    pub routes: Vec<Route>,
    /// Whole routes that failed, in order.
    pub refuted: Vec<Refutation>,
    /// Whether the search stopped before all ways were tried.
    pub gave_up: bool,
    /// If there is no route, the set of failing places of least cost. `None` if there is a route, or if no roads lead there.
    pub obstacles: Option<Vec<Obstacle>>,
    /// The way on which these obstacles lie.
    pub blocked: Option<BlockedWay>,
    /// A route that is certified only under conditions, if one was asked for and there is no other.
    pub conditional: Option<Conditional>,
    /// Whether the search for a route under conditions was ended before it was through.
    pub conditions_cut_short: bool,
    /// If no route is certified under any conditions: the places for which nothing does that the search supposed. Ways without them were
    /// tried, too.
    pub nothing_helps: Vec<PartKind>,
    /// The requested places, moved to the road.
    pub snapped: Vec<Snapped>,
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unanswered {
    /// A place is near no road that the vehicle may use.
    #[error(transparent)]
    Place(#[from] SnapError),
    /// The caller cancelled the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// The rungs below the widest strip, with what they cost.
pub(super) struct Below {
    /// The vehicle with the permit of the narrowest strip for each edge and turn.
    pub(super) climbing: Arc<Driver>,
    prices: RungPrices,
    measure: Measure,
}

impl Below {
    /// Adds to an access what it costs to climb.
    pub(super) fn add_prices(&self, access: &mut Access, graph: &Graph) {
        self.prices.add(access, graph, &self.climbing.permits.rungs, self.measure);
    }
}

/// Answers questions about one vehicle. It keeps the corridors that it has made, so later questions are answered faster.
pub struct Planner {
    pub(super) graph: Graph,
    pub(super) snapper: Snapper,
    pub(super) driver: Arc<Driver>,
    whole: Whole,
    /// Made when a route under conditions is first asked for.
    pub(super) fitter: Option<Box<Fitter>>,
    speeds: Speeds,
    access: Access,
    /// A planner that climbs has one for the widest strip alone. It says what blocks, and looks for conditions.
    pub(super) widest: Option<Box<Planner>>,
    /// The planner for the widest strip of a ladder knows the ladder: where conditions hold, a way climbs it, too.
    pub(super) below: Option<Below>,
    pub(super) stop: Stop,
}

impl Planner {
    /// A planner that finds the best routes by `measure`. Strokes, turns and whole routes are made with the settings of the
    /// driver's permits.
    #[must_use]
    pub fn new(roads: &Arc<Roads>, driver: Arc<Driver>, speeds: Speeds, measure: Measure) -> Self {
        let turns = Box::new(MadeTurns::new(Arc::clone(&driver)));
        Self::with_turns(roads, driver, speeds, measure, turns)
    }

    /// A planner whose routes use each road and turn on the narrowest strip of a ladder on which the vehicle has a permit. Wider strips cost
    /// what `prices` says. Where no route is certified, the planner says what blocks the widest strip.
    #[must_use]
    pub fn climbing(
        roads: &Arc<Roads>,
        ladder: &Ladder,
        speeds: &Speeds,
        measure: Measure,
        prices: &RungPrices,
    ) -> Self {
        let mut planner = Self::new(roads, Arc::clone(&ladder.climbing), speeds.clone(), measure);
        let below = Below { climbing: Arc::clone(&ladder.climbing), prices: prices.clone(), measure };
        below.add_prices(&mut planner.access, &planner.graph);
        let widest = Self::new(roads, Arc::clone(&ladder.widest), speeds.clone(), measure);
        planner.widest = Some(Box::new(Self { below: Some(below), ..widest }));
        planner
    }

    /// A planner with another source of turns.
    #[must_use]
    pub fn with_turns(
        roads: &Arc<Roads>,
        driver: Arc<Driver>,
        speeds: Speeds,
        measure: Measure,
        turns: Box<dyn Turns>,
    ) -> Self {
        let graph = Graph::new(roads, &speeds, measure).for_vehicle(&driver.model.vehicle);
        Self {
            snapper: Snapper::new(roads),
            access: driver.permits.access(&roads.movements),
            graph,
            widest: None,
            below: None,
            whole: Whole::new(roads, Arc::clone(&driver), turns),
            fitter: None,
            driver,
            speeds,
            stop: Stop::default(),
        }
    }

    /// The network of the planner.
    #[must_use]
    pub fn network(&self) -> &Network {
        self.graph.network()
    }

    /// The roads of the planner.
    #[must_use]
    pub fn roads(&self) -> &Arc<Roads> {
        self.graph.roads()
    }

    /// The vehicle of the planner, with its permits.
    #[must_use]
    pub fn driver(&self) -> &Arc<Driver> {
        &self.driver
    }

    /// Answers with routes or with what blocks them. The planner checks `stop` before each turn, every few thousand states of a
    /// search and every few metres of a certificate's sweeps. A cancelled call does not change later answers.
    ///
    /// # Errors
    /// A place is near no road that the vehicle may use, or `stop` was told.
    pub fn answer(&mut self, question: &Question, stop: &Stop) -> Result<Answer, Unanswered> {
        let mut answer = self.certified_routes(question, stop)?;
        if answer.routes.is_empty() && self.widest.is_some() {
            return self.on_the_widest(answer, |widest| widest.answer(question, stop));
        }
        if answer.routes.is_empty() {
            (answer.obstacles, answer.blocked) = self.obstacles(&answer)?.unzip();
        }
        Ok(answer)
    }

    /// The certified routes alone.
    ///
    /// # Errors
    /// As [`Self::answer`].
    pub(super) fn certified_routes(&mut self, question: &Question, stop: &Stop) -> Result<Answer, Unanswered> {
        self.stop = stop.clone();
        stop.check()?;
        let usable = |edge| self.driver.permits.edge(edge);
        let snap = |place: &Position| self.snapper.snap(*place, question.snap_m, usable);
        let snapped = question.places.iter().map(snap).collect::<Result<Vec<_>, _>>()?;
        let mut answer = Answer { snapped, ..Answer::default() };
        let mut access = self.access.clone();
        self.next_route(&mut access, question, &mut answer, &|_| true)?;
        if !answer.routes.is_empty() {
            self.alternatives(&access, question, &mut answer)?;
        }
        Ok(answer)
    }

    /// What a planner that found no route by climbing answers: the answer on the widest strip, with the routes that failed before.
    pub(super) fn on_the_widest(
        &mut self,
        climbed: Answer,
        ask: impl FnOnce(&mut Self) -> Result<Answer, Unanswered>,
    ) -> Result<Answer, Unanswered> {
        let Some(widest) = &mut self.widest else { return Ok(climbed) };
        let mut answer = ask(widest)?;
        let of_widest = std::mem::replace(&mut answer.refuted, climbed.refuted);
        answer.refuted.extend(of_widest);
        Ok(answer)
    }

    /// The way of least cost over the places, with the shares of its first and last edge.
    pub(super) fn way(&self, access: &Access, snapped: &[Snapped]) -> Result<Option<(FoundWay, f64, f64)>, Stopped> {
        let Some((from, places)) = snapped.split_first() else { return Ok(None) };
        let starts: Vec<Start> = from.on.iter().map(|on| Start::new(on.edge, on.share)).collect();
        let goals: Vec<Vec<Goal>> = places.iter().map(|place| place.on.clone()).collect();
        let found = search_over(&self.graph, access, &starts, &goals, &self.stop)?;
        Ok(found.and_then(|found| {
            let start = starts.get(found.start)?.share;
            let last = found.drive.edges.last()?;
            let end = places.last()?.on.iter().find(|goal| goal.edge == *last)?.share;
            Some((found, start, end))
        }))
    }

    /// Searches and certifies until a whole route passes, and bars in `access` what fails. Returns whether it found a route.
    fn next_route(
        &mut self,
        access: &mut Access,
        question: &Question,
        answer: &mut Answer,
        wanted: &dyn Fn(&[EdgeNo]) -> bool,
    ) -> Result<bool, Stopped> {
        loop {
            let Some((found, start, end)) = self.way(access, &answer.snapped)? else { return Ok(false) };
            if !wanted(&found.drive.edges) {
                return Ok(false);
            }
            if answer.refuted.len() >= question.tries.max(1) {
                answer.gave_up = true;
                return Ok(false);
            }
            let tries = question.tries.saturating_sub(answer.refuted.len());
            let (route, mut failed) = self.on_any_paths(&found, start, end, tries)?;
            if let Some(route) = route {
                answer.refuted.append(&mut failed);
                answer.routes.push(route);
                return Ok(true);
            }
            // A route that does not fit into one frame fails on every way, so nothing is left out.
            let too_far = failed.iter().any(|failed| matches!(failed.assembly, Some(AssemblyError::Frame(_))));
            if let Some(nearest) = nearest(&mut failed).filter(|_| !too_far) {
                nearest.left_out = self.leave_out(access, nearest.at);
            }
            // If nothing was left out, the search would find the same way again.
            answer.gave_up = !failed.iter().any(|failed| failed.left_out);
            answer.refuted.append(&mut failed);
            if answer.gave_up {
                return Ok(false);
            }
        }
    }

    /// Certifies a way. Returns the route, if one passed, and the failures before it.
    fn on_any_paths(
        &mut self,
        found: &FoundWay,
        start: f64,
        end: f64,
        tries: usize,
    ) -> Result<(Option<Route>, Vec<Refutation>), Stopped> {
        let way = DrivenWay { drive: &found.drive, start, end };
        let (certified, failed) = self.whole.on_any_paths(&way, tries, &self.stop)?;
        Ok((certified.map(|certified| self.route(found, start, end, certified)), failed))
    }

    /// The route on a way that was certified, from the share `start` of its first edge to the share `end` of its last.
    pub(super) fn route(&self, found: &FoundWay, start: f64, end: f64, certified: CertifiedWay) -> Route {
        let CertifiedWay { path, certificate, uses } = certified;
        let time_s = self.time_s(&found.drive, start, end);
        let length_m = (path.corridor.len() - 1) as f64 * path.corridor.spacing_m;
        let (drive, vehicle_length_m) = (found.drive.clone(), self.driver.model.vehicle.length_m);
        // Prices only choose between ways.
        let cost = cost_of(&self.graph, &drive, start, end);
        Route { drive, start, end, cost, time_s, length_m, vehicle_length_m, path, certificate, uses }
    }

    /// The driving time by the table of speeds, seconds.
    fn time_s(&self, drive: &Drive, start: f64, end: f64) -> f64 {
        let network = self.graph.network();
        let time = |(share, edge): (f64, EdgeNo)| {
            share * self.speeds.cost(network, &network.edges[edge.index()], Measure::Time) as f64
        };
        let driven: f64 = shares(drive, start, end).map(time).sum();
        let turns = turns(&self.graph, drive) * self.speeds.turn_cost(Measure::Time);
        1e-3 * (driven + turns as f64)
    }

    /// Bars a place. Returns whether it was not barred before.
    fn leave_out(&self, access: &mut Access, at: PartKind) -> bool {
        let slot = obstacles::slot(access, self.graph.movements(), at);
        slot.is_some_and(|slot| std::mem::replace(slot, BARRED) != BARRED)
    }

    /// The set of failing places of least cost between the requested places, and the way on which they lie.
    fn obstacles(&self, answer: &Answer) -> Result<Option<(Vec<Obstacle>, BlockedWay)>, Stopped> {
        let (permits, movements) = (&self.driver.permits, self.graph.movements());
        let mut access = obstacles::priced(permits, movements, &answer.refuted);
        let found = self.way(&access, &answer.snapped)?;
        Ok(found.map(|(found, start, end)| {
            let mut obstacles = obstacles::on(&found.drive, permits, movements, &mut access, &answer.refuted);
            let passed = self.passed(&found.drive, &answer.snapped);
            if !passed.is_empty() {
                obstacles.extend(passed);
                let place =
                    |obstacle: &Obstacle| found.drive.edges.iter().position(|&edge| obstacle.last_edge() == edge);
                obstacles.sort_by_key(place);
            }
            (obstacles, BlockedWay { edges: found.drive.edges, start, end })
        }))
    }

    /// The roads that are open to a destination only and that a way passes through.
    fn passed(&self, drive: &Drive, snapped: &[Snapped]) -> Vec<Obstacle> {
        let mut stops = Vec::new();
        let mut first = 0;
        let between = snapped.get(1..snapped.len().saturating_sub(1)).unwrap_or_default();
        for place in between {
            let here = |edge: &EdgeNo| place.on.iter().any(|on| on.edge == *edge);
            if let Some(at) = drive.edges.iter().skip(first).position(here) {
                first += at;
                stops.push(first);
            }
        }
        let runs = self.graph.ends_only().passed(&drive.edges, &stops);
        let of_run = |run: std::ops::Range<usize>| drive.edges.get(run.start).copied();
        let obstacle = |edge: EdgeNo| {
            let permit = *self.driver.permits.edges.get(edge.index())?;
            Some(Obstacle::passed_through(edge, self.driver.permits.settings.policy, permit))
        };
        runs.into_iter().filter_map(of_run).filter_map(obstacle).collect()
    }

    /// Adds routes that differ from the earlier ones. Edges of earlier routes are made dearer until another way is cheaper.
    fn alternatives(&mut self, access: &Access, question: &Question, answer: &mut Answer) -> Result<(), Stopped> {
        let Some(first_cost) = answer.routes.first().map(|route| route.cost) else { return Ok(()) };
        let mut access = access.clone();
        let mut rounds = DEARER * question.alternatives as u32;
        while answer.routes.len() <= question.alternatives && rounds > 0 && !answer.gave_up {
            rounds -= 1;
            for route in &answer.routes {
                for &edge in &route.drive.edges {
                    let slot = &mut access.edges[edge.index()];
                    if *slot != BARRED {
                        *slot += self.graph.cost(edge) / 2;
                    }
                }
            }
            let known: Vec<Vec<EdgeNo>> = answer.routes.iter().map(|route| route.drive.edges.clone()).collect();
            let roads = Arc::clone(self.graph.roads());
            let network = &roads.network;
            let longest = (first_cost as f64 * MOST_LONGER) as u64;
            let costs: Vec<u64> = EdgeNo::first(network.edges.len()).map(|edge| self.graph.cost(edge)).collect();
            let wanted = |edges: &[EdgeNo]| {
                let cost: u64 = edges.iter().map(|&edge| costs[edge.index()]).sum();
                let own = |on: &dyn Fn(&EdgeNo) -> bool| -> f64 {
                    edges.iter().filter(|e| on(e)).map(|&e| network.length_m(&network.edges[e.index()])).sum()
                };
                let all = own(&|_| true);
                cost <= longest + costs[edges[0].index()]
                    && known.iter().all(|other| own(&|edge| other.contains(edge)) <= MOST_SHARED * all)
            };
            if self.next_route(&mut access, question, answer, &wanted)?
                && let Some(route) = answer.routes.last_mut()
            {
                route.cost = cost_of(&self.graph, &route.drive, route.start, route.end);
            }
        }
        Ok(())
    }
}

/// The cost of a way without the surcharges of a search.
fn cost_of(graph: &Graph, drive: &Drive, start: f64, end: f64) -> u64 {
    let edges = shares(drive, start, end).map(|(share, edge)| graph.part_cost(edge, share));
    edges.sum::<u64>() + turns(graph, drive) * graph.turn_cost()
}

/// The driven share of each edge. The way begins at the share `start` of its first edge and ends at the share `end` of its last.
fn shares(drive: &Drive, start: f64, end: f64) -> impl Iterator<Item = (f64, EdgeNo)> {
    let last = drive.edges.len() - 1;
    drive.edges.iter().enumerate().map(move |(i, &edge)| {
        let from = if i == 0 { start } else { 0.0 };
        let to = if i == last { end } else { 1.0 };
        (to - from, edge)
    })
}

/// The number of turns of a way. A passage counts as two.
fn turns(graph: &Graph, drive: &Drive) -> u64 {
    let count = |join: Join<'_>| match graph.movements().between(join.from, join.to) {
        Some(movement) => u64::from(movement.kind != MovementKind::StraightOn),
        None => 2,
    };
    drive.joins().map(count).sum()
}

/// The failure on one way that came nearest to passing, by its RSC.
fn nearest(failed: &mut [Refutation]) -> Option<&mut Refutation> {
    let rsc_m = |refutation: &Refutation| refutation.result.map_or(f64::NEG_INFINITY, |result| result.0);
    failed.iter_mut().max_by(|a, b| rsc_m(a).total_cmp(&rsc_m(b)))
}
