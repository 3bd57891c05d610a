//! Certifies the touched part of every set again, each with its own settings and vehicle.

use std::path::Path;

use super::{EvidenceChanged, SetChanged, VerdictChanges};
use crate::certify::{Job, Touched, TurnJob, certify_some_turns, certify_strokes};
use crate::network::Network;
use crate::osm::facts::Policy;
use crate::pipeline::RunError;
use crate::reporter::Reporter;
use crate::rows::{EdgeCertificate, StoredPlan, TurnCertificate};
use crate::settings::Settings;
use crate::stet::Model;
use crate::store::{Database, SetRenewal, StoreError};
use crate::turns::TurnFacts;
use crate::vehicle::Vehicle;

/// What is to be certified again.
pub(super) struct Again<'a> {
    pub(super) db: &'a Path,
    pub(super) network: &'a Network,
    pub(super) facts: Option<&'a [TurnFacts]>,
    pub(super) touched: &'a Touched,
}

/// Sets that are certified together: corridors are made once for all of them.
struct Group {
    settings: Settings,
    turns: bool,
    policy: Policy,
    vehicles: Vec<String>,
}

impl Again<'_> {
    /// Certifies the touched part of every set, each with its own settings and vehicle.
    pub(super) fn sets(
        &self,
        db: &mut Database,
        reporter: &dyn Reporter,
        changed: &mut EvidenceChanged,
    ) -> Result<Vec<SetRenewal>, RunError> {
        if self.touched.strokes.is_empty() && self.touched.turns.is_empty() {
            return Ok(Vec::new());
        }
        let clock = std::time::Instant::now();
        let mut groups: Vec<Group> = Vec::new();
        for set in db.certified()? {
            let (settings, turns) = (set.settings()?, db.has_turns(&set.vehicle_id, set.policy)?);
            match groups.iter_mut().find(|group| group.settings == settings && group.turns == turns) {
                Some(group) => group.vehicles.push(set.vehicle_id),
                None => groups.push(Group { settings, turns, policy: set.policy, vehicles: vec![set.vehicle_id] }),
            }
        }
        let records = db.vehicles()?;
        let mut renewed = Vec::new();
        for group in groups {
            let of = |id: &String| {
                let record = records.iter().find(|record| record.id == *id);
                let record = record.ok_or_else(|| StoreError::NotThere {
                    path: self.db.to_owned(),
                    detail: format!("vehicle {id} is missing; run `netcert ingest` again"),
                })?;
                Ok(Model::new(&Vehicle::from_json(&record.definition)?)?)
            };
            let models = group.vehicles.iter().map(of).collect::<Result<Vec<Model>, RunError>>()?;
            renewed.extend(self.group(db, &group, &models, reporter, changed)?);
        }
        let made = renewed.iter().map(|set| set.edges.len() + set.turns.len()).sum::<usize>();
        changed.summary.stage("certificates", clock, made as u64, "certificates");
        Ok(renewed)
    }

    fn group(
        &self,
        db: &mut Database,
        group: &Group,
        models: &[Model],
        reporter: &dyn Reporter,
        changed: &mut EvidenceChanged,
    ) -> Result<Vec<SetRenewal>, RunError> {
        let Group { settings, policy, vehicles, .. } = group;
        let job = Job { network: self.network, models, settings };
        let mut edges: Vec<Vec<EdgeCertificate>> = vec![Vec::new(); models.len()];
        let Ok(outcome) =
            certify_strokes::<std::convert::Infallible>(&job, &self.touched.strokes, reporter, |vehicle, made| {
                edges[vehicle].push(made.clone());
                Ok(())
            });
        let mut plans: Vec<Vec<StoredPlan>> = vec![Vec::new(); models.len()];
        for (vehicle, plan) in outcome.plans {
            plans[vehicle].push(plan);
        }
        let mut verdicts = Vec::new();
        let mut edge_changes = Vec::new();
        for (vehicle, made) in vehicles.iter().zip(&edges) {
            let mut known = db.edge_verdicts(vehicle, *policy)?;
            let mut changes = VerdictChanges::default();
            for certificate in made {
                if let Some(slot) = known.get_mut(certificate.edge as usize) {
                    let before = std::mem::replace(slot, certificate.conclusion.verdict);
                    changes.note(Some(before), *slot);
                }
            }
            verdicts.push(known);
            edge_changes.push(changes);
        }
        let mut turns: Vec<Vec<TurnCertificate>> = vec![Vec::new(); models.len()];
        if let (true, Some(facts)) = (group.turns, self.facts) {
            let job = TurnJob { network: self.network, turns: facts, models, edges: &verdicts, settings };
            let Ok(_) =
                certify_some_turns::<std::convert::Infallible>(&job, &self.touched.turns, reporter, |vehicle, made| {
                    turns[vehicle].push(made.clone());
                    Ok(())
                });
        }
        let mut renewed = Vec::new();
        let made = edges.into_iter().zip(plans).zip(turns).zip(edge_changes);
        for (vehicle, (((edges, plans), turns), edge_changes)) in vehicles.iter().zip(made) {
            let mut turn_changes = VerdictChanges::default();
            if group.turns {
                let before = db.turn_verdicts(vehicle, *policy)?;
                for turn in &turns {
                    turn_changes.note(before.get(turn.turn as usize).copied(), turn.conclusion.verdict);
                }
            }
            changed.sets.push(SetChanged {
                vehicle: vehicle.clone(),
                policy: *policy,
                edges: edge_changes,
                turns: group.turns.then_some(turn_changes),
            });
            renewed.push(SetRenewal { vehicle: vehicle.clone(), policy: *policy, edges, plans, turns });
        }
        Ok(renewed)
    }
}
