//! The metadata of a GeoParquet file: `geo` is required by the format, `pandas` keeps pandas from rounding ids.

use serde_json::{Map, Value, json};

use super::SIDES;
use crate::formats::GeoParquetVersion;
use crate::rows::Bounds;
use crate::rows::{Column, ColumnKind};

/// The member `geo` of <https://geoparquet.org/releases/v1.1.0/>: lines in the column `geometry`, their boxes in `bbox`. Version 2.0 does not
/// list `covering` and allows it.
pub(super) fn geo(version: GeoParquetVersion, bounds: Option<Bounds>) -> String {
    let covering: Map<_, _> = SIDES.iter().map(|&side| (side.to_owned(), json!(["bbox", side]))).collect();
    let mut column = json!({
        "encoding": "WKB",
        "geometry_types": ["LineString"],
        "crs": epsg_4326(),
        "edges": "planar",
        "covering": {"bbox": covering},
    });
    if let (Some(b), Some(members)) = (bounds, column.as_object_mut()) {
        members.insert("bbox".to_owned(), json!([b.west, b.south, b.east, b.north]));
    }
    let version = format!("{}.0", version.name());
    json!({"version": version, "primary_column": "geometry", "columns": {"geometry": column}}).to_string()
}

/// EPSG:4326 as PROJJSON. Every other format of this program names the same system, so that tables can be joined. Its axes are
/// latitude and longitude, but coordinates in WKB are always x and y, longitude first (GeoParquet 1.1, "Coordinate axis order").
pub(super) fn epsg_4326() -> Value {
    json!({
        "$schema": "https://proj.org/schemas/v0.7/projjson.schema.json",
        "type": "GeographicCRS",
        "name": "WGS 84",
        "datum": {
            "type": "GeodeticReferenceFrame",
            "name": "World Geodetic System 1984",
            "ellipsoid": {"name": "WGS 84", "semi_major_axis": 6_378_137, "inverse_flattening": 298.257_223_563},
        },
        "coordinate_system": {
            "subtype": "ellipsoidal",
            "axis": [
                {"name": "Geodetic latitude", "abbreviation": "Lat", "direction": "north", "unit": "degree"},
                {"name": "Geodetic longitude", "abbreviation": "Lon", "direction": "east", "unit": "degree"},
            ],
        },
        "id": {"authority": "EPSG", "code": 4326},
    })
}

/// The type of each column in pandas (<https://pandas.pydata.org/docs/development/developer.html>). Without it pandas reads a
/// column of integers with gaps as doubles, and ids of 63 bits lose their last digits.
pub(super) fn pandas(columns: &[Column]) -> String {
    let plain = columns.iter().map(|&(name, kind)| {
        let (pandas, numpy) = match kind {
            ColumnKind::Integer => ("int64", "Int64"),
            ColumnKind::Real => ("float64", "float64"),
            ColumnKind::Text => ("unicode", "object"),
            ColumnKind::Flag => ("bool", "bool"),
        };
        (name, pandas, numpy)
    });
    let columns = plain.chain([("geometry", "bytes", "object"), ("bbox", "object", "object")]);
    let columns: Vec<Value> = columns
        .map(|(name, pandas, numpy)| {
            json!({"name": name, "field_name": name, "pandas_type": pandas, "numpy_type": numpy, "metadata": null})
        })
        .collect();
    let creator = json!({"library": "netcert", "version": env!("CARGO_PKG_VERSION")});
    json!({"index_columns": [], "column_indexes": [], "columns": columns, "creator": creator, "pandas_version": "2.2.0"})
        .to_string()
}
