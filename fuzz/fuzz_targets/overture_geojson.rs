//! Overture's features as GeoJSON. An accepted file keeps what `Extract` promises of its arrays, and has a segment for every way.
#![no_main]

use libfuzzer_sys::fuzz_target;
use netcert_fuzz::{check_overture, file, one_thread};

fuzz_target!(init: one_thread(), |bytes: &[u8]| {
    let path = file("overture.geojson", bytes);
    check_overture(&[&path]);
});
