//! Well-known binary, and the blobs of a GeoPackage around it. What is accepted and passes the checks of positions is finite and on the
//! earth, and a shape that is written again as plain well-known binary is read as the same shape.
#![no_main]

use libfuzzer_sys::fuzz_target;
use netcert_fuzz::check_shape;
use netcert_osm::shape::{Shape, Xy, from_geopackage, from_wkb};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(Some(shape)) = from_wkb(bytes) {
        check(&shape);
    }
    if let Ok((_, Some(shape))) = from_geopackage(bytes) {
        check(&shape);
    }
});

fn check(shape: &Shape) {
    check_shape(shape);
    let again = from_wkb(&written(shape)).expect("what was read").expect("a shape that is not empty");
    // Not `==`: a coordinate may be no number.
    assert_eq!(format!("{shape:?}"), format!("{again:?}"));
}

fn written(shape: &Shape) -> Vec<u8> {
    let mut out = vec![1];
    let word = |out: &mut Vec<u8>, n: usize| out.extend((n as u32).to_le_bytes());
    let positions = |out: &mut Vec<u8>, line: &[Xy]| line.iter().flatten().for_each(|x| out.extend(x.to_le_bytes()));
    let line = |out: &mut Vec<u8>, line: &[Xy]| {
        word(out, line.len());
        positions(out, line);
    };
    match shape {
        Shape::Point(at) => {
            word(&mut out, 1);
            positions(&mut out, &[*at]);
        }
        Shape::Line(places) => {
            word(&mut out, 2);
            line(&mut out, places);
        }
        Shape::Polygon(rings) => {
            word(&mut out, 3);
            word(&mut out, rings.len());
            rings.iter().for_each(|ring| line(&mut out, ring));
        }
    }
    out
}
