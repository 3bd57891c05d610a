//! Routes under conditions, their sheets and suppositions over HTTP: as the program tells them, and never taken for safe.

use netcert::osm::facts::Policy;
use netcert::store::{QueryOptions, TurnQuery};
use netcert::verdict::{UnsafeReason, Verdict};
use serde_json::{Value, json};

use super::http::Server;
use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-ATRIPLE53";
const SHORT: &str = "AU-SEMI19";
/// From the Stock Route Road round a corner into the Great Inland Highway, where the assumed kerb is too sharp.
const CORNER: [&str; 2] = ["126.026942,-30.203315", "126.046615,-30.205563"];
/// Along the Great Inland Highway, straight on.
const ALONG: [&str; 2] = ["126.050430,-30.217983", "126.049200,-30.213800"];

fn wide() -> Server {
    Server::over(WorkFolder::with_wide_demo(VEHICLE), "serve --db demo.gpkg --addr 127.0.0.1:0")
}

fn asked([from, to]: [&str; 2]) -> String {
    format!("vehicle={VEHICLE}&from={from}&to={to}&tries=30")
}

/// A copy in which ids are text, as the server has them.
fn with_ids_as_text(mut value: Value) -> Value {
    fn change(value: &mut Value) {
        match value {
            Value::Array(all) => all.iter_mut().for_each(change),
            Value::Object(members) => {
                for (name, member) in members {
                    match name.as_str() {
                        "edge_id" | "from_edge" | "to_edge" => *member = json!(member.to_string()),
                        "edge_ids" => {
                            for id in member.as_array_mut().unwrap() {
                                *id = json!(id.to_string());
                            }
                        }
                        _ => change(member),
                    }
                }
            }
            _ => {}
        }
    }
    change(&mut value);
    value
}

#[test]
fn a_route_under_conditions_is_that_of_the_verb_with_its_sheets() {
    let server = wide();
    let [from, to] = CORNER;
    let answer = server.json(&format!("/api/route?{}", asked(CORNER)));
    let line = format!("route --db demo.gpkg --vehicle {VEHICLE} --from={from} --to={to}");
    let told = with_ids_as_text(server.place.netcert(&format!("{line} --format json")).succeeds().json());
    assert_eq!(answer["routes"], json!([]), "a route under conditions is no certified route");
    let conditional = &answer["conditional"];
    assert_eq!((&conditional["safe"], &conditional["certificate"]["verdict"]), (&json!(false), &json!("conditional")));
    for (name, member) in told["conditional"].as_object().unwrap() {
        assert_eq!(&conditional[name], member, "{name}");
    }
    for name in ["rsc_m", "certificate", "conditions", "obstacles", "refuted"] {
        assert_eq!(answer[name], told[name], "{name}");
    }
    assert!(!answer["conditions"].as_array().unwrap().is_empty());
    assert!(conditional["geometry"]["coordinates"].as_array().unwrap().len() > 10);
    assert_eq!(conditional["drive"], Value::Null, "only certified routes are driven");
    assert!(answer["scope"].as_str().unwrap().contains("only if every condition holds"));

    for form in ["csv", "geojson", "html"] {
        server.place.netcert(&format!("{line} --sheet sheet.{form}")).succeeds();
        let written = String::from_utf8(server.place.read(&format!("sheet.{form}"))).unwrap();
        let reply = server.get(&format!("/api/sheet.{form}?{}", asked(CORNER)));
        assert_eq!(reply.status, 200, "{}", reply.text());
        if form == "html" {
            // The security policy forbids styles within pages, so the style sheet has an address.
            let (head, rest) = written.split_once("<style>").unwrap();
            let (style, body) = rest.split_once("</style>").unwrap();
            let page = reply.text();
            assert!(page.starts_with(head) && page.ends_with(body) && !page.contains("<style"), "{page}");
            assert_eq!(server.get("/api/sheet.css").text(), style);
            assert!(reply.header("content-security-policy").unwrap().contains("style-src 'self'"));
        } else {
            assert_eq!(reply.text(), written, "{form}");
        }
    }
}

#[test]
fn the_sheet_in_feet_asks_for_no_less_than_the_sheet_in_metres() {
    let server = wide();
    let answer = server.json(&format!("/api/route?{}", asked(CORNER)));
    let reply = server.get(&format!("/api/sheet.html?{}&units=feet", asked(CORNER)));
    assert_eq!(reply.status, 200, "{}", reply.text());
    let page = reply.text();
    for condition in answer["conditions"].as_array().unwrap() {
        let needed_m = condition["needed"].as_f64().unwrap();
        let (before, _) =
            page.split_once(&format!(" ({needed_m:.2} m)")).unwrap_or_else(|| panic!("{needed_m}: {page}"));
        let words: Vec<&str> = before.rsplit([' ', '>']).take(4).collect();
        let inches = match words[..] {
            ["in", inches, "ft", feet] => 12.0 * feet.parse::<f64>().unwrap() + inches.parse::<f64>().unwrap(),
            ["ft", feet, ..] => 12.0 * feet.parse::<f64>().unwrap(),
            _ => panic!("{words:?}"),
        };
        let more_m = inches * 0.0254 - needed_m;
        assert!((-1e-6..0.0254).contains(&more_m), "{words:?} for {needed_m} m");
    }
    assert!(page.contains("Measured, ft and in") && page.contains(" mi if ") && !page.contains(" km if "));
    server.problem(&format!("/api/sheet.html?{}&units=miles", asked(CORNER)), 400);
    server.problem(&format!("/api/sheet.csv?{}&units=feet", asked(CORNER)), 400);
}

#[test]
fn without_a_search_for_conditions_the_answer_says_what_blocks_and_on_which_way() {
    let server = wide();
    let answer = server.json(&format!("/api/route?{}&conditions=none", asked(CORNER)));
    assert_eq!((&answer["routes"], &answer["conditional"]), (&json!([]), &Value::Null));
    let obstacles = answer["obstacles"].as_array().unwrap();
    assert!(!obstacles.is_empty());
    for obstacle in obstacles {
        // An edge rests on a width, a turn on a kerb. Nobody has measured a kerb of the drawn region.
        let (width, kerb) = (&obstacle["width_source"], &obstacle["kerb_assumed"]);
        let edge = obstacle["kind"] == "edge";
        assert!(
            if edge { width.is_string() && kerb.is_null() } else { width.is_null() && *kerb == json!(true) },
            "{obstacle}"
        );
    }
    let line = answer["blocked_way"]["coordinates"].as_array().unwrap();
    let near = |place: &Value, wanted: &str| {
        let wanted: Vec<f64> = wanted.split(',').map(|text| text.parse().unwrap()).collect();
        (0..2).all(|axis| (place[axis].as_f64().unwrap() - wanted[axis]).abs() < 2e-3)
    };
    assert!(near(&line[0], CORNER[0]) && near(line.last().unwrap(), CORNER[1]), "{line:?}");
    server.problem(&format!("/api/sheet.csv?{}&conditions=none", asked(CORNER)), 404);

    let certified = server.json(&format!("/api/route?{}", asked(ALONG)));
    assert_eq!(certified["certificate"]["verdict"], "safe");
    assert_eq!((&certified["conditional"], &certified["blocked_way"]), (&Value::Null, &Value::Null));
    let problem = server.problem(&format!("/api/sheet.html?{}", asked(ALONG)), 404);
    assert!(problem["detail"].as_str().unwrap().contains("no route under conditions"));
    server.problem(&format!("/api/route?{}&conditions=maybe", asked(ALONG)), 400);
}

/// What an answer about a supposition may never do.
fn is_no_certificate(answer: &Value) {
    assert_eq!(answer["safe"], false);
    assert_ne!(answer["verdict"], "safe");
    assert!(answer["scope"].as_str().unwrap().contains("A supposition is no certificate"));
}

#[test]
fn an_edge_that_lacks_room_would_do_with_its_need_and_not_as_it_is() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let options = QueryOptions::new(VEHICLE, Policy::Carriageway);
    let rows: Vec<_> = place.database().query(&options).unwrap().map(Result::unwrap).collect();
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0");
    let of = |id: i64, metres: f64| server.json(&format!("/api/suppose/{id}?vehicle={VEHICLE}&metres={metres}"));
    let narrow: Vec<_> = rows.iter().filter(|row| row.need_width_m.is_some()).step_by(9).take(6).collect();
    assert!(!narrow.is_empty());
    let mut opened = 0;
    for row in narrow {
        assert_eq!(row.certificate.verdict, Verdict::Unsafe(UnsafeReason::Width));
        let slider = &server.json(&format!("/api/explain/{}?vehicle={VEHICLE}", row.edge.id))["suppose"];
        let number = |name: &str| slider[name].as_f64().unwrap();
        // The database has an estimate. The width above the slider was certified.
        let need_m = number("need");
        let estimate_m = row.need_width_m.unwrap();
        assert!((need_m - estimate_m).abs() < 0.5, "{need_m} {estimate_m}");
        let met = of(row.edge.id, need_m);
        is_no_certificate(&met);
        assert_eq!(
            (&met["enough"], &met["verdict"], &met["need"]),
            (&json!(true), &json!("conditional"), &json!(estimate_m))
        );
        assert!(met["rsc_m"].as_f64().unwrap() >= 0.0);
        for other in met["opens"].as_array().unwrap() {
            let id: i64 = other["edge_id"].as_str().unwrap().parse().unwrap();
            let known = rows.iter().find(|row| row.edge.id == id).unwrap();
            assert!(matches!(known.certificate.verdict, Verdict::Unsafe(_)) && id != row.edge.id);
            opened += 1;
        }
        let as_it_is = of(row.edge.id, 0.0);
        is_no_certificate(&as_it_is);
        assert_eq!((&as_it_is["enough"], &as_it_is["verdict"]), (&json!(false), &json!("unsafe")));
        assert!((as_it_is["rsc_m"].as_f64().unwrap() - row.certificate.rsc_m.unwrap()).abs() < 2e-3);
        assert_eq!(as_it_is["opens"], json!([]), "nothing opens where nothing is supposed");
        assert!(number("low") <= number("now") && need_m <= number("high"), "{slider}");
    }
    assert!(opened > 0, "no supposition opens another edge");
    let forbidden = rows.iter().find(|row| matches!(row.certificate.verdict, Verdict::Forbidden(_))).unwrap();
    server.problem(&format!("/api/suppose/{}?vehicle={VEHICLE}&metres=9", forbidden.edge.id), 404);
    server.problem(&format!("/api/suppose/{}?vehicle={VEHICLE}", rows[0].edge.id), 400);
    server.problem(&format!("/api/suppose/{}?vehicle={VEHICLE}&metres=NaN", rows[0].edge.id), 400);
}

#[test]
fn a_turn_would_do_with_the_radius_that_it_needs() {
    let place = WorkFolder::with_wide_demo(SHORT);
    place.netcert(&format!("certify --db demo.gpkg --vehicle {SHORT} --corridor carriageway --needs all")).succeeds();
    let turns = place.database().query_turns(&TurnQuery::new(SHORT, Policy::Carriageway)).unwrap();
    let server = Server::over(place, "serve --db demo.gpkg --addr 127.0.0.1:0");
    let sharp: Vec<_> = turns.iter().filter(|turn| turn.need_kerb_radius_m.is_some()).step_by(7).take(4).collect();
    assert!(!sharp.is_empty());
    for turn in sharp {
        let (id, need_m) = (turn.turn.id, turn.need_kerb_radius_m.unwrap());
        let of = |metres: f64| server.json(&format!("/api/suppose/{id}?vehicle={SHORT}&metres={metres}"));
        let met = of(need_m);
        is_no_certificate(&met);
        assert_eq!(
            (&met["enough"], &met["quantity"], &met["need"]),
            (&json!(true), &json!("kerb_radius"), &json!(need_m))
        );
        let as_it_is = of(turn.kerb_radius_m.unwrap());
        is_no_certificate(&as_it_is);
        assert_eq!(as_it_is["enough"], false);
        assert_eq!(server.json(&format!("/api/explain/{id}?vehicle={SHORT}"))["suppose"]["need"], json!(need_m));
    }
    server.problem(&format!("/api/suppose/{}?vehicle={SHORT}&metres=26", turns[0].turn.id), 400);
}
