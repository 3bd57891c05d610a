//! The tables of the plans of strokes and of turns.

use std::collections::BTreeMap;
use std::io;

use sqlx::AssertSqlSafe;
use sqlx::sqlite::SqliteConnection;

use crate::osm::facts::Policy;
use netcert_rows::{StoredPlan, unpack};

use crate::columns::names::corridor_no;
use crate::columns::set_no::SetNo;
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::file::bulk::Bulk;

type Sql<T> = Result<T, sqlx::Error>;

/// The table of plans of strokes, with its columns.
pub(crate) const STROKES: &str = "plan (vehicle_no, corridor_no, fid, coefficients)";
/// The table of plans of turns, with its columns.
pub(crate) const TURNS: &str = "turn_plan (vehicle_no, corridor_no, fid, coefficients)";

/// Sorts the plans of a set by edge or turn.
pub(crate) fn sorted(plans: &mut [StoredPlan]) -> impl Iterator<Item = io::Result<StoredPlan>> {
    plans.sort_unstable_by_key(|plan| plan.at);
    plans.iter().cloned().map(Ok)
}

/// Inserts plans of a set, which are sorted by edge or turn.
pub(crate) async fn insert(
    c: &mut SqliteConnection,
    into: &'static str,
    set: SetNo,
    plans: impl Iterator<Item = io::Result<StoredPlan>>,
) -> Sql<()> {
    let mut bulk = Bulk::new(into, 4);
    for plan in plans {
        let plan = plan?;
        bulk.add(set.vehicle_no);
        bulk.add(set.corridor_no());
        bulk.add(plan.at + 1);
        bulk.add(plan.packed);
        bulk.end_row(c).await?;
    }
    bulk.finish(c).await
}

impl Database {
    /// The plans of a vehicle under a policy, by the index of each stroke's first edge. A stroke without an entry follows the
    /// centreline.
    pub fn plans(&mut self, vehicle: &str, policy: Policy) -> Result<BTreeMap<u32, Vec<i32>>, StoreError> {
        self.plans_in("plan", vehicle, policy)
    }

    /// The plans of a vehicle's turns, by the turn's index. A turn without an entry follows the centreline of its path.
    pub fn turn_plans(&mut self, vehicle: &str, policy: Policy) -> Result<BTreeMap<u32, Vec<i32>>, StoreError> {
        self.plans_in("turn_plan", vehicle, policy)
    }

    fn plans_in(
        &mut self,
        table: &'static str,
        vehicle: &str,
        policy: Policy,
    ) -> Result<BTreeMap<u32, Vec<i32>>, StoreError> {
        let path = self.session.path.clone();
        let damaged = |at: u32| StoreError::sql(&path, content(format!("row {} of {table}", at + 1)));
        let unpacked = |(at, packed): (u32, Vec<u8>)| Ok((at, unpack(&packed).ok_or_else(|| damaged(at))?));
        self.packed_plans(table, vehicle, policy)?.into_iter().map(unpacked).collect()
    }

    /// The plans of a table as they are stored, by index of the edge or turn.
    pub(crate) fn packed_plans(
        &mut self,
        table: &'static str,
        vehicle: &str,
        policy: Policy,
    ) -> Result<BTreeMap<u32, Vec<u8>>, StoreError> {
        self.session.run(async |c| {
            let sql = format!(
                "SELECT fid, coefficients FROM {table} JOIN vehicle USING (vehicle_no) \
                 WHERE vehicle_id = ? AND corridor_no = ? ORDER BY fid"
            );
            let rows: Vec<(u32, Vec<u8>)> =
                sqlx::query_as(AssertSqlSafe(sql)).bind(vehicle).bind(corridor_no(policy)).fetch_all(c).await?;
            Ok(rows.into_iter().map(|(fid, packed)| (fid.saturating_sub(1), packed)).collect())
        })
    }
}
