//! Reads an area from `--bbox` or from the GeoJSON file of `--within`.

use std::path::Path;

use anyhow::{anyhow, bail};
use geo::{Coord, LineString, MultiPolygon, Polygon};
use geojson::{GeoJson, GeometryValue, Position};
use netcert::rows::Bounds;

/// The file is read into memory. The most detailed boundaries of countries take some tens of megabytes.
const MAX_FILE_BYTES: u64 = 256 << 20;

/// Parses `W,S,E,N` in degrees. A box with W greater than E spans the 180th meridian.
pub(crate) fn bounds(text: &str) -> Result<Bounds, String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    let &[west, south, east, north] = numbers.as_slice() else {
        return Err("give four numbers of degrees: west,south,east,north".to_owned());
    };
    let lon = |x: f64| (-180.0..=180.0).contains(&x);
    let lat = |y: f64| (-90.0..=90.0).contains(&y);
    if text.split(',').count() != 4 || !(lon(west) && lon(east) && lat(south) && lat(north)) {
        return Err("give degrees: west,south,east,north, longitudes from -180 to 180, latitudes from -90 to 90".into());
    }
    if south > north {
        return Err(format!(
            "the south edge ({south}) is north of the north edge ({north}); the order is west,south,east,north"
        ));
    }
    Ok(Bounds { west, south, east, north })
}

/// Reads all polygons of a GeoJSON file. The file may be a geometry, a feature or a collection of either.
pub(crate) fn polygons(path: &Path) -> anyhow::Result<MultiPolygon> {
    let name = path.display();
    let bytes = std::fs::metadata(path).map_err(|e| anyhow!("{name}: cannot read the area: {e}"))?.len();
    if bytes > MAX_FILE_BYTES {
        bail!("{name}: {bytes} bytes are too many for an area; simplify it");
    }
    let text = std::fs::read_to_string(path).map_err(|e| anyhow!("{name}: cannot read the area: {e}"))?;
    let geojson: GeoJson = text.parse().map_err(|e| anyhow!("{name}: not GeoJSON: {e}"))?;
    let mut found = Vec::new();
    let collected = match geojson {
        GeoJson::Geometry(geometry) => collect(&geometry.value, &mut found),
        GeoJson::Feature(feature) => feature.geometry.iter().try_for_each(|g| collect(&g.value, &mut found)),
        GeoJson::FeatureCollection(all) => {
            let geometries = all.features.iter().filter_map(|feature| feature.geometry.as_ref());
            geometries.into_iter().try_for_each(|g| collect(&g.value, &mut found))
        }
    };
    collected.map_err(|why| anyhow!("{name}: {why}"))?;
    if found.is_empty() {
        bail!("{name}: no Polygon or MultiPolygon in this file");
    }
    Ok(MultiPolygon(found))
}

fn collect(value: &GeometryValue, found: &mut Vec<Polygon>) -> Result<(), String> {
    match value {
        GeometryValue::Polygon { coordinates } => found.push(polygon(coordinates)?),
        GeometryValue::MultiPolygon { coordinates } => {
            for rings in coordinates {
                found.push(polygon(rings)?);
            }
        }
        GeometryValue::GeometryCollection { geometries } => {
            geometries.iter().try_for_each(|geometry| collect(&geometry.value, found))?;
        }
        other => return Err(format!("a {} has no inside; give Polygon or MultiPolygon", other.type_name())),
    }
    Ok(())
}

/// Written here because the conversion of the `geojson` crate panics on a position of one number.
fn polygon(rings: &[Vec<Position>]) -> Result<Polygon, String> {
    let mut rings = rings.iter().map(|ring| line(ring)).collect::<Result<Vec<_>, _>>()?.into_iter();
    let outer = rings.next().ok_or("a polygon without rings")?;
    Ok(Polygon::new(outer, rings.collect()))
}

fn line(ring: &[Position]) -> Result<LineString, String> {
    if ring.len() < 4 {
        return Err(format!(
            "a ring of {} positions; a ring needs at least four, and the last must equal the first",
            ring.len()
        ));
    }
    ring.iter().map(coord).collect::<Result<Vec<_>, _>>().map(LineString)
}

fn coord(position: &Position) -> Result<Coord, String> {
    match *position.as_slice() {
        [x, y, ..] if x.abs() <= 180.0 && y.abs() <= 90.0 => Ok(Coord { x, y }),
        ref other => Err(format!("position {other:?} is no place on earth; give longitude and latitude in degrees")),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_box_is_four_numbers_in_order() {
        assert_eq!(bounds("-83.1,39.9,-83,40").unwrap(), Bounds { west: -83.1, south: 39.9, east: -83.0, north: 40.0 });
        assert!(bounds("179,-1,-179,1").is_ok(), "across the 180th meridian");
        for wrong in ["", "1,2,3", "1,2,3,4,5", "a,1,2,3,4", "1,2,3,x", "181,0,182,1", "0,91,1,92", "0,nan,1,2"] {
            assert!(bounds(wrong).is_err(), "{wrong}");
        }
        assert!(bounds("0,2,1,1").unwrap_err().contains("north of the north"));
    }

    fn area(json: &str) -> Result<MultiPolygon, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), json).unwrap();
        polygons(file.path()).map_err(|e| e.to_string())
    }

    const RING: &str = "[[[0,0],[1,0],[1,1],[0,0]]]";

    #[test]
    fn polygons_are_found_in_every_form_of_geojson() {
        let polygon = format!(r#"{{"type":"Polygon","coordinates":{RING}}}"#);
        let feature = format!(r#"{{"type":"Feature","properties":null,"geometry":{polygon}}}"#);
        assert_eq!(area(&polygon).unwrap().0.len(), 1);
        assert_eq!(area(&feature).unwrap().0.len(), 1);
        let multi = format!(r#"{{"type":"MultiPolygon","coordinates":[{RING},{RING}]}}"#);
        let all = format!(
            r#"{{"type":"FeatureCollection","features":[{feature},
            {{"type":"Feature","properties":{{}},"geometry":{multi}}}, {{"type":"Feature","properties":{{}},"geometry":null}}]}}"#
        );
        assert_eq!(area(&all).unwrap().0.len(), 3);
    }

    #[test]
    fn what_is_no_area_is_refused_by_name() {
        for (json, said) in [
            ("roads", "not GeoJSON"),
            (r#"{"type":"Point","coordinates":[1,2]}"#, "a Point has no inside"),
            (r#"{"type":"FeatureCollection","features":[]}"#, "no Polygon"),
            (r#"{"type":"Polygon","coordinates":[]}"#, "without rings"),
            (r#"{"type":"Polygon","coordinates":[[[0,0],[1,1],[0,0]]]}"#, "a ring of 3"),
            (r#"{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,910],[0,0]]]}"#, "is no place"),
            (r#"{"type":"Polygon","coordinates":[[[0],[1],[1],[0]]]}"#, ""),
        ] {
            let refused = area(json).unwrap_err();
            assert!(refused.contains(said), "{json}: {refused}");
        }
    }
}
