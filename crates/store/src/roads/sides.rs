//! Reads the driving side of edges.

use sqlx::Row as _;

use netcert_base::corridor::Side;
use netcert_rows::DrivingSides;

use crate::columns::read::edge_of;
use crate::database::Database;
use crate::error::StoreError;

impl Database {
    /// The driving side of every edge.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn driving_sides(&mut self) -> Result<DrivingSides, StoreError> {
        let mostly_left = self.left_hand_traffic()?;
        let mixed = "SELECT min(left_hand_traffic) <> max(left_hand_traffic) FROM road";
        let others = "SELECT fid FROM edge WHERE road_no IN \
                      (SELECT road_no FROM road WHERE left_hand_traffic <> ?) ORDER BY fid";
        let others = self.session.run(async |c| {
            // Edges have no index by road, so the search is slow. A database with one driving side skips it.
            if sqlx::query(mixed).fetch_one(&mut *c).await?.try_get::<Option<bool>, _>(0)? != Some(true) {
                return Ok(Vec::new());
            }
            let rows = sqlx::query(others).bind(mostly_left).fetch_all(c).await?;
            rows.iter().map(|row| Ok(edge_of(row.try_get(0)?))).collect()
        })?;
        let usual = if mostly_left { Side::Left } else { Side::Right };
        Ok(DrivingSides::new(usual, others))
    }
}
