//! One edge: its facts from the map, its certificates for all vehicles, and the turns that lead out of the edge and into it.

use serde_json::{Map, Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::{DecodedRequest, policy};
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::super::roads::RoadIndex;
use super::{SCOPE, answered, id};
use crate::osm::facts::WidthSource;
use crate::rows::{CertificateRow, EdgeRow};
use crate::rows::{EdgeFacts, MapTurn, SetKey};
use crate::store::{QueryOptions, TurnsOf};
use crate::words::{Named, verdict_words};

/// `/api/edges/{id}`
pub(in super::super) fn edge(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&["vehicle", "policy"])?;
    let edge_id = id(ask.name("id")?)?;
    let policy = ask.parameter("policy").map_or(Ok(region.policy), policy)?;
    let certified = ask.parameter("vehicle").map(|vehicle| region.certified(vehicle, policy)).transpose()?;
    let vehicle = certified.map(|certified| certified.vehicle);
    let facts = region.read(|database| database.edge_facts(edge_id))?;
    let facts = facts.ok_or_else(|| Problem::not_found(format!("edge {edge_id}: there is none in this database")))?;
    let mut certificates = Vec::new();
    for set in &region.sets {
        let options = QueryOptions { edge_id: Some(edge_id), ..QueryOptions::new(&set.vehicle_id, set.policy) };
        let row = region.read(|database| database.query(&options)?.next().transpose())?;
        certificates.extend(row.map(|row| certificate(&set.vehicle_id, set.policy.name(), &row)));
    }
    let turns = match vehicle {
        Some(vehicle) => {
            region.read(|db| db.map_turns(SetKey { vehicle: &vehicle.id, policy }, TurnsOf::Edge(facts.edge.index)))?
        }
        None => Vec::new(),
    };
    let wanted = |c: &&Value| vehicle.is_some_and(|v| c["vehicle"] == json!(v.id)) && c["policy"] == policy.name();
    let own = certificates.iter().find(wanted).cloned();
    let roads = region.roads()?;
    let mut members = members(&facts, &title(&roads, edge_id));
    members.insert("certificate".to_owned(), json!(own));
    members.insert("certificates".to_owned(), json!(certificates));
    members.insert("turns".to_owned(), turns.iter().map(|row| turn(&roads, row, edge_id)).collect());
    members.insert("scope".to_owned(), json!(SCOPE));
    Ok(answered(&Value::Object(members)))
}

fn members(e: &EdgeFacts, title: &str) -> Map<String, Value> {
    let line: Vec<_> = e.line.iter().map(|position| position.degrees()).collect();
    let widths = e.widths.iter().map(|(policy, width_m, source)| {
        let source = source.map(WidthSource::name);
        (policy.name().to_owned(), json!({"width_m": width_m, "width_source": source}))
    });
    let widths: Map<String, Value> = widths.collect();
    let limits = e.limits.iter().map(|(name, unit, value)| {
        let unreadable = e.unreadable_limits.iter().any(|other| other.strip_prefix("max_") == Some(*name));
        (format!("max_{name}_{unit}"), if unreadable { json!("unreadable") } else { json!(value) })
    });
    let mut legal: Map<String, Value> = limits.collect();
    legal.insert("hgv".to_owned(), json!(e.hgv.name()));
    legal.insert("motor_vehicle".to_owned(), json!(e.motor_vehicle.name()));
    legal.insert("barred".to_owned(), json!(e.barred));
    legal.insert("rules".to_owned(), json!(e.rules));
    legal.insert("open_when".to_owned(), json!(e.open_when));
    legal.insert("tags".to_owned(), json!(e.legal_tags));
    let members = json!({
        "edge_id": e.edge.id.to_string(),
        "feature_id": e.edge.index.get() + 1,
        "way_id": e.edge.way_id.to_string(),
        "from_node": e.edge.from_node.to_string(),
        "to_node": e.edge.to_node.to_string(),
        "direction": e.edge.direction.name(),
        "oneway": e.oneway.name(),
        "highway": e.road.highway,
        "name": e.road.name,
        "ref": e.road.reference,
        "title": title,
        "lanes": e.lanes,
        "maxspeed_kmh": e.maxspeed_kmh,
        "length_m": e.length_m,
        "widths": widths,
        "min_radius_m": e.min_radius_m,
        "centreline_deviation_m": e.centreline_deviation_m,
        "legal": legal,
        "cut": e.cut,
        "geometry": {"type": "LineString", "coordinates": line},
    });
    match members {
        Value::Object(members) => members,
        _ => Map::new(),
    }
}

/// What the road of an edge is called, or what it joins.
fn title(roads: &RoadIndex, edge_id: i64) -> String {
    let network = roads.network();
    let edge = roads.edge(edge_id).and_then(|edge| network.edges.get(edge.index()));
    edge.map_or_else(String::new, |edge| network.title(edge))
}

fn certificate(vehicle: &str, policy: &str, row: &EdgeRow) -> Value {
    let shown = CertificateRow { hinge_margin_deg: row.certificate.hinge_angle_deg(), ..row.certificate };
    let columns = CertificateRow::COLUMNS.iter().zip(shown.cells());
    let mut members = Map::new();
    members.insert("vehicle".to_owned(), json!(vehicle));
    members.insert("policy".to_owned(), json!(policy));
    members.extend(columns.map(|((name, _), cell)| ((*name).to_owned(), Value::from(cell))));
    members.insert("width_m".to_owned(), json!(row.width_m));
    members.insert("width_source".to_owned(), json!(row.width_source.map(WidthSource::name)));
    Value::Object(members)
}

fn turn(roads: &RoadIndex, row: &MapTurn, edge_id: i64) -> Value {
    let (verdict, reason) = verdict_words(row.verdict);
    let line: Vec<_> = row.line.iter().map(|position| position.degrees()).collect();
    json!({
        "turn_id": row.turn.id.to_string(),
        "leads": if row.turn.from_edge == edge_id { "out" } else { "in" },
        "from_edge": row.turn.from_edge.to_string(),
        "to_edge": row.turn.to_edge.to_string(),
        "from_name": row.turn.from_name,
        "to_name": row.turn.to_name,
        "title": format!("{} into {}", title(roads, row.turn.from_edge), title(roads, row.turn.to_edge)),
        "kind": row.kind,
        "angle_deg": row.angle_deg,
        "kerb_radius_m": row.kerb_radius_m,
        "restriction": row.restriction,
        "verdict": verdict,
        "reason": (!reason.is_empty()).then_some(reason),
        "rsc_m": row.rsc_mm.map(|mm| mm as f64 / 1000.0),
        "geometry": {"type": "LineString", "coordinates": line},
    })
}
