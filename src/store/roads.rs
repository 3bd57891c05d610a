//! Reads ways with their names and boxes, for the search of roads by name.

use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use crate::rows::{Bounds, RoadRow};

use super::database::Database;
use super::error::StoreError;

type Sql<T> = Result<T, sqlx::Error>;

impl Database {
    /// Every way, in order of the network.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn roads(&mut self) -> Result<Vec<RoadRow>, StoreError> {
        let sql = "SELECT e.way_id, e.highway, e.name, e.ref, e.edge_id, b.* FROM ( \
                   SELECT min(w.fid) AS first, min(t.minx), min(t.miny), max(t.maxx), max(t.maxy) \
                   FROM edge AS w CROSS JOIN rtree_edge_geom AS t ON t.id = w.fid GROUP BY w.road_no) AS b \
                   CROSS JOIN edge AS e ON e.fid = b.first ORDER BY b.first";
        self.session.run(async |c| sqlx::query(sql).fetch_all(c).await?.iter().map(road).collect())
    }
}

fn road(row: &SqliteRow) -> Sql<RoadRow> {
    Ok(RoadRow {
        way_id: row.try_get(0)?,
        highway: row.try_get(1)?,
        name: row.try_get(2)?,
        reference: row.try_get(3)?,
        edge_id: row.try_get(4)?,
        bounds: Bounds { west: row.try_get(6)?, south: row.try_get(7)?, east: row.try_get(8)?, north: row.try_get(9)? },
    })
}
