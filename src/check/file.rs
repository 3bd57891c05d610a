//! A certificate file: every member against what the vehicle on that corridor along that plan is proved to keep.
//!
//! The hash comes first: a file that is not as it was written is refuted whatever it says. Unknown members are
//! reported, missing ones make it malformed.

use serde_json::Value;
use sha2::{Digest as _, Sha256};

use super::chain::Chain;
use super::claim::{Finding, LIMITING_TOLERANCE_M, Outcome, SpanClaim, Subject, TOLERANCE_M, finding};
use super::leeway::Swept;
use super::members::{Members, Wrong};
use super::plan;
use super::printed;
use crate::corridor::{Corridor, Frame};
use crate::vehicle::Vehicle;

/// Positions that are written in degrees come back to this, metres.
const PLACE_TOLERANCE_M: f64 = 1e-4;
/// Most that a plan may be off the centreline, metres; beyond it nobody speaks of a correction.
const MOST_SHIFT_M: f64 = 100.0;
/// 𝒞 decides nothing; its h_Ω is nominal, and the prover's own steps are a station long: that moves a nominal place by κℓ²/12 a hinge.
const PRINTED_TOLERANCE_M: f64 = 0.03;
/// Marks the last member.
const SEAL: &str = ",\"sha256\":\"";

/// What is said of each member.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Member and what came of it, in the order in which they were looked at.
    pub claims: Vec<(String, Outcome)>,
    /// Members that the format does not know.
    pub unknown: Vec<String>,
}

impl Report {
    /// Whether every claim is confirmed.
    #[must_use]
    pub fn confirmed(&self) -> bool {
        self.claims.iter().all(|(_, outcome)| *outcome == Outcome::Confirmed)
    }
}

/// Adds the member `sha256` to a document: the hash of all bytes before its own comma.
#[must_use]
pub fn sealed(document: &Value) -> String {
    let text = document.to_string();
    let body = text.strip_suffix('}').unwrap_or(&text);
    format!("{body}{SEAL}{}\"}}\n", hex(body))
}

fn hex(body: &str) -> String {
    Sha256::digest(body.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Checks a certificate file.
#[must_use]
pub fn certificate(text: &str) -> Report {
    let mut report = Report { claims: Vec::new(), unknown: Vec::new() };
    let sealed = seal(text);
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
    match Document::read(&document, &mut report.unknown) {
        Ok(read) => read.check(&mut report.claims),
        Err(wrong) => {
            let path = wrong.split(':').next().unwrap_or_default().to_owned();
            report.claims.push((path, Outcome::Malformed(wrong)));
        }
    }
    report
}

fn seal(text: &str) -> Result<(), Wrong> {
    let (body, tail) = text.rsplit_once(SEAL).ok_or("sha256: missing, or not the last member")?;
    let said = tail.trim_end().strip_suffix("\"}").ok_or("sha256: not the last member")?;
    if said == hex(body) { Ok(()) } else { Err("sha256: the file is not as it was written".to_owned()) }
}

/// A certificate as its file has it.
struct Document {
    vehicle: Vehicle,
    corridor: Corridor,
    coefficients: Vec<i32>,
    rsc_m: f64,
    rsc_published_m: f64,
    hinge_margin_deg: f64,
    safe: bool,
    shrink: f64,
    limiting: Limiting,
    /// Left, right, left centred, right centred.
    leeway: [Vec<f64>; 4],
    tubes: Vec<TubeClaim>,
}

struct Limiting {
    s: f64,
    unit: usize,
    side: usize,
    point_m: f64,
}

struct TubeClaim {
    unit: usize,
    t: Vec<f64>,
    centre: Vec<[f64; 2]>,
    shape: Vec<[f64; 3]>,
    lateral_m: Vec<f64>,
}

const MEMBERS: &[&str] = &[
    "netcert",
    "vehicle",
    "corridor",
    "max_shift_m",
    "rsc_m",
    "rsc_published_m",
    "hinge_margin_deg",
    "safe",
    "tracking_tolerance_m",
    "shrink",
    "limiting",
    "plan",
    "shift",
    "leeway",
    "tubes",
    "sha256",
];
const COLUMNS: [&str; 4] = ["left", "right", "left_centred", "right_centred"];

impl Document {
    fn read(document: &Value, unknown: &mut Vec<String>) -> Result<Self, Wrong> {
        let all = Members::of(document, "")?;
        unknown.extend(all.unknown(MEMBERS));
        if all.text("netcert")?.split('.').filter(|part| part.parse::<u32>().is_ok()).count() != 3 {
            return Err("netcert: not a version".to_owned());
        }
        let vehicle = vehicle(all.value("vehicle")?)?;
        let (corridor, frame) = corridor(Members::of(all.value("corridor")?, "corridor")?, unknown)?;
        let n = corridor.len();
        let coefficients = coefficients(&all, n)?;
        planned(&all, &corridor, frame, &coefficients)?;
        let shrink = all.number("shrink")?;
        if !(shrink >= vehicle.min_shrink - 1e-3 && shrink <= 1.0) {
            return Err(format!("shrink: {shrink} is not from the vehicle's min_shrink to 1"));
        }
        if all.number("tracking_tolerance_m")? != vehicle.tracking_tolerance_m {
            return Err("tracking_tolerance_m: not the vehicle's".to_owned());
        }
        let leeway = Members::of(all.value("leeway")?, "leeway")?;
        unknown.extend(leeway.unknown(&COLUMNS));
        let [left, right, left_centred, right_centred] = COLUMNS.map(|name| leeway.numbers(name, n));
        let tubes = all.list("tubes", Some(vehicle.units.len()))?;
        let tubes = tubes.iter().enumerate().map(|(i, tube)| tube_claim(tube, i, n, frame, &corridor));
        Ok(Self {
            rsc_m: all.number("rsc_m")?,
            rsc_published_m: all.number("rsc_published_m")?,
            hinge_margin_deg: all.number("hinge_margin_deg")?,
            safe: all.truth("safe")?,
            limiting: limiting(Members::of(all.value("limiting")?, "limiting")?, &vehicle, unknown)?,
            leeway: [left?, right?, left_centred?, right_centred?],
            tubes: tubes.collect::<Result<_, _>>()?,
            vehicle,
            corridor,
            coefficients,
            shrink,
        })
    }

    fn check(&self, claims: &mut Vec<(String, Outcome)>) {
        let chain = Chain::new(&self.vehicle);
        let along = Subject::new(&chain, &self.corridor, plan::shift(&self.coefficients), false);
        let centred = Subject::new(&chain, &self.corridor, |_| 0.0, false);
        let (along, centred) = match (along, centred) {
            (Ok(along), Ok(centred)) => (along, centred),
            (Err(e), _) | (_, Err(e)) => {
                let said = format!("corridor.stations[{}]: {}", e.station, e.problem);
                claims.push(("corridor".to_owned(), Outcome::Malformed(said)));
                return;
            }
        };
        let whole = SpanClaim {
            stations: 0..self.corridor.len(),
            rsc_m: Some(self.rsc_m),
            hinge_margin_rad: Some(self.hinge_margin_deg.to_radians()),
            shrink: self.shrink,
            limiting: None,
        };
        let mut found: Vec<Finding> = along.check(&[whole]).remove(0);
        found.extend(self.safety());
        found.extend(self.limit(&along));
        let printed_m = printed::rsc_m(&along, &self.vehicle, 0..self.corridor.len());
        if self.rsc_published_m > printed_m + PRINTED_TOLERANCE_M {
            found.push(finding("rsc_published_m", &format!("{} is above {printed_m:.4}", self.rsc_published_m)));
        }
        for (subject, [left, right]) in [(&along, [0, 1]), (&centred, [2, 3])] {
            for (side, column) in [left, right].into_iter().enumerate() {
                if let Some(detail) = subject.leeway_column(side, &self.leeway[column]) {
                    found.push(finding(&format!("leeway.{}", COLUMNS[column]), &detail));
                }
            }
        }
        let mut swept = along.swept(self.shrink * self.vehicle.tracking_tolerance_m);
        for tube in &self.tubes {
            let Some(swept) = &mut swept else { break };
            if let Some((member, detail)) = self.tube(&along, swept, tube) {
                found.push(finding(&format!("tubes[{}].{member}", tube.unit), &detail));
            }
        }
        for claim in ["rsc_m", "hinge_margin_deg", "safe", "limiting", "rsc_published_m", "leeway", "tubes"] {
            let own: Vec<Finding> = found.iter().filter(|f| f.claim.starts_with(claim)).cloned().collect();
            let outcome = if own.is_empty() { Outcome::Confirmed } else { Outcome::NotConfirmed(own) };
            claims.push((claim.to_owned(), outcome));
        }
    }

    /// `safe` says no more and no less than the two numbers.
    fn safety(&self) -> Option<Finding> {
        let safe = self.rsc_m >= 0.0 && self.hinge_margin_deg >= 0.0;
        (safe != self.safe).then(|| finding("safe", "it is not what rsc_m and hinge_margin_deg say"))
    }

    /// The leeway at the limiting place is the RSC, nearly.
    fn limit(&self, along: &Subject<'_>) -> Option<Finding> {
        let at = &self.limiting;
        let tolerance_m = self.shrink * self.vehicle.tracking_tolerance_m;
        let found = along.leeway_at(at.s, at.unit, at.side, at.point_m, tolerance_m);
        match found {
            // Where much is to spare, or missing, the two programs part by more, as on spans.
            Some(m) if (m - self.rsc_m).abs() <= LIMITING_TOLERANCE_M + 0.25 * self.rsc_m.abs() => None,
            Some(m) => Some(finding("limiting", &format!("the leeway there is {m:.3} m, the RSC {:.3} m", self.rsc_m))),
            None => Some(finding("limiting", "that point does not pass there, or nothing is bounded")),
        }
    }

    /// A tube: centres, shapes and radii at the head's stations; times that grow.
    fn tube(&self, along: &Subject<'_>, swept: &mut Swept<'_>, claim: &TubeClaim) -> Option<(&'static str, String)> {
        if claim.t[0] != 0.0 {
            return Some(("t", "t[0] is not 0".to_owned()));
        }
        if let Some(k) = (1..claim.t.len()).find(|&k| claim.t[k] <= claim.t[k - 1]) {
            return Some(("t", format!("t[{k}] is not after t[{}]", k - 1)));
        }
        for k in 0..claim.t.len() {
            let Some((centre, lateral_m)) = along.tube_at(swept, k, claim.unit, claim.lateral_m[k] + TOLERANCE_M)
            else {
                continue; // nothing is bounded here, and a tube of a certificate that says `unsafe` claims nothing
            };
            let origin = [self.corridor.x[0], self.corridor.y[0]];
            let off = (claim.centre[k][0] - origin[0] - centre[0]).hypot(claim.centre[k][1] - origin[1] - centre[1]);
            // The prover's own steps are a station long: that moves a nominal place by κℓ²/12 a hinge.
            if off > 0.03 {
                return Some(("centre", format!("centre[{k}] is {off:.3} m off the axle's nominal place")));
            }
            // By what its centre is off, the tube must be wider.
            if lateral_m > claim.lateral_m[k] + TOLERANCE_M + off {
                return Some((
                    "lateral_m",
                    format!("lateral_m[{k}] is {:.4}, proved is {lateral_m:.4}", claim.lateral_m[k]),
                ));
            }
            let [q11, q12, q22] = claim.shape[k];
            let radius = claim.lateral_m[k].max(1e-6).powi(-2);
            if (q11 / radius - 1.0).abs() > 1e-9 || (q22 / radius - 1.0).abs() > 1e-9 || q12.abs() > 1e-9 * radius {
                return Some(("shape", format!("shape[{k}] is not the disc of lateral_m")));
            }
        }
        None
    }
}

fn vehicle(value: &Value) -> Result<Vehicle, Wrong> {
    let vehicle = Vehicle::from_json(&value.to_string()).map_err(|e| format!("vehicle: {e}"))?;
    let whole = vehicle.to_json().map_err(|e| format!("vehicle: {e}"))?;
    if whole == *value {
        Ok(vehicle)
    } else {
        Err("vehicle: not the whole definition, every field written out".to_owned())
    }
}

fn corridor(all: Members<'_>, unknown: &mut Vec<String>) -> Result<(Corridor, Option<Frame>), Wrong> {
    unknown.extend(all.unknown(&["frame", "spacing_m", "stations"]));
    let frame = Members::of(all.value("frame")?, "corridor.frame")?;
    unknown.extend(frame.unknown(&["input", "proj"]));
    let frame = match frame.text("input")? {
        "metres" => None,
        "lonlat" => {
            let proj = frame.text("proj")?;
            Some(Frame::defined(proj).ok_or("corridor.frame.proj: not a frame that netcert writes")?)
        }
        other => return Err(format!("corridor.frame.input: {other:?} is neither metres nor lonlat")),
    };
    let mut c = Corridor { spacing_m: all.number("spacing_m")?, ..Corridor::default() };
    let mut places = Vec::new();
    for (k, station) in all.list("stations", None)?.iter().enumerate() {
        let path = format!("corridor.stations[{k}]");
        let station = Members::of(station, &path)?;
        unknown.extend(station.unknown(&["s", "x", "y", "left", "right", "heading", "curvature"]));
        if (station.number("s")? - k as f64 * c.spacing_m).abs() > 1e-6 {
            return Err(format!("{path}.s: not {k} times spacing_m"));
        }
        places.push([station.number("x")?, station.number("y")?]);
        c.left_m.push(station.number("left")?);
        c.right_m.push(station.number("right")?);
        c.heading.push(station.number("heading")?);
        c.curvature.push(station.number("curvature")?);
    }
    for [x, y] in metres(frame, places, "corridor.stations")? {
        c.x.push(x);
        c.y.push(y);
    }
    Ok((c, frame))
}

/// Positions of the file in the frame's metres.
fn metres(frame: Option<Frame>, places: Vec<[f64; 2]>, path: &str) -> Result<Vec<[f64; 2]>, Wrong> {
    let Some(frame) = frame else { return Ok(places) };
    frame.forward_degrees(places.into_iter().map(|[x, y]| (x, y)).collect()).map_err(|e| format!("{path}: {e}"))
}

/// The plan's coefficients: as many as there must be, level at both ends, within the shift allowed.
fn coefficients(all: &Members<'_>, stations: usize) -> Result<Vec<i32>, Wrong> {
    let most_m = all.number("max_shift_m")?;
    if !(0.0..=MOST_SHIFT_M).contains(&most_m) {
        return Err(format!("max_shift_m: {most_m} is not from 0 to {MOST_SHIFT_M}"));
    }
    let numbers = all.numbers("shift", plan::count(stations))?;
    let most = most_m / plan::STEP_M + 0.5;
    if let Some(k) = numbers.iter().position(|c| c.fract() != 0.0 || c.abs() > most) {
        return Err(format!("shift[{k}]: {} is not a whole number of steps within max_shift_m", numbers[k]));
    }
    let whole: Vec<i32> = numbers.iter().map(|&c| c as i32).collect();
    plan::level(&whole).map_err(|why| format!("shift: {why}"))?;
    Ok(whole)
}

/// The plan's points are the shifted centreline.
fn planned(all: &Members<'_>, c: &Corridor, frame: Option<Frame>, coefficients: &[i32]) -> Result<(), Wrong> {
    let points = metres(frame, all.tuples("plan", c.len())?, "plan")?;
    let shift = plan::shift(coefficients);
    for (k, [x, y]) in points.into_iter().enumerate() {
        let (q, heading) = (shift(k as f64), c.heading[k]);
        let off = (x - c.x[k] + q * heading.sin()).hypot(y - c.y[k] - q * heading.cos());
        if off > PLACE_TOLERANCE_M {
            return Err(format!("plan[{k}]: {off:.4} m off the shift of the centreline"));
        }
    }
    Ok(())
}

fn limiting(at: Members<'_>, vehicle: &Vehicle, unknown: &mut Vec<String>) -> Result<Limiting, Wrong> {
    unknown.extend(at.unknown(&["s", "unit", "side", "point_m"]));
    let side = match at.text("side")? {
        "left" => 0,
        "right" => 1,
        other => return Err(format!("limiting.side: {other:?} is neither left nor right")),
    };
    let (unit, point_m) = (at.index("unit")?, at.number("point_m")?);
    let Some(body) = vehicle.units.get(unit) else { return Err(format!("limiting.unit: there is no unit {unit}")) };
    let ends = -body.rear_overhang_m - 1e-6..=body.coupling_to_axle_m + body.front_overhang_m + 1e-6;
    if !ends.contains(&point_m) {
        return Err(format!("limiting.point_m: {point_m} is not on the body of unit {unit}"));
    }
    Ok(Limiting { s: at.number("s")?, unit, side, point_m })
}

fn tube_claim(value: &Value, i: usize, n: usize, frame: Option<Frame>, c: &Corridor) -> Result<TubeClaim, Wrong> {
    let path = format!("tubes[{i}]");
    let all = Members::of(value, &path)?;
    if all.index("unit")? != i {
        return Err(format!("{path}.unit: not {i}"));
    }
    let centre = metres(frame, all.tuples("centre", n)?, &format!("{path}.centre"))?;
    debug_assert_eq!(centre.len(), c.len());
    Ok(TubeClaim {
        unit: i,
        t: all.numbers("t", n)?,
        centre,
        shape: all.tuples("shape", n)?,
        lateral_m: all.numbers("lateral_m", n)?,
    })
}
