//! The columns that certificates of edges and turns have in common.

use crate::verdict::Verdict;
use crate::words::{Named as _, verdict_words};
use netcert_base::corridor::Side;

use super::cell::ColumnKind::{Integer, Real, Text};
use super::cell::{Cell, Column};

/// A certificate as a database stores it, in the units of the views.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // the columns of `certificate`
pub struct CertificateRow {
    pub verdict: Verdict,
    pub rsc_m: Option<f64>,
    pub rsc_published_m: Option<f64>,
    pub hinge_margin_deg: Option<f64>,
    pub shrink: Option<f64>,
    pub limiting_s_m: Option<f64>,
    pub limiting_unit: Option<u16>,
    pub limiting_side: Option<Side>,
}

impl CertificateRow {
    /// The columns of [`Self::cells`].
    pub const COLUMNS: [Column; 9] = [
        ("verdict", Text),
        ("reason", Text),
        ("rsc_m", Real),
        ("rsc_published_m", Real),
        ("hinge_margin_deg", Real),
        ("shrink", Real),
        ("limiting_s_m", Real),
        ("limiting_unit", Integer),
        ("limiting_side", Text),
    ];

    /// The values in the order of [`Self::COLUMNS`].
    #[must_use]
    pub fn cells(&self) -> [Cell<'static>; Self::COLUMNS.len()] {
        let (verdict, reason) = verdict_words(self.verdict);
        [
            Cell::Text(Some(verdict)),
            Cell::filled(reason),
            Cell::Real(self.rsc_m),
            Cell::Real(self.rsc_published_m),
            Cell::Real(self.hinge_margin_deg),
            Cell::Real(self.shrink),
            Cell::Real(self.limiting_s_m),
            Cell::Integer(self.limiting_unit.map(i64::from)),
            Cell::Text(self.limiting_side.map(Side::name)),
        ]
    }

    /// The hinge margin, if it is an angle. A value below −180° means that no bound holds.
    #[must_use]
    pub fn hinge_angle_deg(&self) -> Option<f64> {
        self.hinge_margin_deg.filter(|&degrees| degrees > -180.0)
    }
}
