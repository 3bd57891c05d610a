//! Reads which edge or turn a row is about.

use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use netcert_rows::{EdgeKey, RoadName, TurnKey};

use crate::columns::read::{edge_of, turn_of, word};
use crate::osm::NodeId;

type Sql<T> = Result<T, sqlx::Error>;

/// An edge from `fid` in column 0, and `edge_id`, `way_id`, `from_node`, `to_node`, `direction` from the column `at` on.
pub(crate) fn edge_key(row: &SqliteRow, at: usize) -> Sql<EdgeKey> {
    Ok(EdgeKey {
        index: edge_of(row.try_get(0)?),
        id: row.try_get(at)?,
        way_id: row.try_get(at + 1)?,
        from_node: NodeId::new(row.try_get(at + 2)?),
        to_node: NodeId::new(row.try_get(at + 3)?),
        direction: word(row, at + 4)?,
    })
}

/// A road from `highway`, `name` and `ref` from the column `at` on.
pub(crate) fn road_name(row: &SqliteRow, at: usize) -> Sql<RoadName> {
    Ok(RoadName { highway: row.try_get(at)?, name: row.try_get(at + 1)?, reference: row.try_get(at + 2)? })
}

/// A turn from `fid`, `turn_id` and the ids of both edges in columns 0 to 3, and the names of both roads from the column `names` on.
pub(crate) fn turn_key(row: &SqliteRow, names: usize) -> Sql<TurnKey> {
    Ok(TurnKey {
        index: turn_of(row.try_get(0)?),
        id: row.try_get(1)?,
        from_edge: row.try_get(2)?,
        to_edge: row.try_get(3)?,
        from_name: row.try_get(names)?,
        to_name: row.try_get(names + 1)?,
    })
}
