//! GeoJSON (RFC 7946): a collection of features, or one feature a line with or without a record separator (RFC 8142).

use geojson::{Feature, GeoJson, GeometryValue, Position, feature::Id};
use serde_json::Value;

use crate::columns::{EvidenceColumn, FileRecord, columns, is_geometry, real_text};
use crate::error::Failure;
use crate::shape::{Shape, Xy};

/// All records of a file.
pub(super) fn records(bytes: &[u8]) -> Result<Vec<FileRecord>, Failure> {
    let text = super::text(bytes)?;
    let features = match sequence(text)? {
        Some(features) => features,
        None => collection(text)?,
    };
    check_names(&features)?;
    Ok(features.iter().map(|(number, feature)| record(*number, feature)).collect())
}

type Numbered = (u64, Feature);

/// The features of a file with one feature a line, if its first line is a feature and it has others.
fn sequence(text: &str) -> Result<Option<Vec<Numbered>>, Failure> {
    let bare = |line: &'_ str| line.trim_start_matches(char::from(super::SEPARATOR)).trim().to_owned();
    let lines = || (1..).zip(text.lines().map(bare)).filter(|line| !line.1.is_empty());
    let marked = text.trim_start().starts_with(char::from(super::SEPARATOR));
    let first = lines().next().is_some_and(|(_, line)| line.parse::<Feature>().is_ok());
    if !marked && !first {
        return Ok(None);
    }
    let feature = |(number, line): (u64, String)| {
        let feature = line.parse::<Feature>();
        feature.map(|feature| (number, feature)).map_err(|error| failed(&format!("line {number}: "), &error))
    };
    lines().map(feature).collect::<Result<_, _>>().map(Some)
}

/// The features of a file that is one value.
fn collection(text: &str) -> Result<Vec<Numbered>, Failure> {
    match text.parse::<GeoJson>().map_err(|error| failed("", &error))? {
        GeoJson::FeatureCollection(collection) => {
            known_reference(collection.foreign_members.as_ref().and_then(|members| members.get("crs")))?;
            Ok((1..).zip(collection.features).collect())
        }
        GeoJson::Feature(feature) => Ok(vec![(1, feature)]),
        GeoJson::Geometry(_) => Err("a geometry without a measurement; give features".to_owned().into()),
    }
}

fn failed(line: &str, error: &geojson::Error) -> Failure {
    Failure::File(format!("{line}no GeoJSON feature: {error}; was the file written to its end?"))
}

/// GeoJSON of before 2016 may name its reference system; later it is always WGS 84.
fn known_reference(crs: Option<&Value>) -> Result<(), Failure> {
    let Some(crs) = crs.filter(|crs| !crs.is_null()) else { return Ok(()) };
    let name = crs.pointer("/properties/name").and_then(Value::as_str).unwrap_or("unknown");
    if name.ends_with("CRS84") || name.ends_with(":4326") {
        return Ok(());
    }
    Err(Failure::File(format!("its reference system is {name}; transform it to WGS 84 (EPSG:4326)")))
}

/// Checks the names of all members at once, in the order in which they first occur. A geometry as a member is a copy that GDAL
/// left there.
fn check_names(features: &[Numbered]) -> Result<(), Failure> {
    let mut seen = std::collections::HashSet::new();
    let names = features.iter().filter_map(|(_, feature)| feature.properties.as_ref()).flat_map(|all| all.keys());
    let names = names.map(String::as_str).filter(|name| seen.insert(*name) && !is_geometry(name));
    columns(names)?;
    Ok(())
}

fn record(number: u64, feature: &Feature) -> FileRecord {
    let mut record = FileRecord::new(number);
    for (name, value) in feature.properties.iter().flatten() {
        let Some(column) = EvidenceColumn::named(name).filter(|_| !is_geometry(name)) else { continue };
        match scalar(value) {
            Ok(text) => record.set(column, &text),
            Err(what) => record.fault(column, what),
        }
    }
    if record.text(EvidenceColumn::Id).is_none() {
        match &feature.id {
            Some(Id::String(id)) => record.set(EvidenceColumn::Id, id),
            Some(Id::Number(id)) => record.set(EvidenceColumn::Id, &id.to_string()),
            None => {}
        }
    }
    if let Some(geometry) = &feature.geometry {
        record.set_shape(shape(&geometry.value));
    }
    record
}

fn scalar(value: &Value) -> Result<String, String> {
    Ok(match value {
        Value::Null => String::new(),
        Value::Bool(flag) => flag.to_string(),
        Value::String(text) => text.clone(),
        Value::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
            Some(real) => real_text(real),
            None => number.to_string(),
        },
        Value::Array(_) | Value::Object(_) => return Err("is no single value; give a text or number".to_owned()),
    })
}

fn shape(geometry: &GeometryValue) -> Result<Option<Shape>, String> {
    let nonempty = |shape: Shape| Some(shape).filter(|shape| !shape.is_empty());
    match geometry {
        GeometryValue::Point { coordinates } if coordinates.is_empty() => Ok(None),
        GeometryValue::Point { coordinates } => xy(coordinates).map(|at| Some(Shape::Point(at))),
        GeometryValue::LineString { coordinates } => line(coordinates).map(Shape::Line).map(nonempty),
        GeometryValue::Polygon { coordinates } => rings(coordinates).map(Shape::Polygon).map(nonempty),
        GeometryValue::MultiPoint { coordinates } => Shape::only(line(coordinates)?, Shape::Point),
        GeometryValue::MultiLineString { coordinates } => Shape::only(rings(coordinates)?, Shape::Line),
        GeometryValue::MultiPolygon { coordinates } => {
            let polygons = coordinates.iter().map(|polygon| rings(polygon)).collect::<Result<_, _>>()?;
            Shape::only(polygons, Shape::Polygon)
        }
        GeometryValue::GeometryCollection { .. } => {
            Err("a collection of geometries; give a point, a line or a polygon".to_owned())
        }
    }
}

fn xy(position: &Position) -> Result<Xy, String> {
    match position.as_slice() {
        &[x, y, ..] => Ok([x, y]),
        _ => Err("a position has fewer than two numbers; write the file again".to_owned()),
    }
}

fn line(positions: &[Position]) -> Result<Vec<Xy>, String> {
    positions.iter().map(xy).collect()
}

fn rings(rings: &[Vec<Position>]) -> Result<Vec<Vec<Xy>>, String> {
    rings.iter().map(|ring| line(ring)).collect()
}
