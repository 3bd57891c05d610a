//! Reads a certificate file strictly. A member that is missing, impossible or contradicts another makes the file malformed.

use std::sync::Arc;

use serde_json::Value;

use super::members::{Members, Wrong};
use super::rules;
use crate::corridor::{AreaSpan, Corridor, Frame, PlaneArea};
use crate::vehicle::Vehicle;
use netcert_check::plan;

/// Tolerance of positions that are written in degrees, metres.
const PLACE_TOLERANCE_M: f64 = 1e-4;
/// The greatest `max_shift_m` of a file, metres.
const MOST_SHIFT_M: f64 = 100.0;

/// The content of a certificate file.
pub(super) struct Document {
    pub(super) vehicle: Vehicle,
    pub(super) corridor: Corridor,
    pub(super) coefficients: Vec<i32>,
    pub(super) verdict: String,
    pub(super) reason: Option<String>,
    pub(super) safe: bool,
    /// How many conditions the file names. The corridor is as they say.
    pub(super) conditions: usize,
    /// The RSC in metres and the hinge margin in degrees. `None` if no bound holds.
    pub(super) bounds: Option<(f64, f64)>,
    pub(super) hinge_unit: Option<usize>,
    pub(super) rsc_published_m: Option<f64>,
    pub(super) shrink: f64,
    pub(super) limiting: Option<Limiting>,
    /// Left, right, left centred, right centred.
    pub(super) leeway: [Vec<Option<f64>>; 4],
    /// Empty if no bound holds.
    pub(super) tubes: Vec<TubeClaim>,
}

pub(super) struct Limiting {
    pub(super) s: f64,
    pub(super) unit: usize,
    pub(super) side: usize,
    pub(super) point_m: f64,
    /// `None` where an area limits.
    pub(super) nominal_m: Option<f64>,
}

pub(super) struct TubeClaim {
    pub(super) unit: usize,
    pub(super) t: Vec<f64>,
    pub(super) centre: Vec<[f64; 2]>,
    pub(super) shape: Vec<Option<[f64; 3]>>,
    pub(super) lateral_m: Vec<Option<f64>>,
}

const MEMBERS: &[&str] = &[
    "netcert",
    "vehicle",
    "corridor",
    "max_shift_m",
    "verdict",
    "reason",
    "safe",
    "rsc_m",
    "rsc_published_m",
    "hinge_margin_deg",
    "hinge_unit",
    "tracking_tolerance_m",
    "shrink",
    "limiting",
    "plan",
    "shift",
    "leeway",
    "tubes",
    "conditions",
    "origin",
    "signature",
    "sha256",
];
pub(super) const COLUMNS: [&str; 4] = ["left", "right", "left_centred", "right_centred"];

impl Document {
    pub(super) fn read(document: &Value, unknown: &mut Vec<String>) -> Result<Self, Wrong> {
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
        rules::shrink(&vehicle, shrink)?;
        if all.number("tracking_tolerance_m")? != vehicle.tracking_tolerance_m {
            return Err("tracking_tolerance_m: not the vehicle's".to_owned());
        }
        let leeway = Members::of(all.value("leeway")?, "leeway")?;
        unknown.extend(leeway.unknown(&COLUMNS));
        let [left, right, left_centred, right_centred] = COLUMNS.map(|name| leeway.numbers_or_null(name, n));
        let tubes = match all.value("tubes")? {
            Value::Null => &[],
            _ => all.list("tubes", Some(vehicle.units.len()))?,
        };
        let tubes = tubes.iter().enumerate().map(|(i, tube)| tube_claim(tube, i, n, frame, unknown));
        let tubes = tubes.collect::<Result<_, _>>()?;
        Ok(Self {
            verdict: all.text("verdict")?.to_owned(),
            reason: reason(&all)?,
            safe: all.truth("safe")?,
            conditions: match document.get("conditions") {
                Some(_) => all.list("conditions", None)?.len(),
                None => 0,
            },
            bounds: bounds(&all)?,
            hinge_unit: hinge_unit(&all, &vehicle)?,
            rsc_published_m: all.number_or_null("rsc_published_m")?,
            limiting: limiting(&all, &vehicle, &corridor, unknown)?,
            leeway: [left?, right?, left_centred?, right_centred?],
            tubes,
            vehicle,
            corridor,
            coefficients,
            shrink,
        })
    }
}

fn reason(all: &Members<'_>) -> Result<Option<String>, Wrong> {
    if all.value("reason")?.is_null() { Ok(None) } else { Ok(Some(all.text("reason")?.to_owned())) }
}

/// RSC and hinge margin. Both must be numbers, or both null.
fn bounds(all: &Members<'_>) -> Result<Option<(f64, f64)>, Wrong> {
    match (all.number_or_null("rsc_m")?, all.number_or_null("hinge_margin_deg")?) {
        (Some(rsc_m), Some(hinge_deg)) => Ok(Some((rsc_m, hinge_deg))),
        (None, None) => Ok(None),
        _ => Err("hinge_margin_deg: rsc_m and hinge_margin_deg must both be numbers or both be null".to_owned()),
    }
}

fn hinge_unit(all: &Members<'_>, vehicle: &Vehicle) -> Result<Option<usize>, Wrong> {
    if all.value("hinge_unit")?.is_null() {
        return Ok(None);
    }
    let unit = all.index("hinge_unit")?;
    if unit < vehicle.units.len() { Ok(Some(unit)) } else { Err(format!("hinge_unit: there is no unit {unit}")) }
}

fn vehicle(value: &Value) -> Result<Vehicle, Wrong> {
    let vehicle = Vehicle::from_json(&value.to_string()).map_err(|e| format!("vehicle: {e}"))?;
    let whole = vehicle.to_json().map_err(|e| format!("vehicle: {e}"))?;
    if whole == *value {
        Ok(vehicle)
    } else {
        Err("vehicle: not the complete definition with every field written out".to_owned())
    }
}

fn corridor(all: Members<'_>, unknown: &mut Vec<String>) -> Result<(Corridor, Option<Frame>), Wrong> {
    unknown.extend(all.unknown(&["frame", "spacing_m", "stations", "areas"]));
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
    c.areas = areas(&all, frame, c.len(), unknown)?;
    Ok((c, frame))
}

/// The areas of a corridor. A corridor without areas has no such member.
fn areas(
    all: &Members<'_>,
    frame: Option<Frame>,
    stations: usize,
    unknown: &mut Vec<String>,
) -> Result<Vec<AreaSpan>, Wrong> {
    if !all.has("areas") {
        return Ok(Vec::new());
    }
    let mut spans = Vec::new();
    for (i, area) in all.list("areas", None)?.iter().enumerate() {
        let path = format!("corridor.areas[{i}]");
        let area = Members::of(area, &path)?;
        unknown.extend(area.unknown(&["heads", "rings"]));
        let heads = area.numbers("heads", 2)?;
        let whole = heads.iter().all(|k| k.fract() == 0.0 && *k >= 0.0 && *k < stations as f64);
        if !whole || heads[0] >= heads[1] {
            return Err(format!("{path}.heads: {heads:?} are not two stations of the corridor in driving order"));
        }
        let rings = area.rings("rings")?.into_iter();
        let rings = rings.map(|ring| metres(frame, ring, &format!("{path}.rings"))).collect::<Result<_, _>>()?;
        spans.push(AreaSpan { heads: heads[0] as usize..heads[1] as usize + 1, area: Arc::new(PlaneArea { rings }) });
    }
    Ok(spans)
}

/// Converts positions of the file into the frame's metres.
fn metres(frame: Option<Frame>, places: Vec<[f64; 2]>, path: &str) -> Result<Vec<[f64; 2]>, Wrong> {
    let Some(frame) = frame else { return Ok(places) };
    frame.forward_degrees(places.into_iter().map(|[x, y]| (x, y)).collect()).map_err(|e| format!("{path}: {e}"))
}

/// Reads the plan's coefficients and checks their number, that they are level at both ends, and that they are within
/// `max_shift_m`.
fn coefficients(all: &Members<'_>, stations: usize) -> Result<Vec<i32>, Wrong> {
    let most_m = all.number("max_shift_m")?;
    if !(0.0..=MOST_SHIFT_M).contains(&most_m) {
        return Err(format!("max_shift_m: {most_m} is not from 0 to {MOST_SHIFT_M}"));
    }
    let numbers = all.numbers("shift", plan::count(stations))?;
    if let Some(k) = numbers.iter().position(|c| c.fract() != 0.0) {
        return Err(format!("shift[{k}]: {} is not a whole number of steps", numbers[k]));
    }
    // Numbers beyond 32 bits become the greatest one, which no rule allows.
    let whole: Vec<i32> = numbers.iter().map(|&c| c as i32).collect();
    rules::shift(&whole, most_m)?;
    Ok(whole)
}

/// Checks that the plan's points are those of the shifted centreline.
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

fn limiting(
    all: &Members<'_>,
    vehicle: &Vehicle,
    corridor: &Corridor,
    unknown: &mut Vec<String>,
) -> Result<Option<Limiting>, Wrong> {
    let at = all.value("limiting")?;
    if at.is_null() {
        return Ok(None);
    }
    let at = Members::of(at, "limiting")?;
    unknown.extend(at.unknown(&["s", "unit", "side", "point_m", "nominal_m"]));
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
    let s = at.number("s")?;
    if !(0.0..=corridor.spacing_m * corridor.len() as f64).contains(&s) {
        return Err(format!("limiting.s: {s} is not on the corridor"));
    }
    Ok(Some(Limiting { s, unit, side, point_m, nominal_m: nominal_m(&at, corridor)? }))
}

/// The nominal distance from the edge. It may be null where the corridor has areas.
fn nominal_m(at: &Members<'_>, corridor: &Corridor) -> Result<Option<f64>, Wrong> {
    match at.number_or_null("nominal_m")? {
        None if corridor.areas.is_empty() => Err("limiting.nominal_m: null, and the corridor has no areas".to_owned()),
        nominal_m => Ok(nominal_m),
    }
}

fn tube_claim(
    value: &Value,
    i: usize,
    n: usize,
    frame: Option<Frame>,
    unknown: &mut Vec<String>,
) -> Result<TubeClaim, Wrong> {
    let path = format!("tubes[{i}]");
    let all = Members::of(value, &path)?;
    unknown.extend(all.unknown(&["unit", "t", "centre", "shape", "lateral_m"]));
    if all.index("unit")? != i {
        return Err(format!("{path}.unit: not {i}"));
    }
    Ok(TubeClaim {
        unit: i,
        t: all.numbers("t", n)?,
        centre: metres(frame, all.tuples("centre", n)?, &format!("{path}.centre"))?,
        shape: all.tuples_or_null("shape", n)?,
        lateral_m: all.numbers_or_null("lateral_m", n)?,
    })
}
