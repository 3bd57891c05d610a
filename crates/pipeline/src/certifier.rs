//! Certifies the roads of a new database, portion by portion: all strokes, then all turns.

use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::account::AccountRow;
use crate::certify::{CertificationOutcome, Job, TurnJob, TurnOutcome, by_cell, make_strokes, make_turns};
use crate::network::{EdgeNo, Network, Portion};
use crate::osm::{LonLat, NodeId};
use crate::reporter::Reporter;
use crate::rows::{EdgeCertificate, StoredPlan, StrokeMade, TurnCertificate, TurnMade};
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{Checkpoint, CheckpointStage, PartOfWork, VehicleNo, Writer};
use crate::turns::{JunctionArea, TurnFacts, TurnNo, junction_areas, junction_places, turn_facts};

use super::edge_verdicts::EdgeVerdicts;
use super::error::RunError;
use super::reuse::{Earlier, without_corridor};
use super::roads::ExtractRoads;
use super::share::Share;
use super::summary::{Summary, TurnWork};
use super::task_results::{failed_stroke, failed_turn, unknown_rest};

/// The work on one portion.
struct PortionWork<'a> {
    number: usize,
    portion: &'a Portion,
    /// Where its progress is told.
    share: Share<'a>,
}

/// Certifies portions: how, and for whom.
pub(super) struct Certifier<'a> {
    pub(super) settings: &'a Settings,
    pub(super) models: &'a [Model],
    /// The numbers of the vehicles in the new database.
    pub(super) numbers: &'a [VehicleNo],
    /// What an earlier database has; only if the roads are whole.
    pub(super) earlier: Option<&'a Earlier>,
    /// What failed on other machines, if those have certified the portions.
    pub(super) failed: Option<&'a BTreeSet<PartOfWork>>,
    pub(super) reporter: &'a dyn Reporter,
}

impl Certifier<'_> {
    /// Certifies all edges. Takes what an earlier database or an earlier run has. Returns the verdicts, and the account.
    pub(super) fn strokes(
        &self,
        roads: &mut ExtractRoads<'_>,
        writer: &mut Writer,
        checkpoint: &mut Checkpoint,
        summary: &mut Summary,
    ) -> Result<(EdgeVerdicts, Vec<AccountRow>), RunError> {
        let clock = Instant::now();
        let mut verdicts = EdgeVerdicts::new(roads.edges() as usize, self.models, self.settings);
        let mut outcome = CertificationOutcome::default();
        self.reporter.begin("certificates", u64::from(roads.edges()));
        let mut done = 0;
        for number in 0..roads.portions() {
            let portion = roads.portion(number);
            outcome.go_on(&portion.network);
            let own = portion.edges().count() as u64;
            let work = PortionWork { number, portion, share: Share::new(self.reporter, done, own) };
            self.strokes_of(&work, writer, checkpoint, &mut outcome, &mut verdicts)?;
            for (vehicle, plan) in std::mem::take(&mut outcome.plans) {
                let first = portion.edge(EdgeNo::new(plan.at));
                let plan = StoredPlan { at: first.get(), ..plan };
                writer.plan(self.numbers[vehicle], self.settings.policy, &plan)?;
            }
            writer.portion(portion, &outcome.measures)?;
            done += own;
            roads.count();
        }
        self.reporter.end();
        summary.stage("certificates", clock, outcome.certificates(), "certificates");
        Ok((verdicts, outcome.rows()))
    }

    fn strokes_of(
        &self,
        work: &PortionWork<'_>,
        writer: &mut Writer,
        checkpoint: &mut Checkpoint,
        outcome: &mut CertificationOutcome,
        verdicts: &mut EdgeVerdicts,
    ) -> Result<(), RunError> {
        let PortionWork { number, portion, share } = work;
        let (network, policy) = (&portion.network, self.settings.policy);
        let job = Job { network, models: self.models, settings: self.settings };
        let own = by_cell(network).into_iter().filter(|&stroke| portion.owns_stroke(stroke)).collect();
        let mut left = Left::new(own, network.strokes.len());
        if let Some(earlier) = self.earlier {
            for stroke in earlier.strokes(network).filter(|&stroke| left.take(stroke)) {
                for (edge, measure, kept) in earlier.edges(network, stroke) {
                    outcome.edge(edge, measure, without_corridor(measure, kept.iter().map(|kept| kept.verdict())));
                    for (vehicle, kept) in kept.into_iter().enumerate() {
                        outcome.count(kept.verdict());
                        verdicts.set(vehicle, edge, kept.verdict());
                        writer.kept(self.numbers[vehicle], policy, edge, kept)?;
                    }
                }
                outcome.plans.extend(earlier.plans(network, stroke));
            }
        }
        let mut sink = |vehicle: usize, certificate: &EdgeCertificate| {
            let edge = portion.edge(certificate.edge);
            verdicts.set(vehicle, edge, certificate.conclusion.verdict);
            writer.certificate(self.numbers[vehicle], policy, &EdgeCertificate { edge, ..certificate.clone() })
        };
        let part = (CheckpointStage::Strokes, *number as u32);
        checkpoint.each(part, |batch: Vec<StrokeMade>| {
            batch.into_iter().filter(|made| left.take(made.stroke)).try_for_each(|made| outcome.add(made, &mut sink))
        })?;
        let left = left.all();
        if unknown_rest(self.failed, part, left.len())? {
            let edges = |stroke: u32| {
                let edges = &network.strokes[stroke as usize].edges;
                &network.stroke_edges[edges.start as usize..edges.end as usize]
            };
            let made = |&stroke: &u32| failed_stroke(stroke, edges(stroke), self.models.len());
            left.iter().map(made).try_for_each(|made| outcome.add(made, &mut sink))?;
            return Ok(());
        }
        let checkpoint = Mutex::new(checkpoint);
        let keep = |made: &[StrokeMade]| locked(&checkpoint).keep(part, made);
        make_strokes(&job, &left, share, &keep, |made| outcome.add(made, &mut sink))?;
        Ok(())
    }

    /// Certifies all turns. Takes what an earlier database or an earlier run has.
    pub(super) fn turns(
        &self,
        roads: &mut ExtractRoads<'_>,
        verdicts: &EdgeVerdicts,
        writer: &mut Writer,
        checkpoint: &mut Checkpoint,
        summary: &mut Summary,
    ) -> Result<(), RunError> {
        let clock = Instant::now();
        let mut outcome = TurnOutcome::default();
        let (portions, edges) = (roads.portions(), u64::from(roads.edges()));
        self.reporter.begin("turns", edges);
        let mut done = 0;
        // From the last portion backwards, because that one is still there.
        for number in (0..portions).rev() {
            let portion = roads.portion(number);
            let own = portion.edges().count() as u64;
            let work = PortionWork { number, portion, share: Share::new(self.reporter, done, own) };
            self.turns_of(&work, &verdicts.of(portion), writer, checkpoint, &mut outcome)?;
            done += own;
        }
        self.reporter.end();
        summary.account.extend(outcome.rows());
        summary.stage("turns", clock, outcome.certificates(), "turn certificates");
        summary.turns = TurnWork { laid_out: outcome.laid_out, of_this_run: outcome.work };
        Ok(())
    }

    /// The areas of the junctions at some nodes.
    fn junctions(&self, network: &Network, places: Vec<(NodeId, LonLat)>) -> Vec<JunctionArea> {
        let (mut areas, nodes) = match self.earlier {
            Some(earlier) => earlier.junctions(network, &places),
            None => (Vec::new(), places.into_iter().map(|(node, _)| node).collect()),
        };
        areas.extend(junction_areas(network, &nodes, &self.settings.turn_params()));
        areas
    }

    fn turns_of(
        &self,
        work: &PortionWork<'_>,
        verdicts: &EdgeVerdicts,
        writer: &mut Writer,
        checkpoint: &mut Checkpoint,
        outcome: &mut TurnOutcome,
    ) -> Result<(), RunError> {
        let PortionWork { number, portion, share } = work;
        let (network, policy) = (&portion.network, self.settings.policy);
        let mut turns: Vec<TurnFacts> = turn_facts(network, &self.settings.kerbs);
        let places = junction_places(network, &turns).into_iter().filter(|&(_, place)| portion.has(place)).collect();
        let junctions = self.junctions(network, places);
        turns.retain(|turn| portion.owns(turn.movement.from));
        let first = writer.turns(portion, &turns, &junctions)?;
        drop(junctions);
        let edges = &verdicts.0[..];
        let job = TurnJob { network, turns: &turns, models: self.models, edges, settings: self.settings };
        let mut left = Left::new(TurnNo::first(turns.len()).collect(), turns.len());
        if let Some(earlier) = self.earlier {
            for (turn, kept) in earlier.turns(network, &turns) {
                if left.take(turn) {
                    outcome.keep(kept.iter().map(|(kept, _)| kept.verdict()));
                    for (&number, (kept, plan)) in self.numbers.iter().zip(kept) {
                        writer.kept_turn(number, policy, turn, kept, plan)?;
                    }
                }
            }
        }
        let mut sink = |vehicle: usize, certificate: &TurnCertificate| {
            writer.turn_certificate(self.numbers[vehicle], policy, first, certificate)
        };
        let part = (CheckpointStage::Turns, *number as u32);
        checkpoint.each(part, |batch: Vec<TurnMade>| {
            batch.into_iter().filter(|made| left.take(made.turn)).try_for_each(|made| outcome.add(&made, &mut sink))
        })?;
        let left = left.all();
        if unknown_rest(self.failed, part, left.len())? {
            let made = |&turn: &TurnNo| failed_turn(turn, self.models.len());
            left.iter().map(made).try_for_each(|made| outcome.add(&made, &mut sink))?;
            return Ok(());
        }
        let checkpoint = Mutex::new(checkpoint);
        let keep = |made: &TurnMade| locked(&checkpoint).keep(part, std::slice::from_ref(made));
        let work = make_turns(&job, &left, share, &keep, |made| outcome.add(&made, &mut sink))?;
        outcome.work += work;
        Ok(())
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is not finished yet: numbers in the order in which they are to be done.
struct Left<N> {
    order: Vec<N>,
    finished: Vec<bool>,
}

impl<N: Copy + Into<u32>> Left<N> {
    /// `order`: what is to be done, as numbers below `count`.
    fn new(order: Vec<N>, count: usize) -> Self {
        let mut finished = vec![true; count];
        order.iter().for_each(|&number| finished[number.into() as usize] = false);
        Self { order, finished }
    }

    /// Notes that a number is finished. `false` if it was before, or is none.
    fn take(&mut self, number: N) -> bool {
        self.finished.get_mut(number.into() as usize).is_some_and(|finished| !std::mem::replace(finished, true))
    }

    fn all(self) -> Vec<N> {
        self.order.into_iter().filter(|&number| !self.finished[number.into() as usize]).collect()
    }
}
