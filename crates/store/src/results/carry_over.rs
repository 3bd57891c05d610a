//! Certificates as they are stored, to be written again unchanged: what an update keeps of the older database.

use std::collections::BTreeMap;

use sqlx::AssertSqlSafe;

use crate::osm::facts::Policy;
use crate::verdict::Verdict;
use netcert_rows::{EdgeMeasure, StoredPlan};

use crate::columns::names::{corridor_no, verdict_of};
use crate::database::Database;
use crate::error::{StoreError, content};
use crate::results::compact::CompactCertificate;

/// Rows of a set that SQLite hands over as one text. Each row that sqlx hands over by itself costs a microsecond or more: a quarter of a
/// million rows took 0.6 s.
pub(crate) const PAGE_ROWS: usize = 1000;

/// A stored certificate of an edge or a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StoredCertificate {
    pub(crate) packed: CompactCertificate,
    verdict: Verdict,
}

/// Stored plans by their places, to be written again unchanged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredPlans(BTreeMap<u32, Vec<u8>>);

impl StoredPlans {
    /// The plan of a place, for another place.
    #[must_use]
    pub fn at(&self, place: u32, now: u32) -> Option<StoredPlan> {
        Some(StoredPlan { at: now, packed: self.0.get(&place)?.clone() })
    }
}

impl StoredCertificate {
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
    pub fn kept_edges(&mut self, vehicle: &str, policy: Policy) -> Result<Vec<StoredCertificate>, StoreError> {
        self.kept("certificate_compact", "need_cm, NULL, NULL", vehicle, policy)
    }

    /// The certificates of the turns of a set as they are stored, by index of the turn. Empty if its turns are not certified.
    ///
    /// # Errors
    /// The file cannot be read, or a certificate is missing.
    pub fn kept_turns(&mut self, vehicle: &str, policy: Policy) -> Result<Vec<StoredCertificate>, StoreError> {
        self.kept("turn_certificate_compact", "need_kerb_cm, need_flare_cm, path_no", vehicle, policy)
    }

    /// The plans of a set as they are stored: of strokes by the index of their first edge, and of turns by their index.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn kept_plans(&mut self, vehicle: &str, policy: Policy) -> Result<[StoredPlans; 2], StoreError> {
        let mut plans = |table| Ok(StoredPlans(self.packed_plans(table, vehicle, policy)?));
        Ok([plans("plan")?, plans("turn_plan")?])
    }

    fn kept(
        &mut self,
        table: &'static str,
        more: &'static str,
        vehicle: &str,
        policy: Policy,
    ) -> Result<Vec<StoredCertificate>, StoreError> {
        let pages: Vec<String> = self.session.run(async |c| {
            let sql = format!(
                "SELECT json_group_array(json_array(fid, verdict_no, rsc_mm, rsc_published_mm, hinge_margin_cdeg, shrink_milli, \
                 limiting_s_dm, limiting_at, {more}) ORDER BY fid) FROM {table} WHERE corridor_no = ? \
                 AND vehicle_no = (SELECT vehicle_no FROM vehicle WHERE vehicle_id = ?) GROUP BY fid / {PAGE_ROWS} ORDER BY fid / {PAGE_ROWS}"
            );
            sqlx::query_scalar(AssertSqlSafe(sql)).bind(corridor_no(policy)).bind(vehicle).fetch_all(c).await
        })?;
        let damaged = |row: usize| StoreError::sql(&self.session.path, content(format!("row {row} of {table}")));
        let mut kept = Vec::with_capacity(pages.len() * PAGE_ROWS);
        for page in &pages {
            let rows: Vec<Numbers> = serde_json::from_str(page).map_err(|_| damaged(kept.len() + 1))?;
            for row in rows {
                let expected = kept.len() + 1;
                let packed = packed(row).filter(|packed| packed.fid as usize == expected);
                let known = packed.and_then(|packed| Some((packed, verdict_of(i64::from(packed.verdict_no))?)));
                let (packed, verdict) = known.ok_or_else(|| damaged(expected))?;
                kept.push(StoredCertificate { packed, verdict });
            }
        }
        Ok(kept)
    }

    /// The ids of all edges with their measures, by index of the edge.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn edge_measures(&mut self) -> Result<Vec<(i64, EdgeMeasure)>, StoreError> {
        self.session.run(async |c| {
            let sql = "SELECT edge_id, min_radius_m, centreline_deviation_m FROM edge ORDER BY fid";
            let rows: Vec<(i64, Option<f64>, Option<f64>)> = sqlx::query_as(sql).fetch_all(c).await?;
            let measure = |(id, min_radius_m, centreline_deviation_m)| {
                (id, EdgeMeasure { length_m: None, min_radius_m, centreline_deviation_m })
            };
            Ok(rows.into_iter().map(measure).collect())
        })
    }
}

/// The columns of a certificate, in the order of [`CompactCertificate`].
type Numbers = [Option<i64>; 11];

/// `None` if a number is missing or out of range.
fn packed(row: Numbers) -> Option<CompactCertificate> {
    fn narrow<T: TryFrom<i64>>(value: Option<i64>) -> Option<Option<T>> {
        value.map(T::try_from).transpose().ok()
    }
    let [fid, verdict_no, rsc, published, hinge, shrink, limiting_s, limiting_at, need, other_need, path_no] = row;
    Some(CompactCertificate {
        fid: narrow(fid)??,
        verdict_no: narrow(verdict_no)??,
        rsc_mm: narrow(rsc)?,
        rsc_published_mm: narrow(published)?,
        hinge_margin_cdeg: narrow(hinge)?,
        shrink_milli: narrow(shrink)?,
        limiting_s_dm: narrow(limiting_s)?,
        limiting_at: narrow(limiting_at)?,
        needs_cm: [narrow(need)?, narrow(other_need)?],
        path_no,
    })
}
