//! Turns the region's source (TOML, described at the head of `data/demo/region.toml`) into nodes and ways.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result, bail, ensure};
use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord};
use serde::Deserialize;

use super::alignment::{Corner, Point, align, circle, direction, distance, offset};
use super::junctions::{Line, Vertex, join};

type Tags = BTreeMap<String, String>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Source {
    name: String,
    /// Longitude and latitude of the point 0 0, degrees.
    origin: [f64; 2],
    style: BTreeMap<String, Tags>,
    road: Vec<Road>,
    #[serde(default)]
    roundabout: Vec<Roundabout>,
    #[serde(default)]
    point: Vec<Spot>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Road {
    id: String,
    like: String,
    #[serde(default)]
    tags: Tags,
    line: String,
    /// Distance of two one-way carriageways, metres: `ID.out` (left of the line) and `ID.back`.
    dual_m: Option<f64>,
    /// Whether the road is cut into one way per block.
    #[serde(default)]
    blocks: bool,
    #[serde(default)]
    change: Vec<Change>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Change {
    from: f64,
    to: f64,
    tags: Tags,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Roundabout {
    at: Point,
    radius_m: f64,
    like: String,
    #[serde(default)]
    tags: Tags,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Spot {
    on: String,
    at: f64,
    tags: Tags,
}

/// The drawn region.
pub(crate) struct Map {
    /// The region's name.
    pub(crate) name: String,
    /// Nodes, with ids ascending from 1.
    pub(crate) nodes: Vec<NodeRecord>,
    /// Ways, with ids ascending from 1.
    pub(crate) ways: Vec<WayRecord>,
    /// Total length of the ways, metres.
    pub(crate) length_m: f64,
}

/// A line with the tags of its ways.
struct Drawn<'s> {
    id: String,
    tags: Tags,
    changes: &'s [Change],
    blocks: bool,
    line: Line,
}

/// The nodes and ways of a source.
pub(crate) fn draw(text: &str) -> Result<Map> {
    let source: Source = toml::from_str(text)?;
    let mut drawn: Vec<Drawn<'_>> = Vec::new();
    for road in &source.road {
        let lines = road_lines(&source, road, &drawn).with_context(|| format!("road {}", road.id))?;
        drawn.extend(lines);
    }
    for roundabout in &source.roundabout {
        drawn.iter_mut().for_each(|d| trim(&mut d.line, roundabout));
        drawn.push(ring(&source, roundabout)?);
    }
    for spot in &source.point {
        let found = drawn.iter_mut().find(|d| d.id == spot.on);
        let on = found.with_context(|| format!("point on {}: no such line", spot.on))?;
        cut(&mut on.line, spot.at).with_context(|| format!("point on {} at {}", spot.on, spot.at))?;
    }
    let mut lines: Vec<Line> = drawn.iter().map(|d| d.line.clone()).collect();
    join(&mut lines);
    for (d, line) in drawn.iter_mut().zip(lines) {
        d.line = line;
    }
    Ok(write(&source, &drawn))
}

fn road_lines<'s>(source: &Source, road: &'s Road, drawn: &[Drawn<'_>]) -> Result<Vec<Drawn<'s>>> {
    let corners: Vec<Corner> = road
        .line
        .lines()
        .map(str::trim)
        .filter(|l| !l.is_empty())
        .map(|l| corner(l, drawn).with_context(|| format!("corner \"{l}\"")))
        .collect::<Result<_>>()?;
    ensure!(corners.len() >= 2, "a road has at least two corners");
    let axis = align(&corners)?;
    let stations = stations(&axis);
    let tags = tags_of(source, &road.like, &road.tags)?;
    let line = |suffix: &str, points: Vec<Point>, backwards: bool| -> Result<Drawn<'s>> {
        let mut vertices: Vec<Vertex> = points
            .into_iter()
            .zip(&stations)
            .map(|(at, &station_m)| Vertex { station_m, at, junction: None })
            .collect();
        if backwards {
            vertices.reverse();
        }
        let mut line = Line { layers: vec![0; vertices.len() - 1], vertices };
        for change in &road.change {
            cut(&mut line, change.from)?;
            cut(&mut line, change.to)?;
        }
        let id = format!("{}{suffix}", road.id);
        let mut drawn = Drawn { id, tags: tags.clone(), changes: &road.change, blocks: road.blocks, line };
        drawn.line.layers = (0..drawn.line.layers.len()).map(|i| layer(&segment_tags(&drawn, i))).collect();
        Ok(drawn)
    };
    match road.dual_m {
        None => Ok(vec![line("", axis, false)?]),
        Some(apart_m) => Ok(vec![
            line(".out", offset(&axis, apart_m / 2.0), false)?,
            line(".back", offset(&axis, -apart_m / 2.0), true)?,
        ]),
    }
}

/// Parses `X Y [Rradius] [Cclothoid]`, or `@LINE STATION [LEFT] …` for a place `LEFT` metres to the left of a line
/// already drawn.
fn corner(text: &str, drawn: &[Drawn<'_>]) -> Result<Corner> {
    let mut words = text.split_whitespace().peekable();
    let mut first = words.next().context("empty")?;
    let (mut numbers, mut radius_m, mut clothoid_m) = (Vec::new(), 0.0, 0.0);
    let on = first.strip_prefix('@');
    if on.is_some() {
        first = words.next().context("a station is missing")?;
    }
    for word in std::iter::once(first).chain(words) {
        match word.split_at(1) {
            ("R", radius) => radius_m = radius.parse()?,
            ("C", length) => clothoid_m = length.parse()?,
            _ => numbers.push(word.parse::<f64>()?),
        }
    }
    let at = match (on, numbers.as_slice()) {
        (None, &[x, y]) => [x, y],
        (Some(id), &[station]) => beside(id, station, 0.0, drawn)?,
        (Some(id), &[station, left]) => beside(id, station, left, drawn)?,
        _ => bail!("expected two coordinates, or a line and a station"),
    };
    Ok(Corner { at, radius_m, clothoid_m })
}

fn beside(id: &str, station_m: f64, left_m: f64, drawn: &[Drawn<'_>]) -> Result<Point> {
    let line = &drawn.iter().find(|d| d.id == id).with_context(|| format!("no line {id} before this one"))?.line;
    let found = line.vertices.windows(2).find(|w| holds(w, station_m));
    let pair = found.with_context(|| format!("{id} has no station {station_m}"))?;
    let t = (station_m - pair[0].station_m) / (pair[1].station_m - pair[0].station_m);
    let (a, b) = (pair[0].at, pair[1].at);
    let along = direction(a, b);
    Ok([a[0] + t * (b[0] - a[0]) - left_m * along[1], a[1] + t * (b[1] - a[1]) + left_m * along[0]])
}

fn holds(pair: &[Vertex], station_m: f64) -> bool {
    let (a, b) = (pair[0].station_m, pair[1].station_m);
    a.min(b) <= station_m && station_m <= a.max(b)
}

/// Ensures a vertex at a station.
fn cut(line: &mut Line, station_m: f64) -> Result<()> {
    if line.vertices.iter().any(|v| (v.station_m - station_m).abs() < 0.05) {
        return Ok(());
    }
    let found = line.vertices.windows(2).position(|w| holds(w, station_m));
    let i = found.with_context(|| format!("there is no station {station_m}"))?;
    let (a, b) = (line.vertices[i], line.vertices[i + 1]);
    let t = (station_m - a.station_m) / (b.station_m - a.station_m);
    let at = [a.at[0] + t * (b.at[0] - a.at[0]), a.at[1] + t * (b.at[1] - a.at[1])];
    line.vertices.insert(i + 1, Vertex { station_m, at, junction: None });
    line.layers.insert(i, line.layers[i]);
    Ok(())
}

/// Removes the parts at a line's ends that lie inside a roundabout.
fn trim(line: &mut Line, roundabout: &Roundabout) {
    let inside = |v: &Vertex| distance(v.at, roundabout.at) < roundabout.radius_m - 0.5;
    for _ in 0..2 {
        if let Some(kept) = line.vertices.iter().position(|v| !inside(v)).filter(|&kept| kept > 0) {
            let (a, b) = (line.vertices[kept - 1], line.vertices[kept]);
            let (mut near, mut far) = (0.0, 1.0);
            for _ in 0..60 {
                let t = f64::midpoint(near, far);
                let at = [a.at[0] + t * (b.at[0] - a.at[0]), a.at[1] + t * (b.at[1] - a.at[1])];
                if distance(at, roundabout.at) < roundabout.radius_m { near = t } else { far = t }
            }
            let at = [a.at[0] + far * (b.at[0] - a.at[0]), a.at[1] + far * (b.at[1] - a.at[1])];
            let station_m = a.station_m + far * (b.station_m - a.station_m);
            line.vertices.drain(..kept - 1);
            line.layers.drain(..kept - 1);
            line.vertices[0] = Vertex { station_m, at, junction: None };
        }
        line.vertices.reverse();
        line.layers.reverse();
    }
}

fn ring<'s>(source: &Source, roundabout: &Roundabout) -> Result<Drawn<'s>> {
    let mut points = circle(roundabout.at, roundabout.radius_m);
    points.extend(points.first().copied());
    let tags = tags_of(source, &roundabout.like, &roundabout.tags)?;
    let vertices: Vec<Vertex> = stations(&points)
        .into_iter()
        .zip(&points)
        .map(|(station_m, &at)| Vertex { station_m, at, junction: None })
        .collect();
    let line = Line { layers: vec![0; vertices.len() - 1], vertices };
    Ok(Drawn { id: "roundabout".into(), tags, changes: &[], blocks: false, line })
}

fn stations(points: &[Point]) -> Vec<f64> {
    let mut along = 0.0;
    let mut stations = vec![0.0];
    for pair in points.windows(2) {
        along += distance(pair[0], pair[1]);
        stations.push(along);
    }
    stations
}

fn tags_of(source: &Source, style: &str, own: &Tags) -> Result<Tags> {
    let mut tags = source.style.get(style).with_context(|| format!("no style {style}"))?.clone();
    overlay(&mut tags, own);
    Ok(tags)
}

/// Later tags replace earlier ones. The value `-` removes a tag.
fn overlay(tags: &mut Tags, own: &Tags) {
    for (key, value) in own {
        if value == "-" {
            tags.remove(key);
        } else {
            tags.insert(key.clone(), value.clone());
        }
    }
}

fn segment_tags(drawn: &Drawn<'_>, segment: usize) -> Tags {
    let mut tags = drawn.tags.clone();
    let pair = &drawn.line.vertices[segment..segment + 2];
    let middle = f64::midpoint(pair[0].station_m, pair[1].station_m);
    drawn.changes.iter().filter(|c| c.from <= middle && middle <= c.to).for_each(|c| overlay(&mut tags, &c.tags));
    tags
}

fn layer(tags: &Tags) -> i32 {
    tags.get("layer").and_then(|l| l.parse().ok()).unwrap_or(0)
}

/// Cuts the lines into ways where their tags change, and numbers everything in drawing order.
fn write(source: &Source, drawn: &[Drawn<'_>]) -> Map {
    let mut map = Map { name: source.name.clone(), nodes: Vec::new(), ways: Vec::new(), length_m: 0.0 };
    let mut shared: BTreeMap<usize, i64> = BTreeMap::new();
    for d in drawn {
        let vertices = &d.line.vertices;
        let mut refs: Vec<i64> = vertices.iter().map(|v| node(source, &mut map, &mut shared, v)).collect();
        if distance(vertices[0].at, vertices[vertices.len() - 1].at) < 1e-9 && vertices[0].junction.is_none() {
            map.nodes.pop();
            refs[vertices.len() - 1] = refs[0];
        }
        for spot in source.point.iter().filter(|s| s.on == d.id) {
            let nearest = (0..vertices.len())
                .min_by(|&a, &b| {
                    let away = |i: usize| (vertices[i].station_m - spot.at).abs();
                    away(a).total_cmp(&away(b))
                })
                .unwrap_or(0);
            if let Some(n) = map.nodes.iter_mut().find(|n| n.id == refs[nearest]) {
                n.tags.extend(spot.tags.clone());
            }
        }
        let mut start = 0;
        for i in 1..vertices.len() {
            map.length_m += distance(vertices[i - 1].at, vertices[i].at);
            let last = i + 1 == vertices.len();
            let block_ends = d.blocks && vertices[i].junction.is_some();
            if last || block_ends || segment_tags(d, i) != segment_tags(d, i - 1) {
                let tags = segment_tags(d, i - 1).into_iter().collect();
                map.ways.push(WayRecord { id: map.ways.len() as i64 + 1, refs: refs[start..=i].to_vec(), tags });
                start = i;
            }
        }
    }
    map
}

/// The node of a vertex: its junction's node if that exists, otherwise a new one.
fn node(source: &Source, map: &mut Map, shared: &mut BTreeMap<usize, i64>, vertex: &Vertex) -> i64 {
    if let Some(&id) = vertex.junction.and_then(|j| shared.get(&j)) {
        return id;
    }
    let id = map.nodes.len() as i64 + 1;
    map.nodes.push(NodeRecord { id, place: place(source.origin, vertex.at), tags: Vec::new() });
    if let Some(junction) = vertex.junction {
        shared.insert(junction, id);
    }
    id
}

/// Degrees of a point by the ellipsoid's radii of curvature at the origin. Lengths are exact at the origin, and 0.1 %
/// wrong ten kilometres north or south of it.
fn place(origin: [f64; 2], at: Point) -> LonLat {
    let (a, e2) = (6_378_137.0, 0.006_694_379_990_14);
    let lat = origin[1].to_radians();
    let w = (1.0 - e2 * lat.sin() * lat.sin()).sqrt();
    let (meridian_m, normal_m) = (a * (1.0 - e2) / (w * w * w), a / w);
    let lon_deg = origin[0] + (at[0] / (normal_m * lat.cos())).to_degrees();
    let lat_deg = origin[1] + (at[1] / meridian_m).to_degrees();
    LonLat { lon_e7: (lon_deg * 1e7).round() as i32, lat_e7: (lat_deg * 1e7).round() as i32 }
}
