//! The narrowest strip on which a vehicle is certified, of the policies under which the database has the vehicle.
//!
//! It is not stored: a set that is made later may be narrower. A row of any set says the same.

use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Row as _};

use crate::osm::facts::Policy;
use crate::words::Named as _;
use netcert_rows::{StripCount, TurnStripCount};

use crate::columns::names::{SAFE, corridor_no};
use crate::error::content;

type Sql<T> = Result<T, sqlx::Error>;

/// The table of certificates of edges.
pub(crate) const EDGES: &str = "certificate_compact";
/// The table of certificates of turns.
pub(crate) const TURNS: &str = "turn_certificate_compact";

/// The number of that strip's policy, for a row called `c` of this table. Null if there is none. Each policy is one search in the table's key.
pub(crate) fn number(table: &str) -> String {
    let search = |&policy: &Policy| {
        format!(
            "(SELECT u.corridor_no FROM {table} AS u WHERE u.vehicle_no = c.vehicle_no AND u.corridor_no = {} \
             AND u.fid = c.fid AND u.verdict_no = {SAFE})",
            corridor_no(policy)
        )
    };
    let searches: Vec<String> = Policy::ALL.iter().map(search).collect();
    format!("coalesce({})", searches.join(", "))
}

/// The name of that strip's policy, for a row called `c` of this table.
pub(crate) fn word(table: &str) -> String {
    format!("(SELECT corridor FROM corridor WHERE corridor_no = {})", number(table))
}

/// The condition that a row called `c` of this table has that strip.
pub(crate) fn is(table: &str, policy: Policy) -> String {
    format!("{} = {}", number(table), corridor_no(policy))
}

/// Reads a column with [`number`].
pub(crate) fn read(row: &SqliteRow, column: usize) -> Sql<Option<Policy>> {
    let Some(number) = row.try_get::<Option<i64>, _>(column)? else { return Ok(None) };
    let policy = Policy::ALL.iter().find(|&&policy| i64::from(corridor_no(policy)) == number);
    policy.copied().map(Some).ok_or_else(|| content(format!("corridor {number}")))
}

/// Counts edges by vehicle, class and that strip. `brief` has the classes and lengths of edges by `fid`.
pub(crate) async fn edges(c: &mut SqliteConnection, brief: &str) -> Sql<Vec<StripCount>> {
    let sql = format!(
        "SELECT vehicle_id, highway, uses, edges, length_m FROM ( \
         SELECT c.vehicle_no, b.highway, {uses} AS uses, count(*) AS edges, total(b.length_m) AS length_m \
         FROM {EDGES} AS c CROSS JOIN {brief} AS b ON b.fid = c.fid WHERE {first} \
         GROUP BY c.vehicle_no, b.highway, uses) JOIN vehicle USING (vehicle_no) \
         ORDER BY vehicle_no, highway, uses IS NULL, uses",
        uses = number(EDGES),
        first = first_set("certified_set"),
    );
    let count = |row: &SqliteRow| -> Sql<StripCount> {
        Ok(StripCount {
            vehicle_id: row.try_get(0)?,
            highway: row.try_get(1)?,
            uses: read(row, 2)?,
            edges: row.try_get::<i64, _>(3)?.unsigned_abs(),
            length_m: row.try_get(4)?,
        })
    };
    sqlx::query(AssertSqlSafe(sql)).fetch_all(c).await?.iter().map(count).collect()
}

/// Counts turns by vehicle and that strip.
pub(crate) async fn turns(c: &mut SqliteConnection) -> Sql<Vec<TurnStripCount>> {
    let sql = format!(
        "SELECT vehicle_id, uses, turns FROM (SELECT c.vehicle_no, {uses} AS uses, count(*) AS turns \
         FROM {TURNS} AS c WHERE {first} GROUP BY c.vehicle_no, uses) JOIN vehicle USING (vehicle_no) \
         ORDER BY vehicle_no, uses IS NULL, uses",
        uses = number(TURNS),
        first = first_set("certified_turns"),
    );
    let count = |row: &SqliteRow| -> Sql<TurnStripCount> {
        Ok(TurnStripCount {
            vehicle_id: row.try_get(0)?,
            uses: read(row, 1)?,
            turns: row.try_get::<i64, _>(2)?.unsigned_abs(),
        })
    };
    sqlx::query(AssertSqlSafe(sql)).fetch_all(c).await?.iter().map(count).collect()
}

/// The condition that a row called `c` is of its vehicle's first set, so that each edge or turn counts once.
fn first_set(sets: &str) -> String {
    format!("c.corridor_no = (SELECT min(corridor_no) FROM {sets} AS s WHERE s.vehicle_no = c.vehicle_no)")
}
