//! OGC API – Features: pages, boxes and conditions give what `query` and SQLite give, and GDAL, OWSLib and QGIS read it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use netcert::osm::facts::Policy;
use netcert::rows::Bounds;
use netcert::store::{Area, QueryOptions, TurnQuery};
use netcert_testing::program::{ProgramRun, WorkFolder};
use netcert_testing::python::python;
use netcert_testing::skip::skipped;
use serde_json::{Value, json};

use super::http::{Reply, Server};
use super::openapi::faults;

const VEHICLE: &str = "AU-SEMI19";
const EDGES: &str = "edges.AU-SEMI19.lane";
const TURNS: &str = "turns.AU-SEMI19.lane";
const ALL: [&str; 5] = ["edges.AU-ATRIPLE53.lane", EDGES, "junctions", "turns.AU-ATRIPLE53.lane", TURNS];
const IDS: [&str; 11] = [
    "edge_id",
    "way_id",
    "from_node",
    "to_node",
    "turn_id",
    "from_edge",
    "to_edge",
    "via_node",
    "first_arc",
    "last_arc",
    "node_id",
];
/// What the server calls itself in links, by the host that the tests ask for.
const ORIGIN: &str = "http://localhost";

fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/engines").join(name)
}

fn encoded(text: &str) -> String {
    let plain = |b: &u8| b.is_ascii_alphanumeric();
    text.bytes().map(|b| if plain(&b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

fn geojson(reply: &Reply) -> Value {
    let kind = reply.header("content-type");
    assert_eq!((reply.status, kind), (200, Some("application/geo+json")), "{}", reply.text());
    reply.json()
}

/// The path and query of a link of an answer.
fn link(answer: &Value, rel: &str) -> Option<String> {
    let links = answer["links"].as_array().unwrap();
    let found: Vec<&Value> = links.iter().filter(|link| link["rel"] == rel).collect();
    assert!(found.len() < 2, "{rel}: {found:?}");
    Some(found.first()?["href"].as_str().unwrap().strip_prefix(ORIGIN).unwrap().to_owned())
}

/// All features of a collection, page by page, and the number of pages.
fn read(server: &Server, collection: &str, parameters: &str) -> (Vec<Value>, usize) {
    let mut target = format!("/ogc/collections/{collection}/items?{parameters}");
    let (mut features, mut pages) = (Vec::new(), 0);
    loop {
        let page = geojson(&server.get(&target));
        let own = page["features"].as_array().unwrap();
        assert_eq!((&page["type"], &page["numberReturned"]), (&json!("FeatureCollection"), &json!(own.len())));
        assert!(page["attribution"].as_str().unwrap().contains("OpenStreetMap"));
        assert_eq!(page["scope"].is_string(), collection != "junctions");
        features.extend(own.iter().cloned());
        pages += 1;
        let Some(next) = link(&page, "next") else { return (features, pages) };
        assert!(!own.is_empty());
        target = next;
    }
}

fn ids(features: &[Value]) -> Vec<String> {
    features.iter().map(|feature| feature["id"].as_str().unwrap().to_owned()).collect()
}

/// The features of `query`, with ids as texts.
fn of_query(place: &WorkFolder, more: &str) -> Vec<Value> {
    let line = format!("query --db demo.gpkg --vehicle {VEHICLE} --format geojson {more}");
    let mut features = place.netcert(&line).succeeds().json()["features"].as_array().unwrap().clone();
    for feature in &mut features {
        for (name, value) in feature["properties"].as_object_mut().unwrap() {
            if value.is_number() && IDS.contains(&name.as_str()) {
                *value = json!(value.to_string());
            }
        }
    }
    features
}

/// The first column of every row that SQLite's shell finds.
fn sqlite(place: &WorkFolder, sql: &str) -> Vec<String> {
    let mut shell = Command::new("sqlite3");
    let out = ProgramRun::of(sql, shell.arg("-readonly").arg(place.path("demo.gpkg")).arg(sql)).succeeds();
    out.out().lines().map(str::to_owned).collect()
}

#[test]
fn pages_add_up_to_all_features_without_repeats() {
    let server = Server::demo();
    let listed = server.json("/ogc/collections");
    let mut names: Vec<&str> =
        listed["collections"].as_array().unwrap().iter().map(|own| own["id"].as_str().unwrap()).collect();
    names.sort_unstable();
    assert_eq!(names, ALL);
    let edges = of_query(&server.place, "");
    let turns = of_query(&server.place, "--turns");
    let nodes = sqlite(&server.place, "SELECT node_id FROM junction ORDER BY node_id");
    for (collection, expected) in [(EDGES, ids(&edges)), (TURNS, ids(&turns)), ("junctions", nodes)] {
        let (features, pages) = read(&server, collection, "limit=37");
        assert_eq!(ids(&features), expected, "{collection}");
        assert_eq!(pages, expected.len().div_ceil(37), "{collection}");
        let (whole, pages) = read(&server, collection, "limit=99999");
        assert_eq!((whole == features, pages), (true, 1), "{collection}");
        // A full page is the last one if nothing follows.
        assert_eq!(read(&server, collection, &format!("limit={}", expected.len())).1, 1);
        let first = geojson(&server.get(&format!("/ogc/collections/{collection}/items?limit=1")));
        assert_eq!(first["numberMatched"], json!(expected.len()), "{collection}");
        assert!(first["timeStamp"].as_str().unwrap().ends_with('Z'));
        for id in [&expected[0], &expected[expected.len() - 1]] {
            let one = geojson(&server.get(&format!("/ogc/collections/{collection}/items/{id}")));
            let same = features.iter().find(|feature| feature["id"] == json!(id)).unwrap();
            for member in ["type", "id", "geometry", "properties"] {
                assert_eq!(one[member], same[member], "{collection} {id}");
            }
            assert_eq!(link(&one, "collection").unwrap(), format!("/ogc/collections/{collection}"));
        }
        server.problem(&format!("/ogc/collections/{collection}/items/999999999999"), 404);
    }
    let usual = geojson(&server.get(&format!("/ogc/collections/{EDGES}/items")));
    assert_eq!(usual["numberReturned"], json!(edges.len().min(1000)));
    assert_eq!(read(&server, EDGES, "").0, edges);
    assert_eq!(read(&server, TURNS, "").0, turns);
    let (junctions, _) = read(&server, "junctions", "");
    for junction in &junctions {
        assert_eq!(junction["geometry"]["type"], "MultiPolygon");
        let ring = junction["geometry"]["coordinates"][0][0].as_array().unwrap();
        assert!(ring.len() > 3 && ring.first() == ring.last(), "{junction}");
        let roads = junction["properties"]["roads"].as_i64().unwrap();
        assert!(roads > 0 && junction["properties"]["node_id"] == junction["id"]);
    }
}

#[test]
fn a_box_has_what_query_finds_in_it() {
    let server = Server::demo();
    let mut database = server.place.database();
    let rows = server.place.rows(VEHICLE);
    let junctions = database.junction_areas().unwrap();
    let mut found = [0; 3];
    for row in rows.iter().step_by(61) {
        let (lon, lat) = row.line[0].degrees();
        for (wide, high) in [(0.0004, 0.0003), (0.003, 0.002), (0.03, 0.002)] {
            let bounds = Bounds { west: lon - wide, south: lat - high, east: lon + wide, north: lat + high / 3.0 };
            let Bounds { west, south, east, north } = bounds;
            let area = Some(Area::Bounds(bounds));
            let asked = format!("limit=9&bbox={west},{south},{east},{north}");
            let options = QueryOptions { area: area.clone(), ..QueryOptions::new(VEHICLE, Policy::Lane) };
            let edges: Vec<String> =
                database.query(&options).unwrap().map(|row| row.unwrap().edge.id.to_string()).collect();
            let turns = database.query_turns(&TurnQuery { area, ..TurnQuery::new(VEHICLE, Policy::Lane) }).unwrap();
            let turns: Vec<String> = turns.iter().map(|row| row.turn.id.to_string()).collect();
            assert_eq!(ids(&read(&server, EDGES, &asked).0), edges, "{asked}");
            assert_eq!(ids(&read(&server, TURNS, &asked).0), turns, "{asked}");
            let own: BTreeSet<String> = ids(&read(&server, "junctions", &asked).0).into_iter().collect();
            for junction in &junctions {
                let places = || junction.polygons.iter().flatten().flatten().copied();
                let inside = |place: netcert::osm::LonLat| {
                    let (lon, lat) = place.degrees();
                    west <= lon && lon <= east && south <= lat && lat <= north
                };
                let is_found = own.contains(&junction.node.to_string());
                assert!(is_found || !places().any(inside), "{asked}: {}", junction.node);
                assert!(!is_found || Bounds::around(places()).unwrap().touches(bounds), "{asked}: {}", junction.node);
            }
            found = [found[0] + edges.len(), found[1] + turns.len(), found[2] + own.len()];
        }
    }
    assert!(found.iter().all(|&found| found > 10), "{found:?}");
    let all = rows.len();
    let count = |bbox: &str| read(&server, EDGES, &format!("bbox={bbox}")).0.len();
    assert_eq!(count("-180,-90,180,90"), all);
    assert_eq!(count("100,-90,-170,90"), all, "over 180°");
    assert_eq!(count("170,-90,-170,90"), 0, "over 180°");
    assert_eq!(count("100,-90,-1000,-170,90,9000"), all, "heights do not matter");
    let some = read(&server, EDGES, "bbox=-180,-90,180,90&limit=3&datetime=2026-11-21T08:00:00Z/..").0;
    assert_eq!(some.len(), all);
}

#[test]
fn conditions_find_what_sqlite_finds() {
    let server = Server::demo();
    let of_edges = "SELECT e.edge_id FROM certificate AS c JOIN edge AS e ON e.fid = c.edge_fid \
                    WHERE c.vehicle_id = 'AU-SEMI19' AND c.corridor = 'lane' AND";
    let of_turns = "SELECT t.turn_id FROM turn_certificate AS c JOIN turn AS t ON t.fid = c.turn_fid \
                    WHERE c.vehicle_id = 'AU-SEMI19' AND c.corridor = 'lane' AND";
    let of_junctions = "SELECT node_id FROM junction WHERE";
    let row = &server.place.rows(VEHICLE)[5];
    let of_ids = format!("edge_id IN ('{}', 'x', '0{0}') AND way_id = '{}'", row.edge.id, row.edge.way_id);
    let same_ids = format!("e.edge_id = {}", row.edge.id);
    let asked = [
        (EDGES, of_edges, "verdict = 'safe'", "c.verdict = 'safe'"),
        (EDGES, of_edges, "verdict <> 'safe' AND rsc_m >= -0.25", "c.verdict <> 'safe' AND c.rsc_m >= -0.25"),
        (
            EDGES,
            of_edges,
            "NOT (highway IN ('motorway', 'trunk') OR maxspeed_kmh > 60)",
            "NOT (e.highway IN ('motorway', 'trunk') OR e.maxspeed_kmh > 60)",
        ),
        (EDGES, of_edges, "name LIKE '%Motorway'", "substr(e.name, -8) = 'Motorway'"),
        (EDGES, of_edges, "name LIKE 'S_ltb%'", "substr(e.name, 1, 1) = 'S' AND substr(e.name, 3, 3) = 'ltb'"),
        (EDGES, of_edges, "name LIKE 's%'", "substr(e.name, 1, 1) = 's'"),
        (EDGES, of_edges, "name NOT LIKE '%o%'", "instr(e.name, 'o') = 0"),
        (EDGES, of_edges, "reason IS NULL", "c.reason IS NULL"),
        (
            EDGES,
            of_edges,
            "reason IS NOT NULL AND need_width_m IS NULL",
            "c.reason NOT NULL AND c.need_width_m IS NULL",
        ),
        (EDGES, of_edges, "length_m BETWEEN 100 AND 200.5", "e.length_m BETWEEN 100 AND 200.5"),
        (EDGES, of_edges, "length_m NOT BETWEEN 100 AND 200.5", "e.length_m NOT BETWEEN 100 AND 200.5"),
        (
            EDGES,
            of_edges,
            "width_source = 'tagged' AND width_m < 3.5",
            "e.width_source = 'tagged' AND e.lane_width_m < 3.5",
        ),
        (
            EDGES,
            of_edges,
            "limiting_side = 'left' AND limiting_unit >= 1",
            "c.limiting_side = 'left' AND c.limiting_unit >= 1",
        ),
        (EDGES, of_edges, "shrink < 1 OR hinge_margin_deg <= 10", "c.shrink < 1 OR c.hinge_margin_deg <= 10"),
        (EDGES, of_edges, "ref IS NULL OR ref > 'M'", "e.ref IS NULL OR e.ref > 'M'"),
        (EDGES, of_edges, "direction = 'backward' and not false", "e.direction = 'backward'"),
        (EDGES, of_edges, "NOT maxspeed_kmh = 50", "e.maxspeed_kmh <> 50"),
        (EDGES, of_edges, "edge_id < '5'", "CAST(e.edge_id AS TEXT) < '5'"),
        (EDGES, of_edges, &of_ids, &same_ids),
        (EDGES, of_edges, "name = 'x''; DROP TABLE edge; --'", "FALSE"),
        (EDGES, of_edges, "FALSE", "FALSE"),
        (EDGES, of_edges, "TRUE", "TRUE"),
        (TURNS, of_turns, "kind = 'left' AND angle_deg < 90", "t.kind = 'left' AND t.angle_deg < 90"),
        (TURNS, of_turns, "kerb_source IS NULL OR kerb_radius_m > 6", "t.kerb_source IS NULL OR t.kerb_radius_m > 6"),
        (TURNS, of_turns, "restriction IS NOT NULL", "t.restriction NOT NULL"),
        (TURNS, of_turns, "first_arc IS NOT NULL", "t.first_arc_fid NOT NULL"),
        (TURNS, of_turns, "verdict IN ('safe', 'forbidden')", "c.verdict IN ('safe', 'forbidden')"),
        ("junctions", of_junctions, "roads >= 4", "roads >= 4"),
        ("junctions", of_junctions, "kerb_source = 'assumed'", "kerb_source = 'assumed'"),
    ];
    let mut telling = 0;
    for (collection, select, filter, sql) in asked {
        let order = if collection == "junctions" { "node_id" } else { "c.fid" };
        let expected = sqlite(&server.place, &format!("{select} ({sql}) ORDER BY {order}"));
        let parameters = format!("limit=50&filter-lang=cql2-text&filter={}", encoded(filter));
        let (features, _) = read(&server, collection, &parameters);
        assert_eq!(ids(&features), expected, "{filter}");
        let all = ids(&read(&server, collection, "").0).len();
        telling += usize::from(!expected.is_empty() && expected.len() < all);
    }
    assert!(telling >= 16, "only {telling} conditions find some and not all");
}

#[test]
fn long_conditions_are_answered_and_go_together_with_boxes() {
    let server = Server::demo();
    // As many values as fit. Encoded they would make the address too long.
    let found = |filter: &str| {
        assert!(filter.len() <= 2000, "{}", filter.len());
        read(&server, EDGES, &format!("filter={}", filter.replace(' ', "+"))).0.len()
    };
    assert_eq!(found(&format!("edge_id IN ({})", vec!["'1'"; 490].join(","))), 0);
    assert_eq!(found(&format!("maxspeed_kmh IN ({})", vec!["1"; 980].join(","))), 0);
    assert_eq!(found(&format!("TRUE{}", " AND TRUE".repeat(220))), server.place.rows(VEHICLE).len());
    let rows = server.place.rows(VEHICLE);
    let (lon, lat) = rows[100].line[0].degrees();
    let bbox = format!("bbox={},{},{},{}", lon - 0.02, lat - 0.02, lon + 0.02, lat + 0.02);
    let both = read(&server, EDGES, &format!("{bbox}&limit=2&filter={}", encoded("verdict = 'safe'"))).0;
    let inside = read(&server, EDGES, &bbox).0;
    let safe: Vec<Value> = inside.into_iter().filter(|own| own["properties"]["verdict"] == "safe").collect();
    assert!(!safe.is_empty() && both == safe);
}

#[test]
fn what_cannot_be_answered_is_refused_with_its_place() {
    let server = Server::demo();
    let items = format!("/ogc/collections/{EDGES}/items");
    let filter = |text: &str| format!("{items}?filter={}", encoded(text));
    for (target, status, what) in [
        (format!("{items}?speed=5"), 400, "no such parameter"),
        ("/ogc/?f=html".to_owned(), 400, "no such parameter"),
        (format!("{items}?limit=0"), 400, "from 1 on"),
        (format!("{items}?limit=many"), 400, "from 1 on"),
        (format!("{items}?limit=5&limit=6"), 400, "more than once"),
        (format!("{items}?bbox=126,-30,126.1,-30.2"), 400, "wrong order"),
        (format!("{items}?bbox=-30.2,126,-30.1,126.1"), 400, "longitude comes first"),
        (format!("{items}?bbox=1,2,3"), 400, "four or six"),
        (format!("{items}?bbox=a,b,c,d"), 400, "not all of it are numbers"),
        (format!("{items}?datetime=yesterday"), 400, "give a time"),
        (format!("{items}?datetime=../.."), 400, "give a time"),
        (format!("{items}?after=5"), 400, "take it from the link"),
        (format!("{items}?after=5-0123456789abcdef"), 409, "has changed"),
        (format!("{items}?filter=TRUE&filter-lang=cql2-json"), 400, "only cql2-text"),
        (format!("{items}?filter=TRUE&filter-crs=EPSG:4326"), 400, "CRS84"),
        (filter("verdict == 'safe'"), 400, "character 10"),
        (filter("verdict = 'safe' rsc_m > 1"), 400, "character 18"),
        (filter("vehicle_id = 'AU-SEMI19'"), 400, "character 1: there is no attribute vehicle_id"),
        (filter("rsc_m > 'a'"), 400, "character 9"),
        (filter("S_INTERSECTS(geometry, POINT(1 1))"), 400, "functions are not supported"),
        (filter(&format!("{}TRUE{}", "(".repeat(40), ")".repeat(40))), 400, "deep"),
        (filter(&"x".repeat(2001)), 400, "longer than 2000"),
        ("/ogc/collections/edges.nobody.lane".to_owned(), 404, "/ogc/collections lists them"),
        ("/ogc/collections/edges.AU-SEMI19.lane.x/items".to_owned(), 404, "lists them"),
        ("/ogc/collections/nothing/queryables".to_owned(), 404, "lists them"),
        ("/ogc/collections/nothing/schema".to_owned(), 404, "lists them"),
        (format!("{items}/0{}", server.place.rows(VEHICLE)[0].edge.id), 404, "no feature"),
        (format!("{items}/x"), 404, "no feature"),
        ("/ogc/nothing".to_owned(), 404, ""),
    ] {
        let problem = server.problem(&target, status);
        assert!(problem["detail"].as_str().unwrap().contains(what), "{target}: {problem}");
    }
    // Pages of two states are not put together.
    let first = geojson(&server.get(&format!("{items}?limit=10")));
    let next = link(&first, "next").unwrap();
    assert_eq!(server.get(&next).status, 200);
    std::thread::sleep(std::time::Duration::from_millis(20));
    server.place.sql("UPDATE run SET parameters = parameters || ' '");
    let problem = server.problem(&next, 409);
    assert_eq!(problem["type"], "urn:netcert:problem:changed");
    assert_eq!(geojson(&server.get(&format!("{items}?limit=10")))["features"], first["features"]);
}

#[test]
fn every_answer_is_as_described_and_every_link_leads_somewhere() {
    let server = Server::demo();
    let api = server.get("/ogc/api");
    assert_eq!(api.header("content-type"), Some("application/vnd.oai.openapi+json;version=3.0"));
    let document = api.json();
    assert_eq!(
        (&document["openapi"], &document["servers"][0]["url"]),
        (&json!("3.0.3"), &json!("http://localhost/ogc"))
    );
    let edge = server.place.rows(VEHICLE)[0].edge.id;
    let asked = [
        ("/", "/ogc/".to_owned()),
        ("/", "/ogc".to_owned()),
        ("/api", "/ogc/api".to_owned()),
        ("/conformance", "/ogc/conformance".to_owned()),
        ("/collections", "/ogc/collections".to_owned()),
        ("/collections/{collectionId}", format!("/ogc/collections/{EDGES}")),
        ("/collections/{collectionId}", "/ogc/collections/junctions".to_owned()),
        ("/collections/{collectionId}/queryables", format!("/ogc/collections/{TURNS}/queryables")),
        ("/collections/{collectionId}/schema", format!("/ogc/collections/{TURNS}/schema")),
        ("/collections/{collectionId}/items", format!("/ogc/collections/{EDGES}/items?limit=20")),
        ("/collections/{collectionId}/items", format!("/ogc/collections/{TURNS}/items?bbox=125,-31,126,-30")),
        ("/collections/{collectionId}/items", "/ogc/collections/junctions/items".to_owned()),
        ("/collections/{collectionId}/items/{featureId}", format!("/ogc/collections/{EDGES}/items/{edge}")),
    ];
    let mut links = BTreeSet::new();
    for (path, target) in &asked {
        let described = &document["paths"][path]["get"]["responses"]["200"]["content"];
        let (kind, schema) = described.as_object().unwrap().iter().next().unwrap();
        let reply = server.get(target);
        assert_eq!((reply.status, reply.header("content-type")), (200, Some(kind.as_str())), "{target}");
        let mut found = Vec::new();
        faults(&document, &schema["schema"], &reply.json(), path, &mut found);
        found.truncate(20);
        assert_eq!(found, Vec::<String>::new(), "{target}");
        let head = format!("HEAD {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        let head = server.raw(head.as_bytes());
        assert_eq!(
            (head.status, head.header("content-type"), head.body.len()),
            (200, Some(kind.as_str()), 0),
            "{target}"
        );
        let answer = reply.json();
        let of_collections = answer["collections"].as_array().into_iter().flatten();
        for own in of_collections.chain([&answer]).flat_map(|own| own["links"].as_array().into_iter().flatten()) {
            links.insert(["href", "type"].map(|member| own[member].as_str().unwrap().to_owned()));
        }
    }
    for path in document["paths"].as_object().unwrap().keys() {
        assert!(asked.iter().any(|(asked, _)| asked == path), "{path} was not asked");
    }
    for [href, kind] in &links {
        match href.strip_prefix(ORIGIN) {
            Some(target) => {
                let reply = server.get(target);
                assert_eq!((reply.status, reply.header("content-type")), (200, Some(kind.as_str())), "{href}");
            }
            None => assert_eq!(href, "https://opendatacommons.org/licenses/odbl/1-0/"),
        }
    }
    assert!(links.len() > 20, "{links:?}");
    let mut found = Vec::new();
    faults(
        &document,
        &document["components"]["schemas"]["Problem"],
        &server.problem("/ogc/?x=1", 400),
        "problem",
        &mut found,
    );
    assert_eq!(found, Vec::<String>::new());

    // Links have the name by which the server was asked, and a proxy's scheme.
    let forwarded = server.with("/ogc/collections", "X-Forwarded-Proto: https\r\n").json();
    assert_eq!(forwarded["links"][0]["href"], "https://localhost/ogc/collections");
    let port = server.address.port();
    let named = format!("GET /ogc/collections HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n");
    let named = server.raw(named.as_bytes()).json();
    assert_eq!(named["links"][0]["href"], json!(format!("http://127.0.0.1:{port}/ogc/collections")));
}

#[test]
fn what_can_be_asked_of_a_collection_is_what_its_features_have() {
    let server = Server::demo();
    for collection in ALL {
        let (features, _) = read(&server, collection, "");
        let of_set = |name: &&String| ["vehicle_id", "corridor"].contains(&name.as_str());
        let queryables = server.get(&format!("/ogc/collections/{collection}/queryables"));
        assert_eq!(queryables.header("content-type"), Some("application/schema+json"));
        let queryables = queryables.json()["properties"].as_object().unwrap().clone();
        let schema = server.get(&format!("/ogc/collections/{collection}/schema")).json();
        let typed = schema["properties"]["properties"]["properties"].as_object().unwrap().clone();
        for feature in &features {
            let own = feature["properties"].as_object().unwrap();
            assert!(own.keys().eq(typed.keys()), "{collection}");
            assert!(own.keys().filter(|name| !of_set(name)).eq(queryables.keys()), "{collection}");
            for (name, value) in own.iter().filter(|(_, value)| !value.is_null()) {
                let fits = match typed[name]["type"].as_str().unwrap() {
                    "string" => value.is_string(),
                    "integer" => value.is_i64(),
                    "number" => value.is_number(),
                    other => panic!("{name}: {other}"),
                };
                assert!(fits, "{collection} {name}: {value}");
                assert!(!IDS.contains(&name.as_str()) || value.is_string(), "{name}");
            }
        }
        // Every attribute can be asked for.
        for name in queryables.keys() {
            let filter = encoded(&format!("{name} IS NOT NULL"));
            let found = read(&server, collection, &format!("filter={filter}")).0;
            let expected: Vec<&Value> =
                features.iter().filter(|feature| !feature["properties"][name].is_null()).collect();
            assert!(found.iter().eq(expected), "{collection} {name}");
        }
    }
}

/// GDAL's answer over the server's address, without a word of warning.
fn ogrinfo(server: &Server, arguments: &[&str]) -> String {
    let mut command = Command::new("ogrinfo");
    command.args(["-ro", "-oo", "PAGE_SIZE=50"]).args(arguments);
    command.arg(format!("OAPIF:http://{}/ogc", server.address)).env("NO_PROXY", "127.0.0.1");
    ProgramRun::of("ogrinfo", &mut command).succeeds().tells_nothing().out()
}

#[test]
fn gdal_reads_every_collection() {
    if Command::new("ogrinfo").arg("--version").output().is_err() {
        return skipped("ogrinfo", "Debian: gdal-bin");
    }
    let server = Server::demo();
    let summary = ogrinfo(&server, &["-so", "-al"]);
    let mut counts = BTreeMap::new();
    let mut fields: BTreeMap<&str, Vec<(&str, &str)>> = BTreeMap::new();
    let mut layer = "";
    for line in summary.lines() {
        match line.split_once(": ") {
            Some(("Layer name", name)) => layer = name,
            Some(("Feature Count", count)) => {
                counts.insert(layer, count.parse::<usize>().unwrap());
            }
            Some((name, kind))
                if kind.starts_with(char::is_alphabetic) && kind.ends_with(')') && !name.contains(' ') =>
            {
                fields.entry(layer).or_default().push((name, kind.split(' ').next().unwrap()));
            }
            _ => {}
        }
    }
    assert_eq!(counts.keys().copied().collect::<Vec<_>>(), ALL);
    for collection in ALL {
        let (features, _) = read(&server, collection, "");
        assert_eq!(counts[collection], features.len(), "{collection}");
        let own: Vec<&str> = fields[collection].iter().map(|field| field.0).filter(|name| *name != "id").collect();
        let expected: Vec<&String> = features[0]["properties"].as_object().unwrap().keys().collect();
        assert!(own.iter().eq(expected.iter()), "{collection}: {own:?}");
    }
    let kind = |layer: &str, name: &str| fields[layer].iter().find(|field| field.0 == name).unwrap().1;
    for (name, expected) in [
        ("edge_id", "String"),
        ("rsc_m", "Real"),
        ("need_width_m", "Real"),
        ("maxspeed_kmh", "Integer"),
        ("ref", "String"),
    ] {
        assert_eq!(kind(EDGES, name), expected, "{name}");
    }

    // All features with their ids, over many pages, and those of a box.
    let written = |arguments: &[&str]| -> Vec<String> {
        let out = ogrinfo(&server, arguments);
        out.lines().filter_map(|line| line.trim().strip_prefix("edge_id (String) = ")).map(str::to_owned).collect()
    };
    let of_edges = |more: &[&str]| -> Vec<String> {
        let sql = format!("SELECT * FROM \"{EDGES}\"");
        written(&[&["-q", "-sql", &sql][..], more].concat())
    };
    assert_eq!(of_edges(&[]), ids(&read(&server, EDGES, "").0));
    let rows = server.place.rows(VEHICLE);
    let (lon, lat) = rows[200].line[0].degrees();
    let sides = [lon - 0.01, lat - 0.01, lon + 0.01, lat + 0.01].map(|side| side.to_string());
    let spat = ["-spat", &sides[0], &sides[1], &sides[2], &sides[3]];
    let inside = ids(&read(&server, EDGES, &format!("bbox={}", sides.join(","))).0);
    assert!(!inside.is_empty() && inside.len() < rows.len());
    assert_eq!(of_edges(&spat), inside);
    let safe = ids(&read(&server, EDGES, &format!("filter={}", encoded("verdict = 'safe' AND rsc_m >= 0.5"))).0);
    let sql = format!("SELECT * FROM \"{EDGES}\" WHERE verdict = 'safe' AND rsc_m >= 0.5");
    assert_eq!(written(&["-q", "-sql", &sql]), safe);
}

#[test]
fn owslib_lists_and_pages() {
    let Some(python) = python("owslib", &["OWSLib==0.35.0"]) else { return };
    let server = Server::demo();
    let mut command = Command::new(python);
    command
        .arg(script("check_features.py"))
        .arg(format!("http://{}/ogc/", server.address))
        .env("NO_PROXY", "127.0.0.1");
    let said = ProgramRun::of("check_features.py", &mut command).succeeds().json();
    let classes: Vec<&str> =
        said["conformance"].as_array().unwrap().iter().map(|class| class.as_str().unwrap()).collect();
    assert!(classes.contains(&"http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/core"));
    assert_eq!(said["api"], "3.0.3");
    let mut names: Vec<&String> = said["collections"].as_object().unwrap().keys().collect();
    names.sort_unstable();
    assert!(names.iter().eq(&ALL), "{names:?}");
    for collection in ALL {
        let own = &said["collections"][collection];
        let (features, _) = read(&server, collection, "");
        assert_eq!(own["ids"], json!(ids(&features)), "{collection}");
        let box_text: Vec<String> = own["box"].as_array().unwrap().iter().map(Value::to_string).collect();
        let inside = read(&server, collection, &format!("bbox={}", box_text.join(","))).0.len();
        assert_eq!(own["in_box"], json!(inside), "{collection}");
        let safe = features.iter().filter(|feature| feature["properties"]["verdict"] == "safe").count();
        assert_eq!(own["safe"], if collection == "junctions" { Value::Null } else { json!(safe) }, "{collection}");
    }
}

#[test]
fn qgis_opens_a_collection() {
    let python = || Command::new("/usr/bin/python3");
    if !python().args(["-c", "import qgis.core"]).output().is_ok_and(|out| out.status.success()) {
        return skipped("qgis", "Debian: python3-qgis");
    }
    let server = Server::demo();
    let rows = server.place.rows(VEHICLE);
    let (lon, lat) = rows[200].line[0].degrees();
    let sides = [lon - 0.01, lat - 0.01, lon + 0.01, lat + 0.01].map(|side| side.to_string());
    let mut command = python();
    command.arg(script("run_qgis_features.py")).arg(format!("http://{}/ogc", server.address)).arg(EDGES).args(&sides);
    command.arg("\"verdict\" = 'safe'").env("QT_QPA_PLATFORM", "offscreen").env("NO_PROXY", "127.0.0.1");
    let said = ProgramRun::of("run_qgis_features.py", &mut command).succeeds().out();
    // QGIS may say more before.
    let said: Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    assert_eq!((&said["fields"]["edge_id"], &said["fields"]["rsc_m"]), (&json!("String"), &json!("Real")));
    let sorted = |parameters: &str| {
        let mut ids = ids(&read(&server, EDGES, parameters).0);
        ids.sort_unstable();
        json!(ids)
    };
    assert_eq!(said["all"], sorted(""));
    assert_eq!(said["in_box"], sorted(&format!("bbox={}", sides.join(","))));
    assert_eq!(said["filtered"], sorted(&format!("filter={}", encoded("verdict = 'safe'"))));
}
