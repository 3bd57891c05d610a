//! Reads the measurements behind an edge or a turn: rows of the register that count there.

use sqlx::{AssertSqlSafe, Row as _};

use super::database::Database;
use super::error::StoreError;

/// A measurement that counts at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Its number in the register.
    pub evidence_no: i64,
    /// What was measured, such as `lane_width`.
    pub quantity: String,
    /// What was measured: metres, or tonnes of masses. `None` for surfaces.
    pub value: Option<f64>,
    /// What of it counts, in the same unit.
    pub lower: Option<f64>,
    /// Who measured it.
    pub source: String,
    /// The day.
    pub date: Option<String>,
    /// Name of the file that it came from.
    pub file: String,
    /// Its row there.
    pub file_row: i64,
}

/// A corner of a junction: its node, and the edges before and after the turn (`edge_id`).
pub type MeasuredCorner = (i64, [i64; 2]);

impl Database {
    /// The measurements that count on some edges (`edge_id`), and at the corner of a turn if one is given, in order of their numbers.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn measured(&mut self, edges: &[i64], corner: Option<MeasuredCorner>) -> Result<Vec<Measured>, StoreError> {
        let edges: Vec<String> = edges.iter().map(i64::to_string).collect();
        let at_corner = corner.map_or(String::new(), |(node, [from, to])| {
            format!(" OR p.node = {node} AND (p.from_edge IS NULL OR p.from_edge = {from} AND p.to_edge = {to})")
        });
        // Only numbers are put into the text.
        let sql = format!(
            "SELECT evidence_no, quantity, value, lower, source, date, file, file_row FROM evidence WHERE evidence_no IN \
             (SELECT p.evidence_no FROM evidence_place AS p WHERE p.counts AND (p.edge_id IN ({}){at_corner})) \
             ORDER BY evidence_no",
            edges.join(", ")
        );
        self.session.run(async |c| {
            let rows = sqlx::query(AssertSqlSafe(sql)).fetch_all(c).await?;
            let read = |row: &sqlx::sqlite::SqliteRow| {
                Ok(Measured {
                    evidence_no: row.try_get(0)?,
                    quantity: row.try_get(1)?,
                    value: row.try_get(2)?,
                    lower: row.try_get(3)?,
                    source: row.try_get(4)?,
                    date: row.try_get(5)?,
                    file: row.try_get(6)?,
                    file_row: row.try_get(7)?,
                })
            };
            rows.iter().map(read).collect()
        })
    }
}
