//! Work that is told to stop does, wherever it is; what has been stopped has no result.

use std::cell::Cell;
use std::collections::BTreeMap;

use netcert::corridor::Params;
use netcert::explain::explain_edge_until;
use netcert::network::{Movement, Network};
use netcert::osm::facts::Policy;
use netcert::pipeline::Settings;
use netcert::route::{
    Graph, MadeTurns, Measure, Permits, Planner, Position, Question, Speeds, Strokes, TurnPiece, Turns,
};
use netcert::stet::{Model, Options};
use netcert::stop::{Stop, Stopped};
use netcert::store::{Database, QueryOptions, TurnQuery};
use netcert::vehicle::Vehicle;
use netcert::verdict::{UnknownReason, Verdict};

use crate::support::program::Place;

const VEHICLE: &str = "AU-SEMI19";

/// Turns that tell the work to stop as soon as one is asked for.
struct Telling<'m> {
    inner: MadeTurns<'m>,
    stop: Stop,
    asked: Cell<usize>,
}

impl Turns for Telling<'_> {
    fn pieces(
        &self,
        strokes: &mut Strokes<'_>,
        movement: &Movement,
        arcs: &[u32],
    ) -> Result<Vec<TurnPiece>, UnknownReason> {
        self.asked.set(self.asked.get() + 1);
        self.stop.tell();
        self.inner.pieces(strokes, movement, arcs)
    }
}

/// The demo under the carriageway policy, where some corners pass.
fn wide() -> (Place, Database, Network, Model, Settings) {
    let place = Place::with_wide_demo("AU-SEMI19");
    let mut database = place.database();
    let network = database.load_network().unwrap();
    let (corridor, stet) = (Params::default(), Options::default());
    let settings = Settings { policy: Policy::Carriageway, corridor, stet, turns: true };
    let definition = database.vehicles().unwrap().remove(0).definition;
    let model = Model::new(&Vehicle::from_json(&definition).unwrap()).unwrap();
    (place, database, network, model, settings)
}

#[test]
fn a_route_that_is_told_to_stop_asks_for_no_further_turn() {
    let (_place, mut database, network, model, settings) = wide();
    let movements = network.movements();
    let permits = Permits::stored(&mut database, &network, &movements, VEHICLE, settings.policy).unwrap();
    let rows = database.query(&QueryOptions::new(VEHICLE, settings.policy)).unwrap().map(Result::unwrap);
    let middles: BTreeMap<i64, Position> = rows
        .map(|row| (row.edge_id, row.line[row.line.len() / 2].degrees()))
        .map(|(edge, (lon, lat))| (edge, Position { lon, lat }))
        .collect();
    let turns = database.query_turns(&TurnQuery::new(VEHICLE, settings.policy)).unwrap().into_iter();
    let safe = turns.filter(|turn| turn.verdict == Verdict::Safe);
    let pairs: Vec<[Position; 2]> = safe.map(|turn| [middles[&turn.from_edge], middles[&turn.to_edge]]).collect();
    let inner =
        MadeTurns { model: &model, policy: settings.policy, params: settings.turn_params(), options: settings.stet };
    let speeds = Speeds::builtin().unwrap();
    let mut stopped = 0;
    for places in pairs.into_iter().take(12) {
        let turns = Telling { inner: inner.clone(), stop: Stop::default(), asked: Cell::default() };
        let graph = Graph::new(&network, &movements, &speeds, Measure::Time);
        let strokes = Strokes::new(&network, settings.policy, settings.corridor);
        let mut planner = Planner::new(graph, &permits, &model, &turns, strokes, settings.stet, speeds.clone());
        let question = Question { places: places.to_vec(), snap_m: 100.0, alternatives: 2, tries: 30 };
        let answer = planner.answer_until(&question, &turns.stop).unwrap();
        // Over a turn it was stopped there; a way without turns went to its end.
        assert_eq!((answer.is_none(), turns.asked.get()), (turns.stop.told(), usize::from(turns.stop.told())));
        stopped += turns.asked.get();
        // The same planner then answers as if nothing had been.
        assert!(planner.answer_until(&question, &Stop::default()).unwrap().is_some());
    }
    assert!(stopped > 0, "no way leads over a turn");
}

#[test]
fn an_explanation_that_is_told_to_stop_has_no_result() {
    let (_place, _, network, model, settings) = wide();
    let (told, other) = (Stop::default(), Stop::default());
    told.tell();
    let explained = |stop: &Stop| explain_edge_until(&network, 0, &model, &settings, stop).map(|e| e.is_some());
    assert_eq!((explained(&told), explained(&other)), (Err(Stopped), Ok(true)));
}
