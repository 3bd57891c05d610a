//! Certificates as they are stored, to be written again unchanged: what an update keeps of the older database.

use std::collections::BTreeMap;

use sqlx::sqlite::SqliteRow;
use sqlx::{AssertSqlSafe, Row as _};

use crate::osm::facts::Policy;
use crate::rows::{EdgeMeasure, StoredPlan};
use crate::verdict::Verdict;

use super::database::Database;
use super::error::{StoreError, content};
use super::names::{corridor_no, verdict_of};
use super::packed::Packed;
use super::writer::{VehicleNo, Writer};

type Sql<T> = Result<T, sqlx::Error>;

/// A stored certificate of an edge or a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kept {
    packed: Packed,
    verdict: Verdict,
}

/// Stored plans by their places, to be written again unchanged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeptPlans(BTreeMap<u32, Vec<u8>>);

impl KeptPlans {
    /// The plan of a place, for another place.
    #[must_use]
    pub fn at(&self, place: u32, now: u32) -> Option<StoredPlan> {
        Some(StoredPlan { at: now, packed: self.0.get(&place)?.clone() })
    }
}

impl Kept {
    /// The verdict.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }
}

impl Database {
    /// The certificates of a set as they are stored, by index of the edge.
    ///
    /// # Errors
    /// The file cannot be read, or a certificate is missing.
    pub fn kept_edges(&mut self, vehicle: &str, policy: Policy) -> Result<Vec<Kept>, StoreError> {
        self.kept("certificate_compact", "need_cm, NULL, NULL", vehicle, policy)
    }

    /// The certificates of the turns of a set as they are stored, by index of the turn. Empty if its turns are not certified.
    ///
    /// # Errors
    /// The file cannot be read, or a certificate is missing.
    pub fn kept_turns(&mut self, vehicle: &str, policy: Policy) -> Result<Vec<Kept>, StoreError> {
        self.kept("turn_certificate_compact", "need_kerb_cm, need_flare_cm, path_no", vehicle, policy)
    }

    /// The plans of a set as they are stored: of strokes by the index of their first edge, and of turns by their index.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn kept_plans(&mut self, vehicle: &str, policy: Policy) -> Result<[KeptPlans; 2], StoreError> {
        let mut plans = |table| Ok(KeptPlans(self.packed_plans(table, vehicle, policy)?));
        Ok([plans("plan")?, plans("turn_plan")?])
    }

    fn kept(
        &mut self,
        table: &'static str,
        more: &'static str,
        vehicle: &str,
        policy: Policy,
    ) -> Result<Vec<Kept>, StoreError> {
        self.session.run(async |c| {
            let sql = format!(
                "SELECT fid, verdict_no, rsc_mm, rsc_published_mm, hinge_margin_cdeg, shrink_milli, limiting_s_dm, \
                 limiting_at, {more} FROM {table} WHERE corridor_no = ? \
                 AND vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) ORDER BY fid"
            );
            let rows = sqlx::query(AssertSqlSafe(sql)).bind(corridor_no(policy)).bind(vehicle).fetch_all(c).await?;
            (1..)
                .zip(&rows)
                .map(|(expected, row)| {
                    let packed = packed(row)?;
                    let verdict = verdict_of(i64::from(packed.verdict_no)).filter(|_| packed.fid == expected);
                    let verdict = verdict.ok_or_else(|| content(format!("row {expected} of {table}")))?;
                    Ok(Kept { packed, verdict })
                })
                .collect()
        })
    }

    /// The measures of all edges, by index of the edge.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edge_measures(&mut self) -> Result<Vec<EdgeMeasure>, StoreError> {
        self.session.run(async |c| {
            let sql = "SELECT min_radius_m, centreline_deviation_m FROM edge ORDER BY fid";
            let rows: Vec<(Option<f64>, Option<f64>)> = sqlx::query_as(sql).fetch_all(c).await?;
            let measure = |(min_radius_m, centreline_deviation_m)| EdgeMeasure {
                length_m: None,
                min_radius_m,
                centreline_deviation_m,
            };
            Ok(rows.into_iter().map(measure).collect())
        })
    }
}

fn packed(row: &SqliteRow) -> Sql<Packed> {
    Ok(Packed {
        fid: row.try_get(0)?,
        verdict_no: row.try_get(1)?,
        rsc_mm: row.try_get(2)?,
        rsc_published_mm: row.try_get(3)?,
        hinge_margin_cdeg: row.try_get(4)?,
        shrink_milli: row.try_get(5)?,
        limiting_s_dm: row.try_get(6)?,
        limiting_at: row.try_get(7)?,
        needs_cm: [row.try_get(8)?, row.try_get(9)?],
        path_no: row.try_get(10)?,
    })
}

impl Writer {
    /// Adds a certificate of an older database for the edge with this index.
    ///
    /// # Errors
    /// A temporary file cannot be written.
    pub fn kept(&mut self, vehicle: VehicleNo, policy: Policy, edge: u32, kept: &Kept) -> Result<(), StoreError> {
        self.push(vehicle, policy, Packed { fid: edge + 1, ..kept.packed })
    }

    /// Adds a certificate of an older database for the turn with this index.
    ///
    /// # Errors
    /// A temporary file cannot be written.
    pub fn kept_turn(
        &mut self,
        vehicle: VehicleNo,
        policy: Policy,
        (turn, kept): (u32, &Kept),
        plan: Option<StoredPlan>,
    ) -> Result<(), StoreError> {
        self.push_turn(vehicle, policy, Packed { fid: turn + 1, ..kept.packed }, plan)
    }
}
