//! A vehicle beside a reference vehicle on the same road: `relative_m` and `as_reference`.
//!
//! This is a statement of its own. It makes nothing safe and opens no permit: a verdict says what is proved of one vehicle, this
//! says whether a second one was given less room by its own certificate. Both RSCs are lower bounds, each at the best plan found, so
//! the comparison is one of certificates and no proof of what the reference needs.

use netcert_base::leeway::known_m;

use crate::verdict::{UnsafeReason, Verdict};

use super::cell::ColumnKind::{Flag, Real};
use super::cell::{Cell, Column};
use super::certificate::CertificateRow;

/// What a comparison takes from one certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CertificateStanding {
    verdict: Verdict,
    /// The RSC rounded down, millimetres. `None` if there is none, or if the bounds do not close.
    rsc_mm: Option<i64>,
    /// Whether every hinge and the steering lock are within their limits. A row that is `unsafe: width` may exceed them, too.
    hinges_hold: bool,
    /// The shrink γ of the certificate, thousandths: the vehicle must stay within this share of its tracking tolerance.
    shrink_milli: u16,
    /// Whether areas of junctions count there.
    in_area: bool,
}

/// Where a body does not fit into the area of a junction, the prover rounds what is missing up: by at most this length, millimetres,
/// or this share of what is missing (`docs/proof.md`, section 11). An RSC below 0 may be so much too low there.
const ROUNDED_MM: i64 = 100;
const ROUNDED_SHARE: i64 = 10;

impl CertificateStanding {
    /// Of a stored certificate: the RSC in metres, in whole millimetres, the hinge margin in degrees, and the shrink in whole thousandths
    /// (`None`: 1).
    #[must_use]
    pub fn stored(verdict: Verdict, rsc_m: Option<f64>, hinge_margin_deg: Option<f64>, shrink: Option<f64>) -> Self {
        let rsc_mm = rsc_m.and_then(known_m).map(|rsc_m| (rsc_m * 1000.0).round() as i64);
        let hinges_hold = hinge_margin_deg.is_some_and(|margin| margin >= 0.0);
        let shrink_milli = (shrink.unwrap_or(1.0) * 1000.0).round() as u16;
        Self { verdict, rsc_mm, hinges_hold, shrink_milli, in_area: false }
    }

    /// Of a stored certificate as a row.
    #[must_use]
    pub fn of(certificate: &CertificateRow) -> Self {
        let CertificateRow { verdict, rsc_m, hinge_margin_deg, shrink, .. } = *certificate;
        Self::stored(verdict, rsc_m, hinge_margin_deg, shrink)
    }

    /// Of numbers at full precision: as [`Self::stored`], but the RSC is rounded down and the hinge margin is in radians. `verdict` is the
    /// verdict with law and map.
    #[must_use]
    pub fn computed(verdict: Verdict, rsc_m: Option<f64>, hinge_margin_rad: Option<f64>, shrink: f64) -> Self {
        let rsc_mm = rsc_m.and_then(known_m).map(|rsc_m| (rsc_m * 1000.0).floor() as i64);
        let hinges_hold = hinge_margin_rad.is_some_and(|margin| margin >= 0.0);
        let shrink_milli = (shrink * 1000.0).round() as u16;
        Self { verdict, rsc_mm, hinges_hold, shrink_milli, in_area: false }
    }

    /// Of what has no certificate.
    #[must_use]
    pub fn bare(verdict: Verdict) -> Self {
        Self { verdict, rsc_mm: None, hinges_hold: false, shrink_milli: 1000, in_area: false }
    }

    /// The same on a turn, a passage, or a route over one: there areas of junctions count.
    #[must_use]
    pub fn in_area(self) -> Self {
        Self { in_area: true, ..self }
    }

    /// The verdict.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// The greatest RSC that may stand behind the stored one, millimetres.
    fn most_mm(&self) -> Option<i64> {
        let rounded = |mm: i64| if self.in_area && mm < 0 { ROUNDED_MM.max(-mm / ROUNDED_SHARE) } else { 0 };
        self.rsc_mm.map(|mm| mm + 1 + rounded(mm))
    }

    /// The RSC, if it is a bound of what the vehicle needs beside a reference with this shrink. An RSC at a smaller shrink leaves less freedom to
    /// steer, so it is no bound at a greater one. Where a body does not fit into an area, an RSC below 0 says what is missing at least.
    fn comparable_mm(&self, shrink_milli: u16) -> Option<i64> {
        let as_free = self.shrink_milli >= shrink_milli;
        self.rsc_mm.filter(|&mm| as_free && !(self.in_area && mm < 0))
    }

    /// Whether room alone decides here: access is lawful, and no hinge and no steering lock fails. Else there is nothing to compare.
    fn by_room(&self) -> bool {
        self.hinges_hold && matches!(self.verdict, Verdict::Safe | Verdict::Unsafe(UnsafeReason::Width))
    }
}

/// The comparison of a vehicle with a reference on one edge, turn or route.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Relative {
    /// RSC of the vehicle less RSC of the reference, metres, rounded to the safe side. `None` if either has none, or if they are not
    /// comparable: the vehicle's shrink is less than the reference's, or the vehicle does not fit into the area of a junction.
    pub relative_m: Option<f64>,
    /// Whether the vehicle needs no more room than the reference. It does not mean `safe`.
    pub as_reference: bool,
}

impl Relative {
    /// The columns of [`Self::cells`]. They follow all other columns.
    pub const COLUMNS: [Column; 2] = [("relative_m", Real), ("as_reference", Flag)];

    /// Compares two vehicles. Each RSC is rounded down to a millimetre, so the reference's true one may be up to a millimetre
    /// more: this millimetre is deducted. Where the reference does not fit into the area of a junction, its RSC is rounded more
    /// coarsely, and a decimetre or a tenth of it is deducted.
    #[must_use]
    pub fn between(vehicle: CertificateStanding, reference: CertificateStanding) -> Self {
        // Both are on the same road.
        let vehicle = if reference.in_area { vehicle.in_area() } else { vehicle };
        let own_mm = vehicle.comparable_mm(reference.shrink_milli);
        let relative_mm = own_mm.zip(reference.most_mm()).map(|(own, other)| own - other);
        Self::of(relative_mm, [vehicle, reference])
    }

    /// Compares a vehicle with itself. The difference is 0: nothing is rounded.
    #[must_use]
    pub fn to_itself(vehicle: CertificateStanding) -> Self {
        Self::of(vehicle.rsc_mm.map(|_| 0), [vehicle])
    }

    /// The comparison of these vehicles, whose difference is `relative_mm`.
    fn of<const N: usize>(relative_mm: Option<i64>, vehicles: [CertificateStanding; N]) -> Self {
        let by_room = vehicles.iter().all(CertificateStanding::by_room);
        let as_reference = by_room && relative_mm.is_some_and(|mm| mm >= 0);
        Self { relative_m: relative_mm.map(|mm| mm as f64 / 1000.0), as_reference }
    }

    /// The values in the order of [`Self::COLUMNS`].
    #[must_use]
    pub fn cells(self) -> [Cell<'static>; 2] {
        [Cell::Real(self.relative_m), Cell::Flag(self.as_reference)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::{ForbiddenReason, UnknownReason};

    const WIDTH: Verdict = Verdict::Unsafe(UnsafeReason::Width);

    fn standing(verdict: Verdict, rsc_m: f64) -> CertificateStanding {
        CertificateStanding::stored(verdict, Some(rsc_m), Some(12.0), None)
    }

    fn said(vehicle: CertificateStanding, reference: CertificateStanding) -> (Option<f64>, bool) {
        let said = Relative::between(vehicle, reference);
        (said.relative_m, said.as_reference)
    }

    #[test]
    fn a_millimetre_is_deducted_for_what_the_reference_lost_by_rounding() {
        let reference = standing(WIDTH, -0.3);
        assert_eq!(said(standing(WIDTH, -0.299), reference), (Some(0.0), true));
        assert_eq!(said(standing(WIDTH, -0.3), reference), (Some(-0.001), false));
        assert_eq!(said(standing(Verdict::Safe, 0.057), standing(Verdict::Safe, 0.029)), (Some(0.027), true));
        for mm in -5000..5000 {
            let own = standing(WIDTH, f64::from(mm) / 1000.0);
            assert_eq!(Relative::between(own, reference).relative_m, Some(f64::from(mm + 299) / 1000.0));
        }
    }

    #[test]
    fn what_a_reference_lacks_in_an_area_is_rounded_coarsely() {
        let turn = |rsc_m| standing(WIDTH, rsc_m).in_area();
        assert_eq!(said(turn(0.0), turn(-0.3)), (Some(0.199), true));
        assert_eq!(said(turn(0.0), turn(-2.0)), (Some(1.799), true));
        // An RSC of 0 or more is not rounded so.
        assert_eq!(said(turn(0.301), turn(0.3)), (Some(0.0), true));
        assert_eq!(Relative::to_itself(turn(-0.3)).relative_m, Some(0.0));
    }

    #[test]
    fn what_a_vehicle_lacks_in_an_area_is_at_least_that_and_is_not_compared() {
        let turn = |rsc_m| standing(WIDTH, rsc_m).in_area();
        assert_eq!(said(turn(-0.001), turn(-0.3)), (None, false));
        assert_eq!(said(standing(WIDTH, -0.23), turn(-1.0)), (None, false));
        assert_eq!(said(standing(WIDTH, -0.23), standing(WIDTH, -1.0)), (Some(0.769), true), "on an edge it is");
    }

    #[test]
    fn a_vehicle_that_must_be_steered_more_exactly_is_not_compared() {
        let at = |rsc_m, shrink| CertificateStanding::stored(Verdict::Safe, Some(rsc_m), Some(12.0), Some(shrink));
        assert_eq!(said(at(0.5, 0.367), at(0.1, 1.0)), (None, false));
        assert_eq!(said(at(0.5, 0.999), at(0.1, 1.0)), (None, false));
        // At the reference's smaller shrink the vehicle has at least this much.
        assert_eq!(said(at(0.5, 1.0), at(0.1, 0.367)), (Some(0.399), true));
        assert_eq!(said(at(0.5, 0.367), at(0.1, 0.367)), (Some(0.399), true));
        assert_eq!(Relative::to_itself(at(0.5, 0.367)).relative_m, Some(0.0));
    }

    #[test]
    fn the_same_vehicle_needs_exactly_as_much() {
        let own = Relative::to_itself(standing(WIDTH, -0.3));
        assert_eq!((own.relative_m, own.as_reference), (Some(0.0), true));
        let folded = Relative::to_itself(standing(Verdict::Unsafe(UnsafeReason::Articulation), 0.4));
        assert_eq!((folded.relative_m, folded.as_reference), (Some(0.0), false));
        assert_eq!(Relative::to_itself(CertificateStanding::bare(WIDTH)), Relative::default());
    }

    #[test]
    fn without_both_rscs_there_is_no_comparison() {
        let (there, none) = (standing(Verdict::Safe, 1.0), CertificateStanding::bare(WIDTH));
        let open = CertificateStanding::stored(WIDTH, Some(-1000.0), Some(-515.67), None);
        for (vehicle, reference) in [(there, none), (none, there), (none, none), (there, open), (open, there)] {
            assert_eq!(said(vehicle, reference), (None, false));
        }
    }

    /// Law, missing facts, hinges and the steering lock are no matter of room, on either side.
    #[test]
    fn what_room_does_not_decide_is_never_as_the_reference() {
        let other = [
            Verdict::Unsafe(UnsafeReason::Articulation),
            Verdict::Unsafe(UnsafeReason::SteeringLock),
            Verdict::Forbidden(ForbiddenReason::Length),
            Verdict::Unknown(UnknownReason::Limit),
        ];
        for verdict in other {
            assert_eq!(said(standing(verdict, 2.0), standing(Verdict::Safe, 0.5)), (Some(1.499), false), "{verdict:?}");
            assert_eq!(said(standing(Verdict::Safe, 2.0), standing(verdict, 0.5)), (Some(1.499), false), "{verdict:?}");
        }
        // Where the road is too narrow, the reason is `width`, even if a hinge fails as well.
        let folds = CertificateStanding::stored(WIDTH, Some(-0.1), Some(-0.01), None);
        assert_eq!(said(folds, standing(WIDTH, -0.5)), (Some(0.399), false));
        assert_eq!(
            said(standing(WIDTH, -0.1), CertificateStanding::stored(WIDTH, Some(-0.5), None, None)),
            (Some(0.399), false)
        );
    }

    #[test]
    fn full_precision_is_rounded_down_like_a_stored_certificate() {
        let computed = |rsc_m| CertificateStanding::computed(Verdict::Safe, Some(rsc_m), Some(0.1), 1.0);
        assert_eq!(computed(0.5007), standing(Verdict::Safe, 0.5));
        assert_eq!(said(computed(0.5007), computed(0.4999)), (Some(0.0), true));
        assert_eq!(said(computed(0.5007), computed(0.5005)), (Some(-0.001), false));
    }
}
