//! Reads one edge with all columns that are of interest to people.

use sqlx::sqlite::SqliteRow;
use sqlx::{AssertSqlSafe, Row as _};

use crate::osm::facts::Policy;
use netcert_rows::EdgeFacts;

use crate::columns::read::{line, word, word_or_none};
use crate::database::Database;
use crate::database::row_stream::RowStream;
use crate::error::StoreError;
use crate::roads::key::{edge_key, road_name};

type Sql<T> = Result<T, sqlx::Error>;

/// The columns that [`facts`] reads.
const SELECT: &str = "SELECT fid, edge_id, way_id, from_node, to_node, direction, oneway, highway, name, ref, lanes, \
                      length_m, lane_width_m, width_source, direction_width_m, direction_width_source, \
                      carriageway_width_m, carriageway_width_source, min_radius_m, centreline_deviation_m, max_height_m, \
                      max_weight_t, max_axle_load_t, max_length_m, max_width_m, unreadable_limits, hgv, motor_vehicle, \
                      barred, cut, geom, maxspeed_kmh, rules, open_when, legal_tags, width_tags FROM edge";

impl Database {
    /// Every edge, in order of the network.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn all_edge_facts(&mut self) -> Result<RowStream<'_, EdgeFacts>, StoreError> {
        Ok(self.streamed_plainly(format!("{SELECT} ORDER BY fid"), facts))
    }

    /// The edge with this `edge_id`, or `None`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edge_facts(&mut self, edge_id: i64) -> Result<Option<EdgeFacts>, StoreError> {
        let sql = format!("{SELECT} WHERE edge_id = ?");
        self.session.run(async |c| {
            let row = sqlx::query(AssertSqlSafe(sql)).bind(edge_id).fetch_optional(c).await?;
            row.as_ref().map(facts).transpose()
        })
    }
}

fn facts(row: &SqliteRow) -> Sql<EdgeFacts> {
    let fid: u32 = row.try_get(0)?;
    let width = |policy, column| -> Sql<_> { Ok((policy, row.try_get(column)?, word_or_none(row, column + 1)?)) };
    let limit = |name, unit, column: usize| -> Sql<_> { Ok((name, unit, row.try_get(column)?)) };
    let unreadable: Option<&str> = row.try_get(25)?;
    Ok(EdgeFacts {
        edge: edge_key(row, 1)?,
        oneway: word(row, 6)?,
        road: road_name(row, 7)?,
        lanes: row.try_get(10)?,
        maxspeed_kmh: row.try_get(31)?,
        length_m: row.try_get(11)?,
        widths: [width(Policy::Lane, 12)?, width(Policy::Direction, 14)?, width(Policy::Carriageway, 16)?],
        min_radius_m: row.try_get(18)?,
        centreline_deviation_m: row.try_get(19)?,
        limits: [
            limit("height", "m", 20)?,
            limit("weight", "t", 21)?,
            limit("axle_load", "t", 22)?,
            limit("length", "m", 23)?,
            limit("width", "m", 24)?,
        ],
        unreadable_limits: unreadable.into_iter().flat_map(|names| names.split(',')).map(str::to_owned).collect(),
        hgv: word(row, 26)?,
        motor_vehicle: word(row, 27)?,
        barred: row.try_get(28)?,
        cut: row.try_get(29)?,
        rules: row.try_get(32)?,
        open_when: row.try_get(33)?,
        legal_tags: row.try_get(34)?,
        width_tags: row.try_get(35)?,
        line: line(row, 30, || format!("edge {fid}"))?,
    })
}
