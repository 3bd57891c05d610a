//! The check of claims about spans: leeway, room in areas and hinges, all tolerances in turn.

use std::ops::Range;

use crate::claim::{Finding, SpanClaim, TOLERANCE_RAD, Weight, asked, finding, rsc_weight, weight};
use crate::plane::Cramped;
use crate::subject::Subject;
use crate::swept_vehicle::SweptVehicle;
use crate::targets::{Shortfall, Targets};
use crate::{STEPS, TOLERANCE_M};

impl Subject<'_> {
    /// Checks the claims. Returns the findings of each claim; a claim without findings is proved.
    #[must_use]
    pub fn check(&self, claims: &[SpanClaim]) -> Vec<Vec<Finding>> {
        let Some(motion) = &self.motion else {
            let wrong = "the plan cannot be driven: it turns back, or a unit stands across it";
            let of = |claim: &SpanClaim| claim.rsc_m.map(|_| finding("rsc_m", wrong)).into_iter().collect();
            return claims.iter().map(of).collect();
        };
        let mut findings = vec![Vec::new(); claims.len()];
        let tolerance = |claim: &SpanClaim| claim.shrink.min(1.0) * self.chain.tolerance_m;
        let mut tolerances: Vec<f64> = claims.iter().map(tolerance).collect();
        tolerances.sort_by(f64::total_cmp);
        tolerances.dedup();
        let Some(&most) = tolerances.last() else { return findings };
        let mut whole = SweptVehicle::new(self.chain, &self.road, motion, most);
        for tolerance_m in tolerances {
            let own: Vec<usize> = (0..claims.len()).filter(|&i| tolerance(&claims[i]) == tolerance_m).collect();
            let mut part = (tolerance_m < most).then(|| {
                let spans = own.iter().map(|&i| self.stretches(&claims[i].stations));
                let range = spans.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(0..0);
                whole.within(tolerance_m, range)
            });
            self.check_some(part.as_mut().unwrap_or(&mut whole), claims, &own, &mut findings);
        }
        // Where room is missing, nothing is promised, and a place without a bound contradicts nothing.
        let nothing_promised =
            claims.iter().zip(&mut findings).filter(|(claim, _)| claim.rsc_m.is_some_and(|rsc_m| rsc_m < 0.0));
        for finding in nothing_promised.flat_map(|(_, own)| own).filter(|finding| finding.weight == Weight::Unbounded) {
            finding.weight = Weight::Remark;
        }
        findings
    }

    /// Checks the claims of these numbers, which are made at one tolerance.
    fn check_some(
        &self,
        swept: &mut SweptVehicle<'_>,
        claims: &[SpanClaim],
        own: &[usize],
        findings: &mut [Vec<Finding>],
    ) {
        self.limiting_places(swept, claims, own, findings);
        self.leeway(swept, claims, own, findings);
        self.room(swept, claims, own, findings);
        for &i in own {
            if let Some(station) = self.torn_before(swept, &claims[i]) {
                let detail = format!(
                    "{:.1} m: no corridor fits the station, and how the units stood there still matters on the span",
                    (station as f64 - self.road.lead as f64) * self.road.spacing
                );
                findings[i].push(Finding { weight: Weight::Unbounded, ..finding("rsc_m", &detail) });
            }
            let margin = claims[i].hinge_margin_rad;
            if let Some(short) = margin.and_then(|margin| self.hinges(swept, &claims[i].stations, margin)) {
                findings[i].push(Finding { weight: short.1, ..finding("hinge_margin_deg", &short.0) });
            }
        }
    }

    /// The last station that does not fit its neighbours and that the steer axle passed so shortly before a claimed span that the units have
    /// not settled since.
    fn torn_before(&self, swept: &SweptVehicle<'_>, claim: &SpanClaim) -> Option<usize> {
        claim.rsc_m?;
        let first = swept.steps(self.stretches(&claim.stations)).start / STEPS;
        let fading = (self.chain.fading_m / self.road.spacing) as usize;
        self.road.torn(first.saturating_sub(fading)..first)
    }

    fn leeway(&self, swept: &mut SweptVehicle<'_>, claims: &[SpanClaim], own: &[usize], findings: &mut [Vec<Finding>]) {
        let stretches = self.road.count - 1;
        let mut side = vec![f64::NEG_INFINITY; stretches];
        for &i in own {
            if let Some(rsc_m) = claims[i].rsc_m {
                for k in self.stretches(&claims[i].stations) {
                    side[k] = side[k].max(asked(rsc_m));
                }
            }
        }
        let shortfalls = swept.refute(&Targets([side.clone(), side.clone()]));
        for &i in own {
            let Some(rsc_m) = claims[i].rsc_m else { continue };
            // A stretch shared by two spans was tested for the greater claim.
            let short = |s: &Shortfall, k: usize| s.short_m - (side[k] - asked(rsc_m));
            let worst = shortfalls
                .iter()
                .filter_map(|s| {
                    let k = (s.station.max(0.0) as usize).min(stretches - 1);
                    let near = self.stretches(&claims[i].stations).contains(&k);
                    (near && short(s, k) > 0.0).then(|| (short(s, k), s))
                })
                .max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((short_m, at)) = worst {
                let weight = rsc_weight(rsc_m, short_m);
                findings[i].push(Finding { weight, ..finding("rsc_m", &self.describe(short_m, at)) });
            }
        }
    }

    /// Checks the room in areas, in all steps in which any point of the vehicle may be on a span.
    fn room(&self, swept: &mut SweptVehicle<'_>, claims: &[SpanClaim], own: &[usize], findings: &mut [Vec<Finding>]) {
        let claimed = |&i: &usize| Some((i, asked(claims[i].rsc_m?)));
        let mut own: Vec<(usize, f64)> = own.iter().filter_map(claimed).collect();
        // A greater claim that is proved settles the lesser ones in the steps that they share.
        own.sort_by(|a, b| b.1.total_cmp(&a.1));
        let steps = |i: usize| swept.steps(self.stretches(&claims[i].stations));
        let asked: Vec<_> = own.iter().map(|&(i, target)| (steps(i), target)).collect();
        for ((i, _), worst) in own.iter().zip(swept.cramped(&asked, None)) {
            if let Some(worst) = worst {
                let weight = rsc_weight(claims[*i].rsc_m.unwrap_or_default(), worst.short_m);
                findings[*i].push(Finding { weight, ..finding("rsc_m", &self.describe_cramped(&worst)) });
            }
        }
    }

    fn describe_cramped(&self, at: &Cramped) -> String {
        let from_start_m = (at.step as f64 / STEPS as f64 - self.road.lead as f64) * self.road.spacing;
        if at.short_m.is_infinite() {
            return format!("{from_start_m:.1} m, in an area: no bound holds there (unit {})", at.unit);
        }
        format!(
            "off by {:.4} m or more in an area, with the steer axle at {from_start_m:.1} m: unit {}, {:.1} m ahead of its \
             axle and {:.1} m to the left",
            at.short_m + TOLERANCE_M,
            at.unit,
            at.at[0],
            at.at[1]
        )
    }

    pub(crate) fn describe(&self, short_m: f64, at: &Shortfall) -> String {
        if short_m.is_infinite() {
            return format!("{:.1} m: no bound holds there (unit {})", at.station * self.road.spacing, at.unit);
        }
        format!(
            "off by {:.4} m or more at {:.1} m: unit {}, {} side, {:.1} m ahead of its axle",
            short_m + TOLERANCE_M,
            at.station * self.road.spacing,
            at.unit,
            ["left", "right"][at.side],
            at.point_m
        )
    }

    /// Why a hinge margin is not proved while any point of the vehicle is on the span.
    fn hinges(
        &self,
        swept: &mut SweptVehicle<'_>,
        stations: &Range<usize>,
        margin_rad: f64,
    ) -> Option<(String, Weight)> {
        let stretches = self.stretches(stations);
        let least = margin_rad - TOLERANCE_RAD;
        let steps = swept.steps(stretches);
        let mut worst: Option<(f64, String)> = None;
        for step in steps {
            for unit in 0..self.chain.links.len() {
                let short = least - swept.hinge_margin(step, unit, least);
                if short > 0.0 && worst.as_ref().is_none_or(|w| short > w.0) {
                    let at = (step as f64 / STEPS as f64 - self.road.lead as f64) * self.road.spacing;
                    let by = (short + TOLERANCE_RAD).to_degrees();
                    worst = Some((short, format!("off by {by:.3}° at {at:.1} m: hinge {unit}")));
                }
            }
        }
        worst.map(|(short, text)| (text, weight(short)))
    }
}
