//! Answers with a certified route between places, else with a route under conditions and the obstacles, with the sheets of conditions, and with the
//! decision sheet.

use std::sync::Arc;

use serde_json::json;

use super::super::answer::StoredAnswer;
use super::super::ask::{DecodedRequest, one_of, policy};
use super::super::planning::{PlannedAnswer, Planners, RouteQuestion, Router};
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::{GEOJSON, SCOPE, answered};
use crate::network::Network;
use crate::osm::facts::Policy;
use crate::picture::{self, CaseFields, DecisionBasis, SheetStyle, Units};
use crate::route::{self, AtMost, Conditional, Conditions, Measure, Question};
use crate::store::Database;
use crate::vehicle::Vehicle;
use crate::words::Named;

/// The greatest number of places between beginning and end.
const MOST_VIA: usize = 8;
/// Default of `snap`, the greatest distance from a place to a road, metres. `netcert route` has the same default.
const SNAP_M: f64 = 100.0;
/// Default of `tries`, the number of whole routes that may fail. Each try costs a certificate over the whole route.
const TRIES: u32 = 12;

/// The address of the style sheet of pages to print.
const SHEET_STYLE_AT: &str = "/api/sheet.css";

/// The parameters of a route and of its sheets.
const PARAMETERS: [&str; 12] = [
    "vehicle",
    "policy",
    "at_most",
    "from",
    "to",
    "via*",
    "alternatives",
    "snap",
    "tries",
    "least",
    "drive",
    "conditions",
];

/// `/api/route`
pub(in super::super) fn route(
    region: &RegionState,
    planners: &Planners,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    Ok(answered(&planned(region, planners, ask, &[])?.members))
}

/// `/api/decision.html`
pub(in super::super) fn decision_html(
    region: &RegionState,
    planners: &Planners,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    let units = units(ask)?;
    let planned = planned(region, planners, ask, &["units"])?;
    let (vehicle, policy) = vehicle(region, ask)?;
    let widest = strips(region, ask, &vehicle.id, policy)?.into_iter().max().unwrap_or(policy);
    let read = region.runs.iter().find(|run| run.read_extract()).or(region.runs.first());
    let basis = DecisionBasis {
        input_name: read.map_or_else(String::new, |run| run.input_name.clone()),
        map_time: read.and_then(|run| run.replication_timestamp.clone()),
        input_blake3: read.and_then(|run| run.input_blake3.clone()),
        read_by: read.map_or_else(String::new, |run| run.netcert_version.clone()),
        measurements: region.read(Database::register)?.entries.len(),
        at: None,
        conditions: conditions(ask)?,
        strips: [policy, widest],
    };
    let (roads, fields, style) = (region.roads()?, CaseFields::default(), SheetStyle::At(SHEET_STYLE_AT));
    let page = picture::decision(roads.network(), vehicle, &planned.found, &fields, &basis, units, style);
    Ok(StoredAnswer::new("text/html; charset=utf-8", page.into_bytes()))
}

/// `/api/sheet.html`
pub(in super::super) fn sheet_html(
    region: &RegionState,
    planners: &Planners,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    let units = units(ask)?;
    sheet(region, planners, ask, &["units"], "text/html; charset=utf-8", |network, vehicle, conditional| {
        picture::sheet(network, vehicle, conditional, units, SheetStyle::At(SHEET_STYLE_AT))
    })
}

/// `/api/sheet.csv`
pub(in super::super) fn sheet_csv(
    region: &RegionState,
    planners: &Planners,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    sheet(region, planners, ask, &[], "text/csv; charset=utf-8", |network, _, conditional| {
        route::sheet_csv(network, conditional)
    })
}

/// `/api/sheet.geojson`
pub(in super::super) fn sheet_geojson(
    region: &RegionState,
    planners: &Planners,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    sheet(region, planners, ask, &[], GEOJSON, route::sheet_geojson)
}

/// `/api/sheet.css`
pub(in super::super) fn sheet_css(ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    Ok(StoredAnswer::new("text/css; charset=utf-8", picture::SHEET_STYLE.as_bytes().to_vec()))
}

/// A sheet. `more` are parameters beside those of a route.
fn sheet(
    region: &RegionState,
    planners: &Planners,
    ask: &DecodedRequest,
    more: &[&str],
    kind: &'static str,
    text: impl FnOnce(&Network, &Vehicle, &Conditional) -> String,
) -> Result<StoredAnswer, Problem> {
    let planned = planned(region, planners, ask, more)?;
    let Some(conditional) = &planned.found.conditional else {
        let detail = "there is no route under conditions between these places, so there is nothing to check; /api/route has the answer";
        return Err(Problem::not_found(detail));
    };
    let (vehicle, _) = vehicle(region, ask)?;
    Ok(StoredAnswer::new(kind, text(region.roads()?.network(), vehicle, conditional).into_bytes()))
}

/// The units of a page's lengths.
fn units(ask: &DecodedRequest) -> Result<Units, Problem> {
    match ask.parameter("units").unwrap_or("metres") {
        "metres" => Ok(Units::Metres),
        "feet" => Ok(Units::Feet),
        _ => Err(Problem::parameter("units", "give metres or feet")),
    }
}

/// The vehicle and the policy of a question.
fn vehicle<'r>(region: &'r RegionState, ask: &DecodedRequest) -> Result<(&'r Vehicle, Policy), Problem> {
    let policy = ask.parameter("policy").map_or(Ok(region.policy), policy)?;
    Ok((region.certified(ask.required("vehicle")?, policy)?.vehicle, policy))
}

/// The answer to a question. The last ones are kept.
fn planned(
    region: &RegionState,
    planners: &Planners,
    ask: &DecodedRequest,
    more: &[&str],
) -> Result<Arc<PlannedAnswer>, Problem> {
    ask.only(&[&PARAMETERS, more].concat())?;
    let (vehicle, policy) = vehicle(region, ask)?;
    let ride = ride(ask)?;
    let measure = match ask.parameter("least").unwrap_or("time") {
        "time" => Measure::Time,
        "distance" => Measure::Distance,
        _ => return Err(Problem::parameter("least", "give time or distance")),
    };
    let strips = strips(region, ask, &vehicle.id, policy)?;
    let sets = strips.iter().map(|&policy| region.certified(&vehicle.id, policy)).collect::<Result<Vec<_>, _>>()?;
    let names: Vec<&str> = strips.iter().map(|policy| policy.name()).collect();
    let key = format!("{} {} {measure:?}", vehicle.id, names.join(" "));
    let question = format!("{key} {:?} {} {:?}", ride.question, ride.drives, ride.conditions);
    planners.planned.get(&question, || {
        let router = planners.routers.get(&key, || Router::start(region, &sets, measure))?;
        let Some(answer) = router.ask(ride) else {
            planners.routers.forget(&key);
            return Err(Problem::fault("the search for routes broke off"));
        };
        let mut planned = answer?;
        planned.members["scope"] = json!(format!(
            "{SCOPE} Kerb radii of corners are assumed where they are neither surveyed nor mapped; times are by class of road and \
             tagged limits. A route under conditions is certified only if every condition holds on site."
        ));
        Ok(planned)
    })
}

/// The policies of a route: that of the question, and wider ones if `at_most` allows them and the vehicle's turns are certified under them.
fn strips(region: &RegionState, ask: &DecodedRequest, id: &str, base: Policy) -> Result<Vec<Policy>, Problem> {
    let certified = region.policies(id);
    let has_turns = |policy: Policy| certified.contains(&(policy, true));
    let missing = |policy: Policy| {
        let policy = policy.name();
        Problem::not_found(format!(
            "the turns of {id} are not certified under the {policy} policy; `netcert certify --vehicle {id} --corridor \
             {policy}` does that"
        ))
    };
    if !has_turns(base) {
        return Err(missing(base));
    }
    let top = match at_most(ask)? {
        None => return Ok(vec![base]),
        // As wide as the database allows.
        Some(AtMost::Attested) => Policy::Carriageway,
        Some(top) if top.strip() <= base => {
            return Err(Problem::parameter(
                "at_most",
                "name a policy that is wider than `policy`, or `attested`, or leave it out",
            ));
        }
        Some(top) if !has_turns(top.strip()) => return Err(missing(top.strip())),
        Some(top) => top.strip(),
    };
    Ok(Policy::ALL.iter().copied().filter(|&policy| policy >= base && policy <= top && has_turns(policy)).collect())
}

fn at_most(ask: &DecodedRequest) -> Result<Option<AtMost>, Problem> {
    ask.parameter("at_most").map(|word| one_of("at_most", word)).transpose()
}

/// Where a route may have conditions.
fn conditions(ask: &DecodedRequest) -> Result<Conditions, Problem> {
    match ask.parameter("conditions").unwrap_or("search") {
        "search" => Ok(at_most(ask)?.map_or(Conditions::Anywhere, AtMost::conditions)),
        "none" => Ok(Conditions::Nowhere),
        _ => Err(Problem::parameter("conditions", "give search or none")),
    }
}

fn ride(ask: &DecodedRequest) -> Result<RouteQuestion, Problem> {
    let one = |name: &str| -> Result<_, Problem> {
        ask.required(name)?;
        ask.places(name)?.into_iter().next().ok_or_else(|| Problem::parameter(name, "is missing"))
    };
    let via = ask.places("via")?;
    if via.len() > MOST_VIA {
        return Err(Problem::parameter("via", format!("{} places; {MOST_VIA} are allowed", via.len())));
    }
    let places = std::iter::once(one("from")?).chain(via).chain([one("to")?]).collect();
    let alternatives = ask.whole("alternatives", 0..=3)?.unwrap_or(0) as usize;
    let drives = match ask.parameter("drive").unwrap_or("best") {
        "best" => 1,
        "all" => alternatives + 1,
        "none" => 0,
        _ => return Err(Problem::parameter("drive", "give best, all or none")),
    };
    let conditions = conditions(ask)?;
    let snap_m = ask.number("snap", 0.0, 5000.0)?.unwrap_or(SNAP_M);
    let tries = ask.whole("tries", 0..=30)?.unwrap_or(TRIES) as usize;
    let question = Question { places, snap_m, alternatives, tries };
    Ok(RouteQuestion { question, drives, conditions, stop: ask.stop.clone() })
}
