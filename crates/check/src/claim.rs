//! Claims about one vehicle on one corridor, and their check. Pure: no input or output.

use std::cmp::Ordering;
use std::ops::Range;

use crate::chain::Chain;
use crate::curve::Place;
use crate::feet::foot;
use crate::fit::RoadError;
use crate::motion::Motion;
use crate::plane::Cramped;
use crate::road::Road;
use crate::swept::Swept;
use crate::targets::{Shortfall, Targets};
use crate::{STEPS, TOLERANCE_M};
use netcert_base::corridor::Corridor;

/// The tolerance of hinge margins, radians (0.02°).
pub(crate) const TOLERANCE_RAD: f64 = 0.02 * std::f64::consts::PI / 180.0;

/// A body that lacks this much room folds up, or leaves the road for another leg of it, metres. The two programs follow it for different
/// ways, so its limiting place is not checked.
const ASTRAY_M: f64 = 3.0;

/// A body that lacks as much room as it is wide is wholly outside of the road, metres. Entries of columns promise nothing there.
const OUTSIDE_M: f64 = 2.5;

/// The claimed limiting place may have this much more room than the RSC, metres. The two programs deduct different
/// amounts for what lies between their steps.
const LIMITING_TOLERANCE_M: f64 = 0.06;

/// The same where the corridor ends in a bend: beyond the end the road goes straight on, and the prover deducts more for the jump of the
/// curvature.
const LIMITING_AT_END_M: f64 = 0.2;

/// In areas the prover looks at boundaries up to 4 m away only, and measures only the pieces of bodies that may have the least room. An
/// RSC of this much is therefore a bound, but its place may have more room, metres.
const ROOMY_M: f64 = 2.0;

/// Where an RSC is negative, a shortfall of no more than this is a remark, metres. Nothing is promised there, and the two programs differ
/// by millimetres where a body passes over a boundary.
const ROUGHLY_M: f64 = 0.005;

/// Vehicle lengths by which the rear may lag behind the steer axle: the arc of a quarter turn instead of its chord
/// (proof, section 7).
const FARTHEST: f64 = 1.6;

/// Stations by which the limiting place may lie beyond the span: the prover works on stations in blocks of eight.
const LIMITING_BEYOND: f64 = 8.0;

/// The result of a claim.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Proved, within the tolerance.
    Confirmed,
    /// Proved, too. The remarks say what the certificate displays beside its claims and is not so.
    Remarked(Vec<Finding>),
    /// Not proved; says by how much the bound falls short, and where.
    NotConfirmed(Vec<Finding>),
    /// A value is missing, impossible or contradicts another.
    Malformed(String),
}

impl Outcome {
    /// The outcome for what was found.
    #[must_use]
    pub fn of(found: Vec<Finding>) -> Self {
        match found.iter().map(|finding| finding.weight).max() {
            None => Self::Confirmed,
            Some(Weight::Remark) => Self::Remarked(found),
            Some(Weight::Unbounded | Weight::Refuted) => Self::NotConfirmed(found),
        }
    }

    /// Whether all claims are proved. Remarks do not count against them.
    #[must_use]
    pub fn holds(&self) -> bool {
        matches!(self, Self::Confirmed | Self::Remarked(_))
    }
}

/// How much a finding counts, the least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// Nothing is promised too much, but what is displayed is not so.
    Remark,
    /// There is no bound at all at that place. The claim is not proved, but nothing contradicts it either.
    Unbounded,
    /// The claim is not proved.
    Refuted,
}

/// One claim that is not proved, or one remark.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name of the claim: `rsc_m`, `hinge_margin_deg`, `safe` …
    pub claim: String,
    /// Size and place of the difference, in words.
    pub detail: String,
    /// How much it counts.
    pub weight: Weight,
}

/// The claims about a span of stations.
#[derive(Debug, Clone, PartialEq)]
pub struct SpanClaim {
    /// Stations of the corridor, as in `EdgeSpan`.
    pub stations: Range<usize>,
    /// Least leeway, metres. `None` claims nothing.
    pub rsc_m: Option<f64>,
    /// Least hinge margin, radians.
    pub hinge_margin_rad: Option<f64>,
    /// γ.
    pub shrink: f64,
    /// Claimed place of the least leeway, if known: metres along the corridor, unit, side (0 left, 1 right).
    pub limiting: Option<(f64, usize, usize)>,
}

/// A vehicle on a corridor along a plan.
pub struct Subject<'a> {
    pub(crate) chain: &'a Chain,
    pub(crate) road: Road,
    pub(crate) motion: Option<Motion>,
    /// Shift of the steer axle's path at the corridor's stations, metres.
    shifts: Vec<f64>,
}

impl<'a> Subject<'a> {
    /// `shift(s)` is the plan: metres left of the centreline at `s` stations from the corridor's first. It is held
    /// beyond both ends. With `lenient`, a station that does not fit is no error; nothing is confirmed on the stretch
    /// before it.
    ///
    /// # Errors
    /// [`RoadError`] if stations do not fit each other, or an area is malformed.
    pub fn new(
        chain: &'a Chain,
        corridor: &Corridor,
        shift: impl Fn(f64) -> f64,
        lenient: bool,
    ) -> Result<Self, RoadError> {
        let (ahead, behind) = chain.reach_m();
        let road = Road::new(
            corridor,
            ahead + 3.0 * corridor.spacing_m,
            FARTHEST * behind + 3.0 * corridor.spacing_m,
            lenient,
        )?;
        let (lead, last) = (road.lead as f64, road.count as f64 - 1.0);
        let motion = Motion::new(chain, &road, |s| shift((s - lead).clamp(0.0, last)));
        let shifts = (0..road.count).map(|k| shift(k as f64)).collect();
        Ok(Self { chain, road, motion, shifts })
    }

    /// Shift of the steer axle's path `s` stations from the corridor's first, metres.
    pub(crate) fn planned(&self, s: f64) -> f64 {
        let last = self.shifts.len() - 1;
        let s = s.clamp(0.0, last as f64);
        let k = (s as usize).min(last.saturating_sub(1));
        self.shifts[k] + (self.shifts[(k + 1).min(last)] - self.shifts[k]) * (s - k as f64)
    }

    /// Checks the claims. Returns the findings of each claim; a claim without findings is proved.
    #[must_use]
    pub fn check(&self, claims: &[SpanClaim]) -> Vec<Vec<Finding>> {
        let mut findings = vec![Vec::new(); claims.len()];
        let Some(motion) = &self.motion else {
            for (claim, found) in claims.iter().zip(&mut findings) {
                if claim.rsc_m.is_some() {
                    found
                        .push(finding("rsc_m", "the plan cannot be driven: it turns back, or a unit stands across it"));
                }
            }
            return findings;
        };
        let tolerance = |claim: &SpanClaim| claim.shrink.min(1.0) * self.chain.tolerance_m;
        let mut tolerances: Vec<f64> = claims.iter().map(tolerance).collect();
        tolerances.sort_by(f64::total_cmp);
        tolerances.dedup();
        let Some(&most) = tolerances.last() else { return findings };
        let mut whole = Swept::new(self.chain, &self.road, motion, most);
        for tolerance_m in tolerances {
            let own: Vec<usize> = (0..claims.len()).filter(|&i| tolerance(&claims[i]) == tolerance_m).collect();
            let mut part = None;
            if tolerance_m < most {
                let spans = own.iter().map(|&i| self.stretches(&claims[i].stations));
                let range = spans.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(0..0);
                part = Some(whole.within(tolerance_m, range));
            }
            let swept = part.as_mut().unwrap_or(&mut whole);
            self.limiting_places(swept, claims, &own, &mut findings);
            self.leeway(swept, claims, &own, &mut findings);
            self.room(swept, claims, &own, &mut findings);
            for i in own {
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
        // Where room is missing, nothing is promised, and a place without a bound contradicts nothing.
        let nothing_promised =
            claims.iter().zip(&mut findings).filter(|(claim, _)| claim.rsc_m.is_some_and(|rsc_m| rsc_m < 0.0));
        for finding in nothing_promised.flat_map(|(_, own)| own).filter(|finding| finding.weight == Weight::Unbounded) {
            finding.weight = Weight::Remark;
        }
        findings
    }

    /// The last station that does not fit its neighbours and that the steer axle passed so shortly before a claimed span that the units have
    /// not settled since.
    fn torn_before(&self, swept: &Swept<'_>, claim: &SpanClaim) -> Option<usize> {
        claim.rsc_m?;
        let first = swept.steps(self.stretches(&claim.stations)).start / STEPS;
        let fading = (self.chain.fading_m / self.road.spacing) as usize;
        self.road.torn(first.saturating_sub(fading)..first)
    }

    /// Checks two columns of leeway (left, right), with one entry per station at γ = 1. Each entry claims what a span
    /// of its station alone would: the leeway over both stretches that meet there. Columns claim nothing about steps in
    /// areas: what they show there is for drawing. Returns for each side why it is not proved, or `None`. Where room is missing, nothing is
    /// promised: a place without a bound is a remark there, and so is every place at which a body is wholly outside of the road.
    pub fn leeway_columns(&self, columns: [&[Option<f64>]; 2]) -> [Option<(String, Weight)>; 2] {
        let stretches = self.road.count - 1;
        let claimed = |column: &[Option<f64>], k: usize| {
            let both = [column[k], column[k + 1]];
            both.into_iter().flatten().map(asked_alone).fold(f64::NEG_INFINITY, f64::max)
        };
        let targets = columns.map(|column| (0..stretches).map(|k| claimed(column, k)).collect::<Vec<_>>());
        let claims_nothing = |side: &[f64]| side.iter().all(|target| *target == f64::NEG_INFINITY);
        let Some(motion) = &self.motion else {
            let wrong = |side: &Vec<f64>| {
                (!claims_nothing(side)).then(|| ("the plan cannot be driven".to_owned(), Weight::Refuted))
            };
            return [wrong(&targets[0]), wrong(&targets[1])];
        };
        let mut swept = Swept::new(self.chain, &self.road, motion, self.chain.tolerance_m);
        let shortfalls = swept.refute(&Targets(targets.clone()));
        [0, 1].map(|side| {
            let weighed = |at: &Shortfall| {
                let claimed = targets[side][(at.station.max(0.0) as usize).min(stretches - 1)];
                let promised = if at.short_m.is_infinite() { claimed >= 0.0 } else { claimed > -OUTSIDE_M };
                if promised { weight(at.short_m) } else { Weight::Remark }
            };
            let own = shortfalls.iter().filter(|shortfall| shortfall.side == side);
            let worst = own.max_by(|a, b| {
                (weighed(a), a.short_m).partial_cmp(&(weighed(b), b.short_m)).unwrap_or(Ordering::Equal)
            })?;
            Some((self.describe(worst.short_m, worst), weighed(worst)))
        })
    }

    /// Nominal leeway of a body point as it passes the normal `s` metres along the corridor, with exact steering.
    pub fn nominal_at(&self, s: f64, unit: usize, side: usize, a: f64) -> Option<f64> {
        let swept = self.swept(self.chain.tolerance_m)?;
        swept.nominal_at(s / self.road.spacing + self.road.lead as f64, unit, side, a)
    }

    /// Checks the limiting places of some claims. The filter's bounds decide, because the prover may have used the filter.
    fn limiting_places(
        &self,
        swept: &mut Swept<'_>,
        claims: &[SpanClaim],
        own: &[usize],
        findings: &mut [Vec<Finding>],
    ) {
        let mut check = |filtered: &mut Swept<'_>| {
            for &i in own {
                findings[i].extend(self.limiting(filtered, &claims[i]));
            }
        };
        if swept.is_filtered() {
            swept.filter_alone(true);
            check(swept);
            swept.filter_alone(false);
        } else {
            check(&mut swept.filtered_again());
        }
    }

    /// Checks the limiting place: it must be on the span and have hardly more room than the RSC. More room there is a remark, since the RSC
    /// is then too low by so much.
    fn limiting(&self, filtered: &mut Swept<'_>, claim: &SpanClaim) -> Option<Finding> {
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
        // Where much room is left, the two programs differ by more, but nothing depends on it. Where room is missing, nothing is promised:
        // it is enough that room is missing at the place.
        let target = (rsc_m + tolerance_m + kink_m + 0.25 * rsc_m.abs()).max(0.0);
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

    /// Nominal place of an axle (from the corridor's first station) when the steer axle is at station `k`.
    pub fn axle_at(&self, k: usize, unit: usize) -> Option<[f64; 2]> {
        Some(self.motion.as_ref()?.pose((self.road.lead + k) * STEPS, unit).p)
    }

    /// Bound of an axle's deviation when the steer axle is at station `k`. It is the filter's bound if that is at most
    /// `enough`, otherwise the adjoint's.
    pub fn tube_at(&self, swept: &mut Swept<'_>, k: usize, unit: usize, enough: f64) -> Option<f64> {
        let step = (self.road.lead + k) * STEPS;
        swept.axle_bound(step.checked_sub(1)?, unit, enough)
    }

    /// The vehicle swept at a tolerance, metres.
    pub fn swept(&self, tolerance_m: f64) -> Option<Swept<'_>> {
        Some(Swept::new(self.chain, &self.road, self.motion.as_ref()?, tolerance_m))
    }

    /// As [`Self::swept`], by the filter alone.
    pub fn filtered(&self, tolerance_m: f64) -> Option<Swept<'_>> {
        Some(Swept::filtered(self.chain, &self.road, self.motion.as_ref()?, tolerance_m))
    }

    /// The foot of a point near `guess` (stations of the road), its place, and the point's lateral place.
    pub(crate) fn foot(&self, x: [f64; 2], guess: f64) -> Option<(f64, Place, f64)> {
        foot(&self.road, x, guess)
    }

    fn leeway(&self, swept: &mut Swept<'_>, claims: &[SpanClaim], own: &[usize], findings: &mut [Vec<Finding>]) {
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
    fn room(&self, swept: &mut Swept<'_>, claims: &[SpanClaim], own: &[usize], findings: &mut [Vec<Finding>]) {
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

    fn describe(&self, short_m: f64, at: &Shortfall) -> String {
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

    /// Stretches between the stations of a span. For a single station, the stretches that meet there.
    fn stretches(&self, stations: &Range<usize>) -> Range<usize> {
        let last = self.road.count - 1;
        let (from, to) = (stations.start.min(last), stations.end.saturating_sub(1).min(last));
        if to > from { from..to } else { from.saturating_sub(1)..(from + 1).min(last) }
    }

    /// Why a hinge margin is not proved while any point of the vehicle is on the span.
    fn hinges(&self, swept: &mut Swept<'_>, stations: &Range<usize>, margin_rad: f64) -> Option<(String, Weight)> {
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

/// The bound needed to prove an RSC. A negative RSC promises nothing to anybody, and the second orders of the two
/// programs differ where a vehicle stands metres outside. There an additional thousandth of the RSC is allowed.
fn asked(rsc_m: f64) -> f64 {
    rsc_m - TOLERANCE_M + 1e-3 * rsc_m.min(0.0)
}

/// The bound needed to prove a single station's entry. Where the vehicle stands outside, on normals that crowd, a
/// twentieth is allowed.
fn asked_alone(leeway_m: f64) -> f64 {
    leeway_m - TOLERANCE_M + 0.05 * leeway_m.min(0.0)
}

/// A claim that is not proved, with the reason.
#[must_use]
pub fn finding(claim: &str, detail: &str) -> Finding {
    Finding { claim: claim.to_owned(), detail: detail.to_owned(), weight: Weight::Refuted }
}

/// The weight of an RSC that lacks so much.
fn rsc_weight(rsc_m: f64, short_m: f64) -> Weight {
    if rsc_m < 0.0 && short_m <= ROUGHLY_M { Weight::Remark } else { weight(short_m) }
}

/// The weight of a claim that lacks so much.
fn weight(short: f64) -> Weight {
    if short.is_infinite() { Weight::Unbounded } else { Weight::Refuted }
}
