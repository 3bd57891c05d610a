//! Routes: one thread for each vehicle, policy and measure that was asked for lately, with the planner and all it has
//! made.
//!
//! A planner answers one question at a time and keeps the corridors it has made. The thread ends when nobody can ask it any
//! more.

use std::sync::{Arc, mpsc};

use super::drive;
use super::problem::Problem;
use super::region::{Certified, Region};
use crate::route::{self, Driver, Measure, NoDriver, Planner, Question, Roads, Speeds, Unanswered};
use crate::stop::Stop;
use crate::words::Named as _;
use serde_json::{Value, json};

/// After so many answers a planner begins afresh: what it keeps of turns and strokes grows with what it has seen.
const ANSWERS: usize = 100;
/// Questions that may wait for one planner; the lane lets no more through anyway.
const MOST_WAITING: usize = 64;

/// A question, and how much of the answer is wanted.
#[derive(Debug, Clone)]
pub(super) struct Ride {
    pub(super) question: Question,
    /// Of so many routes, from the best on, the drive is wanted.
    pub(super) drives: usize,
    /// Told when nobody waits for it any more.
    pub(super) stop: Stop,
}

type Reply = mpsc::Sender<Result<Value, Problem>>;

/// Where questions go.
pub(super) struct Router {
    questions: mpsc::SyncSender<(Ride, Reply)>,
}

/// What one planner is for.
struct Wanted {
    roads: Arc<Roads>,
    driver: Arc<Driver>,
    measure: Measure,
    speeds: Speeds,
}

impl Router {
    /// Reads the permits and starts the thread.
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

    /// Asks and waits. `None`: the thread has ended, which is a fault.
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
                // Who asked may have gone.
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

/// 63 bits are more than JavaScript's numbers hold.
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
