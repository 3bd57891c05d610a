//! Plans routes. Each recent combination of vehicle, policy and measure has a thread with its own planner.
//!
//! A planner answers one question at a time and keeps the corridors that it has made. The thread ends when its [`Router`]
//! is dropped.

use std::sync::{Arc, mpsc};

use super::drive;
use super::problem::Problem;
use super::region::{Certified, Region};
use crate::route::{self, Driver, Measure, NoDriver, Planner, Question, Roads, Speeds, Unanswered};
use crate::stop::Stop;
use crate::words::Named as _;
use serde_json::{Value, json};

/// After this many answers a planner is replaced by a new one, because the corridors that it keeps grow with every answer.
const ANSWERS: usize = 100;
/// Questions that may wait for one planner. The slow lane lets fewer through.
const MOST_WAITING: usize = 64;

/// A question, and the number of drives wanted in the answer.
#[derive(Debug, Clone)]
pub(super) struct Ride {
    pub(super) question: Question,
    /// Number of routes, from the best on, whose drive is wanted.
    pub(super) drives: usize,
    /// Told to stop when nobody waits for the answer any more.
    pub(super) stop: Stop,
}

type Reply = mpsc::Sender<Result<Value, Problem>>;

/// The sending end of a planner's questions.
pub(super) struct Router {
    questions: mpsc::SyncSender<(Ride, Reply)>,
}

/// What one planner is made from.
struct Wanted {
    roads: Arc<Roads>,
    driver: Arc<Driver>,
    measure: Measure,
    speeds: Speeds,
}

impl Router {
    /// Reads the permits of the vehicle and starts the planner's thread.
    pub(super) fn start(region: &Region, certified: &Certified<'_>, measure: Measure) -> Result<Self, Problem> {
        let roads = Arc::clone(&region.roads()?.roads);
        let driver =
            region.read(|database| match Driver::stored(database, &roads, certified.vehicle, certified.set) {
                Err(NoDriver::Store(error)) => Err(error),
                driver => Ok(driver),
            })?;
        let driver = driver.map_err(|error| Problem::fault(error.to_string()))?;
        let speeds = Speeds::builtin().map_err(|error| Problem::fault(error.to_string()))?;
        let wanted = Wanted { roads, driver, measure, speeds };
        let (questions, asked) = mpsc::sync_channel(MOST_WAITING);
        let thread = std::thread::Builder::new().name("routes".to_owned()).spawn(move || wanted.serve(&asked));
        thread.map_err(|error| Problem::busy(format!("no thread for routes: {error}")))?;
        Ok(Self { questions })
    }

    /// Asks the planner and waits for the answer. `None` means that the thread has ended, which is a fault.
    pub(super) fn ask(&self, ride: Ride) -> Option<Result<Value, Problem>> {
        let (reply, answer) = mpsc::channel();
        self.questions.send((ride, reply)).ok()?;
        answer.recv().ok()
    }
}

impl Wanted {
    fn serve(&self, asked: &mpsc::Receiver<(Ride, Reply)>) {
        loop {
            let mut planner = Planner::new(&self.roads, Arc::clone(&self.driver), self.speeds.clone(), self.measure);
            for _ in 0..ANSWERS {
                let Ok((ride, reply)) = asked.recv() else { return };
                // Sending fails if the request has gone, which is no error.
                let _ = reply.send(self.answer(&mut planner, &ride));
            }
        }
    }

    fn answer(&self, planner: &mut Planner, ride: &Ride) -> Result<Value, Problem> {
        let answer = planner.answer(&ride.question, &ride.stop).map_err(|unanswered| match unanswered {
            Unanswered::Place(error) => Problem::no_road(error.to_string()),
            Unanswered::Stopped(stopped) => stopped.into(),
        })?;
        let mut members = route::json(&self.roads.network, &self.driver.model, &answer);
        for (i, found) in answer.routes.iter().enumerate() {
            ride.stop.check()?;
            let more = drive::members(&self.driver.model, found, i < ride.drives);
            let more = more.map_err(|error| Problem::fault(error.to_string()))?;
            if let (Some(Value::Object(route)), Value::Object(more)) = (members["routes"].get_mut(i), more) {
                route.extend(more);
            }
        }
        members["policy"] = json!(self.driver.permits.settings.policy.name());
        ids_as_text(&mut members);
        Ok(members)
    }
}

/// Replaces the ids of edges by text, because they have 63 bits and JavaScript's numbers hold 53.
fn ids_as_text(value: &mut Value) {
    match value {
        Value::Array(all) => all.iter_mut().for_each(ids_as_text),
        Value::Object(members) => {
            for (name, member) in members {
                match member {
                    Value::Number(id) if matches!(name.as_str(), "edge_id" | "from_edge" | "to_edge") => {
                        *member = json!(id.to_string());
                    }
                    other => ids_as_text(other),
                }
            }
        }
        _ => {}
    }
}
