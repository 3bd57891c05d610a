//! What the examples of the documentation stand on.

use std::path::{Path, PathBuf};

use netcert::osm::LonLat;
use netcert::osm::facts::Policy;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use netcert::pipeline::{Ingest, Selection, ingest};
use netcert::settings::Settings;

/// The drawn region without turns, certified for a tug with four trailers. The folder goes with the first value.
pub fn demo_region() -> (tempfile::TempDir, PathBuf) {
    demo_with(&Settings { policy: Policy::Carriageway, turns: false, ..Settings::default() })
}

/// As [`demo_region`], with turns.
pub fn demo_region_with_turns() -> (tempfile::TempDir, PathBuf) {
    demo_with(&with_turns())
}

fn with_turns() -> Settings {
    Settings { policy: Policy::Carriageway, turns: true, ..Settings::default() }
}

fn demo_with(settings: &Settings) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("demo.gpkg");
    certified(&crate::demo::demo(), &path, settings);
    (folder, path)
}

/// The extract of [`junction`], certified for the same tug with all its turns, which takes moments. All of it is safe.
pub fn junction_region() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("junction.gpkg");
    certified(&junction(folder.path()), &path, &with_turns());
    (folder, path)
}

/// A small extract: a road from west to east along the equator, and a side road to the north, 334 m and 332 m long between nodes.
pub fn junction(folder: &Path) -> PathBuf {
    let at = |id, lon_e7, lat_e7| NodeRecord { id, place: LonLat { lon_e7, lat_e7 }, tags: Vec::new() };
    let nodes = [at(1, 0, 0), at(2, 30_000, 0), at(3, 60_000, 0), at(4, 30_000, 30_000)];
    let way = |id, refs: &[i64], class: &str, width: &str| {
        let tags = [("highway", class), ("width", width)].map(|(key, value)| (key.to_owned(), value.to_owned()));
        WayRecord { id, refs: refs.to_vec(), tags: tags.to_vec() }
    };
    let ways = [way(1, &[1, 2, 3], "primary", "12"), way(2, &[2, 4], "residential", "8")];
    let path = folder.join("junction.osm.pbf");
    std::fs::write(&path, write_extract(&nodes, &ways)).expect("the extract is written");
    path
}

fn certified(extract: &Path, path: &Path, settings: &Settings) {
    let ask = Ingest {
        inputs: &[extract],
        db: path,
        catalogue: &netcert::vehicle::Catalogue::builtin().expect("the catalogue"),
        selection: &Selection::Ids(vec!["AGV-TUG4".to_owned()]),
        countries: &netcert::osm::facts::Countries::load().expect("the countries"),
        settings,
        edges_at_once: netcert::pipeline::EDGES_AT_ONCE,
        parameters: "{}".parse().expect("an object"),
        now: &|| "2026-01-01T00:00:00.000Z".to_owned(),
    };
    ingest(&ask, &netcert::reporter::Silent).expect("the region is certified");
}

/// Before and behind a turn that the tug may take.
pub fn two_places(path: &std::path::Path) -> [netcert::route::Position; 2] {
    use netcert::store::{Database, QueryOptions, TurnQuery};
    let mut database = Database::open(path).expect("the demo");
    let rows = database.query_turns(&TurnQuery::new("AGV-TUG4", Policy::Carriageway)).expect("its turns");
    let turn =
        rows.into_iter().find(|row| row.certificate.verdict == netcert::verdict::Verdict::Safe).expect("a safe turn");
    [turn.turn.from_edge, turn.turn.to_edge].map(|edge_id| {
        let options = QueryOptions { edge_id: Some(edge_id), ..QueryOptions::new("AGV-TUG4", Policy::Carriageway) };
        let row = database.query(&options).expect("its edges").next().expect("the edge").expect("a row");
        let (lon, lat) = row.line[row.line.len() / 2].degrees();
        netcert::route::Position { lon, lat }
    })
}
