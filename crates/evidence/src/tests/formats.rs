//! The same rows in all formats, and what each format refuses.

use std::path::Path;

use super::super::{MeasurementRow, read};
use super::write::{Drawn, Table, csv, geojson, geojson_lines, geopackage, read_as, refusal, temporary};

/// Rows of every kind. Ids of edges have 63 bits.
pub(super) fn table() -> Table {
    let columns = vec![
        "id", "quantity", "value", "unit", "sigma", "source", "date", "way_id", "edge_id", "junction", "vehicle",
        "name", "note",
    ];
    let row = |text: &str, drawn| (text.split('|').map(str::to_owned).collect(), drawn);
    let line = vec![[8.691_234_5, 49.41], [8.692, 49.410_001_2]];
    let ring = vec![[8.69, 49.41], [8.70, 49.41], [8.70, 49.42], [8.69, 49.41]];
    let rows = vec![
        row("a|lane_width|3.25||0.05|office|2026-05-31||9007199254740993|||Haupt, \"Straße\"|", Drawn::Nothing),
        row("b|carriageway_width|725|cm||office||12|||||x", Drawn::Nothing),
        row("c|max_weight|7500|kg||office||||||Weg|", Drawn::Line(line)),
        row("d|kerb_radius|6||1|office||||4611686018427387905|||", Drawn::Nothing),
        row("e|drivable_by||||office|||||EU-SEMI16.5||", Drawn::Point([8.69, -49.41])),
        row("f|surface||||office|||||||", Drawn::Polygon(vec![ring])),
    ];
    Table { columns, rows }
}

/// The rows of a file that `write` makes, numbered from 1.
fn through(name: &str, write: impl Fn(&Table, &Path)) -> Vec<MeasurementRow> {
    let (_folder, path) = temporary(name);
    write(&table(), &path);
    let mut rows = read(&path).unwrap();
    rows.iter_mut().zip(1..).for_each(|(row, number)| row.number = number);
    rows
}

fn wgs84(table: &Table, path: &Path) {
    geopackage(table, path, 4326, "");
}

#[test]
fn all_formats_give_the_same_rows() {
    let rows = through("rows.csv", csv);
    assert_eq!(rows.len(), 6);
    assert_eq!(through("rows.geojson", geojson), rows);
    assert_eq!(through("rows.geojsonl", geojson_lines), rows);
    assert_eq!(through("rows.gpkg", wgs84), rows);
    // Without a name that tells, the content does.
    assert_eq!(through("rows", geojson), rows);
    assert_eq!(through("rows", wgs84), rows);
    #[cfg(feature = "geoparquet")]
    for compression in [parquet::basic::Compression::UNCOMPRESSED, parquet::basic::Compression::SNAPPY] {
        let write = |table: &Table, path: &Path| super::write::geoparquet(table, path, compression, super::write::GEO);
        assert_eq!(through("rows.parquet", write), rows);
        assert_eq!(through("rows", write), rows);
    }
}

#[cfg(feature = "geoparquet")]
#[test]
fn a_parquet_file_of_another_kind_is_refused_by_name() {
    use super::write::GEO;
    use parquet::basic::Compression;
    let refused = |geo: &str| {
        let (_folder, path) = temporary("rows.parquet");
        super::write::geoparquet(&table(), &path, Compression::SNAPPY, geo);
        refusal(read(&path))
    };
    let utm =
        r#"{"encoding": "WKB", "crs": {"name": "ETRS89 / UTM zone 32N", "id": {"authority": "EPSG", "code": 25832}}}"#;
    let utm = GEO.replace(r#"{"encoding": "WKB"}"#, utm);
    assert!(refused(&utm).contains("its reference system is EPSG:25832; transform it"), "{}", refused(&utm));
    let unknown = GEO.replace(r#""WKB""#, r#""WKB", "crs": null"#);
    assert!(refused(&unknown).contains("its reference system is unknown"), "{}", refused(&unknown));
    let native = GEO.replace("WKB", "linestring");
    assert!(refused(&native).contains("encoded as linestring; write them as WKB"), "{}", refused(&native));
    assert!(refused("").contains("unknown column `shape`"), "{}", refused(""));
    let named = GEO.replace(r#""WKB""#, r#""WKB", "crs": {"id": {"authority": "OGC", "code": "CRS84"}}"#);
    let (_folder, path) = temporary("rows.parquet");
    super::write::geoparquet(&table(), &path, Compression::SNAPPY, &named);
    assert_eq!(read(&path).unwrap().len(), 6);
}

#[test]
fn geojson_of_another_kind_is_refused() {
    let crs = r#"{"type": "FeatureCollection", "features": [],
        "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}}"#;
    let found = refusal(read_as("rows.geojson", crs.as_bytes()));
    assert_eq!(
        found,
        "rows.geojson: its reference system is urn:ogc:def:crs:EPSG::25832; transform it to WGS 84 (EPSG:4326)"
    );
    let named = |name: &str| format!(r#"{{"type": "Feature", "geometry": null, "properties": {{"{name}": [1]}}}}"#);
    let unknown = refusal(read_as("rows.geojson", named("wide").as_bytes()));
    assert!(unknown.starts_with("rows.geojson: unknown column `wide`"), "{unknown}");
    let list = refusal(read_as("rows.geojson", named("value").as_bytes()));
    assert!(list.contains("value: is no single value"), "{list}");
    let point = refusal(read_as("rows.json", br#"{"type": "Point", "coordinates": [8, 49]}"#));
    assert!(point.contains("a geometry without a measurement"), "{point}");
    let second = "{\"type\": \"Feature\", \"geometry\": null, \"properties\": {}}\n{\"type\"\n";
    let second = refusal(read_as("rows.geojsonl", second.as_bytes()));
    assert!(second.starts_with("rows.geojsonl: line 2: no GeoJSON feature"), "{second}");
}

#[test]
fn a_record_separator_before_each_feature_is_read() {
    let properties = r#"{"quantity": "lane_width", "value": 3, "source": "office", "edge_id": 1}"#;
    let feature =
        format!("\u{1e}{{\"type\": \"Feature\", \"id\": 7, \"geometry\": null, \"properties\": {properties}}}\n");
    let rows = read_as("rows.geojsons", feature.repeat(2).as_bytes()).unwrap();
    assert_eq!(
        rows.iter().map(|row| (row.number, row.id.as_deref())).collect::<Vec<_>>(),
        [(1, Some("7")), (2, Some("7"))]
    );
}

#[test]
fn another_sqlite_file_is_refused() {
    let database = refusal(read_as("rows.gpkg", b"quantity,value\n"));
    assert!(database.contains("no GeoPackage, or one that was cut off"), "{database}");
}

/// A query of such a table ended like one without rows.
#[test]
fn a_column_whose_name_is_no_text_is_refused() {
    let (_folder, path) = temporary("rows.gpkg");
    geopackage(&table(), &path, 4326, "");
    let mut bytes = std::fs::read(&path).unwrap();
    let name = b"\"quantity\" NUMERIC";
    let at = (0..bytes.len() - name.len()).find(|&at| bytes[at..].starts_with(name)).unwrap();
    bytes[at + 3] |= 0x80;
    std::fs::write(&path, bytes).unwrap();
    let refused = refusal(read(&path));
    assert!(refused.contains("a name in its schema is not UTF-8"), "{refused}");
}

/// GDAL keeps the text of a CSV file's geometry beside the geometry that it makes of it.
#[test]
fn a_copy_of_the_geometry_does_not_matter() {
    let cells = ["lane_width", "3.5", "office", "POINT (1 1)"].map(str::to_owned).to_vec();
    let columns = vec!["quantity", "value", "source", "WKT"];
    let copied = Table { columns, rows: vec![(cells, Drawn::Point([8.0, 49.0]))] };
    let rows = |name: &str, write: &dyn Fn(&Table, &Path)| {
        let (_folder, path) = temporary(name);
        write(&copied, &path);
        read(&path).unwrap()
    };
    let expected = super::super::Place::Point(crate::osm::LonLat { lon_e7: 80_000_000, lat_e7: 490_000_000 });
    assert_eq!(rows("rows.geojson", &geojson)[0].place, expected);
    assert_eq!(rows("rows.gpkg", &wgs84)[0].place, expected);
}
