//! Entity tags, compression, how long answers keep, and a database that changes under the server.

use std::io::Read as _;

use super::http::Server;
use super::tiles;

/// The tile of zoom 12 in the middle of the region.
fn tile(server: &Server) -> String {
    let region = server.json("/api/region");
    let side = |i: usize| region["focus"][i].as_f64().unwrap();
    let (lon, lat) = (f64::midpoint(side(0), side(2)), f64::midpoint(side(1), side(3)));
    let [x, y] = tiles::at(12, (lon, lat)).map(|c| c as u32);
    format!("/tiles/lane/AU-SEMI19/12/{x}/{y}.mvt")
}

#[test]
fn a_known_answer_is_not_sent_again() {
    let server = Server::demo();
    let tile = tile(&server);
    for target in ["/", "/api/region", "/api/vehicles", "/api/search?q=a", &tile, "/api/openapi.json"] {
        let first = server.get(target);
        let tag = first.header("etag").unwrap().to_owned();
        let again = server.with(target, &format!("If-None-Match: {tag}\r\n"));
        assert_eq!((again.status, again.body.len()), (304, 0), "{target}");
        assert_eq!(again.header("etag"), Some(tag.as_str()), "{target}");
        assert_eq!(server.with(target, "If-None-Match: \"other\"\r\n").status, 200, "{target}");
        assert_eq!(server.get(target).body, first.body, "{target}: the same again");
    }
    let wrong = server.with("/api/edges/1", "If-None-Match: *\r\n");
    assert_eq!(wrong.status, 404, "what is not there does not match");
}

#[test]
fn compressed_or_not_it_is_the_same() {
    let server = Server::demo();
    for target in ["/api/vehicles", "/api/openapi.json", "/api/stats?policy=lane"] {
        let (plain, packed) = (server.get(target), server.with(target, "Accept-Encoding: br, gzip\r\n"));
        assert_eq!((plain.header("content-encoding"), packed.header("content-encoding")), (None, Some("gzip")));
        assert!(packed.body.len() < plain.body.len());
        let mut back = Vec::new();
        flate2::read::GzDecoder::new(packed.body.as_slice()).read_to_end(&mut back).unwrap();
        assert_eq!(back, plain.body, "{target}");
        assert_ne!(plain.header("etag"), packed.header("etag"));
        assert_eq!(packed.header("vary"), Some("Accept-Encoding"));
        let refused = server.with(target, "Accept-Encoding: gzip;q=0, br\r\n");
        assert_eq!(refused.header("content-encoding"), None);
    }
}

#[test]
fn an_answer_keeps_only_under_the_state_that_it_is_of() {
    let server = Server::demo();
    let state = server.json("/api/region")["state"].as_str().unwrap().to_owned();
    let tile = tile(&server);
    let keeps = |target: &str| server.get(target).header("cache-control").unwrap().to_owned();
    assert!(keeps(&format!("{tile}?state={state}")).contains("immutable"));
    assert_eq!(keeps(&format!("{tile}?state=0123456789abcdef")), "no-cache");
    assert_eq!(keeps(&tile), "no-cache");
    assert_eq!(server.get("/nothing").header("cache-control"), Some("no-store"));
}

#[test]
fn a_database_that_changes_is_noticed_at_the_next_request() {
    let server = Server::demo();
    let before = server.json("/api/region");
    assert_eq!(before["policies"], serde_json::json!(["lane"]));
    let tile = tile(&server);
    let old = server.get(&tile);
    assert!(!old.body.is_empty());

    // The file is changed in place.
    server.place.netcert("certify --db demo.gpkg --vehicle AU-BDOUBLE26 --corridor carriageway --no-turns").succeeds();
    let changed = server.json("/api/region");
    assert_eq!(changed["policies"], serde_json::json!(["lane", "carriageway"]));
    assert_ne!((&before["state"], &before["database_hash"]), (&changed["state"], &changed["database_hash"]));
    let other = tile.replace("lane", "carriageway").replace("AU-SEMI19", "AU-BDOUBLE26");
    assert_eq!(server.get(&other).status, 200);
    assert_eq!(server.get(&tile).header("etag"), old.header("etag"), "what did not change has the same tag");
    // A tile says on which of the vehicle's strips a road is safe.
    server.place.netcert("certify --db demo.gpkg --vehicle AU-SEMI19 --corridor carriageway --no-turns").succeeds();
    assert_ne!(server.get(&tile).header("etag"), old.header("etag"));

    // Another file replaces it.
    server.place.netcert("ingest {demo} --db other.gpkg --vehicle AU-BDOUBLE26 --no-turns").succeeds();
    std::fs::rename(server.place.path("other.gpkg"), server.place.path("demo.gpkg")).unwrap();
    assert_eq!(server.json("/api/region")["vehicles_certified"], serde_json::json!(["AU-BDOUBLE26"]));
    server.problem(&tile, 404);

    // The file is removed and put back.
    std::fs::rename(server.place.path("demo.gpkg"), server.place.path("away.gpkg")).unwrap();
    let problem = server.problem("/api/region", 503);
    assert!(!problem["detail"].as_str().unwrap().contains("gpkg"), "{problem}");
    std::fs::rename(server.place.path("away.gpkg"), server.place.path("demo.gpkg")).unwrap();
    assert_eq!(server.get("/api/region").status, 200);
}
