//! Reads where the register knows vehicles to go: its rows `drivable_by`.
//!
//! A row of a road counts for the edges that it was matched to. A row of a junction counts for the turn of its corner. A junction
//! without a corner says nothing of any turn, because nobody knows which one was driven.

use std::collections::BTreeMap;

use crate::database::Database;
use crate::error::StoreError;

/// Where one vehicle is known to go: sorted indices into the network's edges and turns.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct KnownVehicle {
    pub(crate) edges: Vec<u32>,
    pub(crate) turns: Vec<u32>,
}

impl Database {
    /// The vehicles that the register knows to go somewhere, by id.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(crate) fn register_vehicles(&mut self) -> Result<BTreeMap<String, KnownVehicle>, StoreError> {
        let places = |table: &str| {
            format!(
                "SELECT DISTINCT v.vehicle, t.fid - 1 FROM evidence AS v JOIN evidence_place AS p USING (evidence_no) \
                 JOIN {table} WHERE v.quantity = 'drivable_by' AND v.state = 'matched' AND v.vehicle NOT NULL \
                 ORDER BY v.vehicle, t.fid"
            )
        };
        let edges = places("edge AS t ON t.edge_id = p.edge_id");
        let turns = places(
            "edge AS a ON a.edge_id = p.from_edge JOIN edge AS b ON b.edge_id = p.to_edge \
             JOIN turn AS t ON t.from_fid = a.fid AND t.to_fid = b.fid",
        );
        self.session.run(async |c| {
            let mut known: BTreeMap<String, KnownVehicle> = BTreeMap::new();
            for (vehicle, edge) in
                sqlx::query_as::<_, (String, u32)>(sqlx::AssertSqlSafe(edges)).fetch_all(&mut *c).await?
            {
                known.entry(vehicle).or_default().edges.push(edge);
            }
            for (vehicle, turn) in sqlx::query_as::<_, (String, u32)>(sqlx::AssertSqlSafe(turns)).fetch_all(c).await? {
                known.entry(vehicle).or_default().turns.push(turn);
            }
            Ok(known)
        })
    }
}
