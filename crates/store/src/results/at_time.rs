//! The verdicts at a time. A certificate has no clock: what is closed at some time is `unknown: time` in the file. A connection that is
//! given a time sees instead what the rules say then.
//!
//! Only such rows differ, and only those whose numbers hold: an edge becomes safe or forbidden, or stays `unknown: time` where the time does
//! not decide, as on a school holiday. A turn is forbidden if one of its edges is, stays unknown if one does, and else is safe.
//!
//! Temporary views with the names of the tables hide these on the connection, so that every query sees the time. The file is not changed.

use std::collections::BTreeMap;

use jiff::civil::DateTime;
use rustc_hash::FxHashMap;
use sqlx::sqlite::SqliteConnection;
use sqlx::{AssertSqlSafe, Row as _};

use crate::columns::names::verdict_no;
use crate::columns::read::edge_of;
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::network::EdgeNo;
use crate::osm::facts::{At, Legal};
use crate::roads::network_read::{self, RuleSets};
use crate::vehicle::Vehicle;
use crate::verdict::{UnknownReason, Verdict};
use netcert_rows::Rings;

type Sql<T> = Result<T, sqlx::Error>;

/// What is closed at some times.
const TIME: Verdict = Verdict::Unknown(UnknownReason::Time);

/// The columns of both tables, and those of each. Those that are computed for other programs are left out.
const COLUMNS: &str = "vehicle_no, corridor_no, fid, rsc_mm, rsc_published_mm, hinge_margin_cdeg, shrink_milli, limiting_s_dm, \
                       limiting_at";
const TABLES: [(&str, &str); 2] =
    [("certificate_compact", "need_cm"), ("turn_certificate_compact", "need_kerb_cm, need_flare_cm, path_no")];

/// The edges with rules that depend on the time, by index, each with its country.
type Timed = FxHashMap<EdgeNo, (Legal, [u8; 2])>;

impl Database {
    /// From now on, queries of certificates give the verdicts at this time, which is local time of the place. A second call sets another time.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn set_time(&mut self, time: DateTime) -> Result<(), StoreError> {
        let rings = Rings::new(self.rings()?);
        self.session.run(async |c| set_time(c, time, &rings).await)?;
        self.time = Some(time);
        Ok(())
    }
}

async fn set_time(c: &mut SqliteConnection, time: DateTime, rings: &Rings) -> Sql<()> {
    for (table, _) in TABLES {
        let drop = format!("DROP VIEW IF EXISTS temp.{table}; DROP TABLE IF EXISTS temp.{table}_at");
        sqlx::raw_sql(AssertSqlSafe(drop)).execute(&mut *c).await?;
    }
    let timed = timed(c).await?;
    let vehicles: Vec<(u32, String)> =
        sqlx::query_as("SELECT vehicle_no, definition FROM vehicle ORDER BY vehicle_no").fetch_all(&mut *c).await?;
    let vehicles: BTreeMap<u32, Vehicle> = vehicles
        .into_iter()
        .map(|(no, definition)| {
            let vehicle = Vehicle::from_json(&definition).map_err(|e| content(format!("vehicle {no}: {e}")))?;
            Ok((no, vehicle))
        })
        .collect::<Sql<_>>()?;
    let verdict = |vehicle: u32, edges: &[EdgeNo]| -> Option<u8> {
        let vehicle = vehicles.get(&vehicle).filter(|_| edges.iter().any(|edge| timed.contains_key(edge)))?;
        let at = |edge: &EdgeNo| {
            let (legal, country) = timed.get(edge)?;
            legal.judge(vehicle, At::Time { time, country: *country }).verdict
        };
        let verdicts: Vec<Verdict> = edges.iter().filter_map(at).collect();
        let forbidden = verdicts.iter().find(|verdict| matches!(verdict, Verdict::Forbidden(_)));
        verdict_no(forbidden.or(verdicts.first()).copied().unwrap_or(Verdict::Safe))
    };
    for (table, own) in TABLES {
        let rows = rows(c, table, rings).await?;
        sqlx::raw_sql(AssertSqlSafe(format!(
            "CREATE TABLE temp.{table}_at (vehicle_no, corridor_no, fid, verdict_no, \
             PRIMARY KEY (vehicle_no, corridor_no, fid)) WITHOUT ROWID"
        )))
        .execute(&mut *c)
        .await?;
        for (vehicle, corridor, fid, edges) in rows {
            let Some(verdict) = verdict(vehicle, &edges) else { continue };
            let insert = sqlx::query(AssertSqlSafe(format!("INSERT INTO temp.{table}_at VALUES (?, ?, ?, ?)")));
            insert.bind(vehicle).bind(corridor).bind(fid).bind(verdict).execute(&mut *c).await?;
        }
        let view = format!(
            "CREATE TEMP VIEW {table} AS SELECT {COLUMNS}, {own}, coalesce((SELECT a.verdict_no FROM temp.{table}_at AS a \
             WHERE a.vehicle_no = m.vehicle_no AND a.corridor_no = m.corridor_no AND a.fid = m.fid), verdict_no) \
             AS verdict_no FROM main.{table} AS m"
        );
        sqlx::raw_sql(AssertSqlSafe(view)).execute(&mut *c).await?;
    }
    Ok(())
}

/// The edges whose rules depend on the time.
async fn timed(c: &mut SqliteConnection) -> Sql<Timed> {
    let sql = "SELECT e.fid, r.country, e.max_height_m, e.max_weight_t, e.max_axle_load_t, e.max_length_m, e.max_width_m, \
               e.unreadable_limits, e.hgv, e.motor_vehicle, e.rules, e.legal_tags FROM edge AS e JOIN road AS r ON r.road_no = e.road_no \
               WHERE e.open_when NOT NULL";
    let mut sets = RuleSets::default();
    let rows = sqlx::query(sql).fetch_all(c).await?;
    let of = |row| -> Sql<_> {
        let fid = sqlx::Row::try_get(row, 0)?;
        Ok((edge_of(fid), (network_read::legal(row, 2, [10, 11], &mut sets)?, network_read::country(row, 1)?)))
    };
    rows.iter().map(of).collect()
}

/// The rows of a table that time decides: vehicle, corridor, `fid` and the edges that it leads over.
async fn rows(c: &mut SqliteConnection, table: &str, rings: &Rings) -> Sql<Vec<(u32, u32, u32, Vec<EdgeNo>)>> {
    let time_no = verdict_no(TIME).map_or(-1, i32::from);
    let holds = format!("c.verdict_no = {time_no} AND c.rsc_mm >= 0 AND c.hinge_margin_cdeg >= 0");
    let edges = if table == "certificate_compact" {
        format!("SELECT vehicle_no, corridor_no, fid, fid, fid, NULL, NULL FROM main.{table} AS c WHERE {holds}")
    } else {
        format!(
            "SELECT vehicle_no, corridor_no, c.fid, from_fid, to_fid, first_arc_fid, last_arc_fid \
             FROM main.{table} AS c JOIN turn AS t ON t.fid = c.fid WHERE {holds}"
        )
    };
    let mut out = Vec::new();
    for row in sqlx::query(AssertSqlSafe(edges)).fetch_all(c).await? {
        let index = |column| -> Sql<EdgeNo> { Ok(edge_of(row.try_get(column)?)) };
        let mut edges = vec![index(3)?, index(4)?];
        if let Some((first, last)) = row.try_get::<Option<u32>, _>(5)?.zip(row.try_get::<Option<u32>, _>(6)?) {
            let arcs = [first, last].map(edge_of);
            // Where the arcs between are not known, the time decides nothing.
            let Some(arcs) = rings.through(arcs) else { continue };
            edges.extend(arcs);
        }
        out.push((row.try_get(0)?, row.try_get(1)?, row.try_get(2)?, edges));
    }
    Ok(out)
}
