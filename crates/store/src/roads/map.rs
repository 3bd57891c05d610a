//! Reads the edges and turns within a box for a map, through the spatial index, with only the columns that are drawn.
//!
//! Rows come in order of the network. `query` reads rows with all columns.

use futures_util::{StreamExt as _, TryStreamExt as _};
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Row as _};

use crate::network::EdgeNo;
use crate::osm::facts::{Policy, RoadClass};
use crate::words::Named;
use netcert_rows::{Bounds, MapEdge, MapNumbers, MapTurn, RscBin, SetKey};

use crate::columns::names::{corridor_no, width_columns};
use crate::columns::read::{centimetres, line, verdict, word, word_or_none};
use crate::columns::uses;
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::roads::key::{edge_key, road_name, turn_key};

type Sql<T> = Result<T, sqlx::Error>;

/// The turns to read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TurnsOf {
    /// The turns out of edges that touch the box.
    Box(Bounds),
    /// The turns out of this edge or into it.
    Edge(EdgeNo),
}

impl Database {
    /// The box around all edges; `None` if there are none.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn extent(&mut self) -> Result<Option<Bounds>, StoreError> {
        self.layer_extent("edge")
    }

    /// The box around a layer: `edge`, `turn` or `junction`; `None` if there is no such layer or it is empty.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn layer_extent(&mut self, layer: &str) -> Result<Option<Bounds>, StoreError> {
        let sql = "SELECT min_x, min_y, max_x, max_y FROM gpkg_contents WHERE table_name = ?";
        let row = self
            .session
            .run(async |c| sqlx::query(sql).bind(layer).fetch_optional(c).await?.as_ref().map(sides).transpose())?;
        Ok(row.flatten())
    }

    /// A box without the outermost fiftieth of the edges on each side, in which a map can begin. Extracts often have some
    /// roads that lead far out of their area. `None` if there are no edges.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn focus(&mut self) -> Result<Option<Bounds>, StoreError> {
        let side = |column: &str, order: &str| {
            format!(
                "(SELECT {column} FROM rtree_edge_geom ORDER BY {column} {order} LIMIT 1 \
                 OFFSET (SELECT count(*) / 50 FROM edge))"
            )
        };
        let all = [side("minx", ""), side("miny", ""), side("maxx", "DESC"), side("maxy", "DESC")];
        let sql = format!("SELECT {}", all.join(", "));
        let row = self.session.run(async |c| sides(&sqlx::query(AssertSqlSafe(sql)).fetch_one(c).await?))?;
        Ok(row.filter(|b| b.west < b.east && b.south < b.north))
    }

    /// The number of edges.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edges(&mut self) -> Result<u32, StoreError> {
        // Edges are numbered from 1 on.
        let sql = "SELECT coalesce(max(fid), 0) FROM edge";
        self.session.run(async |c| sqlx::query_scalar(sql).fetch_one(c).await)
    }

    /// Whether traffic keeps left on most ways.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn left_hand_traffic(&mut self) -> Result<bool, StoreError> {
        let sql = "SELECT 2 * total(left_hand_traffic) > count(*) FROM road";
        self.session.run(async |c| sqlx::query(sql).fetch_one(c).await?.try_get(0))
    }

    /// The edges of these classes (with their links) whose own box touches a box, with a vehicle's certificates.
    ///
    /// # Errors
    /// The file cannot be read. A vehicle that is not certified under this policy has no rows.
    pub fn map_edges(
        &mut self,
        set: SetKey<'_>,
        bounds: Bounds,
        classes: &[RoadClass],
    ) -> Result<Vec<MapEdge<'static>>, StoreError> {
        let ([width, source], shared) = (width_columns(set.policy), shared_column(set.policy));
        let mut sql = format!(
            "SELECT e.fid, e.length_m, e.{width}, e.{source}, c.verdict_no, c.rsc_mm, c.need_cm, {shared}, {uses}, e.edge_id, \
             e.way_id, e.from_node, e.to_node, e.direction, e.oneway, e.highway, e.name, e.ref, e.geom FROM rtree_edge_geom AS t \
             CROSS JOIN edge AS e ON e.fid = t.id \
             CROSS JOIN certificate_compact AS c \
             ON c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) \
             AND c.corridor_no = ? AND c.fid = t.id \
             WHERE t.maxx >= ? AND t.minx <= ? AND t.maxy >= ? AND t.miny <= ?",
            uses = uses::number(uses::EDGES)
        );
        if classes.len() < RoadClass::ALL.len() {
            let words: Vec<String> = classes.iter().map(|class| format!("'{0}','{0}_link'", class.name())).collect();
            sql += &format!(" AND e.highway IN ({})", words.join(","));
        }
        let Bounds { west, south, east, north } = bounds;
        let mut rows: Vec<MapEdge<'static>> = self.session.run(async |c| {
            let query = sqlx::query(AssertSqlSafe(sql)).bind(set.vehicle).bind(corridor_no(set.policy));
            query.bind(west).bind(east).bind(south).bind(north).fetch_all(c).await?.iter().map(map_edge).collect()
        })?;
        // The index has boxes in single precision, and finds some edges that only come near.
        rows.retain(|row| Bounds::around(row.line.iter().copied()).is_some_and(|own| own.touches(bounds)));
        rows.sort_unstable_by_key(|row| row.edge.index);
        Ok(rows)
    }

    /// The numbers of every edge with a vehicle's certificates, by index into `Network::edges`.
    ///
    /// # Errors
    /// The file cannot be read, or an edge before the last certified one has no certificate. A vehicle that is not certified under this
    /// policy has no numbers.
    pub fn map_numbers(&mut self, set: SetKey<'_>) -> Result<Vec<MapNumbers>, StoreError> {
        let ([width, source], shared) = (width_columns(set.policy), shared_column(set.policy));
        let sql = format!(
            "SELECT e.fid, e.length_m, e.{width}, e.{source}, c.verdict_no, c.rsc_mm, c.need_cm, {shared}, {uses} \
             FROM edge AS e \
             CROSS JOIN certificate_compact AS c \
             ON c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) \
             AND c.corridor_no = ? AND c.fid = e.fid ORDER BY e.fid",
            uses = uses::number(uses::EDGES)
        );
        self.session.run(async |c| {
            let query = sqlx::query(AssertSqlSafe(sql)).bind(set.vehicle).bind(corridor_no(set.policy));
            let mut expected = 0_u32;
            let read = |row: Sql<SqliteRow>| {
                let row = row?;
                expected += 1;
                // The index of a row is that of its edge.
                if row.try_get::<u32, _>(0)? != expected {
                    return Err(content(format!("edge {expected} of the network has no certificate")));
                }
                map_numbers(&row)
            };
            query.fetch(c).map(read).try_collect().await
        })
    }

    /// Turns with a vehicle's certificates.
    ///
    /// # Errors
    /// The file cannot be read. A vehicle whose turns are not certified under this policy has no rows.
    pub fn map_turns(&mut self, set: SetKey<'_>, of: TurnsOf) -> Result<Vec<MapTurn>, StoreError> {
        self.session.run(async |c| turns(c, set, of).await)
    }

    /// A histogram of length over RSC in bins of `width_mm`, for every vehicle under a policy. Edges without an RSC are left
    /// out.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn rsc_bins(&mut self, policy: Policy, width_mm: u32) -> Result<Vec<RscBin>, StoreError> {
        // Integer division rounds towards zero. Negative values are rounded down explicitly, so that no bin is too high.
        let sql = "SELECT vehicle_id, bin, verdict_no, edges, length_m FROM ( \
                   SELECT c.vehicle_no, c.verdict_no, count(*) AS edges, total(e.length_m) AS length_m, \
                   CASE WHEN c.rsc_mm >= 0 THEN c.rsc_mm / ?1 ELSE -((?1 - 1 - c.rsc_mm) / ?1) END AS bin \
                   FROM certificate_compact AS c CROSS JOIN edge AS e ON e.fid = c.fid \
                   WHERE c.corridor_no = ?2 AND c.rsc_mm NOT NULL GROUP BY c.vehicle_no, bin, c.verdict_no) \
                   JOIN vehicle USING (vehicle_no) ORDER BY vehicle_no, bin, verdict_no";
        let width = i64::from(width_mm.max(1));
        let bin = |row: &SqliteRow| -> Sql<RscBin> {
            Ok(RscBin {
                vehicle_id: row.try_get(0)?,
                policy,
                from_mm: row.try_get::<i64, _>(1)?.saturating_mul(width),
                verdict: verdict(row, 2, || "a bin".to_owned())?,
                edges: row.try_get::<i64, _>(3)?.unsigned_abs(),
                length_m: row.try_get(4)?,
            })
        };
        self.session.run(async |c| {
            let rows = sqlx::query(sql).bind(width).bind(corridor_no(policy)).fetch_all(c).await?;
            rows.iter().map(bin).collect()
        })
    }
}

/// The box of the columns west, south, east, north. `None` if one of them is null.
fn sides(row: &SqliteRow) -> Sql<Option<Bounds>> {
    let side = |column: usize| row.try_get::<Option<f64>, _>(column);
    let (Some(west), Some(south), Some(east), Some(north)) = (side(0)?, side(1)?, side(2)?, side(3)?) else {
        return Ok(None);
    };
    Ok(Some(Bounds { west, south, east, north }))
}

fn map_edge(row: &SqliteRow) -> Sql<MapEdge<'static>> {
    let fid: u32 = row.try_get(0)?;
    Ok(MapEdge {
        numbers: map_numbers(row)?,
        edge: edge_key(row, 9)?,
        oneway: word(row, 14)?,
        road: road_name(row, 15)?.into(),
        line: line(row, 18, || format!("edge {fid}"))?,
    })
}

/// The column that says whether both directions share the strip of that policy beyond what its name says.
fn shared_column(policy: Policy) -> &'static str {
    if policy == Policy::Lane { "e.lane_shared" } else { "0" }
}

/// The numbers of a row that begins with its `fid`.
fn map_numbers(row: &SqliteRow) -> Sql<MapNumbers> {
    Ok(MapNumbers {
        length_m: row.try_get(1)?,
        width_m: row.try_get(2)?,
        width_source: word_or_none(row, 3)?,
        verdict: verdict(row, 4, || {
            row.try_get::<i64, _>(0).map_or_else(|_| "an edge".to_owned(), |fid| format!("edge {fid}"))
        })?,
        rsc_mm: row.try_get(5)?,
        need_width_m: centimetres(row, 6)?,
        shared: row.try_get(7)?,
        uses: uses::read(row, 8)?,
    })
}

async fn turns(c: &mut SqliteConnection, set: SetKey<'_>, of: TurnsOf) -> Sql<Vec<MapTurn>> {
    let which = match of {
        TurnsOf::Box(_) => {
            "t.from_fid IN (SELECT id FROM rtree_edge_geom WHERE maxx >= ? AND minx <= ? AND maxy >= ? AND miny <= ?)"
        }
        TurnsOf::Edge(_) => "(t.from_fid = ? OR t.to_fid = ?)",
    };
    let sql = format!(
        "SELECT t.fid, t.turn_id, a.edge_id, b.edge_id, coalesce(a.name, a.ref), coalesce(b.name, b.ref), t.kind, \
         t.angle_deg, t.kerb_radius_m, t.restriction, c.verdict_no, c.rsc_mm, t.geom, {uses} FROM turn AS t \
         CROSS JOIN turn_certificate_compact AS c \
         ON c.vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) \
         AND c.corridor_no = ? AND c.fid = t.fid \
         CROSS JOIN edge AS a ON a.fid = t.from_fid CROSS JOIN edge AS b ON b.fid = t.to_fid WHERE {which}",
        uses = uses::number(uses::TURNS)
    );
    let query = sqlx::query(AssertSqlSafe(sql)).bind(set.vehicle).bind(corridor_no(set.policy));
    let query = match of {
        TurnsOf::Box(Bounds { west, south, east, north }) => query.bind(west).bind(east).bind(south).bind(north),
        TurnsOf::Edge(edge) => query.bind(i64::from(edge) + 1).bind(i64::from(edge) + 1),
    };
    let mut rows = query.fetch_all(c).await?.iter().map(map_turn).collect::<Sql<Vec<_>>>()?;
    rows.sort_unstable_by_key(|row| row.turn.index);
    Ok(rows)
}

fn map_turn(row: &SqliteRow) -> Sql<MapTurn> {
    let fid: u32 = row.try_get(0)?;
    Ok(MapTurn {
        turn: turn_key(row, 4)?,
        kind: row.try_get(6)?,
        angle_deg: row.try_get(7)?,
        kerb_radius_m: row.try_get(8)?,
        restriction: row.try_get(9)?,
        verdict: verdict(row, 10, || format!("turn {fid}"))?,
        rsc_mm: row.try_get(11)?,
        uses: uses::read(row, 13)?,
        line: line(row, 12, || format!("turn {fid}"))?,
    })
}
