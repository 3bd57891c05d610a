//! Reads the measurements behind an edge or a turn: rows of the register that count there.

use sqlx::{AssertSqlSafe, Row as _};

use crate::network::{EdgeNo, Network};
use crate::osm::NodeId;
use netcert_roads::turns::TurnFacts;
use netcert_rows::Measurement;

use crate::database::Database;
use crate::error::StoreError;

impl Database {
    /// The measurements that count on an edge, in order of their numbers.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn measured_on(&mut self, network: &Network, edge: EdgeNo) -> Result<Vec<Measurement>, StoreError> {
        let ids: Vec<i64> = network.edges.get(edge.index()).map(|edge| edge.id).into_iter().collect();
        self.measured(&ids, &[])
    }

    /// The measurements that count on the edges of a turn, those between included, and at its corners, in order of their numbers.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn measured_at(&mut self, network: &Network, turn: &TurnFacts) -> Result<Vec<Measurement>, StoreError> {
        let edge = |index: EdgeNo| network.edges.get(index.index());
        let way = [turn.movement.from].into_iter().chain(turn.through.iter().copied()).chain([turn.movement.to]);
        let way: Vec<_> = way.filter_map(edge).collect();
        let corners: Vec<_> = way.array_windows().map(|[from, to]| (from.to_node, [from.id, to.id])).collect();
        self.measured(&way.iter().map(|edge| edge.id).collect::<Vec<_>>(), &corners)
    }

    /// On some edges (`edge_id`), and at corners: each a node, and the edges before and after it.
    fn measured(&mut self, edges: &[i64], corners: &[(NodeId, [i64; 2])]) -> Result<Vec<Measurement>, StoreError> {
        let edges: Vec<String> = edges.iter().map(i64::to_string).collect();
        let corner = |(node, [from, to]): &(NodeId, [i64; 2])| {
            format!(" OR p.node = {node} AND (p.from_edge IS NULL OR p.from_edge = {from} AND p.to_edge = {to})")
        };
        let at_corners: String = corners.iter().map(corner).collect();
        // Only numbers are put into the text.
        let sql = format!(
            "SELECT evidence_no, quantity, value, lower, source, date, file, file_row FROM evidence WHERE evidence_no IN \
             (SELECT p.evidence_no FROM evidence_place AS p WHERE p.counts AND (p.edge_id IN ({}){at_corners})) \
             ORDER BY evidence_no",
            edges.join(", ")
        );
        self.session.run(async |c| {
            let rows = sqlx::query(AssertSqlSafe(sql)).fetch_all(c).await?;
            let read = |row: &sqlx::sqlite::SqliteRow| {
                Ok(Measurement {
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
