//! The narrowest strip on which a vehicle is certified, of the policies under which the database has the vehicle.
//!
//! It is not stored: a set that is made later may be narrower. A row of any set says the same.

use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use crate::osm::facts::Policy;
use crate::words::Named as _;

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
