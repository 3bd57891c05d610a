//! A whole road as GeoJSON, with a summary of its certificates.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::super::answer::StoredAnswer;
use super::super::ask::DecodedRequest;
use super::super::problem::Problem;
use super::super::region::RegionState;
use super::super::roads::RoadIndex;
use super::super::search::{WholeRoad, edges_of};
use super::summary::Numbers;
use super::{GEOJSON, SCOPE, id};
use crate::network::{EdgeNo, Network};
use crate::osm::StringId;
use crate::osm::facts::highway;
use crate::rows::{Bounds, RoadName};
use crate::words::{Named as _, verdict_words};

/// More edges are not drawn. The summary counts them all.
const MOST_EDGES: usize = 20_000;

/// What a road is called.
pub(super) struct Told {
    pub(super) road: RoadName,
    pub(super) title: String,
}

/// `/api/road?way=`
pub(in super::super) fn road(region: &RegionState, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&["way", "ref", "vehicle", "policy"])?;
    let way_id = id(ask.required("way")?)?;
    let roads = region.roads()?;
    let numbers = Numbers::asked(region, &roads, ask)?;
    let network = roads.network();
    let no_way = || Problem::not_found(format!("way {way_id}: there is no road of this way in this database"));
    let way = network.roads.binary_search_by_key(&way_id, |road| road.way_id).map_err(|_| no_way())? as u32;
    let finder = region.finder()?;
    let whole = match ask.parameter("ref") {
        Some(text) => {
            let found =
                finder.roads().find(|road| road.by_ref && *road.text == *text && road.ways.binary_search(&way).is_ok());
            let found =
                found.ok_or_else(|| Problem::not_found(format!("way {way_id}: it is part of no road of this ref")))?;
            Some(found)
        }
        // By its name if it has one, otherwise by its first ref.
        None => finder.roads().find(|road| road.ways.binary_search(&way).is_ok()),
    };
    let (edges, told) = match whole {
        Some(whole) => (whole.edges(network).collect(), told(network, whole)),
        None => {
            let edges: Vec<EdgeNo> = edges_of(network, way).collect();
            let told = unnamed(network, &edges).ok_or_else(no_way)?;
            (edges, told)
        }
    };
    Ok(StoredAnswer::new(GEOJSON, members(&roads, &edges, &told, numbers.as_ref()).to_string().into_bytes()))
}

fn members(roads: &RoadIndex, edges: &[EdgeNo], told: &Told, numbers: Option<&Numbers>) -> Value {
    let network = roads.network();
    let drawn = edges.iter().take(MOST_EDGES);
    let features: Vec<Value> = drawn.filter_map(|&edge| feature(network, edge, numbers)).collect();
    let positions = edges.iter().filter_map(|&edge| network.edges.get(edge.index()));
    let bounds = Bounds::around(positions.flat_map(|edge| network.positions(edge)));
    json!({
        "type": "FeatureCollection",
        "bbox": bounds.map(|b| [b.west, b.south, b.east, b.north]),
        "title": told.title,
        "name": told.road.name,
        "ref": told.road.reference,
        "highway": told.road.highway,
        "pieces": edges.len(),
        "complete": edges.len() <= MOST_EDGES,
        "summary": numbers.map(|numbers| numbers.summary(roads, edges.iter().copied())),
        "scope": SCOPE,
        "features": features,
    })
}

fn feature(network: &Network, index: EdgeNo, numbers: Option<&Numbers>) -> Option<Value> {
    let edge = network.edges.get(index.index())?;
    let line: Vec<(f64, f64)> = network.positions(edge).map(crate::osm::LonLat::degrees).collect();
    let own = numbers.and_then(|numbers| numbers.of(index));
    let words = own.map(|own| verdict_words(own.verdict));
    let id = edge.id.to_string();
    Some(json!({
        "type": "Feature",
        "id": id,
        "geometry": {"type": "LineString", "coordinates": line},
        "properties": {
            "edge_id": id,
            "way_id": network.road(edge).way_id.to_string(),
            "direction": edge.direction.name(),
            "verdict": words.map(|words| words.0),
            "reason": words.map(|words| words.1).filter(|reason| !reason.is_empty()),
            "rsc_m": own.and_then(|own| own.rsc_mm).map(|mm| mm as f64 / 1000.0),
        },
    }))
}

/// The edges of a way by its id.
pub(super) fn edges_of_way(network: &Network, way_id: i64) -> Option<impl Iterator<Item = EdgeNo> + use<>> {
    let way = network.roads.binary_search_by_key(&way_id, |road| road.way_id).ok()?;
    Some(edges_of(network, way as u32)).filter(|edges| edges.len() > 0)
}

/// Name, ref and class that most edges of a road have. The one that the road is one by comes first in its title.
pub(super) fn told(network: &Network, whole: &WholeRoad) -> Told {
    let (mut names, mut refs, mut classes) = (Votes::default(), Votes::default(), BTreeMap::<String, usize>::new());
    for &way in &whole.ways {
        let Some(road) = network.roads.get(way as usize) else { continue };
        let pieces = edges_of(network, way).len();
        *names.0.entry(road.name).or_default() += pieces;
        *refs.0.entry(road.reference).or_default() += pieces;
        *classes.entry(highway(road.class, road.link)).or_default() += pieces;
    }
    let text = |id: Option<StringId>| id.map(|id| network.strings.text(id).to_owned());
    let (name, reference) = (text(names.most()), text(refs.most()));
    let highway = classes.into_iter().max_by_key(|(_, pieces)| *pieces).map_or_else(String::new, |most| most.0);
    let own = Some(whole.text.to_string());
    let (name, reference) = if whole.by_ref { (name, own) } else { (own, reference) };
    let title = reference.iter().chain(&name).map(String::as_str).collect::<Vec<_>>().join(" ");
    Told { road: RoadName { highway, name, reference }, title }
}

fn unnamed(network: &Network, edges: &[EdgeNo]) -> Option<Told> {
    let edge = network.edges.get(edges.first()?.index())?;
    let road = network.road(edge);
    let road = RoadName { highway: highway(road.class, road.link), name: None, reference: None };
    Some(Told { road, title: network.title(edge) })
}

/// How many edges have each text.
#[derive(Default)]
struct Votes(BTreeMap<Option<StringId>, usize>);

impl Votes {
    /// The text that most edges have, or none if more edges have none.
    fn most(&self) -> Option<StringId> {
        self.0.iter().max_by_key(|(_, pieces)| **pieces).and_then(|(id, _)| *id)
    }
}
