//! `route --at-most`: the sets that a ladder needs are made, and every output says where the route uses more than its own lane.

use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use netcert_testing::program::WorkFolder;
use serde_json::Value;

use crate::serve::http::Server;

pub(crate) const FROM_TO: &str = "--from 0.0005,0 --to 0.0065,0";

/// A straight road of 780 m at the equator, with side roads and 120 m of 5.4 m between roads of 7 m: a lane of 2.7 m is too narrow for
/// AU-SEMI19.
pub(crate) fn bottleneck() -> WorkFolder {
    let at = |id, lon_e7, lat_e7| NodeRecord { id, place: LonLat { lon_e7, lat_e7 }, tags: Vec::new() };
    let main =
        [(1, 0), (2, 15_000), (3, 30_000), (4, 40_800), (5, 55_000), (6, 70_000)].map(|(id, lon)| at(id, lon, 0));
    let nodes = [&main[..], &[at(7, 15_000, -9_000), at(8, 55_000, -9_000)]].concat();
    let way = |id, refs: &[i64], tags: &[(&str, &str)]| {
        let tags = tags.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect();
        WayRecord { id, refs: refs.to_vec(), tags }
    };
    let wide = [("highway", "secondary"), ("lanes", "2"), ("width", "7")];
    let narrow = [("highway", "secondary"), ("lanes", "2"), ("width", "5.4")];
    let side = [("highway", "residential")];
    let ways = [
        way(1, &[1, 2, 3], &wide),
        way(2, &[3, 4], &narrow),
        way(3, &[4, 5, 6], &wide),
        way(4, &[2, 7], &side),
        way(5, &[5, 8], &side),
    ];
    let folder = WorkFolder::empty().file("road.osm.pbf", write_extract(&nodes, &ways));
    folder.netcert("ingest road.osm.pbf --db demo.gpkg --vehicle AU-SEMI19").succeeds();
    folder
}

fn uses(route: &Value) -> &Vec<Value> {
    route["uses"].as_array().unwrap()
}

#[test]
fn a_route_that_climbs_says_where_and_how_far_in_every_output() {
    let place = bottleneck();
    let level = format!("route --db demo.gpkg --vehicle AU-SEMI19 {FROM_TO} --certified-only");
    let refused = place.netcert(&level).succeeds();
    refused
        .shows("no certified route")
        .shows("`--at-most carriageway` would use more")
        .shows("(lane policy, every turn's kerbs");
    place
        .netcert(&format!("{level} --at-most lane"))
        .fails()
        .tells("--at-most lane: the certificates are of the lane policy already");

    let climbing = format!("{level} --at-most carriageway");
    place
        .netcert(&format!("{climbing} --out way.json --svg way.svg"))
        .succeeds()
        .tells("AU-SEMI19 is not certified in demo.gpkg under the direction policy yet: doing it now")
        .tells("AU-SEMI19 is not certified in demo.gpkg under the carriageway policy yet: doing it now")
        .shows("a certified route, 0.7 km")
        .shows("Beyond its own lane:")
        .shows("the oncoming lane")
        .shows("Beyond all lanes of its direction for")
        .shows("(lane policy, where that is not enough up to");
    // The certificate is checked as any other, and a signature covers what it uses.
    place.netcert("verify way.json").succeeds();
    let file: Value = serde_json::from_slice(&place.read("way.json")).unwrap();

    let json = place.netcert(&format!("{climbing} --format json")).succeeds().json();
    let route = &json["routes"][0];
    assert_eq!(route["rung"], "carriageway");
    assert_eq!(&file["origin"]["uses"], &route["uses"]);
    let length_m: f64 =
        uses(route).iter().map(|used| used["to_m"].as_f64().unwrap() - used["from_m"].as_f64().unwrap()).sum();
    // The narrow part has 120 m, and the vehicle moves over before it and back after it.
    assert!((100.0..260.0).contains(&length_m), "{length_m}");
    for used in uses(route) {
        assert_eq!(
            (&used["strip"], &used["where"], &used["side"]),
            (&"carriageway".into(), &"road".into(), &"left".into())
        );
        let beyond_m = used["beyond_m"].as_f64().unwrap();
        assert!(beyond_m > 0.0 && beyond_m < 1.5, "{used}");
        // The narrow part lies 278 to 398 m from the beginning.
        assert!(
            used["from_m"].as_f64().unwrap() > 278.0 - 80.0 && used["to_m"].as_f64().unwrap() < 398.0 + 80.0,
            "{used}"
        );
    }

    // The picture has a bar for each use, with its distance, and says what holding traffic back takes.
    let drawn = String::from_utf8(place.read("way.svg")).unwrap();
    let places = uses(route).len();
    let head = format!("Beyond its own lane: beyond all lanes of its direction for {length_m:.0} m at {places} place");
    assert!(drawn.contains(&head), "{head}");
    for used in uses(route) {
        let number = format!(">{:.2} m<", used["beyond_m"].as_f64().unwrap());
        assert!(drawn.contains(&number), "{number}");
    }

    let geojson = place.netcert(&format!("{climbing} --format geojson")).succeeds().json();
    let features = geojson["features"].as_array().unwrap();
    let drawn: Vec<&Value> = features.iter().filter(|feature| feature["properties"]["feature"] == "use").collect();
    assert_eq!(drawn.len(), uses(route).len());
    for (feature, used) in drawn.iter().zip(uses(route)) {
        let line = feature["geometry"]["coordinates"].as_array().unwrap();
        let lon = |at: usize| line[at][0].as_f64().unwrap();
        let along_m = |lon: f64| (lon - 0.0005) * 111_320.0;
        assert!((along_m(lon(0)) - used["from_m"].as_f64().unwrap()).abs() < 3.0, "{feature}");
        assert!((along_m(lon(line.len() - 1)) - used["to_m"].as_f64().unwrap()).abs() < 3.0, "{feature}");
    }
}

#[test]
fn the_server_climbs_as_the_verb_does_and_refuses_what_it_lacks() {
    let place = bottleneck();
    let climbing = format!(
        "route --db demo.gpkg --vehicle AU-SEMI19 {FROM_TO} --certified-only --at-most carriageway --format json"
    );
    let told = place.netcert(&climbing).succeeds().json();
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0");
    let ask = "/api/route?vehicle=AU-SEMI19&policy=lane&from=0.0005,0&to=0.0065,0&drive=none&conditions=none";
    assert_eq!(server.json(ask)["routes"].as_array().unwrap().len(), 0);
    let answer = server.json(&format!("{ask}&at_most=carriageway"));
    assert_eq!((&answer["policy"], &answer["at_most"]), (&"lane".into(), &"carriageway".into()));
    let numbers = |route: &Value| -> Vec<Value> {
        uses(route)
            .iter()
            .flat_map(|used| ["what", "from_m", "to_m", "beyond_m"].map(|name| used[name].clone()))
            .collect()
    };
    assert_eq!(numbers(&answer["routes"][0]), numbers(&told["routes"][0]));
    assert_eq!(answer["routes"][0]["rsc_m"], told["routes"][0]["rsc_m"]);
    for (more, words) in [("at_most=lane", "name a policy that is wider than"), ("at_most=road", "at_most")] {
        let refused = server.get(&format!("{ask}&{more}"));
        assert_eq!(refused.status, 400, "{more}");
        assert!(refused.text().contains(words), "{more}: {}", refused.text());
    }
}
