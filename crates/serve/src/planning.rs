//! Plans routes. Each recent combination of vehicle, policy and measure has a thread with its own planner.
//!
//! A planner answers one question at a time and keeps the corridors that it has made. The thread ends when its [`Router`]
//! is dropped.

use std::sync::{Arc, mpsc};

use super::drive::{self, Detail};
use super::ids::ids_as_text;
use super::memo::Recent;
use super::problem::Problem;
use super::region::{CertifiedVehicle, RegionState};
use crate::route::{
    self, Answer, AtMost, Conditions, Driver, Ladder, Measure, NoDriver, Planner, Question, Roads, RungPrices,
    SnapError, Speeds, Unanswered,
};
use crate::stop::Stop;
use crate::store::Database;
use crate::words::{Named as _, verdict_words};
use serde_json::{Value, json};

/// Number of planners to keep. Each holds an index of all roads and the corridors that it has made.
const MOST_ROUTERS: usize = 4;
/// Number of answers to keep, so that a route and the sheets of its conditions are planned once. An answer with a long drive has some
/// megabytes.
const MOST_PLANNED: usize = 4;
/// After this many answers a planner is replaced by a new one, because the corridors that it keeps grow with every answer.
const ANSWERS: usize = 100;
/// Questions that may wait for one planner. The slow lane lets fewer through.
const MOST_WAITING: usize = 64;
/// A road farther than this is not beside a place, metres.
const MOST_BESIDE_M: f64 = 500.0;

/// A question, and the number of drives wanted in the answer.
#[derive(Debug, Clone)]
pub(super) struct RouteQuestion {
    pub(super) question: Question,
    /// Number of routes, from the best on, whose drive is wanted.
    pub(super) drives: usize,
    /// Where a route may have conditions, if no route is certified.
    pub(super) conditions: Conditions,
    /// Told to stop when nobody waits for the answer any more.
    pub(super) stop: Stop,
}

/// An answer as JSON, and as it was found: sheets are written from it.
#[derive(Debug)]
pub(super) struct PlannedAnswer {
    pub(super) members: Value,
    pub(super) found: Answer,
}

type Reply = mpsc::Sender<Result<PlannedAnswer, Problem>>;

/// The sending end of a planner's questions.
pub(super) struct Router {
    questions: mpsc::SyncSender<(RouteQuestion, Reply)>,
}

/// The last planners and their last answers.
pub(super) struct Planners {
    /// By vehicle, policy and measure.
    pub(super) routers: Recent<Router>,
    /// By the whole question.
    pub(super) planned: Recent<PlannedAnswer>,
}

impl Default for Planners {
    fn default() -> Self {
        Self { routers: Recent::new(MOST_ROUTERS), planned: Recent::new(MOST_PLANNED) }
    }
}

/// The thread of one planner: what it answers from.
struct PlannerThread {
    roads: Arc<Roads>,
    driver: Arc<Driver>,
    /// With it the routes may climb, and the driver is that of the ladder.
    ladder: Option<Ladder>,
    prices: RungPrices,
    measure: Measure,
    speeds: Speeds,
}

impl Router {
    /// Reads the permits of the vehicle and starts the planner's thread. If there are several sets of the vehicle, its routes climb from the
    /// first one's strip to wider ones.
    pub(super) fn start(
        region: &RegionState,
        sets: &[CertifiedVehicle<'_>],
        measure: Measure,
    ) -> Result<Self, Problem> {
        let fault = |error: &dyn std::fmt::Display| Problem::fault(error.to_string());
        let roads = Arc::clone(&region.roads()?.roads);
        let mut drivers: Vec<Arc<Driver>> = Vec::with_capacity(sets.len());
        for certified in sets {
            let driver = match drivers.first() {
                Some(first) => region.read(|database| first.with_set(database, &roads, certified.set))?,
                None => {
                    let stored = |database: &mut Database| match Driver::stored(
                        database,
                        &roads,
                        certified.vehicle,
                        certified.set,
                    ) {
                        Err(NoDriver::Store(error)) => Err(error),
                        driver => Ok(driver),
                    };
                    region.read(stored)?.map_err(|error| fault(&error))?
                }
            };
            drivers.push(driver);
        }
        let ladder = match drivers.len() {
            0 | 1 => None,
            _ => Some(
                Ladder::new(&drivers, &roads.movements)
                    .map_err(|error| Problem::parameter("at_most", error.to_string()))?,
            ),
        };
        let climbing = ladder.as_ref().map(|ladder| Arc::clone(&ladder.climbing));
        let driver = climbing.or_else(|| drivers.into_iter().next());
        let driver = driver.ok_or_else(|| Problem::fault("a route needs a set of certificates".to_owned()))?;
        let speeds = Speeds::builtin().map_err(|error| fault(&error))?;
        let prices = RungPrices::builtin().map_err(|error| fault(&error))?;
        let planner = PlannerThread { roads, driver, ladder, prices, measure, speeds };
        let (questions, asked) = mpsc::sync_channel(MOST_WAITING);
        let thread = std::thread::Builder::new().name("routes".to_owned()).spawn(move || planner.serve(&asked));
        thread.map_err(|error| Problem::busy(format!("no thread for routes: {error}")))?;
        Ok(Self { questions })
    }

    /// Asks the planner and waits for the answer. `None` means that the thread has ended, which is a fault.
    pub(super) fn ask(&self, ride: RouteQuestion) -> Option<Result<PlannedAnswer, Problem>> {
        let (reply, answer) = mpsc::channel();
        self.questions.send((ride, reply)).ok()?;
        answer.recv().ok()
    }
}

impl PlannerThread {
    fn serve(&self, asked: &mpsc::Receiver<(RouteQuestion, Reply)>) {
        loop {
            let mut planner = self.planner();
            for _ in 0..ANSWERS {
                let Ok((ride, reply)) = asked.recv() else { return };
                // Sending fails if the request has gone, which is no error.
                let _ = reply.send(self.answer(&mut planner, &ride));
            }
        }
    }

    fn planner(&self) -> Planner {
        match &self.ladder {
            Some(ladder) => Planner::climbing(&self.roads, ladder, &self.speeds, self.measure, &self.prices),
            None => Planner::new(&self.roads, Arc::clone(&self.driver), self.speeds.clone(), self.measure),
        }
    }

    fn answer(&self, planner: &mut Planner, ride: &RouteQuestion) -> Result<PlannedAnswer, Problem> {
        let answer = planner.best_answer(&ride.question, ride.conditions, &ride.stop, || ());
        let answer = answer.map_err(|unanswered| match unanswered {
            Unanswered::Place(error) => self.no_road(planner, ride, &error),
            Unanswered::Stopped(stopped) => stopped.into(),
            other => Problem::fault(other.to_string()),
        })?;
        let (network, model) = (&self.roads.network, &self.driver.model);
        let mut members = route::json(network, model, &answer);
        let of_route = |i: usize| if i < ride.drives { Detail::Drive } else { Detail::Line };
        let certified = answer.routes.iter().enumerate();
        let certified = certified.map(|(i, found)| (format!("/routes/{i}"), found, of_route(i)));
        let conditional =
            answer.conditional.iter().map(|known| ("/conditional".to_owned(), &known.route, Detail::Line));
        for (place, found, detail) in certified.chain(conditional) {
            ride.stop.check()?;
            let mut more = drive::members(model, found, detail).map_err(|error| Problem::fault(error.to_string()))?;
            if place == "/conditional" {
                more["leeway"]["verdict"] = json!(route::CONDITIONAL);
            }
            if let (Some(Value::Object(route)), Value::Object(more)) = (members.pointer_mut(&place), more) {
                route.extend(more);
            }
        }
        let line = answer.blocked.as_ref().map(|way| way.line(network)).filter(|line| line.len() > 1);
        members["blocked_way"] = json!(line.map(|line| json!({"type": "LineString", "coordinates": line})));
        members["policy"] = json!(self.driver.permits.settings.policy.name());
        let widest = self.ladder.as_ref().map(|ladder| ladder.widest.permits.settings.policy.name());
        members["at_most"] = match ride.conditions {
            Conditions::WhereAttested => json!(AtMost::Attested.name()),
            Conditions::Nowhere | Conditions::Anywhere => json!(widest),
        };
        ids_as_text(&mut members);
        Ok(PlannedAnswer { members, found: answer })
    }

    /// Which place is too far from a road that may be used, the nearest such road, and why the road beside the place is none.
    fn no_road(&self, planner: &Planner, ride: &RouteQuestion, error: &SnapError) -> Problem {
        let (place, nearest) = match *error {
            SnapError::TooFar { place, nearest, distance_m, .. } => (place, Some((nearest, distance_m))),
            SnapError::Nothing { place } | SnapError::Exchanged { place, .. } => (place, None),
            _ => return Problem::fault(error.to_string()),
        };
        let last = ride.question.places.len().saturating_sub(1);
        let at = ride.question.places.iter().position(|&one| one == place);
        let parameter = match at {
            Some(0) => "from",
            Some(at) if at == last => "to",
            _ => "via",
        };
        let network = &self.roads.network;
        let beside =
            planner.beside(place, nearest.map_or(MOST_BESIDE_M, |(_, distance_m)| distance_m.min(MOST_BESIDE_M)));
        let known = beside.and_then(|beside| Some((beside, network.edges.get(beside.edge.index())?)));
        let mut detail = error.to_string();
        let beside = known.map(|(beside, edge)| {
            let ((verdict, reason), title) = (verdict_words(beside.permit.verdict), network.title(edge));
            let why = if reason.is_empty() { String::new() } else { format!(": {}", reason.replace('_', " ")) };
            detail += &format!("; {title}, {:.0} m away, is {verdict}{why}", beside.distance_m);
            json!({
                "edge_id": edge.id,
                "title": title,
                "distance_m": beside.distance_m,
                "verdict": verdict,
                "reason": (!reason.is_empty()).then_some(reason),
                "rsc_m": beside.permit.rsc_m,
            })
        });
        let nearest = nearest.map(|(at, distance_m)| json!({"lon": at.lon, "lat": at.lat, "distance_m": distance_m}));
        let place = json!({"lon": place.lon, "lat": place.lat});
        let mut members = json!({"parameter": parameter, "place": place, "nearest": nearest, "beside": beside});
        ids_as_text(&mut members);
        Problem::no_road(detail, members)
    }
}
