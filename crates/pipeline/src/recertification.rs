//! Certifies again what a change touches, for every set of certificates that a database has, each with its own settings and vehicle.

use std::convert::Infallible;
use std::path::Path;

use super::error::RunError;
use crate::certify::{Dependents, Job, TurnJob, certify_some_turns, certify_strokes};
use crate::network::{EdgeNo, Network};
use crate::reporter::Reporter;
use crate::rows::{EdgeCertificate, EdgeMeasure, StoredPlan, TurnCertificate};
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{Database, SetRenewal, StoreError};
use crate::turns::TurnFacts;
use crate::vehicle::Vehicle;
use crate::verdict::Verdict;

/// How verdicts changed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct VerdictChanges {
    /// Certificates that were made again.
    pub again: usize,
    /// Those that are `safe` and were not.
    pub became_safe: usize,
    /// Those that were `safe` and are not.
    pub no_longer_safe: usize,
}

impl VerdictChanges {
    /// Writes a new verdict over the one before.
    fn replace(&mut self, verdicts: &mut [Verdict], index: usize, now: Verdict) {
        let slot = verdicts.get_mut(index);
        let before = slot.map(|slot| std::mem::replace(slot, now) == Verdict::Safe).unwrap_or_default();
        self.again += 1;
        self.became_safe += usize::from(now == Verdict::Safe && !before);
        self.no_longer_safe += usize::from(before && now != Verdict::Safe);
    }
}

/// A set of certificates of a database: its vehicle, its settings and its verdicts.
pub(super) struct StoredSet {
    pub(super) settings: Settings,
    model: Model,
    /// By edge.
    pub(super) edges: Vec<Verdict>,
    /// By turn; `None` if the vehicle's turns are not certified.
    pub(super) turns: Option<Vec<Verdict>>,
}

impl StoredSet {
    /// All sets of a database at `path`.
    pub(super) fn all(db: &mut Database, path: &Path) -> Result<Vec<Self>, RunError> {
        let records = db.vehicles()?;
        let mut sets = Vec::new();
        for set in db.certified()? {
            let (id, settings) = (&set.vehicle_id, set.settings()?);
            let missing = || StoreError::NotThere {
                path: path.to_owned(),
                detail: format!("vehicle {id} is missing; run `netcert ingest` again"),
            };
            let record = records.iter().find(|record| record.id == *id).ok_or_else(missing)?;
            let model = Model::new(&Vehicle::from_json(&record.definition)?)?;
            let edges = db.edge_verdicts(id, set.policy)?;
            let turns = if db.has_turns(id, set.policy)? { Some(db.turn_verdicts(id, set.policy)?) } else { None };
            sets.push(Self { settings, model, edges, turns });
        }
        Ok(sets)
    }
}

/// The certificates of a set that were made again.
pub(super) struct MadeAgain {
    pub(super) set: SetRenewal,
    pub(super) edges: VerdictChanges,
    /// `None` if the vehicle's turns are not certified.
    pub(super) turns: Option<VerdictChanges>,
}

/// What is to be certified again.
pub(super) struct Recertification<'a> {
    pub(super) network: &'a Network,
    pub(super) facts: &'a [TurnFacts],
    pub(super) touched: &'a Dependents,
}

impl Recertification<'_> {
    /// The edges of touched strokes with the measures of their corridors, in order.
    pub(super) fn measures(&self, settings: &Settings, reporter: &dyn Reporter) -> Vec<(EdgeNo, EdgeMeasure)> {
        let Self { network, touched, .. } = *self;
        let job = Job { network, models: &[], settings };
        let Ok(outcome) = certify_strokes::<Infallible>(&job, &touched.strokes, reporter, |_, _| Ok(()));
        let measure = |edge: EdgeNo| outcome.measures.get(edge.index()).copied().unwrap_or_default();
        let mut all: Vec<(EdgeNo, EdgeMeasure)> = touched.edges(network).map(|edge| (edge, measure(edge))).collect();
        all.sort_unstable_by_key(|edge| edge.0);
        all
    }

    /// Certifies the touched part of every set. The sets then have the new verdicts.
    pub(super) fn sets(&self, sets: &mut [StoredSet], reporter: &dyn Reporter) -> Vec<MadeAgain> {
        let mut made = Vec::new();
        let mut left: Vec<&mut StoredSet> = sets.iter_mut().collect();
        // Sets of the same settings are certified together: corridors are made once for all of them.
        while let Some(first) = left.first() {
            let (settings, turns) = (first.settings.clone(), first.turns.is_some());
            let (group, others) =
                left.into_iter().partition(|set| set.settings == settings && set.turns.is_some() == turns);
            made.extend(self.group(&settings, group, reporter));
            left = others;
        }
        made
    }

    fn group(&self, settings: &Settings, mut sets: Vec<&mut StoredSet>, reporter: &dyn Reporter) -> Vec<MadeAgain> {
        let Self { network, facts, touched } = *self;
        let models: Vec<Model> = sets.iter().map(|set| set.model.clone()).collect();
        let mut edges: Vec<Vec<EdgeCertificate>> = vec![Vec::new(); models.len()];
        let job = Job { network, models: &models, settings };
        let Ok(outcome) = certify_strokes::<Infallible>(&job, &touched.strokes, reporter, |vehicle, made| {
            edges[vehicle].push(made.clone());
            Ok(())
        });
        let mut plans: Vec<Vec<StoredPlan>> = vec![Vec::new(); models.len()];
        for (vehicle, plan) in outcome.plans {
            plans[vehicle].push(plan);
        }
        let mut verdicts: Vec<Vec<Verdict>> = sets.iter_mut().map(|set| std::mem::take(&mut set.edges)).collect();
        let mut edge_changes = vec![VerdictChanges::default(); models.len()];
        for ((made, known), changes) in edges.iter().zip(&mut verdicts).zip(&mut edge_changes) {
            made.iter().for_each(|made| changes.replace(known, made.edge.index(), made.conclusion.verdict));
        }
        let mut turns: Vec<Vec<TurnCertificate>> = vec![Vec::new(); models.len()];
        if sets.first().is_some_and(|set| set.turns.is_some()) {
            let job = TurnJob { network, turns: facts, models: &models, edges: &verdicts, settings };
            let Ok(_) = certify_some_turns::<Infallible>(&job, &touched.turns, reporter, |vehicle, made| {
                turns[vehicle].push(made.clone());
                Ok(())
            });
        }
        let mut again = Vec::new();
        let made = edges.into_iter().zip(plans).zip(turns).zip(verdicts).zip(edge_changes);
        for (set, ((((edges, plans), turns), verdicts), edge_changes)) in sets.into_iter().zip(made) {
            set.edges = verdicts;
            let mut turn_changes = VerdictChanges::default();
            if let Some(known) = &mut set.turns {
                turns.iter().for_each(|made| turn_changes.replace(known, made.turn.index(), made.conclusion.verdict));
            }
            let (vehicle, policy) = (set.model.vehicle.id.clone(), settings.policy);
            again.push(MadeAgain {
                set: SetRenewal { vehicle, policy, edges, plans, turns },
                edges: edge_changes,
                turns: set.turns.as_ref().map(|_| turn_changes),
            });
        }
        again
    }
}
