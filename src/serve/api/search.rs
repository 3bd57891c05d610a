//! Finds an edge or way by its id, or a road by its name or ref.
//!
//! Ways of one name that lie near each other are one road, so the `Hauptstraße` of each village is a separate answer.
//! Results are sorted by how well they match, then by their number of ways.

use serde_json::{Value, json};

use super::super::answer::Stored;
use super::super::ask::Ask;
use super::super::names::{NamedRoad, folded};
use super::super::problem::Problem;
use super::super::region::Region;
use super::answered;
use crate::rows::{Bounds, RoadRow};

/// The longest search text, characters.
const LONGEST: usize = 80;
const DEFAULT_LIMIT: u32 = 12;
const MOST: u32 = 50;
/// At most this many matching ways are looked at.
const MOST_WAYS: usize = 5000;
/// Ways of one name that are closer than this belong to one road, degrees. 0.01° is 1.1 km of latitude.
const NEAR_DEG: f64 = 0.01;

/// `/api/search?q=`
pub(in super::super) fn search(region: &Region, ask: &Ask) -> Result<Stored, Problem> {
    ask.only(&["q", "limit"])?;
    let asked = ask.required("q")?.trim();
    if asked.is_empty() || asked.chars().count() > LONGEST {
        return Err(Problem::parameter("q", format!("give 1 to {LONGEST} characters of a name, a ref or an id")));
    }
    let limit = ask.whole("limit", 1..=MOST)?.unwrap_or(DEFAULT_LIMIT) as usize;
    let mut results = Vec::new();
    if let Ok(number) = asked.parse::<i64>() {
        results.extend(edge(region, number)?);
        results.extend(way(region, number)?);
    }
    results.extend(named(region, &folded(asked))?);
    results.truncate(limit);
    Ok(answered(&json!(results)))
}

fn edge(region: &Region, edge_id: i64) -> Result<Option<Value>, Problem> {
    let Some(facts) = region.read(|database| database.edge_facts(edge_id))? else { return Ok(None) };
    let Some(bounds) = Bounds::around(facts.line.iter().copied()) else { return Ok(None) };
    let middle = facts.line.get(facts.line.len() / 2).map_or((0.0, 0.0), |position| position.degrees());
    let members = json!({
        "kind": "edge", "id": edge_id.to_string(), "edge_id": edge_id.to_string(),
        "name": facts.name, "ref": facts.reference, "highway": facts.highway, "ways": 1,
    });
    Ok(Some(placed(members, bounds, middle)))
}

fn way(region: &Region, way_id: i64) -> Result<Option<Value>, Problem> {
    let roads = region.names()?;
    let found = roads.binary_search_by_key(&way_id, |road| road.row.way_id).ok().and_then(|i| roads.get(i));
    Ok(found.map(|road| result("way", &[&road.row])))
}

fn named(region: &Region, asked: &str) -> Result<Vec<Value>, Problem> {
    let roads = region.names()?;
    let mut found: Vec<(u8, &NamedRoad)> =
        roads.iter().filter_map(|road| Some((road.rank(asked)?, road))).take(MOST_WAYS).collect();
    // The sort is stable, so ways of one name and ref stay in order of the network.
    found.sort_by(|a, b| (a.0, &a.1.row.name, &a.1.row.reference).cmp(&(b.0, &b.1.row.name, &b.1.row.reference)));
    let same = |a: &(u8, &NamedRoad), b: &(u8, &NamedRoad)| {
        a.0 == b.0 && a.1.row.name == b.1.row.name && a.1.row.reference == b.1.row.reference
    };
    let mut results: Vec<(u8, usize, Value)> = Vec::new();
    for group in found.chunk_by(same) {
        let rows: Vec<&RoadRow> = group.iter().map(|(_, road)| &road.row).collect();
        let rank = group.first().map_or(u8::MAX, |first| first.0);
        results.extend(clusters(&rows).iter().map(|cluster| (rank, cluster.len(), result("road", cluster))));
    }
    results.sort_by_key(|(rank, ways, _)| (*rank, std::cmp::Reverse(*ways)));
    Ok(results.into_iter().map(|(_, _, value)| value).collect())
}

/// Groups of rows that are near each other, directly or through other rows of the group.
fn clusters<'r>(rows: &[&'r RoadRow]) -> Vec<Vec<&'r RoadRow>> {
    let mut left: Vec<&RoadRow> = rows.to_vec();
    let mut clusters = Vec::new();
    while let Some(first) = left.first().copied() {
        left.remove(0);
        let mut cluster = vec![first];
        let mut next = 0;
        while let Some(from) = cluster.get(next).copied() {
            next += 1;
            let (near, far): (Vec<&RoadRow>, Vec<&RoadRow>) =
                left.iter().partition(|row| are_near(&row.bounds, &from.bounds));
            cluster.extend(near);
            left = far;
        }
        clusters.push(cluster);
    }
    clusters
}

fn are_near(a: &Bounds, b: &Bounds) -> bool {
    a.west - b.east < NEAR_DEG
        && b.west - a.east < NEAR_DEG
        && a.south - b.north < NEAR_DEG
        && b.south - a.north < NEAR_DEG
}

fn result(kind: &str, rows: &[&RoadRow]) -> Value {
    let Some(first) = rows.first() else { return Value::Null };
    let bounds = rows.iter().fold(first.bounds, |bounds, row| bounds.union(row.bounds));
    // The point for a label: the middle of the box of the middle way.
    let b = rows.get(rows.len() / 2).map_or(first.bounds, |row| row.bounds);
    let middle = (f64::midpoint(b.west, b.east), f64::midpoint(b.south, b.north));
    let members = json!({
        "kind": kind, "id": first.way_id.to_string(), "edge_id": first.edge_id.to_string(),
        "name": first.name, "ref": first.reference, "highway": first.highway, "ways": rows.len(),
    });
    placed(members, bounds, middle)
}

fn placed(mut members: Value, b: Bounds, (lon, lat): (f64, f64)) -> Value {
    let rounded = |degrees: f64| (degrees * 1e6).round() / 1e6;
    members["bbox"] = json!([b.west, b.south, b.east, b.north].map(rounded));
    members["lon"] = json!(rounded(lon));
    members["lat"] = json!(rounded(lat));
    members
}
