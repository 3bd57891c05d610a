//! Checks a certificate file: every member against the bounds that are proved for the vehicle on that corridor along that plan.
//! `docs/certificate.md` says what each member claims.
//!
//! The hash is checked first; a file that was changed is malformed. Unknown members are reported. A missing member makes the
//! file malformed.

use serde_json::Value;

use super::document::{COLUMNS, Document, TubeClaim};
use super::rules;
use crate::seal;
use crate::watch::{self, TookTooLong, Work};
use netcert_check::Chain;
use netcert_check::SweptVehicle;
use netcert_check::paper_rsc;
use netcert_check::plan;
use netcert_check::{Finding, Outcome, SpanClaim, StationReading, Subject, TOLERANCE_M, Weight, finding};

/// Tolerance of nominal places, metres: the error of chords of a quarter of a station in the tightest bends.
const NOMINAL_M: f64 = 5e-3;
/// Tolerance of `rsc_published_m`, which is a maximum over many nominal places: metres, and a share of the value where it diverges to
/// thousands of metres. Nothing is decided by it.
const PRINTED_M: f64 = 0.01;
const PRINTED_SHARE: f64 = 2e-5;
/// The greatest coarse margin of the hinge that the file names as the reason, radians. It allows for the turn of a station's
/// chord.
const HINGE_ABOVE_RAD: f64 = 0.1;
/// Relative tolerance of times.
const TIME_PART: f64 = 1e-9;
/// The greatest speed behind `t`, 80 km/h.
const LIMIT_M_S: f64 = 80.0 / 3.6;
/// The greatest sideways acceleration behind `t`.
const LATERAL_M_S2: f64 = 2.0;

/// The outcome of checking each member.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Each checked member with its outcome, in the order of the checks.
    pub claims: Vec<(String, Outcome)>,
    /// Members that the format does not have.
    pub unknown: Vec<String>,
    /// The titles of the conditions under which the certificate holds.
    pub conditions: Vec<String>,
}

impl Report {
    /// Whether every claim is confirmed.
    #[must_use]
    pub fn confirmed(&self) -> bool {
        self.claims.iter().all(|(_, outcome)| outcome.holds())
    }
}

/// Checks a certificate file.
#[must_use]
pub fn certificate(text: &str) -> Report {
    let mut report = Report { claims: Vec::new(), unknown: Vec::new(), conditions: Vec::new() };
    let sealed = seal::body(text).map(drop);
    let holds = sealed.is_ok();
    report.claims.push(("sha256".to_owned(), sealed.map_or_else(Outcome::Malformed, |()| Outcome::Confirmed)));
    if !holds {
        return report;
    }
    let document: Value = match serde_json::from_str(text) {
        Ok(document) => document,
        Err(e) => {
            report.claims.push(("json".to_owned(), Outcome::Malformed(e.to_string())));
            return report;
        }
    };
    report.conditions = conditions(&document);
    match Document::read(&document, &mut report.unknown) {
        Ok(read) => match watch::guarded(Work::only("certificate"), watch::patience(), || read.check()) {
            Ok(claims) => report.claims.extend(claims),
            Err(TookTooLong) => report.claims.push(("work".to_owned(), rules::took_too_long())),
        },
        Err(wrong) => {
            let path = wrong.split(':').next().unwrap_or_default().to_owned();
            report.claims.push((path, Outcome::Malformed(wrong)));
        }
    }
    report
}

/// Each condition in one line, as far as it can be read.
fn conditions(document: &Value) -> Vec<String> {
    let line = |condition: &Value| {
        let text = |name: &str| condition.get(name).and_then(Value::as_str).unwrap_or("?").to_owned();
        let number = |name: &str| condition.get(name).and_then(Value::as_f64).map_or("?".to_owned(), |m| m.to_string());
        format!("{}: {} at least {} {}", text("title"), text("kind").replace('_', " "), number("needed"), text("unit"))
    };
    document.get("conditions").and_then(Value::as_array).into_iter().flatten().map(line).collect()
}

/// The claims, in the order of the report.
const CLAIMS: [&str; 8] =
    ["verdict", "rsc_m", "hinge_margin_deg", "hinge_unit", "limiting", "rsc_published_m", "leeway", "tubes"];

impl Document {
    fn check(&self) -> Vec<(String, Outcome)> {
        let chain = Chain::new(&self.vehicle);
        let along = Subject::new(&chain, &self.corridor, plan::shift(&self.coefficients), StationReading::Strict);
        let centred = Subject::new(&chain, &self.corridor, |_| 0.0, StationReading::Strict);
        let (along, centred) = match (along, centred) {
            (Ok(along), Ok(centred)) => (along, centred),
            (Err(e), _) | (_, Err(e)) => {
                let said = format!("corridor.stations[{}]: {}", e.station, e.problem);
                return vec![("corridor".to_owned(), Outcome::Malformed(said))];
            }
        };
        let mut found = self.bounded(&along);
        found.extend(self.follows());
        found.extend(self.limit(&along));
        found.extend(self.published(&along));
        for (subject, columns) in [(&along, [0, 1]), (&centred, [2, 3])] {
            let findings = subject.leeway_columns(columns.map(|column| self.leeway[column].as_slice()));
            for (column, detail) in columns.into_iter().zip(findings) {
                let finding = |(detail, weight): (String, Weight)| Finding {
                    weight,
                    ..finding(&format!("leeway.{}", COLUMNS[column]), &detail)
                };
                found.extend(detail.map(finding));
            }
        }
        found.extend(self.tubes(&along));
        let outcome = |claim: &str| {
            let own = found.iter().filter(|f| f.claim.starts_with(claim)).cloned().collect();
            (claim.to_owned(), Outcome::of(own))
        };
        CLAIMS.map(outcome).to_vec()
    }

    /// Checks the RSC, the hinge margin, and the hinge that is the reason for the verdict.
    fn bounded(&self, along: &Subject<'_>) -> Vec<Finding> {
        let Some((rsc_m, hinge_deg)) = self.bounds else { return Vec::new() };
        let claim = SpanClaim {
            stations: 0..self.corridor.len(),
            rsc_m: Some(rsc_m),
            hinge_margin_rad: Some(hinge_deg.to_radians()),
            shrink: self.shrink,
            limiting: None,
        };
        let mut found: Vec<Finding> = along.check(&[claim]).remove(0);
        let refused = rsc_m >= 0.0 && hinge_deg < 0.0;
        match (self.hinge_unit, along.filtered(self.vehicle.tracking_tolerance_m)) {
            (Some(unit), Some(swept)) if refused => {
                let margin = swept.coarse_hinge_margin(unit);
                if margin > HINGE_ABOVE_RAD {
                    let detail = format!("hinge {unit} has {:.1}° left at the least", margin.to_degrees());
                    found.push(finding("hinge_unit", &detail));
                }
            }
            (None, _) if refused => found.push(finding("hinge_unit", "none is named")),
            (Some(_), _) if !refused => found.push(finding("hinge_unit", "no hinge is the reason")),
            _ => {}
        }
        found
    }

    /// Checks that verdict and reason follow from the numbers.
    fn follows(&self) -> Option<Finding> {
        let (verdict, reason) = match (self.bounds, self.hinge_unit) {
            (Some((rsc_m, _)), _) if rsc_m < 0.0 => ("unsafe", Some("width")),
            (Some((_, hinge_deg)), _) if hinge_deg >= 0.0 && self.conditions > 0 => ("conditional", Some("conditions")),
            (Some((_, hinge_deg)), _) if hinge_deg >= 0.0 => ("safe", None),
            (Some(_), Some(0)) => ("unsafe", Some("steering_lock")),
            _ => ("unsafe", Some("articulation")),
        };
        let same = self.verdict == verdict && self.reason.as_deref() == reason && self.safe == (verdict == "safe");
        let because = reason.map_or(String::new(), |reason| format!(": {reason}"));
        (!same).then(|| finding("verdict", &format!("{verdict}{because} follows from the numbers")))
    }

    /// Checks that the limiting point passes the stated place with the stated nominal room, and that the RSC is not greater
    /// than this room.
    fn limit(&self, along: &Subject<'_>) -> Option<Finding> {
        let at = self.limiting.as_ref()?;
        let Some(said_m) = at.nominal_m else {
            return self.bounds.is_none().then(|| finding("limiting", "there is no rsc_m"));
        };
        let Some(nominal_m) = along.nominal_at(at.s, at.unit, at.side, at.point_m) else {
            return Some(finding("limiting", "that point does not pass there"));
        };
        if (nominal_m - said_m).abs() > NOMINAL_M {
            let detail = format!("nominal_m is {said_m:.4}, found {nominal_m:.4}");
            return Some(finding("limiting", &detail));
        }
        match self.bounds {
            Some((rsc_m, _)) if rsc_m <= said_m + TOLERANCE_M => None,
            Some(_) => Some(finding("limiting", "nominal_m is below rsc_m")),
            None => Some(finding("limiting", "there is no rsc_m")),
        }
    }

    fn published(&self, along: &Subject<'_>) -> Option<Finding> {
        let claimed_m = self.rsc_published_m?;
        let printed_m = paper_rsc::rsc_m(along, &self.vehicle, 0..self.corridor.len());
        let detail = format!("{claimed_m} is claimed, found {printed_m:.4}");
        ((claimed_m - printed_m).abs() > PRINTED_M.max(PRINTED_SHARE * printed_m.abs()))
            .then(|| finding("rsc_published_m", &detail))
    }

    fn tubes(&self, along: &Subject<'_>) -> Vec<Finding> {
        let Some(mut swept) = along.swept(self.shrink * self.vehicle.tracking_tolerance_m) else { return Vec::new() };
        let of = |tube: &TubeClaim| {
            let (member, detail) = self.times(tube).or_else(|| self.tube(along, &mut swept, tube))?;
            Some(finding(&format!("tubes[{}].{member}", tube.unit), &detail))
        };
        self.tubes.iter().filter_map(of).collect()
    }

    /// Checks the times. Between stations the speed is the mean of the speeds at both.
    fn times(&self, claim: &TubeClaim) -> Option<(&'static str, String)> {
        let speed = |k: usize| (LATERAL_M_S2 / self.corridor.curvature[k].abs()).sqrt().min(LIMIT_M_S);
        let mut now = 0.0;
        for (k, &said) in claim.t.iter().enumerate() {
            if let Some(before) = k.checked_sub(1) {
                now += 2.0 * self.corridor.spacing_m / (speed(before) + speed(k));
            }
            if (said - now).abs() > TIME_PART * (1.0 + now) {
                return Some(("t", format!("t[{k}] is {said}, found {now}")));
            }
        }
        None
    }

    /// Checks a tube: its centres, shapes and radii at the stations of the steer axle.
    fn tube(
        &self,
        along: &Subject<'_>,
        swept: &mut SweptVehicle<'_>,
        claim: &TubeClaim,
    ) -> Option<(&'static str, String)> {
        let origin = [self.corridor.x[0], self.corridor.y[0]];
        for k in 0..claim.t.len() {
            let centre = along.axle_at(k, claim.unit)?;
            let off = (claim.centre[k][0] - origin[0] - centre[0]).hypot(claim.centre[k][1] - origin[1] - centre[1]);
            if off > NOMINAL_M {
                return Some(("centre", format!("centre[{k}] is {off:.4} m off the axle's nominal place")));
            }
            let Some(said) = claim.lateral_m[k] else {
                if claim.shape[k].is_some() {
                    return Some(("shape", format!("shape[{k}] is there, lateral_m[{k}] is not")));
                }
                continue;
            };
            // The claimed tube is around the file's centre, so the offset between the two centres is added to the proved bound.
            let proved = along.tube_at(swept, k, claim.unit, said + TOLERANCE_M - off).map(|lateral_m| lateral_m + off);
            if proved.is_none_or(|proved| proved > said + TOLERANCE_M) {
                let found = proved.map_or("nothing".to_owned(), |proved| format!("{proved:.4}"));
                return Some(("lateral_m", format!("lateral_m[{k}] is {said:.4}, proved is {found}")));
            }
            let radius = said.max(1e-6).powi(-2);
            let disc = |[q11, q12, q22]: [f64; 3]| {
                (q11 / radius - 1.0).abs() <= 1e-9 && (q22 / radius - 1.0).abs() <= 1e-9 && q12.abs() <= 1e-9 * radius
            };
            if !claim.shape[k].is_some_and(disc) {
                return Some(("shape", format!("shape[{k}] is not the disc of lateral_m")));
            }
        }
        None
    }
}
