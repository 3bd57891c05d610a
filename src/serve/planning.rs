//! Plans routes. Each recent combination of vehicle, policy and measure has a thread with its own planner.
//!
//! A planner answers one question at a time and keeps the corridors that it has made. The thread ends when its [`Router`]
//! is dropped.

use std::sync::{Arc, mpsc};

use super::drive;
use super::problem::Problem;
use super::region::{Certified, Region};
use crate::picture::{self, SheetStyle};
use crate::route::{self, Conditional, Driver, Measure, NoDriver, Planner, Question, Roads, Speeds, Unanswered};
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
    /// Whether a route under conditions is wanted where no route is certified.
    pub(super) conditions: bool,
    /// Told to stop when nobody waits for the answer any more.
    pub(super) stop: Stop,
}

/// An answer, and the sheets of its route under conditions, if it has one.
#[derive(Debug)]
pub(super) struct Planned {
    pub(super) members: Value,
    pub(super) sheets: Option<Sheets>,
}

/// The sheet of a route's conditions in its three forms.
#[derive(Debug)]
pub(super) struct Sheets {
    pub(super) html: String,
    pub(super) csv: String,
    pub(super) geojson: String,
}

/// The address of the style sheet of [`Sheets::html`].
pub(super) const SHEET_STYLE_AT: &str = "/api/sheet.css";

type Reply = mpsc::Sender<Result<Planned, Problem>>;

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
    pub(super) fn ask(&self, ride: Ride) -> Option<Result<Planned, Problem>> {
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

    fn answer(&self, planner: &mut Planner, ride: &Ride) -> Result<Planned, Problem> {
        let answer = match ride.conditions {
            true => planner.best_answer(&ride.question, &ride.stop, || ()),
            false => planner.answer(&ride.question, &ride.stop),
        };
        let answer = answer.map_err(|unanswered| match unanswered {
            Unanswered::Place(error) => Problem::no_road(error.to_string()),
            Unanswered::Stopped(stopped) => stopped.into(),
        })?;
        let (network, model) = (&self.roads.network, &self.driver.model);
        let mut members = route::json(network, model, &answer);
        let certified =
            answer.routes.iter().enumerate().map(|(i, found)| (format!("/routes/{i}"), found, i < ride.drives));
        let conditional = answer.conditional.iter().map(|known| ("/conditional".to_owned(), &known.route, false));
        for (place, found, drive) in certified.chain(conditional) {
            ride.stop.check()?;
            let mut more = drive::members(model, found, drive).map_err(|error| Problem::fault(error.to_string()))?;
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
        ids_as_text(&mut members);
        let sheets = answer.conditional.as_ref().map(|conditional| self.sheets(conditional));
        Ok(Planned { members, sheets })
    }

    fn sheets(&self, conditional: &Conditional) -> Sheets {
        let (network, vehicle) = (&self.roads.network, &self.driver.model.vehicle);
        Sheets {
            html: picture::sheet(network, vehicle, conditional, SheetStyle::At(SHEET_STYLE_AT)),
            csv: route::sheet_csv(network, conditional),
            geojson: route::sheet_geojson(network, vehicle, conditional),
        }
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
                    Value::Array(all) if name == "edge_ids" => {
                        all.iter_mut().for_each(|id| *id = json!(id.to_string()));
                    }
                    other => ids_as_text(other),
                }
            }
        }
        _ => {}
    }
}
