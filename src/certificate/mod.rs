//! Writes certificate files. A file holds everything that its answer depends on, so that users and other programs can check
//! it. `docs/certificate.md` says what each member claims and how closely it is checked.
//!
//! | file | for |
//! | --- | --- |
//! | `nominal` | the poses of all units along the smooth plan when nothing disturbs the vehicle |
//! | `tubes` | the members of one unit's tube |
//! | `origin` | the data behind a route |
//!
//! The sweep steps from station to station, and its bounds allow for that. The nominal places in a file are computed again
//! here in finer steps, so that another program finds the same places.

mod nominal;
mod origin;
mod tubes;

use serde_json::{Value, json};

use crate::corridor::{AreaSpan, FileCorridor, FrameError, PlaneArea};
use crate::seal::sealed;
use crate::stet::{Certificate, Model, Options, known_m};
use crate::words::{Named as _, verdict_words};
use nominal::Nominal;
pub use origin::Origin;

/// The columns of leeway claim this much less than the sweep computed, metres.
const LESS_M: f64 = 1e-2;

/// Why a certificate cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CertificateError {
    /// Positions cannot be converted from the corridor's frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The vehicle's definition cannot be written as JSON.
    #[error("the vehicle's definition: {0}")]
    Vehicle(#[from] serde_json::Error),
}

/// The text of a certificate file with its seal. [`crate::check::certificate`] checks such a text.
///
/// # Errors
/// See [`CertificateError`].
pub fn text(
    given: &FileCorridor,
    model: &Model,
    certificate: &Certificate,
    options: &Options,
) -> Result<String, CertificateError> {
    Ok(sealed(&json(given, model, certificate, options)?))
}

/// The text of a route's certificate file. If there are `conditions`, the corridor is as they say, and the verdict is `conditional`
/// instead of `safe`.
///
/// # Errors
/// See [`CertificateError`].
///
/// ```
/// # let (_folder, path) = netcert_testing::documentation::junction_region();
/// use netcert::corridor::FileCorridor;
/// use netcert::osm::facts::Policy;
/// use netcert::region::Region;
/// use netcert::route::{Measure, Position, Question};
/// use netcert::{certificate, check, stop::Stop};
///
/// let mut region = Region::open(&path)?;
/// let mut planner = region.planner("AGV-TUG4", Policy::Carriageway, Measure::Time)?;
/// let places = vec![Position { lon: 0.001, lat: 0.0 }, Position { lon: 0.003, lat: 0.002 }];
/// let question = Question { places, snap_m: 50.0, alternatives: 0, tries: 30 };
/// let route = planner.answer(&question, &Stop::never())?.routes.remove(0);
///
/// let origin = region.origin("AGV-TUG4", Policy::Carriageway, None)?;
/// let given = FileCorridor { corridor: route.path.corridor, frame: Some(route.path.frame) };
/// let (model, options) = (&planner.driver().model, &planner.driver().permits.settings.stet);
/// let file = certificate::text_under(Vec::new(), &origin, &given, model, &route.certificate, options)?;
/// assert!(check::certificate(&file).confirmed());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn text_under(
    conditions: Vec<Value>,
    origin: &Origin,
    given: &FileCorridor,
    model: &Model,
    certificate: &Certificate,
    options: &Options,
) -> Result<String, CertificateError> {
    let mut document = json(given, model, certificate, options)?;
    if !conditions.is_empty() && certificate.result.safe() {
        document["verdict"] = json!("conditional");
        document["reason"] = json!("conditions");
        document["safe"] = json!(false);
    }
    document["conditions"] = Value::Array(conditions);
    document["origin"] = origin.json();
    Ok(sealed(&document))
}

/// All members of the certificate except the seal.
///
/// # Errors
/// See [`CertificateError`].
#[doc(hidden)]
pub fn json(
    given: &FileCorridor,
    model: &Model,
    certificate: &Certificate,
    options: &Options,
) -> Result<Value, CertificateError> {
    let (result, corridor, vehicle) = (&certificate.result, &given.corridor, &model.vehicle);
    let nominal = Nominal::new(corridor, &certificate.shift, vehicle);
    let frame = match given.frame {
        None => json!({"input": "metres"}),
        Some(frame) => json!({"input": "lonlat", "proj": frame.definition()}),
    };
    let (verdict, reason) = verdict_words(result.verdict());
    let limiting = result.rsc_m.and_then(|_| limiting(&nominal, certificate));
    // If no bound holds for the whole corridor, the file claims no leeway and no tubes.
    let closes = result.closes();
    let column = |column: &[f64]| column.iter().map(|&m| cautious_m(m).filter(|_| closes)).collect::<Vec<_>>();
    Ok(json!({
        "netcert": env!("CARGO_PKG_VERSION"),
        "vehicle": vehicle.to_json()?,
        "corridor": corridor_member(given, &frame)?,
        "max_shift_m": options.max_shift_m,
        "verdict": verdict,
        "reason": (!reason.is_empty()).then_some(reason),
        "safe": result.safe(),
        "rsc_m": result.rsc_m,
        "rsc_published_m": result.rsc_m.map(|_| nominal.published_m()),
        "hinge_margin_deg": result.hinge_margin_rad.map(f64::to_degrees),
        "hinge_unit": (result.closes() && !result.safe() && !result.too_narrow()).then_some(result.hinge_unit),
        "tracking_tolerance_m": vehicle.tracking_tolerance_m,
        "shrink": result.shrink,
        "limiting": limiting,
        "plan": given.to_input(&certificate.plan)?,
        "shift": certificate.shift.coefficients,
        "leeway": {
            "left": column(&certificate.left_m),
            "right": column(&certificate.right_m),
            "left_centred": column(&certificate.left_centred_m),
            "right_centred": column(&certificate.right_centred_m),
        },
        "tubes": if closes { Some(tubes::json(given, model, certificate, &nominal)?) } else { None },
    }))
}

/// The corridor; with `areas` where it has any.
fn corridor_member(given: &FileCorridor, frame: &Value) -> Result<Value, FrameError> {
    let corridor = &given.corridor;
    let mut all = json!({"frame": frame, "spacing_m": corridor.spacing_m, "stations": stations(given)?});
    if !corridor.areas.is_empty() {
        let rings =
            |area: &PlaneArea| area.rings.iter().map(|ring| given.to_input(ring)).collect::<Result<Vec<_>, _>>();
        let area = |span: &AreaSpan| {
            let last = span.heads.end.saturating_sub(1);
            Ok(json!({"heads": [span.heads.start, last], "rings": rings(&span.area)?}))
        };
        all["areas"] = corridor.areas.iter().map(area).collect::<Result<Vec<Value>, FrameError>>()?.into();
    }
    Ok(all)
}

/// The body point with the least leeway: its nominal place along the corridor, and its nominal distance from the edge. An area
/// has no edge beside a station, so that distance is null there.
fn limiting(nominal: &Nominal<'_>, certificate: &Certificate) -> Option<Value> {
    let at = &certificate.result.limiting;
    let (s, nominal_m) = match at.in_area {
        true => (nominal.along_m(at.station), None),
        false => nominal.passing(at).map(|(s, nominal_m)| (s, Some(nominal_m)))?,
    };
    Some(json!({
        "s": s,
        "unit": at.unit,
        "side": at.side.name(),
        "point_m": at.point_m,
        "nominal_m": nominal_m,
    }))
}

/// The claimed leeway. It is a little less than computed, because other programs use other steps.
fn cautious_m(leeway_m: f64) -> Option<f64> {
    known_m(leeway_m).map(|leeway_m| leeway_m - LESS_M)
}

fn stations(given: &FileCorridor) -> Result<Vec<Value>, FrameError> {
    let corridor = &given.corridor;
    let metres: Vec<[f64; 2]> = corridor.x.iter().zip(&corridor.y).map(|(&x, &y)| [x, y]).collect();
    let station = |(k, [x, y]): (usize, [f64; 2])| {
        json!({
            "s": k as f64 * corridor.spacing_m,
            "x": x,
            "y": y,
            "left": corridor.left_m[k],
            "right": corridor.right_m[k],
            "heading": corridor.heading[k],
            "curvature": corridor.curvature[k],
        })
    };
    Ok(given.to_input(&metres)?.into_iter().enumerate().map(station).collect())
}
