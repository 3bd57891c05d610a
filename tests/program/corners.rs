//! `netcert corners`: the table as text, JSON, CSV and a picture.

use netcert_testing::program::WorkFolder;
use netcert_testing::thorough::cases;
use netcert_testing::xml;

#[test]
fn a_table_says_which_kerbs_do_and_what_they_hold_for() {
    let place = WorkFolder::empty();
    // A table of a right angle takes three times as long.
    let angle = cases(30, 90);
    let corners = format!("corners --vehicle US-WB40 --angle {angle}");
    let text = place.netcert(&format!("{corners} --svg corners.svg")).succeeds();
    text.shows(&format!("turn by {angle}°")).shows("0: a sharp corner does").shows("no permit");
    let svg = String::from_utf8(place.read("corners.svg")).unwrap();
    xml::well_formed(&svg);
    let cells = svg.matches("<rect").count();
    assert!((100..110).contains(&cells), "one panel of ten widths by ten: {cells}");

    let json = place.netcert(&format!("{corners} --format json")).succeeds().json();
    let table = &json["corners"][0];
    let widths_m = table["from_and_to_widths_m"].as_array().unwrap();
    let least = table["angles"][0]["least_kerb_radius_m"].as_array().unwrap();
    assert_eq!((table["angles"][0]["turn_deg"].as_f64(), least.len()), (Some(f64::from(angle)), widths_m.len()));

    // The lines of the CSV are the table, row by row.
    let csv = place.netcert(&format!("{corners} --format csv")).succeeds().out();
    let radii: Vec<Option<f64>> =
        csv.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().ok()).collect();
    let of_json: Vec<Option<f64>> =
        least.iter().flat_map(|row| row.as_array().unwrap()).map(serde_json::Value::as_f64).collect();
    assert_eq!(radii, of_json);
    let some = radii.iter().flatten().any(|&radius_m| radius_m > 0.0);
    assert!(some && radii.contains(&Some(0.0)) && radii.contains(&None), "{radii:?}");
}

#[test]
fn what_has_no_table_is_named() {
    let place = WorkFolder::empty();
    place.netcert("corners --vehicle US-WB40 --angle 170").ends_as_misuse().tells("a turn is by 15 to 145 degrees");
    place
        .netcert("corners --vehicle US-WB40 EU-SEMI16.5 --angle 90 --svg x.svg")
        .fails()
        .tells("--svg draws one vehicle");
    place.netcert("corners --vehicle US-WB4").fails().tells("did you mean");
    place.netcert("corners").ends_as_misuse().tells("--vehicle");
}
