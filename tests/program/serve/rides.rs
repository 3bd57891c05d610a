//! Routes over HTTP: the verb's own answer, and a drive along it that hangs together.

use serde_json::{Value, json};

use super::http::Server;
use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";

/// Over the demo region, where the whole carriageway counts: there a semi-trailer gets round some corners.
fn wide() -> Server {
    let place = WorkFolder::with_wide_demo("AU-SEMI19");
    Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0")
}

/// The middles of its edges that may be used.
fn middles(server: &Server) -> Vec<String> {
    let edges = server
        .place
        .netcert(&format!("query --db demo.gpkg --vehicle {VEHICLE} --verdict safe --format geojson"))
        .succeeds()
        .json();
    let middle = |feature: &Value| {
        let line = feature["geometry"]["coordinates"].as_array().unwrap();
        let place = &line[line.len() / 2];
        format!("{},{}", place[0], place[1])
    };
    edges["features"].as_array().unwrap().iter().map(middle).collect()
}

/// Two places that a certified route joins, round a corner if there are such among the first few hundred pairs.
fn places(server: &Server) -> [String; 2] {
    let all = middles(server);
    let mut joined = None;
    for (from, to) in
        all.iter().step_by(5).flat_map(|from| all.iter().rev().step_by(13).map(move |to| (from, to))).take(300)
    {
        let answer = server
            .json(&format!("/api/route?vehicle={VEHICLE}&from={from}&to={to}&drive=none&tries=30&conditions=none"));
        let route = &answer["routes"][0];
        if route["length_m"].as_f64().is_some_and(|m| m > 300.0) {
            let turns = route["parts"].as_array().unwrap().iter().any(|part| part["kind"] == "turn");
            let pair = [from.clone(), to.clone()];
            if turns {
                return pair;
            }
            joined = joined.or(Some(pair));
        }
    }
    joined.expect("no two places of the demo are joined by a certified route")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn a_route_is_that_of_the_verb_and_its_drive_hangs_together() {
    let server = wide();
    let [from, to] = places(&server);
    let answer = server.json(&format!("/api/route?vehicle={VEHICLE}&from={from}&to={to}&tries=30"));
    let line = format!("route --db demo.gpkg --vehicle {VEHICLE} --from={from} --to={to} --format json");
    let said = server.place.netcert(&line).succeeds().json();
    let (route, told) = (&answer["routes"][0], &said["routes"][0]);
    for name in ["length_m", "time_s", "rsc_m", "hinge_margin_deg", "shrink", "safe", "limiting_s_m", "limiting_side"] {
        assert_eq!(route[name], told[name], "{name}");
    }
    assert_eq!(route["parts"].as_array().unwrap().len(), told["parts"].as_array().unwrap().len());
    assert!(answer["scope"].as_str().unwrap().contains("no permit"));
    let id = &route["parts"][0]["edge_id"];
    assert_eq!(id, &json!(told["parts"][0]["edge_id"].to_string()), "ids are text");

    leeway_does_not_flatter(route);
    units_follow_each_other(&server, route);
}

fn leeway_does_not_flatter(route: &Value) {
    let leeway = &route["leeway"];
    let rsc_m = route["rsc_m"].as_f64().unwrap();
    let mut least = f64::INFINITY;
    for side in ["left_m", "right_m"] {
        let column = leeway[side].as_array().unwrap();
        assert_eq!(column.len(), leeway["s_m"].as_array().unwrap().len());
        for value in column.iter().filter_map(Value::as_f64) {
            least = least.min(value);
        }
    }
    assert!(least <= rsc_m + 0.3 && least >= rsc_m - 0.0011, "{least} {rsc_m}");
    assert!(leeway["rsc_m"].as_f64().unwrap() <= rsc_m);
}

/// Every unit's front coupling is where the unit ahead has its rear one, at every moment; nobody jumps; the first axle
/// is within the corridor.
fn units_follow_each_other(server: &Server, route: &Value) {
    let drive = &route["drive"];
    let t = numbers(&drive["t"]);
    assert!(t.len() > 20 && t.windows(2).all(|pair| pair[1] >= pair[0]), "{}", t.len());
    let vehicles = server.json("/api/vehicles");
    let vehicle = vehicles.as_array().unwrap().iter().find(|vehicle| vehicle["id"] == VEHICLE).unwrap();
    let units = drive["units"].as_array().unwrap();
    assert_eq!(units.len(), vehicle["units"].as_array().unwrap().len());
    let poses: Vec<Vec<Vec<f64>>> =
        units.iter().map(|unit| unit["poses"].as_array().unwrap().iter().map(numbers).collect()).collect();
    let (lon_m, lat_m) = {
        let lat = poses[0][0][1].to_radians();
        (111_320.0 * lat.cos(), 110_900.0)
    };
    let along = |pose: &[f64], ahead_m: f64| {
        let heading = pose[2].to_radians();
        [pose[0] * lon_m + ahead_m * heading.sin(), pose[1] * lat_m + ahead_m * heading.cos()]
    };
    for (i, unit) in units.iter().enumerate() {
        assert_eq!(poses[i].len(), t.len());
        let tube = numbers(&unit["tube_m"]);
        assert!(tube.len() == t.len() && tube.iter().all(|&m| m > 0.0 && m < 5.0), "{tube:?}");
        let Some(ahead) = i.checked_sub(1) else { continue };
        let hitch_m = vehicle["units"][ahead]["hitch_offset_m"].as_f64().unwrap();
        let own_m = unit["coupling_to_axle_m"].as_f64().unwrap();
        for (towing, towed) in poses[ahead].iter().zip(&poses[i]) {
            let (a, b) = (along(towing, -hitch_m), along(towed, own_m));
            let gap = (a[0] - b[0]).hypot(a[1] - b[1]);
            assert!(gap < 0.1, "unit {i}: {gap} m");
        }
    }
    for name in ["left_edge", "right_edge", "s_m"] {
        assert_eq!(drive[name].as_array().unwrap().len(), t.len(), "{name}");
    }
    let length_m = route["length_m"].as_f64().unwrap();
    assert!((numbers(&drive["s_m"]).last().unwrap() - length_m).abs() < 0.02);
}

#[test]
fn where_there_is_no_route_the_answer_says_what_blocks() {
    let server = wide();
    let all = middles(&server);
    let mut blocked = 0;
    for (from, to) in all.iter().zip(all.iter().rev()).step_by(9) {
        let answer = server
            .json(&format!("/api/route?vehicle={VEHICLE}&from={from}&to={to}&drive=none&tries=0&conditions=none"));
        if answer["routes"].as_array().unwrap().is_empty() {
            blocked += 1;
            for obstacle in answer["obstacles"].as_array().into_iter().flatten() {
                assert!(obstacle["title"].as_str().is_some_and(|title| !title.is_empty()), "{obstacle}");
                assert_ne!(obstacle["verdict"], "safe", "{obstacle}");
            }
        }
    }
    assert!(blocked > 0, "every pair is joined");
}
