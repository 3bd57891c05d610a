//! Finds an edge or way by its id, a place by its coordinates, or a road or named place by what people type of its name or ref.
//!
//! A road is found whole; see `search/whole.rs`. With a vehicle, each result has a summary of its certificates.

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::super::roads::RoadIndex;
use super::super::search::{Finder, Settlement, Subject, WholeRoad, coordinates};
use super::answered;
use super::road::{Told, edges_of_way, told};
use super::summary::Numbers;
use crate::network::EdgeNo;
use crate::osm::LonLat;
use crate::route::Position;
use crate::rows::{Bounds, RoadName};
use crate::words::Named as _;

/// The longest search text, characters.
const LONGEST: usize = 80;
const DEFAULT_LIMIT: u32 = 12;
const MOST: u32 = 50;
/// How far the nearest road of a place is searched, metres.
const NEAR_M: f64 = 2000.0;
/// A degree of latitude, metres.
const DEGREE_M: f64 = 111_200.0;

/// `/api/search?q=`
pub(in super::super) fn search(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&["q", "limit", "vehicle", "policy"])?;
    let asked = ask.required("q")?.trim();
    if asked.is_empty() || asked.chars().count() > LONGEST {
        return Err(Problem::parameter(
            "q",
            format!("give 1 to {LONGEST} characters of a name, a ref, an id or a place"),
        ));
    }
    let limit = ask.whole("limit", 1..=MOST)?.unwrap_or(DEFAULT_LIMIT) as usize;
    let roads = region.roads()?;
    let numbers = Numbers::asked(region, &roads, ask)?;
    let finder = region.finder()?;
    let mut results = Vec::new();
    if let Ok(number) = asked.parse::<i64>() {
        results.extend(edge(&roads, number));
        results.extend(way(&roads, number));
    }
    if let Some(place) = coordinates(asked, region.extent) {
        results.push(of_place(&roads, place));
    }
    let left = limit.saturating_sub(results.len());
    results.extend(finder.find(asked).iter().take(left).map(|hit| match hit.subject {
        Subject::Road { road, town } => whole(&roads, road, town.as_deref()),
        Subject::Settlement(settlement) => of_settlement(&roads, settlement),
    }));
    results.truncate(limit);
    let members = |(mut members, edges): (Value, Vec<EdgeNo>)| {
        let numbers = numbers.as_ref().filter(|_| !edges.is_empty());
        members["summary"] = json!(numbers.map(|numbers| numbers.summary(&roads, edges.into_iter())));
        if members.get("town").is_none() {
            members["town"] = json!(town(&finder, &members));
        }
        members
    };
    Ok(answered(&results.into_iter().map(members).collect()))
}

/// The named place in which a result lies, but for named places themselves.
fn town(finder: &Finder, members: &Value) -> Option<String> {
    let e7 = |name: &str| members[name].as_f64().map(|degrees| (degrees * 1e7).round() as i32);
    let (lon_e7, lat_e7) = e7("lon").zip(e7("lat")).filter(|_| members["settlement"].is_null())?;
    finder.town(LonLat { lon_e7, lat_e7 }).map(|town| town.name.to_string())
}

/// A result, and the edges that belong to it.
type Found = (Value, Vec<EdgeNo>);

fn edge(roads: &RoadIndex, id: i64) -> Option<Found> {
    let index = roads.edge(id)?;
    let network = roads.network();
    let bounds = Bounds::around(network.positions(network.edges.get(index.index())?))?;
    found(roads, "edge", &id.to_string(), bounds, vec![index])
}

fn way(roads: &RoadIndex, id: i64) -> Option<Found> {
    let edges: Vec<EdgeNo> = edges_of_way(roads.network(), id)?.collect();
    let network = roads.network();
    let positions = edges.iter().filter_map(|&edge| network.edges.get(edge.index()));
    let bounds = Bounds::around(positions.flat_map(|edge| network.positions(edge)))?;
    found(roads, "way", &id.to_string(), bounds, edges)
}

fn whole(roads: &RoadIndex, road: &WholeRoad, town: Option<&str>) -> Found {
    let network = roads.network();
    let edges: Vec<EdgeNo> = road.edges(network).collect();
    let id = road.ways.first().and_then(|&way| network.roads.get(way as usize)).map_or(0, |way| way.way_id);
    let Some((mut members, edges)) = found(roads, "road", &id.to_string(), road.bounds, edges) else {
        return (Value::Null, Vec::new());
    };
    let Told { road: RoadName { name, reference, .. }, title } = told(network, road);
    members["name"] = json!(name);
    members["ref"] = json!(reference);
    members["title"] = json!(title);
    members["by_ref"] = json!(road.by_ref.then_some(&road.text));
    members["ways"] = json!(road.ways.len());
    members["town"] = json!(town);
    (members, edges)
}

/// A place with the road nearest to it.
fn of_place(roads: &RoadIndex, place: Position) -> Found {
    let here = Bounds { west: place.lon, south: place.lat, east: place.lon, north: place.lat };
    let name = format!("{:.5}, {:.5}", place.lat, place.lon);
    let nearest = roads.nearest(place, NEAR_M);
    let network = roads.network();
    let edge = nearest.and_then(|(edge, _)| network.edges.get(edge.index()));
    let beside = edge.zip(nearest).map(|(edge, (_, m))| format!("{name}: {m:.0} m from {}", network.title(edge)));
    let mut members = json!({
        "kind": "place",
        "id": format!("{:.6},{:.6}", place.lon, place.lat),
        "edge_id": edge.map(|edge| edge.id.to_string()),
        "name": name,
        "ref": null,
        "title": beside.unwrap_or(name),
        "by_ref": null,
        "settlement": null,
        "highway": edge.map(|edge| network.road(edge)).map(|road| crate::osm::facts::highway(road.class, road.link)),
        "ways": 0,
        "pieces": 0,
    });
    placed(&mut members, here, place);
    (members, Vec::new())
}

/// A town, village or other named place. Its box is as wide as the place is taken to reach.
fn of_settlement(roads: &RoadIndex, settlement: &Settlement) -> Found {
    let (lon, lat) = settlement.at.degrees();
    let (mut members, edges) = of_place(roads, Position { lon, lat });
    let half_deg = settlement.reach_m() / 3.0 / DEGREE_M;
    let (east, north) = (half_deg / lat.to_radians().cos().max(0.01), half_deg);
    let here = Bounds { west: lon - east, south: lat - north, east: lon + east, north: lat + north };
    members["name"] = json!(settlement.name);
    members["title"] = json!(settlement.name);
    members["settlement"] = json!(settlement.kind.name());
    placed(&mut members, here, Position { lon, lat });
    (members, edges)
}

/// The members of a result. Its point is a vertex of its middle edge.
fn found(roads: &RoadIndex, kind: &str, id: &str, bounds: Bounds, edges: Vec<EdgeNo>) -> Option<Found> {
    let network = roads.network();
    let middle = network.edges.get(edges.get(edges.len() / 2)?.index())?;
    let line: Vec<_> = network.positions(middle).collect();
    let road = network.road(middle);
    let text = |id: Option<crate::osm::StringId>| id.map(|id| network.strings.text(id));
    let mut members = json!({
        "kind": kind,
        "id": id,
        "edge_id": middle.id.to_string(),
        "name": text(road.name),
        "ref": text(road.reference),
        "title": network.title(middle),
        "by_ref": null,
        "settlement": null,
        "highway": crate::osm::facts::highway(road.class, road.link),
        "ways": 1,
        "pieces": edges.len(),
    });
    let (lon, lat) = line.get(line.len() / 2)?.degrees();
    placed(&mut members, bounds, Position { lon, lat });
    Some((members, edges))
}

fn placed(members: &mut Value, b: Bounds, at: Position) {
    let rounded = |degrees: f64| (degrees * 1e6).round() / 1e6;
    members["bbox"] = json!([b.west, b.south, b.east, b.north].map(rounded));
    members["lon"] = json!(rounded(at.lon));
    members["lat"] = json!(rounded(at.lat));
}
