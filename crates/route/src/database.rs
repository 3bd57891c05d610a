//! Reads permits from a database, and certificates for comparisons.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::attested::Attested;
use super::driver::Driver;
use super::permits::{Permit, Permits};
use super::relative::{Peer, Standings};
use super::roads::Roads;
use crate::network::{EdgeNo, Movements, Network};
use crate::osm::facts::Policy;
use crate::rows::CertificateStanding;
use crate::stet::{Model, ModelError};
use crate::store::{CertifiedSet, Database, Reference, StoreError};
use crate::vehicle::Vehicle;
use crate::verdict::{UnknownReason, Verdict};

impl Permits {
    /// The permits of a set, for the edges and turns of the database that `network` is from.
    ///
    /// # Errors
    /// The set's turns are not certified, or its settings cannot be read.
    pub fn stored(
        database: &mut Database,
        network: &Network,
        movements: &Movements,
        set: &CertifiedSet,
    ) -> Result<Self, StoreError> {
        let settings = set.settings()?;
        let (vehicle, policy) = (&set.vehicle_id, set.policy);
        if !database.has_turns(vehicle, policy)? {
            return Err(StoreError::turns_not_certified(database.path(), vehicle, policy));
        }
        let mut edges = vec![Permit::UNKNOWN; network.edges.len()];
        for row in database.edge_conclusions(vehicle, policy)? {
            let (edge, verdict, rsc_m) = row?;
            if let Some(slot) = edges.get_mut(edge.index()) {
                *slot = Permit { verdict, rsc_m };
            }
        }
        let turns = database.turn_conclusions(vehicle, policy)?;
        let turns = turns.map(|row| row.map(|(ends, verdict, rsc_m)| (ends, Permit { verdict, rsc_m })));
        let turns: FxHashMap<[EdgeNo; 2], Permit> = turns.collect::<Result<_, StoreError>>()?;
        let turn = |from, to| turns.get(&[from, to]).copied().unwrap_or(Permit::UNKNOWN);
        Ok(Self::new(settings, edges, movements, turn))
    }
}

/// Why a database gives no driver.
#[derive(Debug, thiserror::Error)]
pub enum NoDriver {
    /// The file cannot be read, or lacks the permits.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The certificate's model does not cover the vehicle.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl Driver {
    /// A vehicle with the permits of one of its sets in a database. `roads` must be those of the same database.
    ///
    /// # Errors
    /// The set's turns are not certified, its settings cannot be read, or the certificate's model does not cover the vehicle.
    pub fn stored(
        database: &mut Database,
        roads: &Roads,
        vehicle: &Vehicle,
        set: &CertifiedSet,
    ) -> Result<Arc<Self>, NoDriver> {
        let permits = Self::permits(database, roads, vehicle, set)?;
        let attested = Attested::new(&database.attestations(&vehicle.id)?);
        Ok(Arc::new(Self { model: Model::new(vehicle)?, permits, attested }))
    }

    /// The same vehicle with the permits of another of its sets in the same database.
    ///
    /// # Errors
    /// The set's turns are not certified, or its settings cannot be read.
    pub fn with_set(
        &self,
        database: &mut Database,
        roads: &Roads,
        set: &CertifiedSet,
    ) -> Result<Arc<Self>, StoreError> {
        let permits = Self::permits(database, roads, &self.model.vehicle, set)?;
        Ok(Arc::new(Self { model: self.model.clone(), permits, attested: self.attested.clone() }))
    }

    fn permits(
        database: &mut Database,
        roads: &Roads,
        vehicle: &Vehicle,
        set: &CertifiedSet,
    ) -> Result<Permits, StoreError> {
        let mut permits = Permits::stored(database, &roads.network, &roads.movements, set)?;
        permits.add_rules(&roads.network, &roads.movements, vehicle);
        Ok(permits)
    }
}

impl Standings {
    /// The certificates of a vehicle, edges and turns.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn stored(database: &mut Database, vehicle: &str, policy: Policy) -> Result<Self, StoreError> {
        let mut out = Self::default();
        for row in database.edge_standings(vehicle, policy)? {
            let (edge, standing) = row?;
            put(&mut out.edges, edge, standing);
        }
        let mut turns = Vec::new();
        for row in database.turn_standings(vehicle, policy)? {
            let (turn, standing) = row?;
            put(&mut turns, turn, standing);
        }
        for step in database.turn_steps(vehicle, policy)? {
            let step = step?;
            let standing = turns.get(step.turn.index()).copied();
            out.turns.extend(standing.map(|standing| ((step.from, step.to), standing)));
        }
        Ok(out)
    }
}

/// Puts a standing at its index. Sets are complete, so nothing is left between; if it were, nothing would be known there.
fn put(all: &mut Vec<CertificateStanding>, index: u32, standing: CertificateStanding) {
    all.resize(all.len().max(index as usize + 1), CertificateStanding::bare(Verdict::Unknown(UnknownReason::Geometry)));
    if let Some(slot) = all.get_mut(index as usize) {
        *slot = standing;
    }
}

impl Peer {
    /// The reference of a set, with the stored certificates of both. `vehicle` is the reference.
    ///
    /// # Errors
    /// The reference's turns are not certified, the file cannot be read, or the certificate's model does not cover the reference.
    pub fn stored(
        database: &mut Database,
        set: &CertifiedSet,
        reference: &Reference,
        vehicle: &Vehicle,
    ) -> Result<Self, NoDriver> {
        reference.check_turns(database)?;
        let own = Standings::stored(database, &set.vehicle_id, set.policy)?;
        let other = Standings::stored(database, reference.id(), set.policy)?;
        Ok(Self { model: Model::new(vehicle)?, same: reference.same(), own, other })
    }
}
