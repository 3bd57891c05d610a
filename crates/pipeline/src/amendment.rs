//! An update in place: where no edge and no turn gets another number, only the rows that differ are changed, in a copy of the older database.

use std::time::Instant;

use super::recertification::{Recertification, StoredSet};
use super::reuse::{Certificates, StoredNetwork, is_undone, same_turn, without_corridor};
use super::summary::Summary;
use crate::account::AccountRow;
use crate::certify::{CertificationOutcome, Dependents, NearNodes, TurnOutcome};
use crate::network::{Differences, EdgeNo, Network, Portion};
use crate::osm::NodeId;
use crate::reporter::Reporter;
use crate::rows::EdgeMeasure;
use crate::settings::Settings;
use crate::store::Amendment;
use crate::turns::{TurnFacts, TurnNo, junction_areas, junction_places};

/// Most touched strokes and turns that are certified in place, and the same as a share of all: one in twenty. Beyond that, most of the time goes
/// into certificates, and they are kept if the program is killed.
const MOST_TOUCHED: usize = 500;
const ONE_IN: usize = 20;

/// Certifies again what newer roads touch. Returns what to write, and the account of all certificates. `None` if rows cannot be changed in
/// place: an edge or a turn gets another number, too much is touched, or the database is not the one of the roads that were read for it.
pub(super) fn amendment<'a>(
    stored: &'a mut StoredNetwork<'_>,
    after: &'a Portion,
    turns: &'a [TurnFacts],
    settings: &Settings,
    reporter: &dyn Reporter,
    summary: &mut Summary,
) -> Option<(Amendment<'a>, Vec<AccountRow>)> {
    let clock = Instant::now();
    let whole = stored.has_these_edges();
    let StoredNetwork { roads: before, facts: turns_before, measures: known, certificates, .. } = stored;
    let Certificates::InPlace(_, sets) = certificates else { return None };
    let network = &after.network;
    let edge_ids = |portion: &'a Portion| portion.network.edges.iter().map(|edge| edge.id);
    let turn_ids = |turns: &'a [TurnFacts]| turns.iter().map(|turn| turn.id);
    let complete = |set: &StoredSet| {
        let of_turns = set.turns.as_ref().is_none_or(|verdicts| verdicts.len() == turns.len());
        set.edges.len() == network.edges.len() && of_turns
    };
    let same_numbers = edge_ids(before).eq(edge_ids(after)) && turn_ids(turns_before).eq(turn_ids(turns));
    if !whole || !same_numbers || !sets.iter().all(complete) {
        return None;
    }
    let differences = Differences::find(&before.network, network);
    let mut touched = Dependents::find(network, turns, &differences.edges, &differences.nodes);
    let others = TurnNo::all().zip(turns_before.iter().zip(turns));
    touched.turns.extend(others.filter(|(_, (old, new))| !same_turn(&differences, old, new)).map(|(index, _)| index));
    let most = MOST_TOUCHED.max((network.strokes.len() + turns.len()) / ONE_IN);
    if touched.strokes.len() + touched.turns.len() > most {
        return None;
    }
    // What was not made before does not decide how the file is written.
    add_undone(&mut touched, network, known, sets);
    let again = Recertification { network, facts: turns, touched: &touched };
    let measures = again.measures(settings, reporter);
    let made = again.sets(sets, reporter);
    let junctions = settings.turns.then(|| {
        let near = NearNodes::new(network, &touched.nodes);
        let places = junction_places(network, turns).into_iter().filter(|(_, place)| near.has(&[*place]));
        let nodes: Vec<NodeId> = places.map(|(node, _)| node).collect();
        let areas = junction_areas(network, &nodes, &settings.turn_params());
        (nodes, areas)
    });
    let mut all: Vec<EdgeMeasure> = known.iter().map(|(_, measure)| *measure).collect();
    measures.iter().for_each(|&(edge, measure)| all[edge.index()] = measure);
    let account = account(after, turns.len(), &all, sets);
    let certificates = made.iter().map(|made| made.set.edges.len() + made.set.turns.len()).sum::<usize>();
    summary.stage("certificates", clock, certificates as u64, "certificates");
    let sets = made.into_iter().map(|made| made.set).collect();
    Some((Amendment { before, turns_before, after, turns, measures, junctions, sets }, account))
}

/// Adds the strokes and turns whose certificates claim nothing, because they took too long or a machine failed.
/// `measures`: by edge.
fn add_undone(touched: &mut Dependents, network: &Network, measures: &[(i64, EdgeMeasure)], sets: &[StoredSet]) {
    let of_edges = network.strokes_of_edges();
    for set in sets {
        let edges = set.edges.iter().zip(measures).zip(&of_edges);
        touched.strokes.extend(
            edges.filter(|((verdict, (_, measure)), _)| is_undone(**verdict, measure)).map(|(_, stroke)| *stroke),
        );
        let turns = TurnNo::all().zip(set.turns.iter().flatten());
        touched.turns.extend(turns.filter(|(_, verdict)| verdict.claims_nothing()).map(|(turn, _)| turn));
    }
    let Dependents { strokes, turns, .. } = touched;
    strokes.sort_unstable();
    strokes.dedup();
    turns.sort_unstable();
    turns.dedup();
}

/// The account of all certificates, those that stand and those that were made again. `measures`: by edge.
fn account(roads: &Portion, turns: usize, measures: &[EdgeMeasure], sets: &[StoredSet]) -> Vec<AccountRow> {
    let mut outcome = CertificationOutcome::new(&roads.network);
    for (edge, &measure) in EdgeNo::all().zip(measures) {
        let verdicts = || sets.iter().filter_map(move |set| set.edges.get(edge.index()).copied());
        outcome.edge(edge, measure, without_corridor(measure, verdicts()));
        verdicts().for_each(|verdict| outcome.count(verdict));
    }
    let mut rows = outcome.rows();
    let of_turns: Vec<_> = sets.iter().filter_map(|set| set.turns.as_ref()).collect();
    if !of_turns.is_empty() {
        let mut outcome = TurnOutcome::default();
        for turn in 0..turns {
            outcome.keep(of_turns.iter().filter_map(|verdicts| verdicts.get(turn).copied()));
        }
        rows.extend(outcome.rows());
    }
    rows
}
