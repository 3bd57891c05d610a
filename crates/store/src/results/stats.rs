//! Counts the length of roads, and the length that each vehicle may use, by class and verdict.

use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, Row as _};

use crate::osm::facts::Policy;
use crate::verdict::{UnsafeReason, Verdict};
use crate::words::Named;
use netcert_rows::{NeedCount, Stats, StatsRow, StripCount, TurnStripCount};

use crate::columns::names::verdict_no;
use crate::columns::read::{verdict, word, word_or_none};
use crate::columns::uses;
use crate::database::Database;
use crate::error::StoreError;
use crate::results::turns;

type Sql<T> = Result<T, sqlx::Error>;

impl Database {
    /// The statistics of the whole database.
    pub fn stats(&mut self) -> Result<Stats, StoreError> {
        self.session.run(async |c| {
            let roads: i64 = sqlx::query_scalar("SELECT count(*) FROM road").fetch_one(&mut *c).await?;
            // A copy of `edge` without geometries, which is fast to join with each vehicle's certificates in order.
            sqlx::raw_sql(
                "CREATE TEMP TABLE IF NOT EXISTS brief (fid INTEGER PRIMARY KEY, highway TEXT, length_m REAL, \
                 lane TEXT, direction TEXT, carriageway TEXT, width_0 REAL, width_1 REAL, width_2 REAL);
                 DELETE FROM temp.brief;
                 INSERT INTO temp.brief SELECT fid, highway, length_m, width_source, direction_width_source, \
                 carriageway_width_source, lane_width_m, direction_width_m, carriageway_width_m FROM edge ORDER BY fid;",
            )
            .execute(&mut *c)
            .await?;
            let network = "SELECT highway, count(*), total(length_m) FROM temp.brief GROUP BY highway ORDER BY highway";
            let network: Vec<(String, i64, f64)> = sqlx::query_as(network).fetch_all(&mut *c).await?;
            let mut widths = Vec::new();
            for &policy in Policy::ALL {
                let source = policy.name(); // a column of `brief`
                let sql = format!("SELECT {source}, count(*), total(length_m) FROM temp.brief GROUP BY {source}");
                for row in sqlx::query(AssertSqlSafe(sql)).fetch_all(&mut *c).await? {
                    let edges = row.try_get::<i64, _>(1)?.unsigned_abs();
                    widths.push((policy, word_or_none(&row, 0)?, edges, row.try_get(2)?));
                }
            }
            let rows = "SELECT vehicle_id, corridor, highway, verdict_no, edges, length_m FROM ( \
                        SELECT c.vehicle_no, c.corridor_no, b.highway, c.verdict_no, count(*) AS edges, \
                        total(b.length_m) AS length_m FROM certificate_compact AS c CROSS JOIN temp.brief AS b \
                        ON b.fid = c.fid GROUP BY c.vehicle_no, c.corridor_no, b.highway, c.verdict_no) \
                        JOIN vehicle USING (vehicle_no) JOIN corridor USING (corridor_no) \
                        ORDER BY vehicle_no, corridor_no, highway, verdict_no";
            let rows = sqlx::query(rows).fetch_all(&mut *c).await?;
            let needs = needs(c).await?;
            let strips = edge_strips(c, "temp.brief").await?;
            sqlx::raw_sql("DROP TABLE temp.brief").execute(&mut *c).await?;
            let turns = turns::counts(c).await?;
            let turn_strips = turn_strips(c).await?;
            let network = network.into_iter().map(|(class, edges, m)| (class, edges.unsigned_abs(), m)).collect();
            let certificates = rows.iter().map(stats_row).collect::<Sql<_>>()?;
            let roads = roads.unsigned_abs();
            Ok(Stats { roads, network, widths, certificates, turns, needs, strips, turn_strips })
        })
    }
}

fn stats_row(row: &sqlx::sqlite::SqliteRow) -> Sql<StatsRow> {
    Ok(StatsRow {
        vehicle_id: row.try_get(0)?,
        policy: word(row, 1)?,
        highway: row.try_get(2)?,
        verdict: verdict(row, 3, || "a count".to_owned())?,
        edges: row.try_get::<i64, _>(4)?.unsigned_abs(),
        length_m: row.try_get(5)?,
    })
}

/// Counts edges that are `unsafe: width` by how much more width would do.
async fn needs(c: &mut SqliteConnection) -> Sql<Vec<NeedCount>> {
    let steps: String = NeedCount::STEPS_M.iter().map(|m| format!("WHEN more_m <= {m:?} THEN {m:?} ")).collect();
    let last = NeedCount::STEPS_M[NeedCount::STEPS_M.len() - 1];
    // A need below the edge's own width means that a narrower neighbour decides.
    let sql = format!(
        "SELECT vehicle_id, corridor, step_m, edges, length_m FROM ( \
         SELECT vehicle_no, corridor_no, CASE WHEN more_m IS NULL THEN NULL {steps} ELSE {last:?} END AS step_m, \
         count(*) AS edges, total(length_m) AS length_m FROM ( \
         SELECT c.vehicle_no, c.corridor_no, b.length_m, round(c.need_cm / 100.0 - CASE c.corridor_no \
         WHEN 0 THEN b.width_0 WHEN 1 THEN b.width_1 ELSE b.width_2 END, 4) AS more_m \
         FROM certificate_compact AS c CROSS JOIN temp.brief AS b ON b.fid = c.fid WHERE c.verdict_no = ?) \
         GROUP BY vehicle_no, corridor_no, step_m) \
         JOIN vehicle USING (vehicle_no) JOIN corridor USING (corridor_no) \
         ORDER BY vehicle_no, corridor_no, step_m IS NULL, step_m"
    );
    let width_no = verdict_no(Verdict::Unsafe(UnsafeReason::Width));
    let rows = sqlx::query(AssertSqlSafe(sql)).bind(width_no).fetch_all(c).await?;
    let count = |row: &sqlx::sqlite::SqliteRow| -> Sql<NeedCount> {
        Ok(NeedCount {
            vehicle_id: row.try_get(0)?,
            policy: word(row, 1)?,
            more_m: row.try_get(2)?,
            edges: row.try_get::<i64, _>(3)?.unsigned_abs(),
            length_m: row.try_get(4)?,
        })
    };
    rows.iter().map(count).collect()
}

/// Counts edges by vehicle, class and that strip. `brief` has the classes and lengths of edges by `fid`.
async fn edge_strips(c: &mut SqliteConnection, brief: &str) -> Sql<Vec<StripCount>> {
    let sql = format!(
        "SELECT vehicle_id, highway, uses, edges, length_m FROM ( \
         SELECT c.vehicle_no, b.highway, {uses} AS uses, count(*) AS edges, total(b.length_m) AS length_m \
         FROM {edges} AS c CROSS JOIN {brief} AS b ON b.fid = c.fid WHERE {first} \
         GROUP BY c.vehicle_no, b.highway, uses) JOIN vehicle USING (vehicle_no) \
         ORDER BY vehicle_no, highway, uses IS NULL, uses",
        edges = uses::EDGES,
        uses = uses::number(uses::EDGES),
        first = first_set("certified_set"),
    );
    let count = |row: &SqliteRow| -> Sql<StripCount> {
        Ok(StripCount {
            vehicle_id: row.try_get(0)?,
            highway: row.try_get(1)?,
            uses: uses::read(row, 2)?,
            edges: row.try_get::<i64, _>(3)?.unsigned_abs(),
            length_m: row.try_get(4)?,
        })
    };
    sqlx::query(AssertSqlSafe(sql)).fetch_all(c).await?.iter().map(count).collect()
}

/// Counts turns by vehicle and that strip.
async fn turn_strips(c: &mut SqliteConnection) -> Sql<Vec<TurnStripCount>> {
    let sql = format!(
        "SELECT vehicle_id, uses, turns FROM (SELECT c.vehicle_no, {uses} AS uses, count(*) AS turns \
         FROM {turns} AS c WHERE {first} GROUP BY c.vehicle_no, uses) JOIN vehicle USING (vehicle_no) \
         ORDER BY vehicle_no, uses IS NULL, uses",
        turns = uses::TURNS,
        uses = uses::number(uses::TURNS),
        first = first_set("certified_turns"),
    );
    let count = |row: &SqliteRow| -> Sql<TurnStripCount> {
        Ok(TurnStripCount {
            vehicle_id: row.try_get(0)?,
            uses: uses::read(row, 1)?,
            turns: row.try_get::<i64, _>(2)?.unsigned_abs(),
        })
    };
    sqlx::query(AssertSqlSafe(sql)).fetch_all(c).await?.iter().map(count).collect()
}

/// The condition that a row called `c` is of its vehicle's first set, so that each edge or turn counts once.
fn first_set(sets: &str) -> String {
    format!("c.corridor_no = (SELECT min(corridor_no) FROM {sets} AS s WHERE s.vehicle_no = c.vehicle_no)")
}
