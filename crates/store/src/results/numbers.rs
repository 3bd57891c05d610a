//! Reads the columns that certificates of edges and turns have in common, in metres and words.

use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use netcert_base::corridor::Side;
use netcert_rows::CertificateRow;

use crate::columns::read::verdict;

/// The columns of a table called `c`, in the order that [`read`] expects.
pub(crate) const COLUMNS: &str = "c.verdict_no, c.rsc_mm, c.rsc_published_mm, c.hinge_margin_cdeg, c.shrink_milli, \
                                  c.limiting_s_dm, c.limiting_at";

/// Reads the columns `first` to `first + 6`; `what` names the row in errors.
pub(crate) fn read(
    row: &SqliteRow,
    first: usize,
    what: impl FnOnce() -> String,
) -> Result<CertificateRow, sqlx::Error> {
    let at: Option<u16> = row.try_get(first + 6)?;
    let parts = |column: usize, parts: f64| -> Result<Option<f64>, sqlx::Error> {
        Ok(row.try_get::<Option<i64>, _>(first + column)?.map(|whole| whole as f64 / parts))
    };
    Ok(CertificateRow {
        verdict: verdict(row, first, what)?,
        rsc_m: parts(1, 1000.0)?,
        rsc_published_m: parts(2, 1000.0)?,
        hinge_margin_deg: parts(3, 100.0)?,
        shrink: if at.is_some() { Some(parts(4, 1000.0)?.unwrap_or(1.0)) } else { None },
        limiting_s_m: parts(5, 10.0)?,
        limiting_unit: at.map(|at| at >> 1),
        limiting_side: at.map(|at| if at & 1 == 0 { Side::Left } else { Side::Right }),
    })
}
