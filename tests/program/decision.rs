//! Decision sheets: what they say of each answer, and that the server's is that of the command line.

use serde_json::Value;

use crate::serve::http::Server;
use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-ATRIPLE53";
/// Along the Great Inland Highway, straight on.
const ALONG: [&str; 2] = ["126.050430,-30.217983", "126.049200,-30.213800"];
/// From the Stock Route Road round a corner into the Great Inland Highway, where the assumed kerb is too sharp.
const ROUND_A_CORNER: [&str; 2] = ["126.026942,-30.203315", "126.046615,-30.205563"];

fn line([from, to]: [&str; 2]) -> String {
    format!("route --vehicle {VEHICLE} --from {from} --to {to}")
}

fn page(place: &WorkFolder, places: [&str; 2], more: &str) -> String {
    place.netcert(&format!("{} --decision out.html {more}", line(places))).succeeds().tells("the decision sheet");
    String::from_utf8(place.read("out.html")).unwrap()
}

#[test]
fn a_certified_way_says_so_and_what_it_rests_on() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let said = page(&place, ALONG, "--case A-17<b> --applicant Miller&Sons");
    for part in [
        "<h2>Certified on the whole way</h2>",
        "<th>From</th><td>latitude -30.21798, longitude 126.05043",
        "<th>To</th>",
        "It is no permit.",
        "<td>A-17&lt;b&gt;</td>",
        "<td>Miller&amp;Sons</td>",
        "<th>Applicant's reference</th><td class=\"fill\" contenteditable=\"true\">",
        "Great Inland Highway",
        "the whole carriageway",
        "Within the stated model, widths and error bounds.",
        "☐ granted",
        "© OpenStreetMap contributors",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let stats = place.netcert("stats --format json").succeeds().json();
    let hash = stats["runs"].as_array().into_iter().flatten().find_map(|run| run["input_blake3"].as_str());
    assert!(said.contains(hash.unwrap()), "the hash of the map: {hash:?}");
    assert!(!said.contains("Only under conditions") && !said.contains("What stands in the way"));
    assert_eq!(said, page(&place, ALONG, "--case A-17<b> --applicant Miller&Sons"), "no date of its own");
    place.netcert(&format!("{} --case A-17", line(ALONG))).ends_as_misuse();
}

#[test]
fn a_way_under_conditions_is_not_certified_and_lists_them() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let said = page(&place, ROUND_A_CORNER, "");
    let answer = place.netcert(&format!("{} --format json", line(ROUND_A_CORNER))).succeeds().json();
    let conditions = answer["conditional"]["conditions"].as_array().unwrap().len();
    assert!(said.contains("<h2>Only under conditions: not certified</h2>") && !said.contains("Certified on"));
    let list = said.split("What would have to be so").nth(1).unwrap().split("</table>").next().unwrap();
    assert_eq!(list.matches("<tr><td>").count(), conditions, "{list}");
    let feet = page(&place, ROUND_A_CORNER, "--decision-units feet");
    assert!(feet.contains(" ft") && feet.contains(" mi, about"));
}

#[test]
fn without_a_way_the_sheet_says_no_and_what_stands_in_it() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let said = page(&place, ROUND_A_CORNER, "--certified-only");
    let answer = place.netcert(&format!("{} --certified-only --format json", line(ROUND_A_CORNER))).succeeds().json();
    for part in [
        "<h2>Not certified</h2>",
        "That does not say that no driver could do it.",
        "Nobody asked whether measurements would help.",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!said.contains("☐ granted"));
    let list = said.split("What stands in the way").nth(1).unwrap().split("</table>").next().unwrap();
    assert_eq!(list.matches("<tr><td>").count(), answer["obstacles"].as_array().unwrap().len());
    assert!(list.contains("not certified: width") && list.contains("longitude 126."), "{list}");
}

#[test]
fn the_server_s_sheet_is_that_of_the_command_line() {
    let server = Server::over(WorkFolder::with_wide_demo(VEHICLE), "serve --db demo.gpkg --addr 127.0.0.1:0");
    let body = |page: &str| page.split("<body>").nth(1).unwrap().to_owned();
    for (places, more, asked) in [
        (ALONG, "", ""),
        (ROUND_A_CORNER, "", ""),
        (ROUND_A_CORNER, "--certified-only", "&conditions=none"),
        (ALONG, "--decision-units feet", "&units=feet"),
    ] {
        let [from, to] = places;
        let target = format!("/api/decision.html?vehicle={VEHICLE}&from={from}&to={to}&tries=30{asked}");
        let reply = server.get(&target);
        assert_eq!(reply.header("content-type"), Some("text/html; charset=utf-8"), "{}", reply.text());
        assert_eq!(body(&reply.text()), body(&page(&server.place, places, more)), "{target}");
    }
    let problem = server.problem(&format!("/api/decision.html?vehicle={VEHICLE}&from=1,1&to=2,2&units=miles"), 400);
    assert_eq!(problem["parameter"], Value::from("units"));
}
