//! Writes an explanation as GeoJSON (RFC 7946), for maps and for programs such as QGIS.
//!
//! Every feature has a `part`, and the verdict with its number. The collection has the whole JSON answer as a foreign member
//! `netcert`, and with it the scope of the verdict.

use geo::orient::{Direction, Orient as _};
use geo::{LineString, MultiPolygon};
use serde_json::{Map, Value, json};

use super::json::{body_part, json as answer};
use super::map_shapes::{DrawnMotion, MapShapes};
use super::{Explanation, Geometry, TurnExplanation};
use crate::corridor::{Frame, FrameError};
use crate::osm::{LonLat, rounded};
use crate::stop::{Stop, Stopped};
use netcert_base::words::{Named as _, verdict_words};

/// What every explanation of a turn adds to its scope.
pub const TURN_NOTE: &str = "The turn by itself, on the best of its paths; its two edges have verdicts of their own. Kerb radii are \
                             assumed where they are neither surveyed nor mapped.";

/// Why an explanation cannot be drawn on a map.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The caller no longer wants it.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A shape has no place on earth.
    #[error(transparent)]
    Frame(#[from] FrameError),
}

/// An edge's explanation as a `FeatureCollection`.
///
/// # Errors
/// See [`MapError`].
pub fn edge_geojson(e: &Explanation, stop: &Stop) -> Result<Value, MapError> {
    let Some(road) = &e.road else { return Ok(collection(&answer(e), &[])) };
    let writer = Writer { e, id: ("edge_id", road.edge.id) };
    let mut header = answer(e);
    header["policy"] = json!(road.policy.name());
    Ok(collection(&header, &writer.features(MapShapes::of_edge(e, stop)?.as_ref(), &road.line)?))
}

/// A turn's explanation as a `FeatureCollection`.
///
/// # Errors
/// See [`MapError`].
pub fn turn_geojson(t: &TurnExplanation, stop: &Stop) -> Result<Value, MapError> {
    let e = &t.explanation;
    let writer = Writer { e, id: ("turn_id", t.facts.id) };
    let mut header = answer(e);
    header["policy"] = json!(t.policy.name());
    header["turn_id"] = json!(t.facts.id.to_string());
    header["turn"] = json!(t.title());
    header["turn_corridor"] = json!(t.strip.name());
    header["note"] = json!(TURN_NOTE);
    Ok(collection(&header, &writer.features(MapShapes::of_turn(t, stop)?.as_ref(), &t.facts.line)?))
}

fn collection(header: &Value, features: &[Value]) -> Value {
    json!({"type": "FeatureCollection", "name": "explanation", "netcert": header, "features": features})
}

/// Writes the features of one explanation.
struct Writer<'e> {
    e: &'e Explanation,
    /// The name of the id, and the id.
    id: (&'static str, i64),
}

impl Writer<'_> {
    /// All features. Without a corridor there is only the map's line.
    fn features(&self, drawn: Option<&MapShapes>, line: &[LonLat]) -> Result<Vec<Value>, FrameError> {
        let Some(drawn) = drawn else {
            let line: Vec<[f64; 2]> = line.iter().map(|place| rounded(place.degrees().into())).collect();
            let geometry = json!({"type": "LineString", "coordinates": line});
            return Ok(if line.len() > 1 { vec![self.feature("line", &geometry, &[])] } else { Vec::new() });
        };
        let mut out = Vec::new();
        for (part, shape) in [("area", &drawn.area), ("strip", &drawn.strip), ("beyond", &drawn.beyond)] {
            out.extend(polygons(drawn.frame, shape)?.map(|geometry| self.feature(part, &geometry, &[])));
        }
        if let (Some(motion), Some(g)) = (&drawn.motion, &self.e.geometry) {
            self.motion(&mut out, motion, g, drawn.frame)?;
        }
        Ok(out)
    }

    fn motion(&self, out: &mut Vec<Value>, motion: &DrawnMotion, g: &Geometry, frame: Frame) -> Result<(), FrameError> {
        for (i, swept) in motion.swept.iter().enumerate() {
            out.extend(polygons(frame, swept)?.map(|geometry| self.feature("swept", &geometry, &self.unit(i))));
        }
        let path = json!({"type": "LineString", "coordinates": degrees(frame, &motion.path)?});
        out.push(self.feature("path", &path, &[]));
        for (i, (unit, pose)) in self.e.vehicle.units.iter().zip(&motion.poses).enumerate() {
            let body = polygon_of(&pose.outline(unit));
            out.extend(polygons(frame, &body)?.map(|geometry| self.feature("body", &geometry, &self.unit(i))));
        }
        if g.result.closes() {
            out.push(self.feature("tightest", &point(frame, g.place.edge)?, &self.tightest(g)));
        }
        if self.e.hinge_decides() {
            let (unit, pose) = (self.e.vehicle.units.get(g.hinge.unit), g.hinge.poses.get(g.hinge.unit));
            let coupling = unit.zip(pose).map(|(unit, pose)| pose.place(unit.coupling_to_axle_m, 0.0));
            if let Some(at) = coupling {
                out.push(self.feature("hinge", &point(frame, at)?, &self.hinge(g)));
            }
        }
        Ok(())
    }

    fn unit(&self, unit: usize) -> [(&'static str, Value); 2] {
        let name = self.e.vehicle.units.get(unit).map(|unit| unit.name.as_str());
        [("unit", json!(unit)), ("unit_name", json!(name))]
    }

    /// The place of the least leeway. Room is rounded down, and what is missing is rounded up.
    fn tightest(&self, g: &Geometry) -> Vec<(&'static str, Value)> {
        let (part, ahead_m) = body_part(g.place.part);
        let leeway_m = g.result.rsc_m.unwrap_or(f64::NEG_INFINITY);
        let mut own = self.unit(g.place.unit).to_vec();
        own.extend([
            ("side", json!(g.place.side.name())),
            ("body_part", json!(part)),
            ("ahead_of_axle_m", json!(ahead_m)),
            ("s_m", json!(g.along_m(g.place.station))),
            ("leeway_m", json!((leeway_m >= 0.0).then(|| (leeway_m * 100.0 + 1e-6).floor() / 100.0))),
            ("missing_m", json!((leeway_m < 0.0).then(|| (-leeway_m * 100.0 - 1e-6).ceil() / 100.0))),
        ]);
        own
    }

    /// The hinge that turns too far, or for which no bound holds.
    fn hinge(&self, g: &Geometry) -> Vec<(&'static str, Value)> {
        let mut own = self.unit(g.hinge.unit).to_vec();
        own.extend([
            ("s_m", json!(g.along_m(g.hinge.station))),
            ("limit_deg", json!(g.hinge.limit_rad.to_degrees())),
            ("margin_deg", json!(g.result.hinge_margin_rad.map(f64::to_degrees))),
        ]);
        own
    }

    fn feature(&self, part: &str, geometry: &Value, own: &[(&'static str, Value)]) -> Value {
        let (verdict, reason) = verdict_words(self.e.verdict);
        let mut properties = Map::new();
        let common = [
            ("part", json!(part)),
            (self.id.0, json!(self.id.1.to_string())),
            ("vehicle", json!(self.e.vehicle.id)),
            ("verdict", json!(verdict)),
            ("reason", json!(Some(reason).filter(|reason| !reason.is_empty()))),
            ("rsc_m", json!(self.e.geometry.as_ref().and_then(|g| g.result.rsc_m))),
        ];
        for (name, value) in common.into_iter().chain(own.iter().cloned()) {
            properties.insert(name.to_owned(), value);
        }
        json!({"type": "Feature", "properties": properties, "geometry": geometry})
    }
}

fn polygon_of(ring: &[[f64; 2]]) -> MultiPolygon {
    MultiPolygon(vec![geo::Polygon::new(LineString::from(ring.to_vec()), Vec::new())])
}

/// A `Polygon` or a `MultiPolygon`, with exterior rings counter-clockwise. `None` if there is nothing to draw.
fn polygons(frame: Frame, shape: &MultiPolygon) -> Result<std::option::IntoIter<Value>, FrameError> {
    let mut all = Vec::new();
    for polygon in &shape.orient(Direction::Default) {
        let mut rings = Vec::new();
        for (i, ring) in std::iter::once(polygon.exterior()).chain(polygon.interiors()).enumerate() {
            let places: Vec<[f64; 2]> = ring.coords().map(|c| [c.x, c.y]).collect();
            let mut places = degrees(frame, &places)?;
            // Rounding may leave nothing of a small ring.
            let closed = places.len() > 3;
            if closed && places.first() != places.last() {
                places.extend(places.first().copied());
            }
            if closed {
                rings.push(places);
            } else if i == 0 {
                break;
            }
        }
        if !rings.is_empty() {
            all.push(rings);
        }
    }
    let geometry = match all.as_slice() {
        [] => None,
        [one] => Some(json!({"type": "Polygon", "coordinates": one})),
        several => Some(json!({"type": "MultiPolygon", "coordinates": several})),
    };
    Ok(geometry.into_iter())
}

fn point(frame: Frame, place: [f64; 2]) -> Result<Value, FrameError> {
    Ok(json!({"type": "Point", "coordinates": degrees(frame, &[place])?.first()}))
}

/// Rounded positions of places in the frame, without repeated ones.
fn degrees(frame: Frame, places: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, FrameError> {
    let mut out: Vec<[f64; 2]> = frame.inverse(places)?.into_iter().map(rounded).collect();
    out.dedup();
    Ok(out)
}
