//! Vehicle files: TOML, and the JSON of the server and of certificates. Every number of an accepted vehicle is finite, and its definition, written
//! as JSON, is read as the same vehicle.
#![no_main]

use libfuzzer_sys::fuzz_target;
use netcert_base::vehicle::{Catalogue, Vehicle};

fuzz_target!(|text: &str| {
    if let Ok(catalogue) = Catalogue::from_toml(text, "fuzz.toml") {
        assert!(catalogue.iter().len() > 0);
        catalogue.iter().for_each(check);
        let _ = catalogue.get(text);
    }
    if let Ok(vehicle) = Vehicle::from_json(text) {
        check(&vehicle);
    }
});

fn check(vehicle: &Vehicle) {
    let json = vehicle.to_json().expect("a vehicle that passed the checks");
    assert!(vehicle.length_m.is_finite() && vehicle.width_m() > 0.0 && !vehicle.units.is_empty());
    let again = Vehicle::from_json(&json.to_string()).expect("what was written");
    assert_eq!(&again, vehicle);
}
