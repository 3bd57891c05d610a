//! Well-known text, as in the cells of a table. What is accepted and passes the checks of positions is finite and on the earth, and a shape
//! that is written again is read as the same shape.
#![no_main]

use libfuzzer_sys::fuzz_target;
use netcert_fuzz::check_shape;
use netcert_osm::shape::{Shape, Xy, from_text};

fuzz_target!(|text: &str| {
    if let Ok(Some(shape)) = from_text(text) {
        check_shape(&shape);
        let empty = match &shape {
            Shape::Point(_) => false,
            Shape::Line(line) => line.is_empty(),
            Shape::Polygon(rings) => rings.iter().any(Vec::is_empty),
        };
        // Hexadecimal binary may have lists that are empty, which text cannot say.
        if !empty {
            let again = from_text(&written(&shape)).expect("what was read").expect("a shape that is not empty");
            // Not `==`: a coordinate may be no number.
            assert_eq!(format!("{shape:?}"), format!("{again:?}"));
        }
    }
});

fn written(shape: &Shape) -> String {
    let line = |line: &Vec<Xy>| {
        let places: Vec<String> = line.iter().map(|[x, y]| format!("{x:?} {y:?}")).collect();
        format!("({})", places.join(","))
    };
    match shape {
        Shape::Point([x, y]) => format!("POINT ({x:?} {y:?})"),
        Shape::Line(places) => format!("LINESTRING {}", line(places)),
        Shape::Polygon(rings) => format!("POLYGON ({})", rings.iter().map(line).collect::<Vec<_>>().join(",")),
    }
}
