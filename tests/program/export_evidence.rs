//! Every export says which measurements stand behind its permits.

use flate2::read::ZlibDecoder;
use netcert::evidence::Usage;
use osmpbfreader::fileformat::{Blob, BlobHeader};
use osmpbfreader::osmformat::HeaderBlock;
use protobuf::Message as _;
use serde_json::{Value, json};
use std::io::Read as _;

use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";

/// The drawn region with three measurements that count, of two sources, and one that does not.
fn measured() -> WorkFolder {
    let place = WorkFolder::with_demo();
    let edges: Vec<i64> = place.rows(VEHICLE).iter().map(|row| row.edge.id).take(3).collect();
    let mut text = "quantity,value,sigma,edge_id,vehicle,source,date,licence\n".to_owned();
    for (edge, source, date, licence) in [
        (edges[0], "laser", "2026-03-01", "ODbL-1.0"),
        (edges[1], "laser", "2026-05-31", "ODbL-1.0"),
        (edges[2], "\"tape, \"\"by hand\"\"\"", "", ""),
    ] {
        text += &format!("lane_width,3.4,0.02,{edge},,{source},{date},{licence}\n");
    }
    text += &format!("drivable_by,,,{},{VEHICLE},a permit,,\n", edges[0]);
    let place = place.file("measured.csv", text);
    place.netcert("evidence add measured.csv --db demo.gpkg").succeeds();
    let register = place.database().register().unwrap();
    assert_eq!(register.entries.iter().filter(|entry| entry.usage() == Some(Usage::Counts)).count(), 3);
    assert_eq!(register.entries.len(), 4);
    place
}

fn expected() -> Value {
    json!({
        "measurements": 3,
        "sources": [
            {"source": "laser", "licence": "ODbL-1.0", "count": 2, "days": ["2026-03-01", "2026-05-31"]},
            {"source": "tape, \"by hand\"", "licence": null, "count": 1, "days": null},
        ],
        "rows": "netcert evidence list",
    })
}

/// The header that a text has after a mark.
fn after(bytes: &[u8], mark: &str) -> Value {
    let at = bytes.windows(mark.len()).position(|window| window == mark.as_bytes()).expect("a header") + mark.len();
    serde_json::Deserializer::from_slice(&bytes[at..]).into_iter().next().unwrap().unwrap()
}

/// The `source` of an OSM file's header.
fn osm_source(bytes: &[u8]) -> String {
    let length = u32::from_be_bytes(bytes[..4].try_into().unwrap()) as usize;
    let header = BlobHeader::parse_from_bytes(&bytes[4..4 + length]).unwrap();
    let blob = &bytes[4 + length..4 + length + header.datasize() as usize];
    let blob = Blob::parse_from_bytes(blob).unwrap();
    let mut unpacked = Vec::new();
    ZlibDecoder::new(blob.zlib_data()).read_to_end(&mut unpacked).unwrap();
    HeaderBlock::parse_from_bytes(&unpacked).unwrap().source().to_owned()
}

#[test]
fn every_format_says_which_measurements_stand_behind_it() {
    let place = measured();
    let export = |target: &str, more: &str| {
        let line = format!("export {target} --vehicle {VEHICLE} --out {target} {more}");
        place.netcert(&line).succeeds().tells("3 measurements stand behind the certificates: laser (ODbL-1.0) 2");
    };
    let header = |name: &str| serde_json::from_slice::<Value>(&place.read(name)).unwrap()["evidence"].clone();
    for target in ["csv", "geojson", "geojsonseq", "geoparquet", "flatgeobuf", "overture", "pgrouting", "ors"] {
        export(target, "");
        assert_eq!(header(&format!("{target}/netcert.json")), expected(), "{target}");
    }
    for target in ["osrm", "valhalla"] {
        export(target, "--extract {demo}");
        assert_eq!(header(&format!("{target}/netcert.json")), expected(), "{target}");
    }
    export("osm-pbf", "--extract {demo}");
    export("graphhopper", "");
    // In the files themselves, where the format has room.
    for (name, mark) in [
        ("geojson/edges.geojson", "\"netcert\":"),
        ("geojson/turns.geojson", "\"netcert\":"),
        ("geojsonseq/edges.geojsons", "\"netcert\":"),
        ("flatgeobuf/edges.fgb", "\"evidence\":"),
        ("geoparquet/edges.parquet", "\"evidence\":"),
        ("overture/segment.geojson", "\"netcert\":"),
        ("graphhopper", "\"netcert\":"),
        ("pgrouting/header.copy", "\"evidence\":"),
    ] {
        let mut bytes = place.read(name);
        if name.starts_with("pgrouting") {
            bytes = String::from_utf8(bytes).unwrap().replace("\\\\", "\\").into_bytes();
        }
        let found = after(&bytes, mark);
        assert_eq!(found.get("evidence").unwrap_or(&found), &expected(), "{name}");
    }
    for name in ["osm-pbf", "valhalla/extract.osm.pbf"] {
        let source = osm_source(&place.read(name));
        assert_eq!(after(source.as_bytes(), "netcert: ")["evidence"], expected(), "{name}");
    }
}

#[test]
fn without_measurements_the_header_says_none_and_the_program_nothing() {
    let place = WorkFolder::with_demo();
    let told = place.netcert(&format!("export csv --vehicle {VEHICLE} --out csv")).succeeds().err();
    assert!(!told.contains("measurement"), "{told}");
    let header: Value = serde_json::from_slice(&place.read("csv/netcert.json")).unwrap();
    assert_eq!(header["evidence"], json!({"measurements": 0, "sources": [], "rows": "netcert evidence list"}));
}
