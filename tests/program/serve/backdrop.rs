//! `/backdrop/…`: what lies behind the roads, read with another program's reader.

use fast_mvt::{MvtReaderRef, MvtValueRef};
use serde_json::Value;

use super::http::Server;
use crate::update;

/// The grid of roads with woods around its middle, a pond, a river and a town.
pub(super) fn server() -> Server {
    let place = update::place();
    update::run(&place, "update --db grid.gpkg 1.osc").succeeds();
    Server::over(place, "serve --db grid.gpkg --addr 127.0.0.1:0")
}

/// Kind, name, and number of rings, lines or points of each feature of a layer.
fn things(server: &Server, tile: &str, wanted: &str) -> Vec<(String, Option<String>, usize)> {
    let reply = server.get(tile);
    assert_eq!((reply.status, reply.header("content-type")), (200, Some("application/vnd.mapbox-vector-tile")));
    let reader = MvtReaderRef::new(&reply.body).unwrap();
    let mut all = Vec::new();
    for layer in reader.layers().filter(|layer| layer.name() == wanted) {
        for feature in layer.features() {
            let text = |key: &str| {
                feature.properties().map(Result::unwrap).find_map(|(own, value)| match value {
                    MvtValueRef::String(text) if own == key => Some(text.to_owned()),
                    _ => None,
                })
            };
            all.push((text("kind").unwrap(), text("name"), parts(feature.geometry_commands())));
        }
    }
    all
}

/// By the specification's section 4.3. `ClosePath` has no parameters, the others two for each point.
fn parts(commands: &[u32]) -> usize {
    let (mut at, mut moves) = (0, 0);
    while let Some(&integer) = commands.get(at) {
        let (command, count) = (integer & 7, integer >> 3);
        moves += usize::from(command == 1);
        at += if command == 7 { 1 } else { 1 + 2 * count as usize };
    }
    moves
}

fn tile(z: u32) -> String {
    // The grid lies north-east of the point where equator and meridian meet.
    format!("/backdrop/{z}/{0}/{1}.mvt", 1_u32 << (z - 1), (1_u32 << (z - 1)) - 1)
}

#[test]
fn tiles_have_what_their_zoom_shows() {
    let server = server();
    let named = |kind: &str, name: &str| (kind.to_owned(), Some(name.to_owned()), 1);
    let area = |kind: &str, rings: usize| (kind.to_owned(), None, rings);
    // The woods have a clearing. The pond is a hundred metres wide, four pixels at zoom 12.
    assert_eq!(things(&server, &tile(14), "area"), [area("wood", 2), area("water", 1)]);
    assert_eq!(things(&server, &tile(10), "area"), []);
    assert_eq!(things(&server, &tile(11), "area"), [area("wood", 2)]);
    assert_eq!(things(&server, &tile(14), "line"), [area("river", 1)]);
    assert_eq!(things(&server, &tile(8), "line"), []);
    for z in 8..=14 {
        assert_eq!(things(&server, &tile(z), "place"), [named("town", "Midgrid")], "zoom {z}");
    }
    assert_eq!(things(&server, "/backdrop/7/64/63.mvt", "place"), []);
    assert_eq!(server.get("/backdrop/14/0/0.mvt").body, b"");
    server.problem("/backdrop/15/0/0.mvt", 404);
    server.problem("/backdrop/1/2/0.mvt", 404);
    server.problem("/backdrop/1/0/0.mvt?vehicle=AU-SEMI19", 400);
}

#[test]
fn the_region_says_where_tiles_are_and_that_there_are_none() {
    let server = server();
    let region = server.get("/api/region").json();
    let address = region["backdrop"]["tiles"].as_str().unwrap();
    assert_eq!(region["backdrop"]["max_zoom"], 14);
    let address = address.replace("{z}", "14").replace("{x}", "8192").replace("{y}", "8191");
    assert_eq!(things(&server, &address, "area").len(), 2);
    let without = Server::over(update::place(), "serve --db grid.gpkg --addr 127.0.0.1:0");
    assert_eq!(without.get("/api/region").json()["backdrop"], Value::Null);
    assert_eq!(without.get(&tile(14)).body, b"");
}
