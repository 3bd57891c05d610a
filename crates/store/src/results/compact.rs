//! A certificate as it is stored: small integers, each rounded down, so that a stored value never claims more than the
//! computed one. A `safe` certificate whose rounded numbers do not support it is refused.

use crate::verdict::Verdict;
use netcert_rows::{Conclusion, EdgeCertificate, TurnCertificate};

use crate::columns::names::verdict_no;
use crate::file::bulk::Bulk;

/// A row of `certificate_compact` without vehicle and corridor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct CompactCertificate {
    pub(crate) fid: u32,
    pub(crate) verdict_no: u8,
    pub(crate) rsc_mm: Option<i32>,
    pub(crate) rsc_published_mm: Option<i32>,
    pub(crate) hinge_margin_cdeg: Option<i32>,
    pub(crate) shrink_milli: Option<u16>,
    pub(crate) limiting_s_dm: Option<u32>,
    pub(crate) limiting_at: Option<u16>,
    /// What would be enough, centimetres: an edge's width; a turn's kerb radius, and the width of both its roads.
    pub(crate) needs_cm: [Option<u16>; 2],
    /// The code of the path, for turns only.
    pub(crate) path_no: Option<i64>,
}

impl CompactCertificate {
    /// Adds the columns that certificates of edges and turns have in common, from `fid` on.
    pub(crate) fn add_to(&self, bulk: &mut Bulk) {
        bulk.add(self.fid);
        bulk.add(self.verdict_no);
        bulk.add(self.rsc_mm);
        bulk.add(self.rsc_published_mm);
        bulk.add(self.hinge_margin_cdeg);
        bulk.add(self.shrink_milli);
        bulk.add(self.limiting_s_dm);
        bulk.add(self.limiting_at);
        bulk.add(self.needs_cm[0]);
    }
}

impl CompactCertificate {
    /// Packs the certificate of an edge. The error says why it may not be stored.
    pub(crate) fn edge(certificate: &EdgeCertificate) -> Result<Self, String> {
        let needs_cm = [need_cm(certificate.need_width_m), None];
        Ok(Self { needs_cm, ..Self::conclusion(&certificate.conclusion, certificate.edge.get())? })
    }

    /// Packs the certificate of a turn. The error says why it may not be stored.
    pub(crate) fn turn(certificate: &TurnCertificate) -> Result<Self, String> {
        let needs_cm = [certificate.need.kerb_radius_m, certificate.need.flare_m].map(need_cm);
        Ok(Self {
            path_no: certificate.path,
            needs_cm,
            ..Self::conclusion(&certificate.conclusion, certificate.turn.get())?
        })
    }

    /// Packs the conclusion of the edge or turn with this index.
    pub(crate) fn conclusion(conclusion: &Conclusion, index: u32) -> Result<Self, String> {
        let verdict_no = verdict_no(conclusion.verdict).ok_or("its verdict has no number")?;
        let fid = index.checked_add(1).ok_or("its index is out of range")?;
        let mut packed = Self {
            fid,
            verdict_no,
            rsc_mm: None,
            rsc_published_mm: None,
            hinge_margin_cdeg: None,
            shrink_milli: None,
            limiting_s_dm: None,
            limiting_at: None,
            needs_cm: [None; 2],
            path_no: None,
        };
        if let Some(m) = &conclusion.measured {
            packed.rsc_mm = floor_to(m.rsc_m, 1000.0);
            packed.rsc_published_mm = floor_to(m.rsc_published_m, 1000.0);
            packed.hinge_margin_cdeg = floor_to(m.hinge_margin_rad.to_degrees(), 100.0);
            packed.shrink_milli = Some(shrink_milli(m.shrink)?).filter(|&milli| milli != 1000);
            packed.limiting_s_dm = Some((m.limiting_s_m * 10.0).round() as u32); // saturates; not a number: 0
            let unit = u16::try_from(m.limiting_unit).ok().filter(|&unit| unit < 1 << 14);
            packed.limiting_at = Some(2 * unit.ok_or("its limiting unit is out of range")? + m.limiting_side as u16);
        }
        let holds = packed.rsc_mm >= Some(0) && packed.hinge_margin_cdeg >= Some(0);
        if conclusion.verdict == Verdict::Safe && !holds {
            return Err(format!("its verdict is safe, but its numbers do not support that: {:?}", conclusion.measured));
        }
        Ok(packed)
    }
}

/// The greatest whole number that, divided by `parts` as the views do, is at most `value`.
///
/// `None` for a value that is not finite or is out of range, such as a bound that grew without limit.
fn floor_to(value: f64, parts: f64) -> Option<i32> {
    if !(value * parts).is_finite() || (value * parts).abs() > 2e9 {
        return None;
    }
    // Rounded up first, because the product may be just below a whole number that gives `value` when divided.
    let mut whole = (value * parts).ceil() as i32;
    if f64::from(whole) / parts > value {
        whole = whole.saturating_sub(1);
    }
    Some(whole)
}

/// A need in centimetres, rounded up. `None` if it is out of range.
fn need_cm(need_m: Option<f64>) -> Option<u16> {
    let cm = (need_m? * 100.0 - 1e-6).ceil();
    (0.0..60_000.0).contains(&cm).then_some(cm as u16)
}

fn shrink_milli(shrink: f64) -> Result<u16, String> {
    let milli = (shrink * 1000.0).round();
    let quantised = (1.0..=1000.0).contains(&milli) && (milli / 1000.0 - shrink).abs() < 1e-9;
    if quantised {
        Ok(milli as u16)
    } else {
        Err(format!("its shrink, {shrink}, is not a multiple of 1/1000 in (0, 1]"))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::verdict::UnsafeReason;
    use netcert_base::corridor::Side;
    use netcert_rows::Measured;
    use proptest::prelude::*;

    fn measured(rsc_m: f64, hinge_margin_rad: f64, shrink: f64) -> Measured {
        Measured {
            rsc_m,
            rsc_published_m: rsc_m - 1.0,
            hinge_margin_rad,
            shrink,
            limiting_s_m: 12.34,
            limiting_unit: 3,
            limiting_side: Side::Right,
        }
    }

    fn pack(verdict: Verdict, m: Measured) -> Result<CompactCertificate, String> {
        CompactCertificate::conclusion(&Conclusion { verdict, measured: Some(m) }, 6)
    }

    const UNSAFE: Verdict = Verdict::Unsafe(UnsafeReason::Width);

    proptest! {
        #[test]
        fn rounding_never_raises_and_loses_less_than_a_step(rsc in -50.0..50.0_f64, hinge in -3.0..3.0_f64, milli in 1..=1000_u16) {
            let packed = pack(UNSAFE, measured(rsc, hinge, f64::from(milli) / 1000.0)).unwrap();
            let rsc_back = f64::from(packed.rsc_mm.unwrap()) / 1000.0;
            let hinge_back = f64::from(packed.hinge_margin_cdeg.unwrap()) / 100.0;
            prop_assert!(rsc_back <= rsc && rsc - rsc_back < 1.0001e-3);
            prop_assert!(hinge_back <= hinge.to_degrees() && hinge.to_degrees() - hinge_back < 1.0001e-2);
            prop_assert_eq!(packed.shrink_milli.unwrap_or(1000), milli);
        }
    }

    #[test]
    fn a_need_is_rounded_up_to_centimetres() {
        assert_eq!(
            [Some(3.3), Some(3.301), Some(0.0), Some(-1.0), Some(1e9), None].map(need_cm),
            [Some(330), Some(331), Some(0), None, None, None]
        );
    }

    #[test]
    fn whole_millimetres_stay_what_they_are() {
        for mm in -5000..5000 {
            let packed = pack(UNSAFE, measured(f64::from(mm) / 1000.0, 0.0, 1.0)).unwrap();
            assert_eq!(packed.rsc_mm, Some(mm));
        }
    }

    #[test]
    fn safe_is_refused_without_numbers_that_bear_it_out() {
        assert!(pack(Verdict::Safe, measured(0.0, 0.0, 1.0)).is_ok());
        assert!(pack(Verdict::Safe, measured(-1e-9, 0.1, 1.0)).is_err());
        assert!(pack(Verdict::Safe, measured(0.1, -1e-9, 1.0)).is_err());
        assert!(pack(Verdict::Safe, measured(f64::NAN, 0.1, 1.0)).is_err());
        assert!(pack(Verdict::Safe, measured(0.1, f64::INFINITY, 1.0)).is_err());
        assert!(CompactCertificate::conclusion(&Conclusion::bare(Verdict::Safe), 0).is_err());
    }

    #[test]
    fn what_is_out_of_range_is_missing() {
        for rsc in [-1e9, -3e6, 3e6, f64::NEG_INFINITY, f64::NAN] {
            assert_eq!(pack(UNSAFE, measured(rsc, -9.0, 0.3)).unwrap().rsc_mm, None);
        }
    }

    #[test]
    fn a_shrink_that_would_need_rounding_is_refused() {
        for shrink in [0.0, -0.1, 0.3004, 1.001, f64::NAN] {
            assert!(pack(UNSAFE, measured(0.1, 0.1, shrink)).is_err(), "{shrink}");
        }
    }
}
