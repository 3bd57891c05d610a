//! What an edge or a turn would be if a width or a kerb radius were another one: `/api/suppose/{id}`.
//!
//! The stroke or the turn is certified again under the supposition. The answer is no certificate, and says so: it never has the
//! verdict `safe`.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::{DecodedRequest, policy};
use super::super::problem::Problem;
use super::super::region::{CertifiedVehicle, RegionState};
use super::super::roads::RoadIndex;
use super::{answered, id};
use crate::certify::{MOST_KERB_M, MOST_MORE_M, edge_need, stroke_at_least, turn_as_it_is, turn_with_kerb, verdict};
use crate::network::{EdgeNo, Network};
use crate::osm::facts::Policy;
use crate::route::{CONDITIONAL, PartKind, title};
use crate::rows::{EdgeRow, SetKey, TurnRow};
use crate::settings::{Needs, Settings};
use crate::stet::{Model, SpanResult};
use crate::stop::Stop;
use crate::store::{Database, QueryOptions, TurnQuery};
use crate::turns::TurnFacts;
use crate::verdict::{UnsafeReason, Verdict};
use crate::words::{Named, verdict_words};
use netcert_evidence::{self as evidence, Entry, MeasurementRow, MeasurementTarget, Quantity};

/// The steps of a slider, metres. Needs are in steps that these meet.
const WIDTH_STEP_M: f64 = 0.05;
const KERB_STEP_M: f64 = 0.5;
/// How far above the present width, and above the need, a slider goes at least, metres.
const MORE_M: f64 = 2.0;
const ABOVE_NEED_M: f64 = 0.5;
/// The greatest width that may be supposed, metres.
const MOST_WIDTH_M: f64 = 60.0;

const SCOPE: &str = "A supposition is no certificate: the numbers hold only if the road is so on site, and nothing here says that it is. \
                     `netcert evidence add` takes measurements. No permit.";

/// `/api/suppose/{id}?metres=`
pub(in super::super) fn suppose(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&["vehicle", "policy", "metres"])?;
    ask.required("metres")?;
    of_case(region, ask, |case, id| match case.roads.edge(id) {
        Some(edge) => case.edge(edge, metres(ask, MOST_WIDTH_M)?),
        None => case.turn(id, metres(ask, MOST_KERB_M)?),
    })
}

/// `POST /api/suppose/{id}`: the turn with the surface of the body, which is not kept.
pub(in super::super) fn suppose_surface(
    region: &RegionState,
    ask: &DecodedRequest,
    body: &[u8],
) -> Result<StoredAnswer, Problem> {
    ask.only(&["vehicle", "policy"])?;
    let rows = super::evidence::rows_of(body)?;
    if rows.iter().any(|row| row.quantity != Quantity::Surface) {
        let detail = "only surfaces can be supposed so; `metres` supposes a width or a radius";
        return Err(Problem::faulty(detail, Vec::new()));
    }
    of_case(region, ask, |case, id| case.surface(id, rows))
}

/// The answer about the edge or turn, the vehicle and the policy of a request.
fn of_case(
    region: &RegionState,
    ask: &DecodedRequest,
    made: impl FnOnce(&Case<'_>, i64) -> Result<Value, Problem>,
) -> Result<StoredAnswer, Problem> {
    let id = id(ask.name("id")?)?;
    let policy = ask.parameter("policy").map_or(Ok(region.policy), policy)?;
    let certified = region.certified(ask.required("vehicle")?, policy)?;
    let roads = region.roads()?;
    let model = Model::new(certified.vehicle).map_err(|error| Problem::fault(error.to_string()))?;
    let case = Case { region, roads: &roads, certified: &certified, model: &model, stop: &ask.stop };
    let mut members = made(&case, id)?;
    members["vehicle"] = json!(certified.vehicle.id);
    members["policy"] = json!(policy.name());
    members["unit"] = json!("m");
    members["safe"] = json!(false);
    members["scope"] = json!(SCOPE);
    Ok(answered(&members))
}

fn metres(ask: &DecodedRequest, most_m: f64) -> Result<f64, Problem> {
    ask.number("metres", 0.0, most_m)?.ok_or_else(|| Problem::parameter("metres", "is missing"))
}

/// One vehicle under one policy.
struct Case<'a> {
    region: &'a RegionState,
    roads: &'a RoadIndex,
    certified: &'a CertifiedVehicle<'a>,
    model: &'a Model,
    stop: &'a Stop,
}

impl Case<'_> {
    fn settings(&self) -> &Settings {
        &self.certified.settings
    }

    fn network(&self) -> &Network {
        self.roads.network()
    }

    fn edge(&self, edge: EdgeNo, width_m: f64) -> Result<Value, Problem> {
        let (network, policy) = (self.network(), self.settings().policy);
        let facts = &network.edges[edge.index()];
        let no_width =
            || Problem::not_found(format!("edge {}: it has no width that another one could replace", facts.id));
        let now_m = width_m_of(network, edge, policy).ok_or_else(no_width)?;
        let stroke = *network.strokes_of_edges().get(edge.index()).ok_or_else(no_width)?;
        let results = stroke_at_least(network, stroke, width_m, self.model, self.settings(), self.stop)?;
        let own = results.iter().find(|(other, _)| *other == edge).map(|(_, result)| result).ok_or_else(no_width)?;
        if let Verdict::Forbidden(_) | Verdict::Unknown(_) = verdict(self.network(), facts, self.model, None, Some(own))
        {
            return Err(Problem::not_found(format!("edge {}: a rule decides there, and no width helps", facts.id)));
        }
        let row = self.row(facts.id)?;
        let mut members = result_members(Some(own));
        members["kind"] = json!("edge");
        members["edge_id"] = json!(facts.id.to_string());
        members["quantity"] = json!(width_name(policy));
        members["supposed"] = json!(width_m);
        members["now"] = json!(hundredths(now_m));
        members["need"] = json!(row.and_then(|row| row.need_width_m));
        let mut opens = Vec::new();
        let mut opens_m = 0.0;
        for (other, result) in results.iter().filter(|(other, result)| *other != edge && result.safe()) {
            self.stop.check()?;
            let (other_id, length_m) =
                (network.edges[other.index()].id, network.length_m(&network.edges[other.index()]));
            let Some(row) = self.row(other_id)? else { continue };
            if matches!(row.certificate.verdict, Verdict::Unsafe(_)) {
                opens_m += length_m;
                opens.push(json!({
                    "edge_id": other_id.to_string(),
                    "title": title(network, PartKind::Edge(*other)),
                    "length_m": hundredths(length_m),
                    "rsc_m": rsc_m(result),
                }));
            }
        }
        members["opens"] = json!(opens);
        members["opens_m"] = json!(hundredths(opens_m));
        Ok(members)
    }

    fn row(&self, edge_id: i64) -> Result<Option<EdgeRow>, Problem> {
        let (vehicle, policy) = (&self.certified.vehicle.id, self.settings().policy);
        let options = QueryOptions { edge_id: Some(edge_id), ..QueryOptions::new(vehicle, policy) };
        self.region.read(|database| database.query(&options)?.next().transpose())
    }

    /// The row of a turn. Where the turn is forbidden, nothing that is paved or round helps.
    fn unless_forbidden(&self, id: i64, what: &str) -> Result<Option<TurnRow>, Problem> {
        let row = turn_row(self.region, &self.certified.vehicle.id, self.settings().policy, id)?;
        if row.as_ref().is_some_and(|row| matches!(row.certificate.verdict, Verdict::Forbidden(_))) {
            return Err(Problem::not_found(format!("turn {id}: a rule decides there, and {what}")));
        }
        Ok(row)
    }

    /// The turn, if the surfaces of these rows were paved, beside what is measured already.
    fn surface(&self, id: i64, rows: Vec<MeasurementRow>) -> Result<Value, Problem> {
        let facts = self.roads.turn(id, self.settings())?;
        let facts = facts.ok_or_else(|| Problem::not_found(format!("{id}: no turn of this database")))?;
        self.unless_forbidden(id, "no surface helps")?;
        let mut register = self.region.read(Database::register)?;
        let mut network = self.network().clone();
        let added = evidence::entries(&network, super::evidence::FILE, rows, register.last_no + 1);
        let node = network.edges.get(facts.movement.from.index()).map(|edge| edge.to_node);
        let here = |entry: &Entry| entry.targets().any(|target| Some(target) == node.map(MeasurementTarget::Area));
        if let Some(elsewhere) = added.iter().find(|entry| !here(entry)) {
            let why = elsewhere.why.as_deref().unwrap_or("it surrounds another junction");
            return Err(Problem::faulty(format!("the surface is not that of this turn's junction: {why}"), Vec::new()));
        }
        register.entries.extend(added);
        network.site = evidence::decide(&network, &mut register.entries).site;
        let result = turn_as_it_is(&network, &facts, self.model, self.settings(), self.stop)?;
        let mut members = result_members(result.as_ref());
        members["kind"] = json!("turn");
        members["turn_id"] = json!(id.to_string());
        members["quantity"] = json!("surface");
        for unknown in ["supposed", "now", "need", "need_flare"] {
            members[unknown] = Value::Null;
        }
        Ok(members)
    }

    fn turn(&self, id: i64, radius_m: f64) -> Result<Value, Problem> {
        let facts = self.roads.turn(id, self.settings())?;
        let facts =
            facts.ok_or_else(|| Problem::not_found(format!("{id}: neither an edge nor a turn of this database")))?;
        let no_kerb = || Problem::not_found(format!("turn {id}: it has no kerb radius that another one could replace"));
        let now_m = facts.kerb_radius_m.ok_or_else(no_kerb)?;
        let row = self.unless_forbidden(id, "no kerb radius helps")?;
        let result = turn_with_kerb(self.network(), &facts, radius_m, self.model, self.settings(), self.stop)?;
        let mut members = result_members(result.as_ref());
        members["kind"] = json!("turn");
        members["turn_id"] = json!(id.to_string());
        members["quantity"] = json!("kerb_radius");
        members["supposed"] = json!(radius_m);
        members["now"] = json!(hundredths(now_m));
        members["need"] = json!(row.as_ref().and_then(|row| row.need_kerb_radius_m));
        members["need_flare"] = json!(row.as_ref().and_then(|row| row.need_flare_m));
        Ok(members)
    }
}

/// The numbers under the supposition. `conditional` in place of `safe`, because nothing says that the supposition holds.
fn result_members(result: Option<&SpanResult>) -> Value {
    let enough = result.is_some_and(SpanResult::safe);
    let reason = result.map_or("articulation", |result| verdict_words(result.verdict()).1);
    json!({
        "verdict": if enough { CONDITIONAL } else { "unsafe" },
        "reason": (!enough).then_some(reason),
        "enough": enough,
        "rsc_m": result.and_then(rsc_m),
    })
}

/// Metres, never rounded up.
fn rsc_m(result: &SpanResult) -> Option<f64> {
    result.rsc_m.filter(|rsc_m| rsc_m.is_finite()).map(|rsc_m| (rsc_m * 1000.0).floor() / 1000.0)
}

fn width_m_of(network: &Network, edge: EdgeNo, policy: Policy) -> Option<f64> {
    let strip = network.section(network.edges.get(edge.index())?).strip(policy)?;
    Some(f64::from(strip.width_m())).filter(|&width_m| width_m > 0.0)
}

fn width_name(policy: Policy) -> String {
    format!("{}_width", policy.name())
}

fn hundredths(m: f64) -> f64 {
    (m * 100.0).floor() / 100.0
}

fn turn_row(region: &RegionState, vehicle: &str, policy: Policy, id: i64) -> Result<Option<TurnRow>, Problem> {
    let query = TurnQuery { turn_id: Some(id), ..TurnQuery::new(vehicle, policy) };
    Ok(region.read(|database| database.query_turns(&query))?.pop())
}

/// What may be supposed of an edge, for a slider. Null if no width decides there.
pub(super) fn of_edge(
    network: &Network,
    edge: EdgeNo,
    model: &Model,
    settings: &Settings,
    row: Option<&EdgeRow>,
) -> Value {
    let Some(now_m) = width_m_of(network, edge, settings.policy) else { return Value::Null };
    let Some(row) = row.filter(|row| matches!(row.certificate.verdict, Verdict::Safe | Verdict::Unsafe(_))) else {
        return Value::Null;
    };
    let need_m = certified_need_m(network, edge, model, settings, row);
    let high_m = need_m.map_or(0.0, |need_m| need_m + ABOVE_NEED_M).max(now_m + MORE_M).min(now_m + MOST_MORE_M);
    let step = |m: f64| (m / WIDTH_STEP_M + 1e-6).floor() * WIDTH_STEP_M;
    json!({
        "quantity": width_name(settings.policy),
        "unit": "m",
        "now": hundredths(now_m),
        "low": hundredths(step(now_m) + 1e-6),
        "high": hundredths(step(high_m) + 1e-6),
        "step": WIDTH_STEP_M,
        "need": need_m,
        "need_flare": Value::Null,
    })
}

/// A width that was certified to do for an edge that lacks room, metres: the stored one, or if that is an estimate, one that is looked for now.
fn certified_need_m(network: &Network, edge: EdgeNo, model: &Model, settings: &Settings, row: &EdgeRow) -> Option<f64> {
    if settings.needs.include(Needs::Edges) || row.certificate.verdict != Verdict::Unsafe(UnsafeReason::Width) {
        return row.need_width_m;
    }
    let stroke = *network.strokes_of_edges().get(edge.index())?;
    edge_need(network, stroke, edge, model, settings)
}

/// What may be supposed of a turn, for a slider. Null if no kerb radius decides there.
pub(super) fn of_turn(
    region: &RegionState,
    facts: &TurnFacts,
    certified: SetKey<'_>,
    own: Verdict,
) -> Result<Value, Problem> {
    let Some(now_m) = facts.kerb_radius_m.filter(|_| matches!(own, Verdict::Safe | Verdict::Unsafe(_))) else {
        return Ok(Value::Null);
    };
    let row = turn_row(region, certified.vehicle, certified.policy, facts.id)?;
    Ok(json!({
        "quantity": "kerb_radius",
        "unit": "m",
        "now": hundredths(now_m),
        "low": (now_m / KERB_STEP_M).floor() * KERB_STEP_M,
        "high": MOST_KERB_M,
        "step": KERB_STEP_M,
        "need": row.as_ref().and_then(|row| row.need_kerb_radius_m),
        "need_flare": row.as_ref().and_then(|row| row.need_flare_m),
    }))
}
