//! Reads the verdicts of a whole set, without their numbers.

use sqlx::AssertSqlSafe;

use crate::osm::facts::Policy;
use crate::verdict::Verdict;

use crate::columns::names::{corridor_no, verdict_of};
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::results::carry_over::PAGE_ROWS;

impl Database {
    /// The verdicts of a set, by edge.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edge_verdicts(&mut self, vehicle: &str, policy: Policy) -> Result<Vec<Verdict>, StoreError> {
        self.verdicts("certificate_compact", vehicle, policy)
    }

    /// The verdicts of a vehicle's turns, by turn. Empty if its turns are not certified.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn turn_verdicts(&mut self, vehicle: &str, policy: Policy) -> Result<Vec<Verdict>, StoreError> {
        self.verdicts("turn_certificate_compact", vehicle, policy)
    }

    fn verdicts(&mut self, table: &'static str, vehicle: &str, policy: Policy) -> Result<Vec<Verdict>, StoreError> {
        // A thousand rows come as one text: each row that sqlx hands over by itself costs a microsecond or more.
        let pages: Vec<(i64, String)> = self.session.run(async |c| {
            let sql = format!(
                "SELECT max(fid), json_group_array(verdict_no ORDER BY fid) FROM {table} WHERE corridor_no = ? \
                 AND vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) \
                 GROUP BY fid / {PAGE_ROWS} ORDER BY fid / {PAGE_ROWS}"
            );
            sqlx::query_as(AssertSqlSafe(sql)).bind(corridor_no(policy)).bind(vehicle).fetch_all(c).await
        })?;
        let mut verdicts = Vec::with_capacity(pages.len() * PAGE_ROWS);
        let damaged = |row: usize| StoreError::sql(&self.session.path, content(format!("row {row} of {table}")));
        for (last, page) in &pages {
            let first = verdicts.len() + 1;
            let numbers: Vec<i64> = serde_json::from_str(page).map_err(|_| damaged(first))?;
            for (row, &number) in (first..).zip(&numbers) {
                verdicts.push(verdict_of(number).ok_or_else(|| damaged(row))?);
            }
            // Rows have distinct numbers, so none is missing if the last one has the number of all.
            if *last != verdicts.len() as i64 {
                return Err(damaged(first));
            }
        }
        Ok(verdicts)
    }
}
