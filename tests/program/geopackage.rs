//! Tests of the database from end to end: rows are read as they were written, other programs read the file, and killed runs leave
//! the old file complete.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use netcert::account::AccountRow;
use netcert::network::{Edge, EdgeNo, Network, Portion};
use netcert::osm::facts::{Policy, WidthSource};
use netcert::rows::EdgeRow;
use netcert::rows::{Bounds, EdgeCertificate, EdgeMeasure, TurnCertificate};
use netcert::settings::Settings;
use netcert::store::{Area, Database, QueryOptions, Run, StoreError, TurnSet, VehicleRecord, Writer};
use netcert::turns::{Kerbs, TurnNo, turn_facts};
use netcert::verdict::{UnknownReason, Verdict};
use netcert::words::{VerdictKind, verdict_words};

use netcert_testing::skip::skipped;
use netcert_testing::store_network;
use store_network::{certificate, network};

fn run() -> Run {
    Run {
        command: "ingest".into(),
        input_name: "drawn.osm.pbf".into(),
        input_blake3: Some("ab".repeat(32)),
        replication_timestamp: None,
        netcert_version: "0.1.0".into(),
        started: "2026-11-21T08:00:00.000Z".into(),
        finished: "2026-11-21T08:00:09.000Z".into(),
        parameters: r#"{"corridor":"lane"}"#.into(),
    }
}

fn vehicle(id: &str) -> VehicleRecord {
    VehicleRecord { id: id.into(), name: format!("The {id}"), definition: format!(r#"{{"id":"{id}","units":[]}}"#) }
}

fn account() -> Vec<AccountRow> {
    vec![AccountRow::new("read", "way", "read", "", 12), AccountRow::new("read", "way", "left_out", "no_width", 2)]
}

/// Adds a whole network.
fn add(writer: &mut Writer, network: &Network, measures: &[EdgeMeasure]) -> Result<(), StoreError> {
    writer.areas(network.areas.all().to_vec());
    writer.portion(&Portion::whole(network.clone()), measures)
}

/// A database of `ways` roads and three sets; `order` turns the edges' numbers into another order of arrival.
fn build(path: &Path, ways: u32, order: impl Fn(u32, u32) -> u32) -> Network {
    let network = network(ways);
    let edges = network.edges.len() as u32;
    let mut writer = Database::create(path, &Settings::default()).unwrap();
    let semi = writer.vehicle(vehicle("EU-SEMI16.5"));
    let train = writer.vehicle(vehicle("eu_semi16_5")); // its layer's name is taken
    for i in 0..edges {
        for (vehicle, policy, seed) in [(train, Policy::Lane, 2), (semi, Policy::Lane, 1), (semi, Policy::Direction, 3)]
        {
            writer.certificate(vehicle, policy, &certificate(order(i, edges), seed)).unwrap();
        }
    }
    add(&mut writer, &network, &[]).unwrap();
    writer.account(&account());
    writer.finish(&run()).unwrap();
    network
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// The network as text, with texts and positions in place of their numbers.
fn plain(network: &Network) -> String {
    let text = |id: Option<_>| id.map(|id| network.strings.text(id));
    let mut all = String::new();
    for road in &network.roads {
        let mut bare = road.clone();
        (bare.name, bare.reference) = (None, None);
        all += &format!("{bare:?} {:?} {:?}\n", text(road.name), text(road.reference));
    }
    for edge in &network.edges {
        let bare = Edge { shape: 0..0, ..edge.clone() };
        all += &format!("{bare:?} {:?}\n", network.positions(edge).collect::<Vec<_>>());
    }
    let Network { narrowings, strokes, stroke_edges, restrictions, restriction_edges, areas, .. } = network;
    all += &format!(
        "{narrowings:?}\n{strokes:?}\n{stroke_edges:?}\n{restrictions:?}\n{restriction_edges:?}\n{:?}",
        areas.all()
    );
    all
}

#[test]
fn the_network_comes_back_as_it_was_written_and_makes_the_same_file_again() {
    let folder = folder();
    let (a, b) = (folder.path().join("a.gpkg"), folder.path().join("b.gpkg"));
    let written = network(400);
    let write = |path: &Path, network: &Network| {
        let mut writer = Database::create(path, &Settings::default()).unwrap();
        add(&mut writer, network, &[]).unwrap();
        writer.finish(&run()).unwrap();
    };
    write(&a, &written);
    let read = Database::open(&a).unwrap().load_network().unwrap();
    assert_eq!(plain(&read), plain(&written));
    assert!(read.shapes.len() < written.shapes.len(), "the made-up network has positions that no edge uses");
    write(&b, &read);
    assert!(std::fs::read(&a).unwrap() == std::fs::read(&b).unwrap());
}

#[test]
fn the_same_content_makes_the_same_file_whatever_the_order_of_certificates() {
    let folder = folder();
    let (a, b) = (folder.path().join("a.gpkg"), folder.path().join("b.gpkg"));
    build(&a, 300, |i, _| i);
    build(&b, 300, |i, edges| edges - 1 - i);
    assert!(std::fs::read(&a).unwrap() == std::fs::read(&b).unwrap());
}

fn all(path: &Path, options: &QueryOptions) -> Vec<EdgeRow> {
    Database::open(path).unwrap().query(options).unwrap().collect::<Result<_, _>>().unwrap()
}

#[test]
fn a_query_gives_every_certificate_back_on_the_safe_side() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let network = build(&path, 200, |i, _| i);
    let rows = all(&path, &QueryOptions::new("EU-SEMI16.5", Policy::Lane));
    assert_eq!(rows.len(), network.edges.len());
    for (index, row) in (0..).zip(&rows) {
        let (edge, wrote) = (&network.edges[index as usize], certificate(index, 1));
        let road = network.road(edge);
        assert_eq!(
            (row.edge.index.get(), row.edge.id, row.edge.way_id, row.certificate.verdict),
            (index, edge.id, road.way_id, wrote.conclusion.verdict)
        );
        let limit = network.road(edge).max_speed_km_h[edge.direction as usize];
        assert_eq!(row.maxspeed_kmh, limit.map(std::num::NonZeroU8::get));
        assert_eq!(
            (row.edge.from_node, row.edge.to_node, row.edge.direction),
            (edge.from_node, edge.to_node, edge.direction)
        );
        assert!(row.line.iter().copied().eq(network.positions(edge)));
        let lane = road.sections[edge.direction as usize].lane;
        assert_eq!(row.width_source, lane.map(|strip| strip.source));
        let kept = &row.certificate;
        assert_eq!(kept.rsc_m.is_some(), wrote.conclusion.measured.is_some());
        if let Some(m) = wrote.conclusion.measured {
            let down =
                |stored: Option<f64>, value: f64, step| stored.unwrap() <= value && value - stored.unwrap() < step;
            assert!(down(kept.rsc_m, m.rsc_m, 1.001e-3) && down(kept.rsc_published_m, m.rsc_published_m, 1.001e-3));
            assert!(down(kept.hinge_margin_deg, m.hinge_margin_rad.to_degrees(), 1.001e-2));
            assert_eq!(kept.shrink, Some(m.shrink));
            assert_eq!((kept.limiting_unit, kept.limiting_side), (Some(m.limiting_unit as u16), Some(m.limiting_side)));
        }
    }
}

#[test]
fn every_filter_gives_what_a_plain_search_through_all_rows_gives() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 400, |i, _| i);
    let every = all(&path, &QueryOptions::new("EU-SEMI16.5", Policy::Lane));
    let check = |change: &dyn Fn(&mut QueryOptions), keep: &dyn Fn(&EdgeRow) -> bool| {
        let mut options = QueryOptions::new("EU-SEMI16.5", Policy::Lane);
        change(&mut options);
        let expected: Vec<&EdgeRow> = every.iter().filter(|row| keep(row)).collect();
        assert!(!expected.is_empty() && expected.len() < every.len());
        assert_eq!(all(&path, &options).iter().collect::<Vec<_>>(), expected, "{options:?}");
    };
    for kind in [VerdictKind::Safe, VerdictKind::Unsafe, VerdictKind::Forbidden, VerdictKind::Unknown] {
        let word = netcert::words::Named::name(kind);
        check(&|o| o.verdict = Some(kind), &|row| verdict_words(row.certificate.verdict).0 == word);
    }
    check(&|o| o.min_rsc_m = Some(0.3), &|row| row.certificate.rsc_m.is_some_and(|rsc| rsc >= 0.3));
    check(&|o| o.min_width_source = Some(WidthSource::Tagged), &|row| row.width_source >= Some(WidthSource::Tagged));
    check(&|o| o.edge_id = Some(every[7].edge.id), &|row| row.edge.id == every[7].edge.id);
    // A triangle is smaller than its box, so the index alone would give too many rows.
    let triangle = geo::Triangle::new((8.6, 49.4).into(), (8.75, 49.4).into(), (8.6, 49.55).into()).to_polygon();
    let area = geo::MultiPolygon(vec![triangle]);
    let touches = |row: &EdgeRow| {
        use geo::Intersects;
        area.intersects(&row.line.iter().map(|place| place.degrees()).collect::<geo::LineString>())
    };
    check(&|o| o.area = Some(Area::Polygons(area.clone())), &touches);
    let bounds = Bounds { west: 8.62, south: 49.41, east: 8.7, north: 49.46 };
    let inside = |row: &EdgeRow| {
        row.line
            .iter()
            .map(|p| p.degrees())
            .any(|(x, y)| (bounds.west..=bounds.east).contains(&x) && (bounds.south..=bounds.north).contains(&y))
    };
    check(&|o| o.area = Some(Area::Bounds(bounds)), &inside);
}

#[test]
fn a_vehicle_that_is_not_certified_is_an_error_not_an_empty_answer() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 10, |i, _| i);
    let mut database = Database::open(&path).unwrap();
    let error = database.query(&QueryOptions::new("US-WB67", Policy::Lane)).err().unwrap().to_string();
    assert!(error.contains("netcert certify --vehicle US-WB67 --corridor lane"), "{error}");
}

#[test]
fn stats_add_up_to_the_network() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let network = build(&path, 100, |i, _| i);
    let stats = Database::open(&path).unwrap().stats().unwrap();
    assert_eq!(stats.roads, 100);
    let length: f64 = stats.network.iter().map(|row| row.2).sum();
    assert_eq!(stats.network.iter().map(|row| row.1).sum::<u64>(), network.edges.len() as u64);
    for policy in [Policy::Lane, Policy::Direction] {
        let of = |row: &&netcert::rows::StatsRow| row.vehicle_id == "EU-SEMI16.5" && row.policy == policy;
        let rows: Vec<_> = stats.certificates.iter().filter(of).collect();
        assert_eq!(rows.iter().map(|row| row.edges).sum::<u64>(), network.edges.len() as u64);
        assert!((rows.iter().map(|row| row.length_m).sum::<f64>() - length).abs() < 1e-6 * length);
    }
}

#[test]
fn lengths_and_radii_are_the_corridors_where_there_is_one() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let network = network(2);
    let mut measures = vec![EdgeMeasure::default(); network.edges.len()];
    measures[0] =
        EdgeMeasure { length_m: Some(123.25), min_radius_m: Some(f64::INFINITY), centreline_deviation_m: Some(0.25) };
    measures[1].min_radius_m = Some(80.5);
    let mut writer = Database::create(&path, &Settings::default()).unwrap();
    let semi = writer.vehicle(vehicle("semi"));
    for edge in 0..network.edges.len() as u32 {
        writer.certificate(semi, Policy::Lane, &certificate(edge, 0)).unwrap();
    }
    add(&mut writer, &network, &measures).unwrap();
    writer.finish(&run()).unwrap();
    let rows = all(&path, &QueryOptions::new("semi", Policy::Lane));
    assert_eq!((rows[0].length_m, rows[0].min_radius_m, rows[1].min_radius_m), (123.25, None, Some(80.5)));
    // Three steps of 108.9 m east, of 24.2, 31.1 and 38.0 m north: 340.1 m.
    assert!((340.0..340.3).contains(&rows[1].length_m), "{}", rows[1].length_m);
}

#[test]
fn the_run_and_its_account_are_kept() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 10, |i, _| i);
    assert_eq!(Database::open(&path).unwrap().runs().unwrap(), [(run(), account())]);
}

// --- sets of certificates -------------------------------------------------------------------------------------------

#[test]
fn a_set_is_replaced_whole_and_a_changed_vehicle_loses_its_old_ones() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let edges = build(&path, 50, |i, _| i).edges.len() as u32;
    let unknown = |edge| EdgeCertificate::bare(EdgeNo::new(edge), Verdict::Unknown(UnknownReason::Cut));
    let mut database = Database::open_to_change(&path).unwrap();
    let sets = |database: &mut Database| -> Vec<String> {
        database.certified().unwrap().into_iter().map(|set| set.layer).collect()
    };
    assert_eq!(sets(&mut database), ["permit_eu_semi16_5", "permit_eu_semi16_5_direction", "permit_eu_semi16_5_2"]);

    database
        .replace_certificates(
            &vehicle("EU-SEMI16.5"),
            &Settings::default(),
            (0..edges).rev().map(unknown),
            Vec::new(),
            None,
            &run(),
            &[],
        )
        .unwrap();
    assert_eq!(sets(&mut database).len(), 3);
    let rows = all(&path, &QueryOptions::new("EU-SEMI16.5", Policy::Lane));
    assert!(
        rows.len() == edges as usize
            && rows.iter().all(|row| row.certificate.verdict == Verdict::Unknown(UnknownReason::Cut))
    );

    let mut longer = vehicle("EU-SEMI16.5");
    longer.definition = r#"{"id":"EU-SEMI16.5","units":[1]}"#.into();
    database
        .replace_certificates(
            &longer,
            &Settings { policy: Policy::Carriageway, ..Settings::default() },
            (0..edges).map(unknown),
            Vec::new(),
            None,
            &run(),
            &account(),
        )
        .unwrap();
    assert_eq!(sets(&mut database), ["permit_eu_semi16_5_carriageway", "permit_eu_semi16_5_2"]);
    assert_eq!(database.runs().unwrap().len(), 3);
    database.close().unwrap();
    whole(&path);
}

#[test]
fn a_layer_s_style_comes_and_goes_with_it_and_what_people_saved_stays() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let edges = build(&path, 20, |i, _| i).edges.len() as u32;
    let styles = || sqlite(&path, "SELECT f_table_name, owner, useAsDefault FROM layer_styles ORDER BY 1, 2");
    let made = "edge|netcert|1\npermit_eu_semi16_5|netcert|1\npermit_eu_semi16_5_2|netcert|1\npermit_eu_semi16_5_direction|netcert|1\n";
    assert_eq!(styles(), made);
    let geometry = "SELECT count(*) FROM layer_styles JOIN gpkg_geometry_columns ON f_table_name = table_name \
                    AND f_geometry_column = column_name WHERE styleQML LIKE '%<qgis %'";
    assert_eq!(sqlite(&path, geometry), "4\n");
    // As QGIS saves one.
    let save = "INSERT INTO layer_styles (f_table_name, styleName, useAsDefault, owner) VALUES ('permit_eu_semi16_5', 'mine', 1, '')";
    sqlite(&path, save);
    let mut database = Database::open_to_change(&path).unwrap();
    let mut certify = |vehicle: &VehicleRecord, policy| {
        let settings = Settings { policy, ..Settings::default() };
        let unknown = |edge| EdgeCertificate::bare(EdgeNo::new(edge), Verdict::Unknown(UnknownReason::Cut));
        let rows = (0..edges).map(unknown);
        database.replace_certificates(vehicle, &settings, rows, Vec::new(), None, &run(), &[]).unwrap();
    };
    certify(&vehicle("EU-SEMI16.5"), Policy::Lane);
    let kept = "edge|netcert|1\npermit_eu_semi16_5||1\npermit_eu_semi16_5|netcert|0\npermit_eu_semi16_5_2|netcert|1\npermit_eu_semi16_5_direction|netcert|1\n";
    assert_eq!(styles(), kept, "the layer is made anew, and opens in the person's style");
    let longer = VehicleRecord { definition: r#"{"units":[1]}"#.into(), ..vehicle("EU-SEMI16.5") };
    certify(&longer, Policy::Carriageway);
    let left = "edge|netcert|1\npermit_eu_semi16_5||1\npermit_eu_semi16_5_2|netcert|1\npermit_eu_semi16_5_carriageway|netcert|1\n";
    assert_eq!(styles(), left);
}

#[test]
fn a_set_with_a_gap_or_a_double_or_a_false_safe_is_refused_and_the_old_one_stands() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let edges = build(&path, 50, |i, _| i).edges.len() as u32;
    let before = std::fs::read(&path).unwrap();
    let mut database = Database::open_to_change(&path).unwrap();
    let mut refused = |edges: Vec<u32>, says: &str| {
        let rows = edges.into_iter().map(|edge| certificate(edge, 5));
        let error = database
            .replace_certificates(&vehicle("x"), &Settings::default(), rows, Vec::new(), None, &run(), &[])
            .unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    };
    refused((0..edges).filter(|&edge| edge != 17).collect(), "edge 17, vehicle x: it has no certificate");
    refused((0..edges).chain([9]).collect(), "edge 9, vehicle x: it has two certificates");
    refused((0..=edges).collect(), "the network has no such edge");
    let mut false_safe = certificate(0, 5);
    false_safe.conclusion.verdict = Verdict::Safe;
    false_safe.conclusion.measured.as_mut().unwrap().rsc_m = -0.0001;
    let error = database
        .replace_certificates(&vehicle("x"), &Settings::default(), [false_safe], Vec::new(), None, &run(), &[])
        .unwrap_err();
    assert!(matches!(error, StoreError::Unsound { edge: 0, .. }), "{error}");
    database.close().unwrap();
    assert!(std::fs::read(&path).unwrap() == before);
}

// --- what columns mean ----------------------------------------------------------------------------------------------

#[test]
fn columns_of_layers_and_tables_are_described_and_descriptions_go_with_their_layer() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let edges = build(&path, 50, |i, _| i).edges.len() as u32;
    let extensions = "SELECT table_name, scope FROM gpkg_extensions WHERE extension_name = 'gpkg_schema' ORDER BY 1";
    assert_eq!(sqlite(&path, extensions), "gpkg_data_column_constraints|read-write\ngpkg_data_columns|read-write\n");
    let of = |table: &str, column: &str| {
        let sql = "SELECT d.description, constraint_type, min, min_is_inclusive, max, max_is_inclusive FROM gpkg_data_columns AS d \
                   JOIN gpkg_data_column_constraints USING (constraint_name)";
        sqlite(&path, &format!("{sql} WHERE table_name = '{table}' AND column_name = '{column}'"))
    };
    let width = "width of the vehicle's own lane. Unit: m|range|0|0|Inf|0\n";
    assert_eq!(of("edge", "lane_width_m"), width);
    let rsc = "the Route Safety Certificate of what is safe: the least room between any point of any unit and the corridor's \
               edges, with all errors deducted. Unit: m|range|0|1|1000|1\n";
    assert_eq!(of("permit_eu_semi16_5", "rsc_m"), rsc);
    assert_eq!(of("permit_eu_semi16_5_2", "rsc_m"), of("permit_eu_semi16_5", "rsc_m"));
    let words = "SELECT group_concat(value, ' ') FROM (SELECT value FROM gpkg_data_columns \
                 JOIN gpkg_data_column_constraints USING (constraint_name) \
                 WHERE table_name = 'certificate' AND column_name = 'verdict' AND constraint_type = 'enum' ORDER BY value)";
    assert_eq!(sqlite(&path, words), "forbidden safe unknown unsafe\n");
    // No turns and no measurements, so nothing is said of them; and only columns that are there are described.
    let tables =
        "SELECT group_concat(name, ' ') FROM (SELECT DISTINCT table_name AS name FROM gpkg_data_columns ORDER BY 1)";
    let all = "account certificate edge permit permit_eu_semi16_5 permit_eu_semi16_5_2 permit_eu_semi16_5_direction run \
               turn_certificate vehicle\n";
    assert_eq!(sqlite(&path, tables), all);
    let missing = "SELECT table_name, column_name FROM gpkg_data_columns AS d \
                   WHERE column_name NOT IN (SELECT name FROM pragma_table_xinfo(d.table_name))";
    assert_eq!(sqlite(&path, missing), "");
    let times = "SELECT name, type FROM pragma_table_info('run') WHERE name IN ('started', 'finished')";
    assert_eq!(sqlite(&path, times), "started|DATETIME\nfinished|DATETIME\n");

    sqlite(
        &path,
        "INSERT INTO gpkg_data_column_constraints (constraint_name, constraint_type, value) VALUES ('theirs', 'enum', 'a')",
    );
    let longer = VehicleRecord { definition: r#"{"units":[1]}"#.into(), ..vehicle("EU-SEMI16.5") };
    let settings = Settings { policy: Policy::Carriageway, ..Settings::default() };
    let unknown = (0..edges).map(|edge| EdgeCertificate::bare(EdgeNo::new(edge), Verdict::Unknown(UnknownReason::Cut)));
    let mut database = Database::open_to_change(&path).unwrap();
    database.replace_certificates(&longer, &settings, unknown, Vec::new(), None, &run(), &[]).unwrap();
    database.close().unwrap();
    let layers =
        "SELECT count(DISTINCT table_name) FROM gpkg_data_columns WHERE table_name LIKE 'permit\\_%' ESCAPE '\\'";
    assert_eq!(sqlite(&path, layers), "2\n");
    let layer = "permit_eu_semi16_5_carriageway";
    assert_eq!(of(layer, "rsc_m"), of("permit_eu_semi16_5_2", "rsc_m"));
    assert_eq!(of("permit_eu_semi16_5", "rsc_m"), "");
    // A constraint goes with the last column that has it, and those of other programs stay.
    let unused = "SELECT constraint_name FROM gpkg_data_column_constraints WHERE constraint_name NOT IN \
                (SELECT constraint_name FROM gpkg_data_columns WHERE constraint_name NOT NULL)";
    assert_eq!(sqlite(&path, unused), "theirs\n");
    whole(&path);
    if Command::new("ogrinfo").arg("--version").output().is_err() {
        return skipped("ogrinfo", "Debian: gdal-bin");
    }
    let ogrinfo = |arguments: &[&str]| {
        let out = Command::new("ogrinfo").arg("-ro").args(arguments).output().unwrap();
        assert!(out.status.success() && out.stderr.is_empty(), "{}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8(out.stdout).unwrap()
    };
    let file = path.to_str().unwrap();
    let domain = ogrinfo(&["-fielddomain", "netcert_edge_lane_width_m", file]);
    assert!(domain.contains("Type: range") && domain.contains("Minimum value: 0 (excluded)"), "{domain}");
    assert!(!domain.contains("Maximum value"), "{domain}");
    assert!(ogrinfo(&["-so", file, "edge"]).contains("domain name=netcert_edge_lane_width_m"));
    let runs = ogrinfo(&[file, "run"]);
    assert!(runs.contains("started (DateTime) = 2026/11/21 08:00:00+00"), "{runs}");
}

/// Makes of a database what netcert 0.2 would have written.
fn as_written_by_0_2(path: &Path) {
    let older = "024a446caa8ca653238391c071472373aada44000423663e3c4ae907261485b1466b06ab656f44f23f11c4b3d30aed64";
    sqlite(
        path,
        &format!(
            "DROP TABLE gpkg_data_columns; DROP TABLE gpkg_data_column_constraints; \
             DELETE FROM gpkg_extensions WHERE extension_name = 'gpkg_schema'; \
             DELETE FROM _sqlx_migrations WHERE version = 16; \
             UPDATE _sqlx_migrations SET checksum = x'{older}' WHERE version = 3; \
             ALTER TABLE run RENAME TO newer; \
             CREATE TABLE run (run_id INTEGER PRIMARY KEY, command TEXT NOT NULL, input_name TEXT NOT NULL, \
             input_blake3 TEXT, replication_timestamp TEXT, netcert_version TEXT NOT NULL, started TEXT NOT NULL, \
             finished TEXT NOT NULL, parameters TEXT NOT NULL); \
             INSERT INTO run SELECT * FROM newer; DROP TABLE newer; \
             PRAGMA writable_schema = ON; \
             UPDATE sqlite_schema SET sql = replace(replace(sql, '\"newer\"', 'run'), 'newer', 'run'); \
             PRAGMA writable_schema = RESET;"
        ),
    );
    let types = "SELECT group_concat(type, ' ') FROM pragma_table_info('run') WHERE name IN ('started', 'finished')";
    assert_eq!(sqlite(path, types), "TEXT TEXT\n");
    whole(path);
}

#[test]
fn a_database_of_netcert_0_2_has_the_same_rows_and_takes_new_ones() {
    let folder = folder();
    let (newer, older) = (folder.path().join("newer.gpkg"), folder.path().join("older.gpkg"));
    let edges = build(&newer, 50, |i, _| i).edges.len() as u32;
    std::fs::copy(&newer, &older).unwrap();
    as_written_by_0_2(&older);
    let options = QueryOptions::new("EU-SEMI16.5", Policy::Lane);
    assert_eq!(all(&older, &options), all(&newer, &options));
    let mut database = Database::open_to_change(&older).unwrap();
    assert_eq!(database.runs().unwrap(), [(run(), account())]);
    let rows = (0..edges).map(|edge| certificate(edge, 9));
    database.replace_certificates(&vehicle("x"), &Settings::default(), rows, Vec::new(), None, &run(), &[]).unwrap();
    assert_eq!(database.runs().unwrap().len(), 2);
    assert_eq!(database.certified().unwrap().len(), 4);
    database.close().unwrap();
    whole(&older);
    assert_eq!(sqlite(&older, "SELECT count(*) FROM sqlite_schema WHERE name LIKE 'gpkg_data%'"), "0\n");
    // No other text of a migration serves.
    sqlite(&older, "UPDATE _sqlx_migrations SET checksum = x'00' WHERE version = 3");
    let error = Database::open(&older).err().unwrap().to_string();
    assert!(error.contains("version 3 differs"), "{error}");
    sqlite(&newer, "DELETE FROM _sqlx_migrations WHERE version = 15");
    assert!(matches!(Database::open(&newer), Err(StoreError::Older { .. })));
}

// --- wrong files ----------------------------------------------------------------------------------------------------

#[test]
fn wrong_files_are_told_apart_and_left_alone() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    assert!(matches!(Database::open(&at("none.gpkg")), Err(StoreError::Missing(_))));
    std::fs::write(at("text.gpkg"), "not a database, though longer than the header of one ".repeat(9)).unwrap();
    std::fs::write(at("empty.gpkg"), "").unwrap();
    sqlite(&at("other.gpkg"), "CREATE TABLE t (a)");
    sqlite(&at("foreign.gpkg"), "PRAGMA application_id = 1196444487; CREATE TABLE t (a)");
    for (name, message) in [
        ("text.gpkg", "not a GeoPackage"),
        ("empty.gpkg", "not a GeoPackage"),
        ("other.gpkg", "not one that netcert made"),
        ("foreign.gpkg", "not one that netcert made"),
    ] {
        let before = std::fs::read(at(name)).unwrap();
        let error = Database::open(&at(name)).err().unwrap().to_string();
        assert!(error.contains(message) && error.contains(name), "{error}");
        if before.is_empty() {
            // It may be the rest of a database whose pages are all in a journal.
            std::fs::write(at("empty.gpkg-journal"), "").unwrap();
        }
        assert!(matches!(Database::create(&at(name), &Settings::default()), Err(StoreError::InTheWay(_))), "{name}");
        assert!(std::fs::read(at(name)).unwrap() == before);
    }
    std::fs::remove_file(at("empty.gpkg-journal")).unwrap();
    build(&at("empty.gpkg"), 2, |i, _| i);
    Database::open(&at("empty.gpkg")).unwrap().close().unwrap();
    build(&at("newer.gpkg"), 2, |i, _| i);
    sqlite(&at("newer.gpkg"), "INSERT INTO _sqlx_migrations VALUES (99, 'later', '2030-01-01', 1, x'00', 0)");
    assert!(matches!(Database::open(&at("newer.gpkg")), Err(StoreError::Newer { found: 99, .. })));
    sqlite(&at("newer.gpkg"), "DELETE FROM _sqlx_migrations WHERE version > 3");
    assert!(matches!(Database::open(&at("newer.gpkg")), Err(StoreError::Older { .. })));
    // The form that 0.2.0 wrote lacks a column that nothing reads; any other form is refused.
    build(&at("earlier.gpkg"), 2, |i, _| i);
    let form = |checksum: &str| {
        let sql = format!("UPDATE _sqlx_migrations SET checksum = x'{checksum}' WHERE version = 2");
        sqlite(&at("earlier.gpkg"), &sql);
        Database::open(&at("earlier.gpkg"))
    };
    let earlier = "3ec0c4967b59687e6cf821a35d2f1e28a9b81ffcdf2aaa14146d11a46a5f9ff329e299d56199a80d3f56b051e983c988";
    let mut database = form(earlier).unwrap();
    assert_eq!(database.load_network().unwrap().roads.len(), 2);
    database.close().unwrap();
    assert!(matches!(form(&earlier.replace('3', "4")), Err(StoreError::Older { .. })));
}

#[test]
fn a_damaged_database_is_an_error_never_a_panic() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 60, |i, _| i);
    let good = std::fs::read(&path).unwrap();
    let bad = folder.path().join("bad.gpkg");
    let panics = panics_of_sqlite_threads();
    let mut noticed = 0;
    let cuts = (0..good.len()).step_by(good.len() / 40).map(|at| good[..at].to_vec());
    let flips = (0..400).map(|i| {
        let mut bytes = good.clone();
        let at = (i * 2_654_435_761_usize) % good.len();
        bytes[at] ^= 1 << (i % 8);
        bytes
    });
    for bytes in cuts.chain(flips) {
        std::fs::write(&bad, bytes).unwrap();
        let read = || -> Result<(), StoreError> {
            let mut database = Database::open(&bad)?;
            database.load_network()?;
            database.query(&QueryOptions::new("EU-SEMI16.5", Policy::Lane))?.collect::<Result<Vec<_>, _>>()?;
            database.stats().map(|_| ())
        };
        noticed += usize::from(read().is_err());
    }
    assert!(noticed >= 40, "{noticed}");
    assert_eq!(panics.load(Ordering::Relaxed), 0, "a thread of sqlx panicked");
}

/// Counts the panics of the threads that sqlx runs SQLite on. Their panics reach no caller.
fn panics_of_sqlite_threads() -> Arc<AtomicUsize> {
    let count = Arc::new(AtomicUsize::new(0));
    let (seen, before) = (Arc::clone(&count), std::panic::take_hook());
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().name().is_some_and(|name| name.starts_with("sqlx-")) {
            seen.fetch_add(1, Ordering::Relaxed);
        }
        before(info);
    }));
    count
}

/// A query on such a file ended like one without rows, and the next one sometimes never.
#[test]
fn a_schema_with_a_name_that_is_no_text_is_refused_every_time() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 2, |i, _| i);
    let mut bytes = std::fs::read(&path).unwrap();
    let name = b"oneway";
    let at: Vec<usize> = (0..bytes.len() - name.len()).filter(|&at| bytes[at..].starts_with(name)).collect();
    assert!(!at.is_empty());
    for at in at {
        bytes[at] |= 0x80;
    }
    std::fs::write(&path, bytes).unwrap();
    for _ in 0..100 {
        let error = Database::open(&path).map(|_| ()).unwrap_err();
        assert!(matches!(error, StoreError::Damaged { .. }), "{error}");
        assert!(error.to_string().contains("a name in its schema is not UTF-8; run `netcert ingest` again"), "{error}");
    }
}

// --- killed, crowded and full ---------------------------------------------------------------------------------------

#[test]
fn an_unfinished_writer_leaves_the_old_file_and_nothing_else() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 20, |i, _| i);
    let before = std::fs::read(&path).unwrap();
    let mut writer = Database::create(&path, &Settings::default()).unwrap();
    add(&mut writer, &network(500), &[]).unwrap();
    assert!(
        matches!(Database::create(&path, &Settings::default()), Err(StoreError::Busy(_))),
        "a second run at the same time"
    );
    drop(writer);
    let left_alone = || {
        assert!(std::fs::read(&path).unwrap() == before);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    };
    left_alone();
    // The second time it is given up while another thread writes its network.
    let mut writer = Database::create(&path, &Settings::default()).unwrap();
    add(&mut writer, &network(20_000), &[]).unwrap();
    drop(writer.network_complete().unwrap());
    left_alone();
}

#[test]
fn a_network_that_is_written_beside_certificates_makes_the_same_file() {
    let folder = folder();
    let (a, b) = (folder.path().join("a.gpkg"), folder.path().join("b.gpkg"));
    let network = build(&a, 300, |i, _| i);
    let mut writer = Database::create(&b, &Settings::default()).unwrap();
    let semi = writer.vehicle(vehicle("EU-SEMI16.5"));
    let train = writer.vehicle(vehicle("eu_semi16_5"));
    add(&mut writer, &network, &[]).unwrap();
    let mut writer = writer.network_complete().unwrap();
    for i in 0..network.edges.len() as u32 {
        for (vehicle, policy, seed) in [(semi, Policy::Lane, 1), (semi, Policy::Direction, 3), (train, Policy::Lane, 2)]
        {
            writer.certificate(vehicle, policy, &certificate(i, seed)).unwrap();
        }
    }
    let more = add(&mut writer, &network, &[]).unwrap_err().to_string();
    assert!(more.contains("the network is complete"), "{more}");
    writer.account(&account());
    writer.finish(&run()).unwrap();
    assert!(std::fs::read(&a).unwrap() == std::fs::read(&b).unwrap());
}

#[test]
fn a_vehicle_with_missing_certificates_does_not_become_a_database() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let mut writer = Database::create(&path, &Settings::default()).unwrap();
    let semi = writer.vehicle(vehicle("semi"));
    add(&mut writer, &network(4), &[]).unwrap();
    writer.certificate(semi, Policy::Lane, &certificate(0, 0)).unwrap();
    let error = writer.finish(&run()).unwrap_err().to_string();
    assert!(error.contains("edge 1, vehicle semi: it has no certificate"), "{error}");
    assert!(!path.exists());
}

const CHILD: &str = "NETCERT_STORE_TEST_CHILD";

/// Not a test of its own: the process that `killed_at_any_moment…` kills.
#[test]
fn child_that_is_killed() {
    let Some(path) = std::env::var_os(CHILD).map(PathBuf::from) else { return };
    if path.with_extension("replace").exists() {
        let mut database = Database::open_to_change(&path).unwrap();
        let network = database.load_network().unwrap();
        let facts = turn_facts(&network, &Kerbs::default());
        let unknown = |turn| {
            let verdict = Verdict::Unknown(UnknownReason::Cut);
            TurnCertificate::bare(turn, verdict)
        };
        loop {
            let rows = (0..network.edges.len() as u32).map(|edge| certificate(edge, 9));
            let certificates = TurnNo::first(facts.len()).map(unknown).collect();
            let turns = Some(TurnSet { network: &network, facts: &facts, junctions: &[], certificates });
            database
                .replace_certificates(
                    &vehicle("EU-SEMI16.5"),
                    &Settings::default(),
                    rows,
                    Vec::new(),
                    turns,
                    &run(),
                    &[],
                )
                .unwrap();
        }
    }
    loop {
        build(&path, 3000, |i, _| i);
    }
}

#[test]
fn killed_at_any_moment_the_file_is_whole() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 3000, |i, _| i);
    for (round, millis) in [20, 60, 110, 170, 230, 310, 400, 700].into_iter().enumerate() {
        if round % 2 == 1 {
            std::fs::write(path.with_extension("replace"), "").unwrap();
        } else {
            let _ = std::fs::remove_file(path.with_extension("replace"));
        }
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "geopackage::child_that_is_killed"])
            .env(CHILD, &path)
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(millis));
        assert!(child.try_wait().unwrap().is_none(), "it writes until it is killed");
        child.kill().unwrap();
        child.wait().unwrap();
        let rows = all(&path, &QueryOptions::new("EU-SEMI16.5", Policy::Lane));
        let verdict = |i, seed| certificate(i, seed).conclusion.verdict;
        let seed = if rows.iter().map(|row| row.certificate.verdict).eq((0..).map(|i| verdict(i, 1)).take(rows.len())) {
            1
        } else {
            9
        };
        assert!((0..).zip(&rows).all(|(i, row)| row.certificate.verdict == verdict(i, seed)), "half old, half new");
        let turned = Database::open(&path).unwrap().has_turns("EU-SEMI16.5", Policy::Lane).unwrap();
        assert_eq!(turned, seed == 9, "new edges come with their turns");
        whole(&path);
    }
    // The files of a killed run do not stop the next run.
    let _ = Database::create(&path, &Settings::default()).unwrap();
    build(&path, 10, |i, _| i);
    whole(&path);
}

#[test]
fn a_full_disk_is_a_clear_error_and_the_old_file_stands() {
    let folder = folder();
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=3m", "tmpfs"]).arg(folder.path()).output();
    if !mount.is_ok_and(|out| out.status.success()) {
        return skipped("small file system", "needs the right to mount");
    }
    let path = folder.path().join("a.gpkg");
    let result = std::panic::catch_unwind(|| {
        build(&path, 200, |i, _| i);
        let before = std::fs::read(&path).unwrap();
        for beside in [false, true] {
            let error = (|| {
                let mut writer = Database::create(&path, &Settings::default())?;
                add(&mut writer, &network(20_000), &[])?;
                let writer = if beside { writer.network_complete()? } else { writer };
                writer.finish(&run())
            })()
            .unwrap_err();
            assert!(matches!(error, StoreError::Full(_)), "{error}");
            assert!(error.to_string().contains("a.gpkg:") && error.to_string().contains("free some space"), "{error}");
            assert!(std::fs::read(&path).unwrap() == before);
            assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
        }
    });
    // The dropped connection's thread may take a moment to let go of its file.
    let unmounted = (0..100).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(20));
        Command::new("umount").arg(folder.path()).output().unwrap().status.success()
    });
    assert!(unmounted);
    result.unwrap();
}

// --- other programs -------------------------------------------------------------------------------------------------

fn sqlite(path: &Path, sql: &str) -> String {
    let out = Command::new("sqlite3")
        .arg(path)
        .arg(sql)
        .output()
        .expect("the sqlite3 program, which building PROJ needs too");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

/// SQLite's own checks.
fn whole(path: &Path) {
    assert_eq!(sqlite(path, "PRAGMA integrity_check; PRAGMA foreign_key_check;"), "ok\n");
    assert_eq!(sqlite(path, "SELECT rtreecheck('rtree_edge_geom')"), "ok\n");
}

#[test]
fn sqlite_finds_it_whole_and_reads_the_views() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 300, |i, _| i);
    whole(&path);
    assert_eq!(sqlite(&path, "PRAGMA application_id; PRAGMA user_version"), "1196444487\n10300\n");
    let columns = "SELECT group_concat(name, ' ') FROM pragma_table_info('certificate')";
    assert!(sqlite(&path, columns).starts_with(
        "fid edge_id vehicle_id corridor rsc_m rsc_published_m hinge_margin_deg shrink limiting_s_m limiting_unit \
         limiting_side verdict reason"
    ));
    let safe = "SELECT count(*) FROM certificate WHERE verdict = 'safe'";
    assert_eq!(sqlite(&path, safe), sqlite(&path, "SELECT count(*) FROM permit"));
    assert_eq!(sqlite(&path, "SELECT count(*) FROM certificate WHERE rsc_m < 0 AND verdict = 'safe'"), "0\n");
}

#[test]
fn a_certificate_takes_at_most_32_bytes() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    build(&path, 15_000, |i, _| i);
    let sql =
        "SELECT sum(pgsize) FROM dbstat WHERE name = 'certificate_compact'; SELECT count(*) FROM certificate_compact";
    let numbers: Vec<f64> = sqlite(&path, sql).lines().map(|line| line.parse().unwrap()).collect();
    let bytes = numbers[0] / numbers[1];
    println!("{bytes:.1} bytes a certificate ({} certificates)", numbers[1]);
    assert!(bytes <= 32.0, "{bytes}");
}

#[test]
fn gdal_shows_the_layers() {
    let folder = folder();
    let path = folder.path().join("a.gpkg");
    let network = build(&path, 300, |i, _| i);
    let ogrinfo = |arguments: &[&str]| {
        let out = Command::new("ogrinfo").args(["-ro"]).arg(&path).args(arguments).output().unwrap();
        assert!(out.status.success() && out.stderr.is_empty(), "{}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8(out.stdout).unwrap()
    };
    if Command::new("ogrinfo").arg("--version").output().is_err() {
        return skipped("ogrinfo", "Debian: gdal-bin");
    }
    let count = |text: &str| -> usize {
        let line = text.lines().find(|line| line.starts_with("Feature Count")).unwrap();
        line.rsplit(' ').next().unwrap().parse().unwrap()
    };
    let edge = ogrinfo(&["-so", "edge"]);
    assert_eq!(count(&edge), network.edges.len());
    assert!(
        edge.contains("Geometry: Line String") && edge.contains("WGS 84") && edge.contains("FID Column = fid"),
        "{edge}"
    );
    let permit = ogrinfo(&["-so", "permit_eu_semi16_5"]);
    let safe = all(
        &path,
        &QueryOptions { verdict: Some(VerdictKind::Safe), ..QueryOptions::new("EU-SEMI16.5", Policy::Lane) },
    );
    assert_eq!(count(&permit), safe.len());
    for column in ["rsc_m: Real", "shrink: Real", "length_m: Real", "width_source: String", "edge_id: Integer64"] {
        assert!(permit.contains(column), "{column} in {permit}");
    }
    let spat = ["-so", "-spat", "8.62", "49.41", "8.7", "49.46"];
    for (layer, verdict) in [("edge", None), ("permit_eu_semi16_5", Some(VerdictKind::Safe))] {
        let area = Some(Area::Bounds(Bounds { west: 8.62, south: 49.41, east: 8.7, north: 49.46 }));
        let ours = all(&path, &QueryOptions { area, verdict, ..QueryOptions::new("EU-SEMI16.5", Policy::Lane) });
        assert_eq!(count(&ogrinfo(&[&spat[..], &[layer]].concat())), ours.len(), "{layer}");
    }
    let indexed = ogrinfo(&["-sql", "SELECT HasSpatialIndex('edge', 'geom')"]);
    assert!(indexed.contains("= 1"), "{indexed}");
}
