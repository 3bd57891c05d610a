//! Tests that work stops when it is told to, wherever it is, and that stopped work has no result.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use netcert::corridor::stroke_corridor;
use netcert::explain::{explain_edge, explain_turn};
use netcert::network::{EdgeNo, Movement, Network};
use netcert::osm::facts::Policy;
use netcert::route::{
    self, Conditions, Driver, MadeTurns, Measure, Planner, Position, Question, Roads, Speeds, Strokes, TurnPiece,
    Turns, Unanswered,
};
use netcert::settings::Settings;
use netcert::stet::{self, Model};
use netcert::stop::{Stop, Stopped};
use netcert::store::{Database, QueryOptions, TurnQuery};
use netcert::turns::turn_facts;
use netcert::vehicle::Vehicle;
use netcert::verdict::{UnknownReason, Verdict};

use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";

/// A source of turns that tells the work to stop when the first turn is requested.
struct Telling {
    inner: MadeTurns,
    stop: Stop,
    asked: Arc<AtomicUsize>,
}

impl Turns for Telling {
    fn pieces(
        &self,
        strokes: &mut Strokes,
        movement: &Movement,
        arcs: &[EdgeNo],
    ) -> Result<Vec<TurnPiece>, UnknownReason> {
        self.asked.fetch_add(1, Ordering::Relaxed);
        self.stop.tell();
        self.inner.pieces(strokes, movement, arcs)
    }
}

/// The demo under the carriageway policy, where some corners pass.
fn wide() -> (WorkFolder, Database, Network, Model, Settings) {
    wide_for(VEHICLE)
}

fn wide_for(vehicle: &str) -> (WorkFolder, Database, Network, Model, Settings) {
    let place = WorkFolder::with_wide_demo(vehicle);
    let mut database = place.database();
    let network = database.load_network().unwrap();
    let settings = Settings { policy: Policy::Carriageway, ..Settings::default() };
    let definition = database.vehicles().unwrap().remove(0).definition;
    let model = Model::new(&Vehicle::from_json(&definition).unwrap()).unwrap();
    (place, database, network, model, settings)
}

/// Before and behind each turn that may be taken: the middles of its two edges.
fn round_corners(database: &mut Database, policy: Policy) -> Vec<[Position; 2]> {
    let rows = database.query(&QueryOptions::new(VEHICLE, policy)).unwrap().map(Result::unwrap);
    let middles: BTreeMap<i64, Position> = rows
        .map(|row| (row.edge.id, row.line[row.line.len() / 2].degrees()))
        .map(|(edge, (lon, lat))| (edge, Position { lon, lat }))
        .collect();
    let turns = database.query_turns(&TurnQuery::new(VEHICLE, policy)).unwrap().into_iter();
    let safe = turns.filter(|turn| turn.certificate.verdict == Verdict::Safe);
    safe.map(|turn| [middles[&turn.turn.from_edge], middles[&turn.turn.to_edge]]).collect()
}

fn on_the_road(
    database: &mut Database,
    network: Network,
    model: &Model,
    settings: &Settings,
) -> (Arc<Roads>, Arc<Driver>) {
    let set = database.certified_set(&model.vehicle.id, settings.policy).unwrap().unwrap();
    let roads = Roads::new(network);
    let driver = Driver::stored(database, &roads, &model.vehicle, &set).unwrap();
    (roads, driver)
}

#[test]
fn a_route_that_is_told_to_stop_asks_for_no_further_turn() {
    let (_place, mut database, network, model, settings) = wide();
    let (roads, driver) = on_the_road(&mut database, network, &model, &settings);
    let pairs = round_corners(&mut database, settings.policy);
    let inner = MadeTurns::new(Arc::clone(&driver));
    let speeds = Speeds::builtin().unwrap();
    let mut stopped = 0;
    for places in pairs.into_iter().take(12) {
        let (stop, asked) = (Stop::default(), Arc::new(AtomicUsize::new(0)));
        let turns = Telling { inner: inner.clone(), stop: stop.clone(), asked: Arc::clone(&asked) };
        let driver = Arc::clone(&driver);
        let mut planner = Planner::with_turns(&roads, driver, speeds.clone(), Measure::Time, Box::new(turns));
        let question = Question { places: places.to_vec(), snap_m: 100.0, alternatives: 2, tries: 30 };
        let stopped_at = planner.answer(&question, &stop).err();
        // Over a turn it was stopped there; a way without turns went to its end.
        let asked = asked.load(Ordering::Relaxed);
        let told = stop.told().then_some(Unanswered::Stopped(Stopped));
        assert_eq!((stopped_at, asked > 0), (told, stop.told()));
        // Each thread may have begun a turn before any told.
        assert!(asked <= rayon::current_num_threads(), "{asked}");
        stopped += asked;
        // The same planner then answers as if it had not been stopped.
        assert!(planner.answer(&question, &Stop::never()).is_ok());
    }
    assert!(stopped > 0, "no way leads over a turn");
}

/// A search that is stopped at any of its checks has no answer. If it is stopped after its last check, it has the answer of a search
/// that is never stopped, even on a planner that was stopped many times.
#[test]
fn a_route_is_whole_or_is_not_there() {
    let (_place, mut database, network, model, settings) = wide();
    let (roads, driver) = on_the_road(&mut database, network, &model, &settings);
    let planner = || Planner::new(&roads, Arc::clone(&driver), Speeds::builtin().unwrap(), Measure::Time);
    let question =
        |places: [Position; 2]| Question { places: places.to_vec(), snap_m: 100.0, alternatives: 1, tries: 30 };
    let mut never = planner();
    let pairs = round_corners(&mut database, settings.policy).into_iter();
    let answers = pairs.map(question).map(|question| (never.answer(&question, &Stop::never()).unwrap(), question));
    let (answer, question) = answers.into_iter().find(|(answer, _)| !answer.routes.is_empty()).unwrap();
    let said = |answer| route::json(&roads.network, &model, answer).to_string();

    let mut often = planner();
    let (mut asked, mut stops) = (0, 0);
    let whole = loop {
        match often.answer(&question, &Stop::after(asked)) {
            Ok(whole) => break whole,
            Err(unanswered) => assert_eq!(unanswered, Unanswered::Stopped(Stopped)),
        }
        stops += 1;
        asked += 1 + asked / 4;
    };
    assert_eq!(said(&whole), said(&answer));
    assert_eq!(whole.routes[0].certificate, answer.routes[0].certificate);
    assert!(stops > 15, "it asked fewer than {asked} times");
}

/// A search for a route under conditions that is stopped says what blocks the way, and one that is not has the whole.
#[test]
fn a_route_under_conditions_is_whole_or_is_not_there() {
    let (_place, mut database, network, model, settings) = wide_for("AU-ATRIPLE53");
    let (roads, driver) = on_the_road(&mut database, network, &model, &settings);
    let places = [[126.026_942, -30.203_315], [126.046_615, -30.205_563]].map(|[lon, lat]| Position { lon, lat });
    let question = Question { places: places.to_vec(), snap_m: 100.0, alternatives: 0, tries: 30 };
    let mut planner = Planner::new(&roads, Arc::clone(&driver), Speeds::builtin().unwrap(), Measure::Time);
    let (mut asked, mut searched) = (1, 0);
    let whole = loop {
        let mut begun = false;
        match planner.best_answer(&question, Conditions::Anywhere, &Stop::after(asked), || begun = true) {
            Ok(answer) if answer.conditions_cut_short => {
                assert!(begun && answer.routes.is_empty() && answer.conditional.is_none());
                assert!(answer.obstacles.is_some_and(|obstacles| !obstacles.is_empty()));
                searched += 1;
            }
            Ok(whole) => break whole,
            Err(unanswered) => assert_eq!((begun, unanswered), (false, Unanswered::Stopped(Stopped))),
        }
        asked *= 2;
    };
    assert!(searched > 1, "it was never stopped while it looked for conditions");
    assert!(whole.routes.is_empty() && !whole.conditional.as_ref().unwrap().conditions.is_empty());
    let again = planner.best_answer(&question, Conditions::Anywhere, &Stop::never(), || ()).unwrap();
    let said = |answer| route::json(&roads.network, &model, answer).to_string();
    assert_eq!(said(&whole), said(&again));
}

/// A certificate that is told to stop ends within some metres of one sweep. Each of the following sweeps checks at most once.
#[test]
fn a_certificate_asks_every_few_metres_and_is_whole_or_is_not_there() {
    let (_place, _, network, model, settings) = wide();
    let longest = network.strokes.iter().max_by_key(|stroke| stroke.edges.len()).unwrap();
    let made = stroke_corridor(&network, longest, settings.policy, &settings.corridor).unwrap();
    let certified = |stop: &Stop| stet::certify(&made.corridor, &model, &settings.stet, stop);
    let whole = stet::certify(&made.corridor, &model, &settings.stet, &Stop::never()).unwrap();
    assert!(whole.is_some());
    let mut asks = 1;
    while certified(&Stop::after(asks)).is_err() {
        asks += 1 + asks / 4;
    }
    assert_eq!(certified(&Stop::after(asks)), Ok(whole));
    let length_m = made.corridor.len() as f64 * made.corridor.spacing_m;
    assert!(asks as f64 > length_m / 20.0, "{asks} questions over {length_m} m");
    for some in [0, 1, asks / 8, asks / 2] {
        assert_eq!(certified(&Stop::after(some)), Err(Stopped), "{some} of {asks}");
    }
}

#[test]
fn an_explanation_that_is_told_to_stop_has_no_result() {
    let (_place, _, network, model, settings) = wide();
    let (told, other) = (Stop::default(), Stop::default());
    told.tell();
    let explained = |stop: &Stop| explain_edge(&network, EdgeNo::new(0), &model, &settings, stop).map(|e| e.is_some());
    assert_eq!((explained(&told), explained(&other)), (Err(Stopped), Ok(true)));
    let turn = turn_facts(&network, &settings.kerbs).remove(0);
    let explained = |stop: &Stop| explain_turn(&network, &turn, &model, &settings, stop).map(|e| e.title());
    assert_eq!(explained(&told), Err(Stopped));
    assert_eq!(explained(&Stop::after(2)), Err(Stopped));
    assert!(explained(&other).is_ok());
}
