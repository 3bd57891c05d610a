//! Permits as a database keeps them.

use rustc_hash::FxHashMap;

use super::permits::{Permit, Permits};
use crate::network::{Movements, Network};
use crate::osm::facts::Policy;
use crate::store::{Database, QueryOptions, StoreError, TurnQuery};

impl Permits {
    /// A vehicle's permits for the edges and turns of the database that `network` is from.
    ///
    /// # Errors
    /// Its edges or its turns are not certified there under this policy.
    pub fn stored(
        database: &mut Database,
        network: &Network,
        movements: &Movements,
        vehicle: &str,
        policy: Policy,
    ) -> Result<Self, StoreError> {
        let mut edges = vec![Permit::UNKNOWN; network.edges.len()];
        for row in database.query(&QueryOptions::new(vehicle, policy))? {
            let row = row?;
            if let Some(slot) = edges.get_mut(row.edge as usize) {
                *slot = Permit { verdict: row.verdict, rsc_m: row.rsc_m };
            }
        }
        let turns: FxHashMap<(i64, i64), Permit> = database
            .query_turns(&TurnQuery::new(vehicle, policy))?
            .into_iter()
            .map(|row| ((row.from_edge, row.to_edge), Permit { verdict: row.verdict, rsc_m: row.rsc_m }))
            .collect();
        let id = |edge: u32| network.edges.get(edge as usize).map_or(0, |edge| edge.id);
        Ok(Self::new(edges, movements, |from, to| turns.get(&(id(from), id(to))).copied().unwrap_or(Permit::UNKNOWN)))
    }
}
