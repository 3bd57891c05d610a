//! The check of the limiting places that certificates display.

use std::ops::Range;

use crate::STEPS;
use crate::claim::{Finding, SpanClaim, Weight, finding};
use crate::filter::Adjoint;
use crate::subject::{FARTHEST, Subject};
use crate::swept_vehicle::SweptVehicle;
use crate::targets::Targets;

/// A body that lacks this much room folds up, or leaves the road for another leg of it, metres. The two programs follow it for different
/// ways, so its limiting place is not checked.
const ASTRAY_M: f64 = 3.0;

/// The claimed limiting place may have this much more room than the RSC, metres. The two programs deduct different
/// amounts for what lies between their steps.
const LIMITING_TOLERANCE_M: f64 = 0.06;

/// The same where the corridor ends in a bend: beyond the end the road goes straight on, and the prover deducts more for the jump of the
/// curvature.
const LIMITING_AT_END_M: f64 = 0.2;

/// The same, as a part of the RSC. Where much room is left, the two programs differ by more, but nothing depends on it.
const LIMITING_PART: f64 = 0.25;

/// In areas the prover looks at boundaries up to 4 m away only, and measures only the pieces of bodies that may have the least room. An
/// RSC of this much is therefore a bound, but its place may have more room, metres.
const ROOMY_M: f64 = 2.0;

/// Stations by which the limiting place may lie beyond the span: the prover works on stations in blocks of eight.
const LIMITING_BEYOND: f64 = 8.0;

impl Subject<'_> {
    /// Checks the limiting places of some claims. The filter's bounds decide, because the prover may have used the filter.
    pub(crate) fn limiting_places(
        &self,
        swept: &mut SweptVehicle<'_>,
        claims: &[SpanClaim],
        own: &[usize],
        findings: &mut [Vec<Finding>],
    ) {
        let mut check = |filtered: &mut SweptVehicle<'_>| {
            for &i in own {
                findings[i].extend(self.limiting(filtered, &claims[i]));
            }
        };
        if swept.is_filtered() {
            swept.set_adjoint(Adjoint::Forbidden);
            check(swept);
            swept.set_adjoint(Adjoint::Allowed);
        } else {
            check(&mut swept.filtered_again());
        }
    }

    /// Checks the limiting place: it must be on the span and have hardly more room than the RSC. More room there is a remark, since the RSC
    /// is then too low by so much.
    fn limiting(&self, filtered: &mut SweptVehicle<'_>, claim: &SpanClaim) -> Option<Finding> {
        let ((at_m, unit, side), rsc_m) = (claim.limiting?, claim.rsc_m.filter(|rsc_m| *rsc_m > -ASTRAY_M)?);
        // How far a body is outside of an area is not measured here (`plane`). Far inside, the prover measures roughly. Between γ = 1 and
        // γ_min it takes chords, which may lie far below the room at that γ.
        let measured = (0.0..ROOMY_M).contains(&rsc_m) && claim.shrink >= 1.0;
        if !measured && self.in_area(&claim.stations) {
            return None;
        }
        let own = self.stretches(&claim.stations);
        let at = at_m / self.road.spacing;
        if unit >= self.chain.links.len() || at < own.start as f64 - 1.0 || at > own.end as f64 + LIMITING_BEYOND {
            return Some(finding("limiting", &format!("unit {unit} at {at_m:.1} m is not on the span")));
        }
        let stretches = self.road.count - 1;
        let mut targets = [vec![f64::NEG_INFINITY; stretches], vec![f64::NEG_INFINITY; stretches]];
        let at = at.clamp(own.start as f64, own.end as f64 - 1.0);
        let beyond = LIMITING_BEYOND as usize;
        let near = (at as usize).saturating_sub(beyond)..(at as usize + beyond).min(stretches);
        // Where half-widths kink, the prover deducts a part of the kink, which it may have stepped over. The checker
        // examines the kink itself.
        let kink_m = self.road.kink(side, self.road.lead + near.start..self.road.lead + near.end);
        let tolerance_m = if self.road.ends_in_a_bend(&near) { LIMITING_AT_END_M } else { LIMITING_TOLERANCE_M };
        // Where room is missing, nothing is promised: it is enough that room is missing at the place.
        let target = (rsc_m + tolerance_m + kink_m + LIMITING_PART * rsc_m.abs()).max(0.0);
        let (about, all) = (filtered.steps(near.clone()), filtered.steps(own));
        let in_areas = [(about.start.max(all.start)..about.end.min(all.end), target)];
        targets[side][near].fill(target);
        let roomy =
            !filtered.lacks(&Targets(targets), unit) && filtered.cramped(&in_areas, Some((unit, side)))[0].is_none();
        roomy.then(|| {
            let detail = format!("unit {unit} has more room than the RSC at {at_m:.1} m on that side");
            Finding { weight: Weight::Remark, ..finding("limiting", &detail) }
        })
    }

    /// Whether areas count in any step in which the vehicle is on some stations.
    fn in_area(&self, stations: &Range<usize>) -> bool {
        let (ahead, behind) = self.chain.reach_m();
        let reach = |metres: f64| (FARTHEST * metres / self.road.spacing).ceil() as usize;
        let first = (self.road.lead + stations.start).saturating_sub(reach(ahead)) * STEPS;
        (first..(self.road.lead + stations.end + reach(behind)) * STEPS).any(|step| self.road.areas.decides(step))
    }
}
