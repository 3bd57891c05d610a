//! Files of changes, plain or gzipped. Nodes of an accepted file are on the earth, and to add its changes to themselves changes nothing.
#![no_main]

use libfuzzer_sys::fuzz_target;
use netcert_fuzz::{file, on_earth};
use netcert_osm::osm::changes::{Changes, Object};

fuzz_target!(|bytes: &[u8]| {
    let path = file("change.osc", bytes);
    let Ok(changes) = Changes::read(&path) else { return };
    for (_, object) in changes.objects() {
        if let Object::Node { place, .. } = object {
            on_earth(*place);
        }
    }
    assert!(changes.objects().count() <= changes.len());
    let mut twice = changes.clone();
    twice.merge(changes.clone());
    assert_eq!(twice, changes);
});
