//! Reads tiles with another program's reader. Every edge must be in them, at its place, with the numbers of `query`.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write as _;

use fast_mvt::{MvtReaderRef, MvtValueRef};
use netcert::osm::facts::Policy;
use netcert::rows::EdgeRow;
use netcert::serve::{Editing, Limits, ServerOptions};
use netcert::store::TurnQuery;
use netcert::words::{Named, verdict_words};

use super::http::{Reply, Server};

const VEHICLE: &str = "AU-SEMI19";

/// A decoded feature of lines.
struct Feature {
    /// None from afar.
    id: u64,
    tags: BTreeMap<String, String>,
    /// Tile units.
    lines: Vec<Vec<[f64; 2]>>,
}

fn features(tile: &[u8], wanted: &str) -> Vec<Feature> {
    let reader = MvtReaderRef::new(tile).unwrap();
    let mut all = Vec::new();
    for layer in reader.layers().filter(|layer| layer.name() == wanted) {
        let extent = if wanted == "overview" { 1024 } else { 4096 };
        assert_eq!((layer.version(), layer.extent()), (2, extent));
        for feature in layer.features() {
            let text = |value| match value {
                MvtValueRef::String(text) => text.to_owned(),
                MvtValueRef::Double(number) => number.to_string(),
                MvtValueRef::SInt(whole) => whole.to_string(),
                MvtValueRef::Bool(truth) => truth.to_string(),
                other => panic!("{other:?}"),
            };
            let tags = feature.properties().map(|pair| pair.map(|(key, value)| (key.to_owned(), text(value))).unwrap());
            let tags = tags.collect();
            let lines = lines(feature.geometry_commands());
            all.push(Feature { id: feature.id().unwrap_or(0), tags, lines });
        }
    }
    all
}

impl Feature {
    /// From a place to the nearest of its lines.
    fn away(&self, from: [f64; 2]) -> f64 {
        let pairs = self.lines.iter().flat_map(|line| line.windows(2));
        pairs.map(|pair| distance(from, pair[0], pair[1])).fold(f64::MAX, f64::min)
    }
}

/// By the specification's section 4.3; everything is `MoveTo` 1 and `LineTo` n.
fn lines(commands: &[u32]) -> Vec<Vec<[f64; 2]>> {
    let (mut at, mut cursor) = (0, [0_i64; 2]);
    let mut all: Vec<Vec<[f64; 2]>> = Vec::new();
    while at < commands.len() {
        let (command, count) = (commands[at] & 7, commands[at] >> 3);
        assert!(matches!((command, count), (1, 1) | (2, 1..)), "{command} {count}");
        at += 1;
        if command == 1 {
            all.push(Vec::new());
        }
        for _ in 0..count {
            for axis in &mut cursor {
                let value = i64::from(commands[at]);
                *axis += (value >> 1) ^ -(value & 1);
                at += 1;
            }
            all.last_mut().unwrap().push(cursor.map(|c| c as f64));
        }
    }
    all
}

/// Column and row of a place at a zoom, with fractions.
pub(super) fn at(z: u32, (lon, lat): (f64, f64)) -> [f64; 2] {
    let side = f64::from(1_u32 << z);
    [(lon + 180.0) / 360.0 * side, (0.5 - lat.to_radians().tan().asinh() / std::f64::consts::TAU) * side]
}

/// The tiles that the vertices of all rows lie in.
fn tiles(rows: &[EdgeRow], z: u32) -> BTreeSet<(u32, u32)> {
    let place = |position: &netcert::osm::LonLat| {
        let [x, y] = at(z, position.degrees());
        (x as u32, y as u32)
    };
    rows.iter().flat_map(|row| row.line.iter().map(place)).collect()
}

fn fetch(server: &Server, z: u32, (x, y): (u32, u32), layer: &str) -> Vec<Feature> {
    let reply = server.get(&format!("/tiles/lane/{VEHICLE}/{z}/{x}/{y}.mvt"));
    assert_eq!(reply.status, 200);
    assert_eq!(reply.header("content-type"), Some("application/vnd.mapbox-vector-tile"));
    features(&reply.body, layer)
}

#[test]
fn every_edge_is_in_the_tiles_of_its_vertices_with_the_numbers_of_query() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    for z in [13, 15, 16] {
        let by_tile: BTreeMap<(u32, u32), Vec<Feature>> =
            tiles(&rows, z).into_iter().map(|tile| (tile, fetch(&server, z, tile, "edge"))).collect();
        for row in &rows {
            for position in &row.line {
                let [x, y] = at(z, position.degrees());
                let found =
                    by_tile[&(x as u32, y as u32)].iter().find(|feature| feature.id == u64::from(row.edge.index) + 1);
                let Some(feature) = found else {
                    // Left out only what is smaller than the raster.
                    assert!(row.length_m < 3.0 && z < 16, "zoom {z}, edge {}, {} m", row.edge.id, row.length_m);
                    continue;
                };
                matches_row(feature, row);
                // The vertex is on the drawn line, to the tolerance of two units and rounding.
                let unit = [(x - x.floor()) * 4096.0, (y - y.floor()) * 4096.0];
                let near = feature.away(unit);
                assert!(near < 3.0, "zoom {z}, edge {}: {near} units off", row.edge.id);
            }
        }
    }
}

fn matches_row(feature: &Feature, row: &EdgeRow) {
    let tag = |name: &str| feature.tags.get(name).map(String::as_str);
    let (verdict, reason) = verdict_words(row.certificate.verdict);
    assert_eq!(tag("edge_id"), Some(row.edge.id.to_string().as_str()));
    assert_eq!(tag("way_id"), Some(row.edge.way_id.to_string().as_str()));
    assert_eq!(tag("highway"), Some(row.road.highway.as_str()));
    assert_eq!((tag("verdict"), tag("reason")), (Some(verdict), Some(reason).filter(|reason| !reason.is_empty())));
    assert_eq!(tag("direction"), Some(row.edge.direction.name()));
    assert_eq!((tag("name"), tag("ref")), (row.road.name.as_deref(), row.road.reference.as_deref()));
    assert_eq!(tag("rsc_m").map(|text| text.parse().unwrap()), row.certificate.rsc_m, "exactly as kept");
    assert_eq!(tag("width_source"), row.width_source.map(Named::name));
    assert_eq!(tag("uses"), row.uses.map(Named::name));
    let need_m = tag("need_width_m").map(|shown| shown.parse::<f64>().unwrap());
    assert_eq!(need_m, row.need_width_m, "{}", row.edge.id);
    if let Some(width_m) = row.width_m {
        let shown: f64 = tag("width_m").unwrap().parse().unwrap();
        assert!(shown <= width_m && width_m - shown < 0.0101, "{shown} {width_m}");
    }
}

fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = u[0] * u[0] + u[1] * u[1];
    let along = if squared > 0.0 { ((u[0] * v[0] + u[1] * v[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (v[0] - along * u[0]).hypot(v[1] - along * u[1])
}

/// One server may hold no edges in memory, so it makes its tiles from the file. The other one holds them all.
#[test]
fn tiles_from_memory_have_the_bytes_of_tiles_from_the_file() {
    let loaded = Server::demo();
    let rows = loaded.place.rows(VEHICLE);
    let addresses: Vec<String> = (11..=16)
        .flat_map(|z| tiles(&rows, z).into_iter().map(move |(x, y)| format!("/tiles/lane/{VEHICLE}/{z}/{x}/{y}.mvt")))
        .collect();
    let options = ServerOptions {
        db: loaded.place.path("demo.gpkg"),
        before: None,
        addr: ([127, 0, 0, 1], 0).into(),
        allow_remote: false,
        base_map: None,
        editing: Editing::Off,
        now: std::sync::Arc::new(String::new),
        limits: Limits { held_edges: 0, ..Limits::default() },
    };
    let from_file = netcert::serve::Server::bind(options).unwrap();
    let address = from_file.address();
    let (stop, stopped) = tokio::sync::oneshot::channel::<()>();
    let running = std::thread::spawn(move || from_file.run(async { stopped.await.unwrap_or(()) }));
    for target in &addresses {
        let mut stream = std::net::TcpStream::connect(address).unwrap();
        let request = format!("GET {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let reply = Reply::read(&mut std::io::BufReader::new(stream));
        assert_eq!(reply.status, 200, "{target}");
        assert!(loaded.get(target).body == reply.body, "{target}");
    }
    stop.send(()).unwrap();
    running.join().unwrap();
}

#[test]
fn turns_are_in_the_tiles_from_zoom_15_on() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let turns = server.place.database().query_turns(&TurnQuery::new(VEHICLE, Policy::Lane)).unwrap();
    assert!(tiles(&rows, 14).into_iter().all(|tile| fetch(&server, 14, tile, "turn").is_empty()));
    let mut seen: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    for tile in tiles(&rows, 15) {
        for feature in fetch(&server, 15, tile, "turn") {
            seen.insert(feature.tags["turn_id"].clone(), feature.tags);
        }
    }
    assert_eq!(seen.len(), turns.len());
    for turn in turns {
        let tags = &seen[&turn.turn.id.to_string()];
        assert_eq!(tags["from_edge"], turn.turn.from_edge.to_string());
        assert_eq!(tags["verdict"], verdict_words(turn.certificate.verdict).0);
        assert_eq!(tags.get("rsc_m").map(|text| text.parse().unwrap()), turn.certificate.rsc_m);
    }
}

#[test]
fn small_zooms_show_the_greater_roads_only_and_far_away_there_is_nothing() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let tile = *tiles(&rows, 7).iter().next().unwrap();
    assert!(fetch(&server, 7, tile, "edge").is_empty(), "from afar there are no edges");
    let classes: BTreeSet<String> =
        fetch(&server, 7, tile, "overview").into_iter().map(|feature| feature.tags["highway"].clone()).collect();
    assert!(
        !classes.is_empty() && classes.iter().all(|class| ["motorway", "trunk", "primary"].contains(&class.as_str()))
    );
    let far = server.get(&format!("/tiles/lane/{VEHICLE}/14/0/0.mvt"));
    assert_eq!((far.status, far.body.len()), (200, 0));
}

/// Every vertex of a main road lies on a line, and where its edge is not certified on one that is not either, within a
/// pixel (two units) of where it is.
#[test]
fn from_afar_nothing_is_drawn_as_certified_that_is_not() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let classes = ["motorway", "trunk", "primary", "secondary", "tertiary"];
    let mut barred = 0;
    for (z, shown) in [(6, 2), (8, 3), (9, 4), (10, 5)] {
        let by_tile: BTreeMap<(u32, u32), Vec<Feature>> =
            tiles(&rows, z).into_iter().map(|tile| (tile, fetch(&server, z, tile, "overview"))).collect();
        for row in rows.iter().filter(|row| classes[..shown].contains(&row.road.highway.as_str())) {
            let (verdict, _) = verdict_words(row.certificate.verdict);
            barred += usize::from(verdict != "safe");
            for position in &row.line {
                let [x, y] = at(z, position.degrees());
                let unit = [(x - x.floor()) * 1024.0, (y - y.floor()) * 1024.0];
                let fits = |feature: &&Feature| {
                    feature.tags["highway"] == row.road.highway
                        && (verdict == "safe" || feature.tags["verdict"] != "safe")
                };
                let of_class = by_tile[&(x as u32, y as u32)].iter().filter(fits);
                let near = of_class.map(|feature| feature.away(unit)).fold(f64::MAX, f64::min);
                let short = verdict == "safe" && row.length_m < 1000.0;
                assert!(near < 2.0 || short, "zoom {z}, edge {}, {verdict}: {near} units off", row.edge.id);
            }
        }
        for feature in by_tile.values().flatten() {
            let rsc_m: Option<f64> = feature.tags.get("rsc_m").map(|text| text.parse().unwrap());
            assert!(feature.tags["verdict"] != "safe" || rsc_m.is_some_and(|m| m >= 0.0), "{:?}", feature.tags);
        }
    }
    assert!(barred > 0, "all is certified");
}

#[test]
fn where_a_region_has_both_sides_every_edge_says_on_which_it_is_driven() {
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let tile = *tiles(&rows, 13).iter().next().unwrap();
    assert!(fetch(&server, 13, tile, "edge").iter().all(|feature| !feature.tags.contains_key("left")));
    let way = rows.iter().find(|row| !row.line.is_empty()).unwrap().edge.way_id;
    let other_side = format!("UPDATE road SET left_hand_traffic = NOT left_hand_traffic WHERE way_id = {way}");
    assert!(server.place.sql(&other_side) > 0);
    let most = server.json("/api/region")["left_hand_traffic"].as_bool().unwrap();
    let mut seen = BTreeSet::new();
    for tile in tiles(&rows, 13) {
        for feature in fetch(&server, 13, tile, "edge") {
            let other = feature.tags["way_id"] == way.to_string();
            assert_eq!(feature.tags["left"], (most != other).to_string());
            seen.insert(other);
        }
    }
    assert_eq!(seen.len(), 2);
}
