//! Each thing that can be wrong, with its message.

use super::write::{read_as, read_csv, refusal};

/// The message for one row with these columns beside `source`.
#[track_caller]
fn message(header: &str, cells: &str) -> String {
    let text = refusal(read_csv(&format!("source,{header}\noffice,{cells}\n")));
    let (first, rest) = text.split_once('\n').unwrap();
    assert!(rest.contains("nothing was read"), "{rest}");
    first.strip_prefix("rows.csv:row 2: ").unwrap_or(first).to_owned()
}

#[track_caller]
fn check(header: &str, cells: &str, expected: &str) {
    let found = message(header, cells);
    assert!(found.starts_with(expected), "{cells}\n found: {found}\nwanted: {expected}");
}

#[test]
fn units_that_were_mixed_up_are_found() {
    let header = "quantity,value,unit,edge_id";
    let width = "value: 350 m is no width of a road (0.5 to 60 m); is it cm (3.5 m)? Then write `cm` in column `unit`";
    check(header, "lane_width,350,,1", width);
    check(header, "carriageway_width,0.4,,1", "value: 0.4 m is no width of a road (0.5 to 60 m); check value and unit");
    check(header, "lane_width,3.5,cm,1", "value: 3.5 cm is no width of a road (0.5 to 60 m); check value and unit");
    check(
        "quantity,value,junction",
        "kerb_radius,650,1",
        "value: 650 m is no radius of a kerb (0 to 100 m); is it cm (6.5 m)?",
    );
    check("quantity,value,junction", "kerb_radius,-1,1", "value: -1 m is no radius of a kerb");
    check(header, "max_height,38,,1", "value: 38 m is no height of a vehicle (0.5 to 20 m); is it ft (11.582 m)?");
    check(header, "max_weight,7500,,1", "value: 7500 t is no mass of a vehicle (0.1 to 500 t); is it kg (7.5 t)?");
    check(header, "max_weight,7,m,1", "unit: `m` is no unit of a mass of a vehicle; known are t, kg");
    check(
        header,
        "lane_width,3.5,furlong,1",
        "unit: `furlong` is no unit of a width of a road; known are m, cm, mm, ft, in",
    );
}

#[test]
fn numbers_must_be_numbers() {
    let header = "quantity,value,sigma,edge_id";
    check(header, "lane_width,wide,,1", "value: `wide` is no number; write it like 3.25");
    check(header, "lane_width,\"3,25\",,1", "value: `3,25` is no number; write a point, not a comma");
    check(header, "lane_width,inf,,1", "value: is not finite; give a number");
    check(header, "lane_width,,,1", "value: is empty; give what was measured");
    check(header, "lane_width,3,-0.1,1", "sigma: -0.1 is negative; give the standard uncertainty");
    check(header, "lane_width,3,NaN,1", "sigma: is not finite");
    check(header, "lane_width,3,4,1", "sigma: 4 is more than the value, 3");
    check(header, "lane_width,3,,1.2E+18", "edge_id: 1.2E+18 is a rounded number, and no id; keep ids as text");
    check(header, "lane_width,3,,way/12", "edge_id: `way/12` is no id; give a whole number");
}

#[test]
fn a_row_has_one_place_that_fits() {
    let header =
        "quantity,value,way_id,from_node,to_node,edge_id,junction,from_edge,to_edge,lon,lat,geometry,direction";
    let place = "geometry: no place; give `way_id`, `edge_id`, `junction`, `lon` and `lat`, or a geometry";
    check(header, "lane_width,3,,,,,,,,,,,", place);
    check(header, "lane_width,3,,,,1,2,,,,,,", "junction: the row names a way or edge, too; keep one of them");
    check(header, "lane_width,3,1,2,,,,,,,,,", "to_node: is empty, and `from_node` is not; give both");
    check(header, "lane_width,3,,2,3,,,,,,,,", "from_node: part of a way needs `way_id`, and no `edge_id`");
    check(header, "kerb_radius,3,,,,,,2,3,,,,", "from_edge: a corner needs its node in `junction`");
    check(header, "lane_width,3,,,,,,,,8,,,", "lat: is empty, and `lon` is not; give both");
    check(header, "lane_width,3,,,,,,,,8,49,POINT (8 49),", "lon: the row has a geometry, too; keep one of them");
    check(header, "lane_width,3,,,,,5,,,,,,", "quantity: a `lane_width` belongs to a road");
    check(header, "kerb_radius,3,5,,,,,,,,,,", "quantity: a `kerb_radius` belongs to a junction");
    check(header, "surface,,5,,,,,,,,,,", "geometry: a `surface` needs a polygon");
    check(header, "lane_width,3,,,,5,,,,,,,forward", "direction: only ways, lines and points need one; leave it empty");
    check(
        header,
        "lane_width,3,5,,,,,,,,,,north",
        "direction: `north` is no direction; known are both, forward, backward",
    );
}

#[test]
fn positions_are_longitude_and_latitude() {
    let header = "quantity,value,lon,lat,geometry";
    check(header, "lane_width,3,-37.8,144.9,", "lon: longitude -37.8, latitude 144.9: they look swapped");
    check(header, "lane_width,3,477000,5475000,", "lon: x 477000, y 5475000 are no longitude and latitude in degrees");
    check(
        header,
        "lane_width,3,,,\"LINESTRING (8 49, 477000 5475000)\"",
        "geometry: x 477000, y 5475000 are no longitude",
    );
    check(header, "lane_width,3,,,\"LINESTRING (8 49, 8 49)\"", "geometry: the line has no length");
    check(
        header,
        "lane_width,3,,,\"LINESTRING (8 49, 8\"",
        "geometry: no well-known text: two numbers expected, the end found",
    );
    check(header, "lane_width,3,,,CIRCULARSTRING (8 49)", "geometry: neither point nor line nor polygon");
    check(header, "lane_width,3,,,SRID=25832;POINT (8 49)", "geometry: its reference system is 25832; transform it");
    check(
        header,
        "lane_width,3,,,\"MULTILINESTRING ((8 49, 8.1 49), (8 49, 8.1 49))\"",
        "geometry: 2 parts; write one row for each",
    );
    check(
        header,
        "lane_width,3,,,\"POLYGON ((8 49, 8.1 49, 8 49.1, 8 49))\"",
        "geometry: only a `surface` is a polygon",
    );
    check(header, "surface,,,,\"POLYGON ((8 49, 8.1 49, 8 49.1))\"", "geometry: a ring of the polygon is not closed");
}

#[test]
fn the_other_columns_are_checked_too() {
    check("quantity,value,edge_id", ",3,1", "quantity: is empty; known are carriageway_width, direction_width");
    check("quantity,value,edge_id", "width,3,1", "quantity: `width` is none; known are carriageway_width");
    check(
        "quantity,value,edge_id,date",
        "lane_width,3,1,31.5.2026",
        "date: `31.5.2026` is no day; write it like 2026-05-31",
    );
    check("quantity,value,edge_id,date", "lane_width,3,1,2026-02-30", "date: `2026-02-30` is no day");
    check(
        "quantity,value,edge_id,vehicle",
        "lane_width,3,1,X",
        "vehicle: belongs to `drivable_by`; leave it empty here",
    );
    check("quantity,value,edge_id,vehicle", "drivable_by,,1,", "vehicle: is empty; give the id of the vehicle");
    check("quantity,sigma,edge_id,vehicle", "drivable_by,3,1,X", "sigma: `drivable_by` takes none; leave it empty");
    let square = "POLYGON ((8 49, 8.001 49, 8.001 49.001, 8 49))";
    check(
        "quantity,sigma,geometry",
        &format!("surface,30,\"{square}\""),
        "sigma: 30 m is no uncertainty of an outline",
    );
    check("quantity,sigma,geometry", &format!("surface,-1,\"{square}\""), "sigma: -1 is negative");
    check("quantity,value,edge_id,vehicle", "drivable_by,3,1,X", "value: `drivable_by` takes none; leave it empty");
    let text = refusal(read_csv("quantity,value,edge_id,source\nlane_width,3,1, \n"));
    assert!(text.starts_with("rows.csv:row 2: source: is empty; say who measured it"), "{text}");
}

#[test]
fn headers_are_checked() {
    let unknown = refusal(read_csv("quantity,value,edge_id,source,widht,colour\n"));
    let wanted =
        "unknown columns `widht`, `colour`; known are quantity, value, unit, sigma, source, date, licence, way_id";
    assert!(unknown.starts_with(&format!("rows.csv: {wanted}")), "{unknown}");
    assert_eq!(refusal(read_csv("quantity,what,value\n")), "rows.csv: two columns for `quantity`; keep one of them");
    assert_eq!(refusal(read_csv("quantity,value,source\n")), "rows.csv: has no rows; nothing was read");
    assert_eq!(refusal(read_csv("")), "rows.csv: is empty; was it written to its end?");
    assert_eq!(
        refusal(read_as("rows.csv", b"quantity,\xff\n")),
        "rows.csv: line 1 is no UTF-8; save the file as UTF-8"
    );
}

#[test]
fn a_row_that_was_cut_is_found() {
    let header = "quantity,source,note,value,edge_id\n";
    let cells = refusal(read_csv(&format!("{header}lane_width,office,x,3.5\n")));
    assert!(cells.starts_with("rows.csv: line 2: 4 cells, and the header has 5 columns"), "{cells}");
    let open = refusal(read_csv(&format!("{header}lane_width,office,\"x,3.5,12\nlane_width,office,x,3.5,1\n")));
    assert!(open.starts_with("rows.csv: line 2: a quotation mark is not closed"), "{open}");
    let number = refusal(read_csv(&format!("{header}lane_width,office,x,3.5,12")));
    assert!(
        number.starts_with("rows.csv: row 2: edge_id: the file ends within the line, so this may be cut off"),
        "{number}"
    );
    assert!(read_csv("quantity,value,edge_id,source\nlane_width,3.5,12,office").is_ok());
}

#[test]
fn all_faulty_rows_count_and_the_first_twenty_are_shown() {
    let mut text = "quantity,value,edge_id,source\n".to_owned();
    for value in 0..30 {
        text += &format!("lane_width,{value},1,office\nlane_width,{value},,\n");
    }
    let message = refusal(read_csv(&text));
    assert_eq!(message.lines().count(), 21, "{message}");
    let sum = message.lines().last().unwrap();
    assert_eq!(sum, "rows.csv: nothing was read: 62 faults in 31 rows, the first 20 shown");
}

#[test]
fn a_file_that_is_not_there_says_so() {
    let missing = super::super::read(std::path::Path::new("no/such/rows.csv")).expect_err("no file").to_string();
    assert!(missing.starts_with("no/such/rows.csv: "), "{missing}");
}
