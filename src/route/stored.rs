//! Permits as a database keeps them.

use rustc_hash::FxHashMap;

use super::permits::{Permit, Permits};
use crate::network::{Movements, Network};
use crate::store::{CertifiedSet, Database, QueryOptions, StoreError, TurnQuery};

impl Permits {
    /// The permits of a set, for the edges and turns of the database that `network` is from.
    ///
    /// # Errors
    /// Its turns are not certified, or its settings cannot be read.
    pub fn stored(
        database: &mut Database,
        network: &Network,
        movements: &Movements,
        set: &CertifiedSet,
    ) -> Result<Self, StoreError> {
        let settings = set.settings()?;
        let (vehicle, policy) = (&set.vehicle_id, set.policy);
        let mut edges = vec![Permit::UNKNOWN; network.edges.len()];
        for row in database.query(&QueryOptions::new(vehicle, policy))? {
            let row = row?;
            if let Some(slot) = edges.get_mut(row.edge as usize) {
                *slot = Permit { verdict: row.certificate.verdict, rsc_m: row.certificate.rsc_m };
            }
        }
        let turns: FxHashMap<(i64, i64), Permit> = database
            .query_turns(&TurnQuery::new(vehicle, policy))?
            .into_iter()
            .map(|row| {
                (
                    (row.from_edge, row.to_edge),
                    Permit { verdict: row.certificate.verdict, rsc_m: row.certificate.rsc_m },
                )
            })
            .collect();
        let id = |edge: u32| network.edges.get(edge as usize).map_or(0, |edge| edge.id);
        let turn = |from, to| turns.get(&(id(from), id(to))).copied().unwrap_or(Permit::UNKNOWN);
        Ok(Self::new(settings, edges, movements, turn))
    }
}
