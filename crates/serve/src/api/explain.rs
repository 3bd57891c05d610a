//! Explains why an edge or a turn is safe or unsafe, and draws it. The edge or turn is certified again for the answer, and
//! every hint is certified, too.

use std::sync::Arc;

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::{DecodedRequest, policy};
use super::super::memo::Recent;
use super::super::problem::Problem;
use super::super::region::{CertifiedVehicle, RegionState};
use super::super::roads::RoadIndex;
use super::{GEOJSON, SVG, answered, id, relative, suppose};
use crate::explain::{self, Explanation, MapError};
use crate::network::{EdgeNo, Network};
use crate::osm::{LonLat, NodeId};
use crate::picture;
use crate::rows::{Measurement, SetKey};
use crate::settings::Settings;
use crate::stet::Model;
use crate::stop::Stop;
use crate::store::{QueryOptions, TurnsOf};
use crate::turns::TurnFacts;
use crate::words::Named;

/// Number of explanations to keep. Each has a picture and shapes for the map of some 100 kB.
const MOST_EXPLAINED: usize = 16;

/// The members, the picture and the shapes for a map of one explanation.
struct Explained {
    members: Value,
    picture: Option<String>,
    map: Value,
}

/// The last explanations, by id, vehicle and policy.
pub(in super::super) struct Explanations(Recent<Explained>);

impl Default for Explanations {
    fn default() -> Self {
        Self(Recent::new(MOST_EXPLAINED))
    }
}

impl Explanations {
    /// The explanation of an edge or turn. The first call makes it.
    fn of(&self, id: i64, certified: &CertifiedVehicle<'_>, stop: &Stop) -> Result<Arc<Explained>, Problem> {
        let key = format!("{id} {} {}", certified.vehicle.id, certified.set.policy.name());
        self.0.get(&key, || make(certified.region, id, certified, stop))
    }
}

/// `/api/explain/{id}`
pub(in super::super) fn explain(
    region: &RegionState,
    explanations: &Explanations,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    let (explained, id, certified) = explained(region, explanations, ask, &["vehicle", "policy", "relative_to"])?;
    let Some(reference) = ask.parameter("relative_to") else { return Ok(answered(&explained.members)) };
    let mut members = explained.members.clone();
    members["relative"] = relative::of(region, id, &certified, reference)?;
    Ok(answered(&members))
}

/// `/api/explain/{id}/picture.svg`
pub(in super::super) fn drawn(
    region: &RegionState,
    explanations: &Explanations,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    let (explained, ..) = explained(region, explanations, ask, &["vehicle", "policy"])?;
    let Some(svg) = &explained.picture else {
        let headline = explained.members["headline"].as_str().unwrap_or_default();
        return Err(Problem::not_found(format!("there is nothing to draw: {headline}")));
    };
    Ok(StoredAnswer::new(SVG, svg.clone().into_bytes()))
}

/// `/api/explain/{id}/map.geojson`
pub(in super::super) fn mapped(
    region: &RegionState,
    explanations: &Explanations,
    ask: &DecodedRequest,
) -> Result<StoredAnswer, Problem> {
    let (explained, ..) = explained(region, explanations, ask, &["vehicle", "policy"])?;
    Ok(StoredAnswer::new(GEOJSON, explained.map.to_string().into_bytes()))
}

/// The explanation, with the id and the set that it is of. `known` are the parameters that may be given.
fn explained<'r>(
    region: &'r RegionState,
    explanations: &Explanations,
    ask: &DecodedRequest,
    known: &[&str],
) -> Result<(Arc<Explained>, i64, CertifiedVehicle<'r>), Problem> {
    ask.only(known)?;
    let id = id(ask.name("id")?)?;
    let policy = ask.parameter("policy").map_or(Ok(region.policy), policy)?;
    let certified = region.certified(ask.required("vehicle")?, policy)?;
    Ok((explanations.of(id, &certified, &ask.stop)?, id, certified))
}

fn make(region: &RegionState, id: i64, certified: &CertifiedVehicle<'_>, stop: &Stop) -> Result<Explained, Problem> {
    let settings = &certified.settings;
    let roads = region.roads()?;
    let model = Model::new(certified.vehicle).map_err(|error| Problem::fault(error.to_string()))?;
    let mut explained = match roads.edge(id) {
        Some(edge) => of_edge(region, &roads, edge, &model, settings, stop)?,
        None => of_turn(region, &roads, id, &model, settings, stop)?,
    };
    explained.members["policy"] = json!(settings.policy.name());
    explained.members["picture"] = json!(explained.picture.is_some());
    Ok(explained)
}

fn of_edge(
    region: &RegionState,
    roads: &RoadIndex,
    edge: EdgeNo,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Explained, Problem> {
    let network = roads.network();
    let explanation = explain::explain_edge(network, edge, model, settings, stop)?;
    let explanation = explanation.ok_or_else(|| Problem::fault(format!("edge {edge} is not in the network")))?;
    let edge_id = network.edges.get(edge.index()).map(|edge| edge.id);
    let options = QueryOptions { edge_id, ..QueryOptions::new(&model.vehicle.id, settings.policy) };
    let row = region.read(|database| database.query(&options)?.next().transpose())?;
    if let Some(detail) = row.as_ref().and_then(|row| explanation.disagreement(&row.certificate)) {
        return Err(Problem::stale(format!(
            "the certificate in the database is not what this program computes: {detail}; run `netcert certify \
             --vehicle {} --corridor {}`",
            model.vehicle.id,
            settings.policy.name()
        )));
    }
    let mut members = explain::json(&explanation);
    members["kind"] = json!("edge");
    members["at"] = json!(limiting_place(network, edge, &explanation));
    members["suppose"] = suppose::of_edge(network, edge, model, settings, row.as_ref());
    let measured = region.read(|database| database.measured_on(network, edge))?;
    members["measurements"] = measured.iter().map(Measurement::json).collect();
    let line = network.edges.get(edge.index()).map(|edge| network.positions(edge).collect::<Vec<_>>());
    members["geometry"] = geometry(line.as_deref());
    let mut map = explain::edge_geojson(&explanation, stop).map_err(unmapped)?;
    map["netcert"]["measurements"] = members["measurements"].clone();
    Ok(Explained { members, picture: picture::explanation(&explanation), map })
}

fn of_turn(
    region: &RegionState,
    roads: &RoadIndex,
    id: i64,
    model: &Model,
    settings: &Settings,
    stop: &Stop,
) -> Result<Explained, Problem> {
    let facts = roads.turn(id, settings)?;
    let facts =
        facts.ok_or_else(|| Problem::not_found(format!("{id}: neither an edge nor a turn of this database")))?;
    let turn = explain::explain_turn(roads.network(), &facts, model, settings, stop)?;
    let mut members = explain::json(&turn.explanation);
    members["kind"] = json!("turn");
    members["turn_id"] = json!(id.to_string());
    members["turn"] = json!(turn.title());
    let edge_id = |edge: EdgeNo| roads.network().edges.get(edge.index()).map(|edge| edge.id.to_string());
    members["junction"] = json!(via_node(roads, &facts));
    members["from_edge"] = json!(edge_id(facts.movement.from));
    members["to_edge"] = json!(edge_id(facts.movement.to));
    let node = roads.network().edges.get(facts.movement.from.index());
    let node = node.and_then(|edge| roads.network().positions(edge).next_back());
    members["at"] = json!(node.map(LonLat::degrees));
    let set = SetKey { vehicle: &model.vehicle.id, policy: settings.policy };
    let turns = region.read(|database| database.map_turns(set, TurnsOf::Edge(facts.movement.from)))?;
    members["geometry"] = geometry(turns.iter().find(|row| row.turn.id == id).map(|row| row.line.as_slice()));
    members["suppose"] = suppose::of_turn(region, &facts, set, turn.explanation.verdict)?;
    members["note"] = json!(explain::TURN_NOTE);
    let measured = region.read(|database| database.measured_at(roads.network(), &facts))?;
    members["measurements"] = measured.iter().map(Measurement::json).collect();
    let mut map = explain::turn_geojson(&turn, stop).map_err(unmapped)?;
    map["netcert"]["measurements"] = members["measurements"].clone();
    Ok(Explained { members, picture: picture::turn(&turn), map })
}

/// The node at which a turn leaves its first road.
fn via_node(roads: &RoadIndex, facts: &TurnFacts) -> Option<NodeId> {
    roads.network().edges.get(facts.movement.from.index()).map(|edge| edge.to_node)
}

fn unmapped(error: MapError) -> Problem {
    match error {
        MapError::Stopped(stopped) => stopped.into(),
        other => Problem::fault(other.to_string()),
    }
}

/// A GeoJSON line in direction of travel. Null if there is no line.
fn geometry(line: Option<&[LonLat]>) -> Value {
    let Some(line) = line else { return Value::Null };
    let line: Vec<(f64, f64)> = line.iter().map(|position| position.degrees()).collect();
    json!({"type": "LineString", "coordinates": line})
}

/// Longitude and latitude of the limiting place, on the map's line. The place is transferred by its share of the length,
/// because the corridor's centreline is another line, some decimetres away.
fn limiting_place(network: &Network, edge: EdgeNo, explanation: &Explanation) -> Option<[f64; 2]> {
    let geometry = explanation.geometry.as_ref()?;
    let share = geometry.along_m(geometry.place.station) / geometry.length_m().max(1e-9);
    let line: Vec<(f64, f64)> = network.positions(network.edges.get(edge.index())?).map(LonLat::degrees).collect();
    let shrink = line.first()?.1.to_radians().cos();
    let length = |p: &[(f64, f64)]| ((p[1].0 - p[0].0) * shrink).hypot(p[1].1 - p[0].1);
    let mut left = share.clamp(0.0, 1.0) * line.windows(2).map(length).sum::<f64>();
    for pair in line.windows(2) {
        let own = length(pair);
        if left <= own {
            let along = left / own.max(1e-12);
            let ((a, b), (c, d)) = (pair[0], pair[1]);
            return Some([a + along * (c - a), b + along * (d - b)].map(|degrees| (degrees * 1e7).round() / 1e7));
        }
        left -= own;
    }
    line.last().map(|&(lon, lat)| [lon, lat])
}
