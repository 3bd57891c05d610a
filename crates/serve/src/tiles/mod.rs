//! Vector tiles (Mapbox Vector Tile 2.1) of a vehicle's certificates, made from the database on request.
//!
//! From zoom 11 on, a tile holds every edge of the zoom's classes whose line crosses the tile, with the database's numbers: at zooms 11
//! and 12 the RSC in whole centimetres, rounded down.
//! Only lines of less than a sixteenth of a pixel are left out. At lower zooms, nothing is drawn as certified that is not
//! certified (`overview`). The same state of the database gives the same bytes.
//!
//! | file | for |
//! | --- | --- |
//! | `grid` | the grid of tiles; conversion of degrees into tile units |
//! | `classes` | the classes of road that a zoom shows |
//! | `shape` | clipping, simplifying, rounding |
//! | `overview` | main roads at low zooms: many edges as one line |
//! | `raster` | joins lines on a raster; each segment of it shows the worst verdict that falls on it |
//! | `near` | the edges near a tile, from memory or from the file |
//! | `labels` | lines for the names of roads |
//! | `backdrop` | what lies behind the roads |
//! | `encode` | layers and features as protobuf |

pub(super) mod backdrop;
mod classes;
mod encode;
mod grid;
mod labels;
mod near;
mod overview;
mod raster;
mod shape;

use std::sync::Arc;

use geo::{Coord, Polygon};
use rayon::prelude::*;

use super::answer::StoredAnswer;
use super::ask::{self, DecodedRequest};
use super::memo::Recent;
use super::problem::Problem;
use super::region::RegionState;
use crate::osm::LonLat;
use crate::osm::facts::{Policy, WidthSource};
use crate::rows::{MapEdge, MapNumbers, MapTurn, SetKey};
use crate::stop::Stop;
use crate::store::TurnsOf;
use crate::words::{Named, verdict_words};
use classes::{FIRST_WITH_TURNS, classes};
use encode::{TagValue, TileLayer};
pub(super) use grid::MOST_ZOOM;
use grid::{EXTENT, TileAddress};
use labels::{FIRST_WITH_LABELS, Label, labels};
use overview::Overview;
pub(super) use overview::severity;

/// The media type: <https://www.iana.org/assignments/media-types/application/vnd.mapbox-vector-tile>
const KIND: &str = "application/vnd.mapbox-vector-tile";

/// Number of overviews to keep, one for each vehicle and policy. An overview takes about 60 bytes per vertex.
const MOST_OVERVIEWS: usize = 6;
/// From this zoom on, edges have all their tags. At lower zooms a tile holds thousands of edges, so tags that the map does
/// not use are left out.
const FIRST_IN_FULL: u8 = 13;

/// `/tiles/{policy}/{vehicle}/{z}/{x}/{y}.mvt`
pub(super) fn tile(region: &RegionState, overviews: &Overviews, ask: &DecodedRequest) -> Result<StoredAnswer, Problem> {
    ask.only(&[])?;
    let policy = ask::policy(ask.name("policy")?)?;
    let vehicle = region.certified(ask.name("vehicle")?, policy)?.vehicle;
    let tile = TileAddress::read(ask.name("z")?, ask.name("x")?, ask.name("y")?)?;
    Ok(StoredAnswer::new(KIND, bytes(region, overviews, SetKey { vehicle: &vehicle.id, policy }, tile)?))
}

fn bytes(region: &RegionState, overviews: &Overviews, set: SetKey<'_>, tile: TileAddress) -> Result<Vec<u8>, Problem> {
    if tile.z <= overview::LAST_ZOOM {
        let mut bytes = Vec::new();
        overviews.of(region, set)?.layer(tile).finish(&mut bytes);
        return Ok(bytes);
    }
    let bounds = tile.bounds();
    let roads = region.roads_for_tiles()?;
    let edges = near::edges(region, roads.as_deref(), set, bounds, classes(tile.z))?;
    let mut layer = TileLayer::new("edge", EXTENT as u16);
    let sides = region.sides()?;
    let lines = edges.par_iter().with_min_len(near::LEAST_IN_PARALLEL).map(|row| drawn(&row.line, tile));
    for (row, lines) in edges.iter().zip(lines.collect::<Vec<_>>()) {
        edge(&mut layer, row, &lines, sides.left(row.edge.index), tile.z);
    }
    let mut bytes = Vec::new();
    layer.finish(&mut bytes);
    if tile.z >= FIRST_WITH_LABELS {
        let mut layer = TileLayer::new("label", EXTENT as u16);
        for Label { edge, line } in labels(&edges, tile.z) {
            layer.feature(Some(u64::from(edge.edge.index) + 1), &drawn(&line, tile), |tags| {
                tags.text("name", edge.road.name.as_deref());
                tags.text("ref", edge.road.reference.as_deref());
                tags.add("highway", TagValue::Text(&edge.road.highway));
            });
        }
        layer.finish(&mut bytes);
    }
    if tile.z >= FIRST_WITH_TURNS {
        let turns = region.read(|database| database.map_turns(set, TurnsOf::Box(bounds)))?;
        let mut layer = TileLayer::new("turn", EXTENT as u16);
        for row in &turns {
            turn(&mut layer, row, tile);
        }
        layer.finish(&mut bytes);
        let junctions = region.read(|database| database.map_junctions(bounds))?;
        let mut layer = TileLayer::new("junction", EXTENT as u16);
        for (node, polygons) in &junctions {
            layer.polygons(u64::try_from(node.get()).ok(), &drawn_polygons(polygons, tile), |_| {});
        }
        layer.finish(&mut bytes);
    }
    Ok(bytes)
}

/// The last overviews, by vehicle and policy.
pub(super) struct Overviews(Recent<Overview>);

impl Default for Overviews {
    fn default() -> Self {
        Self(Recent::new(MOST_OVERVIEWS))
    }
}

impl Overviews {
    /// Makes the overviews in advance, for the first [`MOST_OVERVIEWS`] sets of certificates.
    pub(super) fn prepare(&self, region: &RegionState, stop: &Stop) -> Result<(), Problem> {
        for set in region.sets.iter().take(MOST_OVERVIEWS) {
            stop.check()?;
            self.of(region, SetKey { vehicle: &set.vehicle_id, policy: set.policy })?;
        }
        Ok(())
    }

    /// The overview of a set, from which tiles of low zooms are made. The first call makes it.
    fn of(&self, region: &RegionState, set: SetKey<'_>) -> Result<Arc<Overview>, Problem> {
        let key = format!("{} {}", set.vehicle, set.policy.name());
        self.0.get(&key, || {
            let rows = region.read(|database| database.main_roads(set, classes(overview::LAST_ZOOM)))?;
            Ok(Overview::new(&rows))
        })
    }
}

fn drawn(line: &[LonLat], tile: TileAddress) -> Vec<Vec<[i32; 2]>> {
    let line: Vec<[f64; 2]> = line.iter().map(|&position| tile.units(position)).collect();
    let tolerance = if tile.z == MOST_ZOOM { shape::FINE_TOLERANCE } else { shape::TOLERANCE };
    shape::drawn(&line, tolerance)
}

fn drawn_polygons(polygons: &[Vec<Vec<LonLat>>], tile: TileAddress) -> Vec<Vec<[i32; 2]>> {
    let ring = |ring: &Vec<LonLat>| ring.iter().map(|&position| Coord::from(tile.units(position))).collect();
    let polygon = |rings: &Vec<Vec<LonLat>>| {
        let (outer, holes) = rings.split_first()?;
        Some(Polygon::new(ring(outer), holes.iter().map(ring).collect()))
    };
    shape::drawn_polygons(&polygons.iter().filter_map(polygon).collect())
}

fn edge(layer: &mut TileLayer, row: &MapEdge<'_>, lines: &[Vec<[i32; 2]>], left: Option<bool>, z: u8) {
    let MapNumbers { length_m, width_m, width_source, verdict, rsc_mm, need_width_m, shared, uses } = row.numbers;
    let (verdict, reason) = verdict_words(verdict);
    layer.feature(Some(u64::from(row.edge.index) + 1), lines, |tags| {
        tags.only("edge_id", TagValue::Text(&row.edge.id.to_string()));
        tags.text("name", row.road.name.as_deref());
        tags.text("ref", row.road.reference.as_deref());
        tags.add("highway", TagValue::Text(&row.road.highway));
        tags.add("direction", TagValue::Text(row.edge.direction.name()));
        tags.add("oneway", TagValue::Text(row.oneway.name()));
        tags.add("verdict", TagValue::Text(verdict));
        tags.text("reason", Some(reason).filter(|reason| !reason.is_empty()));
        // Whole centimetres are as much as the page shows, and many edges share them.
        let rsc_mm = rsc_mm.map(|mm| if z < FIRST_IN_FULL { mm.div_euclid(10) * 10 } else { mm });
        tags.number("rsc_m", rsc_mm.map(metres));
        tags.truth("left", left);
        tags.truth("shared", shared.then_some(true));
        tags.text("uses", uses.map(Policy::name));
        tags.text("width_source", width_source.map(WidthSource::name));
        if z >= FIRST_IN_FULL {
            tags.add("way_id", TagValue::Whole(row.edge.way_id));
            tags.number("width_m", width_m.map(centimetre));
            tags.number("need_width_m", need_width_m);
            tags.number("length_m", Some(centimetre(length_m)));
        }
    });
}

fn turn(layer: &mut TileLayer, row: &MapTurn, tile: TileAddress) {
    let lines = drawn(&row.line, tile);
    let (verdict, reason) = verdict_words(row.verdict);
    layer.feature(Some(u64::from(row.turn.index) + 1), &lines, |tags| {
        tags.only("turn_id", TagValue::Text(&row.turn.id.to_string()));
        tags.add("from_edge", TagValue::Text(&row.turn.from_edge.to_string()));
        tags.add("to_edge", TagValue::Text(&row.turn.to_edge.to_string()));
        tags.add("kind", TagValue::Text(&row.kind));
        tags.number("angle_deg", Some(row.angle_deg));
        tags.add("verdict", TagValue::Text(verdict));
        tags.text("reason", Some(reason).filter(|reason| !reason.is_empty()));
        tags.number("rsc_m", row.rsc_mm.map(metres));
        tags.text("uses", row.uses.map(Policy::name));
    });
}

/// Metres, as in the view `certificate`. The stored millimetres were rounded down when they were written.
fn metres(mm: i64) -> f64 {
    mm as f64 / 1000.0
}

/// Metres, rounded down to a centimetre, so that a width never looks greater than it is.
fn centimetre(m: f64) -> f64 {
    (m * 100.0).floor() / 100.0
}
