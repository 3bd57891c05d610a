//! What the examples of the documentation stand on.

use netcert::osm::facts::Policy;
use netcert::settings::Settings;

/// The drawn region without turns, certified for a tug with four trailers. The folder goes with the first value.
pub fn demo_region() -> (tempfile::TempDir, std::path::PathBuf) {
    certified(&Settings { policy: Policy::Carriageway, turns: false, ..Settings::default() })
}

/// As [`demo_region`], with turns.
pub fn demo_region_with_turns() -> (tempfile::TempDir, std::path::PathBuf) {
    certified(&Settings { policy: Policy::Carriageway, turns: true, ..Settings::default() })
}

fn certified(settings: &Settings) -> (tempfile::TempDir, std::path::PathBuf) {
    use netcert::pipeline::{Ingest, Selection, ingest};
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("demo.gpkg");
    let demo = crate::demo::demo();
    let ask = Ingest {
        inputs: &[demo.as_path()],
        db: &path,
        catalogue: &netcert::vehicle::Catalogue::builtin().expect("the catalogue"),
        selection: &Selection::Ids(vec!["AGV-TUG4".to_owned()]),
        countries: &netcert::osm::facts::Countries::load().expect("the countries"),
        settings,
        edges_at_once: netcert::pipeline::EDGES_AT_ONCE,
        parameters: "{}".parse().expect("an object"),
        now: &|| "2026-01-01T00:00:00.000Z".to_owned(),
    };
    ingest(&ask, &netcert::reporter::Silent).expect("the demo is certified");
    (folder, path)
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
