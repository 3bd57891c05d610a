//! Overture's GeoParquet, beside a GeoJSON file with the other kind of features. What is accepted keeps what `Extract` promises of its arrays,
//! and has a segment for every way. Panics of the library of the format are caught by the reader, and end no run.
#![no_main]

use libfuzzer_sys::fuzz_target;
use netcert_fuzz::{check_overture, file, one_thread};

/// A segment and its connectors.
const OTHERS: &str = r#"{"type": "FeatureCollection", "features": [
{"type": "Feature", "id": "c1", "geometry": {"type": "Point", "coordinates": [150, -31]}, "properties": {"type": "connector"}},
{"type": "Feature", "id": "c2", "geometry": {"type": "Point", "coordinates": [150.01, -31]}, "properties": {"type": "connector"}},
{"type": "Feature", "id": "s1", "geometry": {"type": "LineString", "coordinates": [[150, -31], [150.01, -31]]}, "properties": {"type": "segment",
"subtype": "road", "class": "secondary", "connectors": [{"connector_id": "c1", "at": 0}, {"connector_id": "c2", "at": 1}]}}]}"#;

fuzz_target!(init: one_thread(), |bytes: &[u8]| {
    let path = file("overture.parquet", bytes);
    let others = file("others.geojson", OTHERS.as_bytes());
    check_overture(&[&path, &others]);
});
