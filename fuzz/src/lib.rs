//! What the targets share. A target calls one public reader with bytes, and says in its first lines what must hold of what the reader accepts.
//! That no reader panics, runs for ever or takes memory without bound, libFuzzer judges.

use std::path::PathBuf;

use netcert_osm::osm::{Extract, LonLat};
use netcert_osm::shape::{self, Shape};

/// Writes bytes to a file of this process, for readers that take paths. `$TMPDIR` says where.
#[must_use]
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("netcert-fuzz-{}-{name}", std::process::id()));
    std::fs::write(&path, bytes).expect("a file for temporary data");
    path
}

/// One thread for all work, so that a run can be repeated.
pub fn one_thread() {
    let built = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    built.expect("the first pool of this process");
}

/// A position of a map is on the earth.
pub fn on_earth(place: LonLat) {
    assert!(place.lon_e7.abs() <= 1_800_000_000 && place.lat_e7.abs() <= 900_000_000, "{place:?}");
}

/// Positions that pass the checks are finite and on the earth; lines and rings that pass have their least number of corners.
pub fn check_shape(shape: &Shape) {
    match shape {
        Shape::Point(at) => shape::position(*at).into_iter().for_each(on_earth),
        Shape::Line(line) => {
            let Ok(places) = shape::line(line) else { return };
            assert!(places.len() > 1);
            assert!(line.iter().flatten().all(|x| x.is_finite()));
            places.into_iter().for_each(on_earth);
        }
        Shape::Polygon(rings) => {
            let Ok(found) = shape::rings(rings) else { return };
            assert!(found.iter().all(|ring| ring.len() > 3 && ring.first() == ring.last()));
            assert!(rings.iter().flatten().flatten().all(|x| x.is_finite()));
            found.into_iter().flatten().for_each(on_earth);
        }
    }
}

/// What `Extract` promises of its arrays.
pub fn check_extract(extract: &Extract) {
    let Extract { ways, refs, nodes, points, areas, restrictions, strings, .. } = extract;
    assert!(ways.is_sorted_by(|a, b| a.id < b.id), "ways are sorted, ids distinct");
    for way in ways {
        let of_way = &refs[way.refs.start as usize..way.refs.end as usize];
        assert!(of_way.len() > 1 && of_way.windows(2).all(|pair| pair[0] != pair[1]), "way {}", way.id);
        assert!(of_way.iter().all(|node| nodes.index(*node).is_some()), "way {}", way.id);
        [way.facts.name, way.facts.reference].into_iter().flatten().for_each(|text| _ = strings.text(text));
    }
    assert!(nodes.ids.is_sorted_by(|a, b| a < b) && nodes.ids.len() == nodes.places.len());
    nodes.places.iter().flatten().copied().for_each(on_earth);
    assert!(points.is_sorted_by_key(|(id, _)| *id));
    assert!(areas.is_sorted_by(|a, b| a.id < b.id));
    assert!(areas.iter().all(|area| area.refs.len() > 3 && area.refs.first() == area.refs.last()));
    assert!(restrictions.is_sorted_by_key(|r| r.id) && restrictions.iter().all(|r| !r.rules.is_empty()));
}

/// Reads Overture's files, and checks what is accepted.
#[cfg(feature = "databases")]
pub fn check_overture(inputs: &[&std::path::Path]) {
    let Ok(read) = netcert_overture::read(inputs, &|_| ()) else { return };
    check_extract(&read.extract);
    assert_eq!(read.segments.len(), read.extract.ways.len());
    for (segment, way) in read.segments.iter().zip(&read.extract.ways) {
        assert_eq!(segment.way_id, way.id);
        let [from, to] = segment.share;
        assert!((0.0..=1.0).contains(&from) && (0.0..=1.0).contains(&to) && from <= to, "{segment:?}");
    }
}
