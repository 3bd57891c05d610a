//! The register of measurements: what is measured counts, what sees it is certified again and nothing else, removing it gives back the
//! map, and a newer ingest keeps it.

use netcert::network::EdgeNo;
use std::collections::BTreeMap;

use netcert::osm::LonLat;
use netcert::osm::facts::{Policy, WidthSource};
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use netcert::rows::EdgeCertificate;
use netcert::settings::Settings;
use netcert::store::{Run, StoreError};
use netcert::verdict::{UnknownReason, Verdict};
use serde_json::Value;
use sqlx::{AssertSqlSafe, Column as _, Connection as _, Row as _, SqliteConnection};

use netcert_testing::program::WorkFolder;

const VEHICLE: &str = "AU-SEMI19";
/// What depends on measurements.
const CERTIFICATES: [&str; 4] = ["certificate_compact", "plan", "turn_certificate_compact", "turn_plan"];
const NETWORK: [&str; 7] = ["edge", "turn", "junction", "section", "road", "evidence", "evidence_place"];

fn sql<T>(place: &WorkFolder, work: impl AsyncFnOnce(&mut SqliteConnection) -> T) -> T {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let mut c = SqliteConnection::connect(place.path("demo.gpkg").to_str().unwrap()).await.unwrap();
        let found = work(&mut c).await;
        c.close().await.unwrap();
        found
    })
}

/// All rows of tables, byte for byte.
pub(crate) fn rows_of<'t>(place: &WorkFolder, tables: &[&'t str]) -> BTreeMap<&'t str, Vec<String>> {
    sql(place, async |c| {
        let mut all = BTreeMap::new();
        for &table in tables {
            let head =
                sqlx::query(AssertSqlSafe(format!("SELECT * FROM {table} LIMIT 1"))).fetch_optional(&mut *c).await;
            let head =
                head.unwrap().map(|row| row.columns().iter().map(|c| format!("quote(\"{}\")", c.name())).collect());
            let columns: Vec<String> = head.unwrap_or_else(|| vec!["1".to_owned()]);
            let statement = format!("SELECT {} AS line FROM {table} ORDER BY line", columns.join(" || ' ' || "));
            let rows = sqlx::query(AssertSqlSafe(statement)).fetch_all(&mut *c).await.unwrap();
            all.insert(table, rows.iter().map(|row| row.get::<String, _>(0)).collect());
        }
        all
    })
}

fn ids(place: &WorkFolder, statement: &str) -> Vec<Vec<i64>> {
    sql(place, async |c| {
        let rows = sqlx::query(AssertSqlSafe(statement.to_owned())).fetch_all(c).await.unwrap();
        rows.iter().map(|row| (0..row.len()).map(|column| row.get::<i64, _>(column)).collect()).collect()
    })
}

pub(crate) fn edges_of(place: &WorkFolder) -> Vec<Value> {
    let answer = place.netcert(&format!("query --vehicle {VEHICLE} --format json")).succeeds();
    answer.json()["edges"].as_array().unwrap().clone()
}

/// The edges of the stroke of an edge.
pub(crate) fn stroke_of(place: &WorkFolder, edge_id: i64) -> Vec<i64> {
    let statement = format!(
        "SELECT e.edge_id FROM stroke AS s JOIN stroke_edge AS p ON p.position > s.edge_start AND p.position <= s.edge_end \
         JOIN edge AS e ON e.fid = p.fid WHERE s.stroke_no = (SELECT stroke_no FROM stroke JOIN stroke_edge \
         ON position > edge_start AND position <= edge_end JOIN edge USING (fid) WHERE edge_id = {edge_id})"
    );
    ids(place, &statement).into_iter().flatten().collect()
}

#[test]
fn the_width_that_is_needed_makes_an_edge_safe_and_removing_it_restores_the_map() {
    let place = WorkFolder::with_demo();
    let before = rows_of(&place, &[&CERTIFICATES[..], &NETWORK].concat());
    let edges = edges_of(&place);
    let needy: Vec<(i64, f64)> =
        edges.iter().filter_map(|edge| Some((edge["edge_id"].as_i64()?, edge["need_width_m"].as_f64()?))).collect();
    let width = |id: i64| edges.iter().find(|edge| edge["edge_id"] == id).unwrap()["width_m"].as_f64().unwrap();
    let &(edge, need) = needy.iter().find(|(edge, _)| stroke_of(&place, *edge).len() > 2).unwrap();
    let mut file = "quantity,value,sigma,edge_id,source\n".to_owned();
    for id in stroke_of(&place, edge).into_iter().filter(|&id| width(id) < need) {
        file += &format!("lane_width,{need},0,{id},tape measure\n");
    }
    let measured = file.lines().count() - 1;
    let place = place.file("survey.csv", &file);
    place
        .netcert("evidence add survey.csv --dry-run")
        .succeeds()
        .shows("would be certified again")
        .shows("dry run: nothing was changed");
    assert_eq!(rows_of(&place, &[&CERTIFICATES[..], &NETWORK].concat()), before);
    place
        .netcert("evidence add survey.csv")
        .succeeds()
        .shows(&format!("{measured} measurement"))
        .shows(&format!("widths or limits of {measured} directed edge"))
        .shows(&format!("{VEHICLE}, lane policy: "))
        .shows("AU-ATRIPLE53, lane policy: ")
        .shows("became safe");
    let now = edges_of(&place).into_iter().find(|row| row["edge_id"] == edge).unwrap();
    assert_eq!((&now["verdict"], &now["width_source"]), (&"safe".into(), &"surveyed".into()), "{now}");
    let row = place.rows(VEHICLE).into_iter().find(|row| row.edge.id == edge).unwrap();
    assert_eq!(row.width_source, Some(WidthSource::Surveyed));
    place.netcert(&format!("verify --db demo.gpkg --vehicle {VEHICLE} --sample 150 --input {{demo}}")).succeeds();

    let verify = format!("verify --db demo.gpkg --vehicle {VEHICLE} --sample 1");
    for tampered in ["UPDATE evidence_place SET counts = 0 WHERE place_no = 1", "UPDATE evidence_place SET edge_id = 1"]
    {
        let other = WorkFolder::empty().file("demo.gpkg", place.read("demo.gpkg"));
        assert!(other.sql(tampered) > 0);
        other.netcert(&verify).fails();
    }

    place.netcert("evidence add survey.csv").succeeds().shows("not added again").shows("nothing changed");
    let list = place.netcert("evidence list --format json").succeeds().json();
    assert_eq!(list.as_array().unwrap().len(), measured);
    assert!(list.as_array().unwrap().iter().all(|one| one["used"] == "counts" && one["state"] == "matched"));
    place.netcert("evidence show 1").succeeds().shows("\"source\": \"tape measure\"");
    place.netcert("evidence remove --all").succeeds().shows("no longer safe");
    assert_eq!(rows_of(&place, &[&CERTIFICATES[..], &NETWORK].concat()), before);
    assert!(place.netcert("evidence list").succeeds().out().is_empty());
    // Numbers are not given twice.
    place.netcert("evidence add survey.csv").succeeds();
    place.netcert(&format!("evidence show {}", measured + 1)).succeeds();
    place.netcert("evidence show 1").fails().tells("no measurement 1");
}

#[test]
fn what_is_certified_again_is_what_certify_makes() {
    let place = WorkFolder::with_wide_demo(VEHICLE);
    let all = [&CERTIFICATES[..], &NETWORK].concat();
    let before = rows_of(&place, &all);
    let edges = ids(&place, "SELECT edge_id FROM edge ORDER BY fid");
    let corners = ids(
        &place,
        "SELECT via_node, a.edge_id, b.edge_id FROM turn AS t JOIN edge AS a ON a.fid = from_fid \
         JOIN edge AS b ON b.fid = to_fid WHERE first_arc_fid IS NULL ORDER BY t.fid",
    );
    let roads = ids(&place, "SELECT way_id FROM road WHERE roundabout ORDER BY road_no");
    let mut file = "quantity,value,sigma,edge_id,way_id,junction,from_edge,to_edge,source,date\n".to_owned();
    file += &format!("carriageway_width,7.1,0.1,{},,,,,tape,2026-01-02\n", edges[40][0]);
    file += &format!("lane_width,2.9,0,{},,,,,tape,\n", edges[200][0]);
    file += &format!("carriageway_width,9,0,,{},,,,tape,\n", roads[0][0]);
    let [node, from, to] = corners[corners.len() / 2][..] else { panic!() };
    file += &format!("kerb_radius,14,0.2,,,{node},{from},{to},tape,\n");
    file += &format!("kerb_radius,9,0,,,{},,,tape,\n", corners[3][0]);
    let place = place.file("survey.csv", &file);
    place.netcert("evidence add survey.csv").succeeds().shows("5 measurements added: 5 matched");
    assert_eq!(ids(&place, "SELECT count(*) FROM turn WHERE kerb_source = 'surveyed'").len(), 1);
    let made = rows_of(&place, &all);
    assert!(made["edge"] != before["edge"] && made["turn"] != before["turn"] && made["junction"] != before["junction"]);
    assert_ne!(made["turn_certificate_compact"], before["turn_certificate_compact"]);
    let turn = format!(
        "SELECT turn_id FROM turn AS t JOIN edge AS a ON a.fid = from_fid JOIN edge AS b ON b.fid = to_fid \
         WHERE a.edge_id = {from} AND b.edge_id = {to}"
    );
    let line = format!("explain {} --vehicle {VEHICLE} --format json", ids(&place, &turn)[0][0]);
    let said = place.netcert(&line).succeeds().json()["measurements"].clone();
    let kerb = |row: &&Value| row["quantity"] == "kerb_radius" && row["value"] == 14.0;
    assert!(said.as_array().unwrap().iter().any(|row| kerb(&row)), "{said}");
    place.netcert(&format!("verify --db demo.gpkg --vehicle {VEHICLE} --sample 40")).succeeds();
    let whole = WorkFolder::empty().file("demo.gpkg", place.read("demo.gpkg"));
    whole.netcert("certify").succeeds();
    assert_eq!(rows_of(&whole, &CERTIFICATES), rows_of(&place, &CERTIFICATES));

    // A new database of the same extract takes the register over, and comes to the same.
    whole.netcert(&format!("ingest {{demo}} --db demo.gpkg --vehicle {VEHICLE} --corridor carriageway")).succeeds();
    let again = rows_of(&whole, &all);
    assert!(all.iter().all(|table| again[table] == made[table]), "{:?}", all.iter().find(|t| again[*t] != made[*t]));

    place.netcert("evidence remove 1 2 3 4 5").succeeds();
    assert_eq!(rows_of(&place, &all), before);
}

/// A road of three ways, and another extract in which the last one is gone.
fn drawn(place: WorkFolder) -> WorkFolder {
    let node = |id: i64| NodeRecord {
        id,
        place: LonLat { lon_e7: 80_000_000 + 30_000 * id as i32, lat_e7: 490_000_000 },
        tags: Vec::new(),
    };
    let way = |id: i64, width: &str| WayRecord {
        id,
        refs: vec![id, id + 1],
        tags: [("highway", "secondary"), ("width", width)]
            .map(|(key, value)| (key.to_owned(), value.to_owned()))
            .to_vec(),
    };
    let nodes: Vec<NodeRecord> = (1..=4).map(node).collect();
    let ways = [way(1, "7"), way(2, "7"), way(3, "7")];
    let place = place.file("old.osm.pbf", write_extract(&nodes, &ways));
    place.file("new.osm.pbf", write_extract(&nodes, &ways[..2]))
}

#[test]
fn a_newer_ingest_keeps_the_register_and_says_what_is_matched_otherwise() {
    let place = drawn(WorkFolder::empty());
    place.netcert("ingest old.osm.pbf --db demo.gpkg --no-certify").succeeds();
    let rows =
        "quantity,value,way_id,source\ncarriageway_width,6.2,2,a\ncarriageway_width,6.4,3,b\nlane_width,3,77,c\n";
    let place = place.file("survey.csv", rows);
    place
        .netcert("evidence add survey.csv")
        .succeeds()
        .shows("2 matched, 1 unmatched")
        .shows("way 77 is no road of this network")
        .shows("is less than the map's tagged 7.00 m");
    let widths = |place: &WorkFolder| {
        sql(place, async |c| {
            let all = "SELECT DISTINCT way_id, carriageway_width_m FROM edge ORDER BY way_id";
            let rows = sqlx::query_as::<_, (i64, f64)>(all).fetch_all(c).await.unwrap();
            rows.into_iter().map(|(way, m)| (way, (m * 100.0).round() as i64)).collect::<Vec<_>>()
        })
    };
    assert_eq!(widths(&place), [(1, 700), (2, 620), (3, 640)]);
    place
        .netcert("ingest new.osm.pbf --db demo.gpkg --no-certify")
        .succeeds()
        .tells("3 measurements taken over")
        .tells("measurement 2 (survey.csv:3), carriageway_width: matched before, unmatched now");
    assert_eq!(widths(&place), [(1, 700), (2, 620)]);
    place
        .netcert("ingest old.osm.pbf --db demo.gpkg --no-certify")
        .succeeds()
        .tells("unmatched before, now matched: edge");
    assert_eq!(widths(&place), [(1, 700), (2, 620), (3, 640)]);
    place.netcert("evidence list --state unmatched").succeeds().shows("way 77").tells("1 measurement");
}

#[test]
fn of_two_measurements_the_later_counts_and_without_dates_the_lesser() {
    let place = drawn(WorkFolder::empty());
    place.netcert("ingest old.osm.pbf --db demo.gpkg --no-certify").succeeds();
    let width = |way: i64| {
        let statement =
            format!("SELECT CAST(round(carriageway_width_m * 100) AS INTEGER) FROM edge WHERE way_id = {way}");
        ids(&place, &statement)[0][0]
    };
    let add = |name: &str, rows: &str| {
        std::fs::write(place.path(name), format!("quantity,value,way_id,source,date\n{rows}")).unwrap();
        place.netcert(&format!("evidence add {name}")).succeeds()
    };
    add("a.csv", "carriageway_width,6.2,1,a,2026-01-01\ncarriageway_width,6.2,2,a,\n");
    let told = add("b.csv", "carriageway_width,6.8,1,b,2026-02-01\ncarriageway_width,6.8,2,b,2026-02-01\n");
    let _ = told
        .shows("conflict: 3 (b.csv:2) says carriageway_width 6.80 m and 1 (a.csv:2) says carriageway_width 6.20 m")
        .shows("3 counts there, it is later")
        .shows("2 counts there, it is the lesser");
    assert_eq!((width(1), width(2)), (680, 620));
    place.netcert("evidence list").succeeds().shows("superseded");
    place.netcert("evidence remove 3").succeeds();
    assert_eq!((width(1), width(2)), (620, 620));
    // Both in one file, and one of them twice.
    let told = add("c.csv", "lane_width,3,3,c,\nlane_width,3.2,3,c,\nlane_width,3,3,c,\n");
    let _ = told.shows("conflict: ").shows("row 4: the file has it twice").shows("2 measurements added");
    // A limit whose uncertainty leaves nothing changes nothing, and netcert says so.
    std::fs::write(place.path("d.csv"), "quantity,value,sigma,way_id,source\nmax_height,3.8,3.8,3,d\n").unwrap();
    let told = place.netcert("evidence add d.csv").succeeds().shows("kept, not used by certificates").out();
    assert!(told.contains("widths or limits of 0 directed edges"), "{told}");
}

#[test]
fn measured_limits_count_in_place_of_the_map_and_removing_them_restores_it() {
    let place = WorkFolder::with_demo();
    let all = [&CERTIFICATES[..], &NETWORK].concat();
    let before = rows_of(&place, &all);
    let edges = edges_of(&place);
    let safe: Vec<i64> =
        edges.iter().filter(|edge| edge["verdict"] == "safe").filter_map(|edge| edge["edge_id"].as_i64()).collect();
    let (low, weak, high) = (safe[0], safe[safe.len() / 2], safe[safe.len() - 1]);
    // 4.4 m less 1.64 times 0.1 m is less than the vehicle's 4.3 m. Its mass is 42.5 t.
    let file = format!(
        "quantity,value,sigma,edge_id,source\nmax_height,4.4,0.1,{low},laser\nmax_weight,42,0,{weak},sign\n\
         max_height,4.4,0.05,{high},laser\n"
    );
    let place = place.file("limits.csv", file);
    place
        .netcert("evidence add limits.csv")
        .succeeds()
        .shows("3 matched")
        .shows("limits of 3 directed edges")
        .shows("no longer safe");
    let verdict = |id: i64| {
        let edges = edges_of(&place);
        let row = edges.iter().find(|row| row["edge_id"] == id).unwrap();
        (row["verdict"].as_str().unwrap().to_owned(), row["reason"].as_str().unwrap_or_default().to_owned())
    };
    let said = |verdict: &str, reason: &str| (verdict.to_owned(), reason.to_owned());
    assert_eq!(verdict(low), said("forbidden", "height"));
    assert_eq!(verdict(weak), said("forbidden", "weight"));
    assert_eq!(verdict(high), said("safe", ""));
    place
        .netcert(&format!("explain {low} --vehicle {VEHICLE}"))
        .succeeds()
        .shows("maxheight is 4.24 m (measured), the vehicle's height 4.30 m")
        .shows("1 max_height 4.40 m, of which 4.24 m counts: laser (limits.csv, row 2)");
    let json = place.netcert(&format!("explain {weak} --vehicle {VEHICLE} --format json")).succeeds().json();
    let [row] = &json["measurements"].as_array().unwrap()[..] else { panic!("{json}") };
    assert_eq!((row["evidence_no"].as_i64(), row["quantity"].as_str()), (Some(2), Some("max_weight")));
    assert_eq!((row["counts"].as_f64(), row["source"].as_str()), (Some(42.0), Some("sign")));
    let json = place.netcert(&format!("explain {} --vehicle {VEHICLE} --format json", safe[3])).succeeds().json();
    assert_eq!(json["measurements"].as_array().map(Vec::len), Some(0));
    place.netcert(&format!("verify --db demo.gpkg --vehicle {VEHICLE} --sample 150")).succeeds();
    let made = rows_of(&place, &CERTIFICATES);
    let whole = WorkFolder::empty().file("demo.gpkg", place.read("demo.gpkg"));
    whole.netcert("certify").succeeds();
    assert_eq!(rows_of(&whole, &CERTIFICATES), made);
    place.netcert("evidence remove --all").succeeds().shows("became safe");
    assert_eq!(rows_of(&place, &all), before);
}

#[test]
fn a_measured_limit_replaces_a_tag_and_says_so() {
    let node = |id: i64| NodeRecord {
        id,
        place: LonLat { lon_e7: 80_000_000 + 30_000 * id as i32, lat_e7: 490_000_000 },
        tags: Vec::new(),
    };
    let way = |id: i64, height: &str| WayRecord {
        id,
        refs: vec![id, id + 1],
        tags: [("highway", "secondary"), ("width", "9"), ("maxheight", height)]
            .map(|(key, value)| (key.to_owned(), value.to_owned()))
            .to_vec(),
    };
    let nodes: Vec<NodeRecord> = (1..=3).map(node).collect();
    let extract = write_extract(&nodes, &[way(1, "3.5"), way(2, "low")]);
    let place = WorkFolder::empty()
        .file("low.osm.pbf", extract)
        .file("limits.csv", "quantity,value,way_id,source\nmax_height,4.2,1,laser\nmax_height,4.2,2,laser\n");
    place.netcert("ingest low.osm.pbf --db demo.gpkg --vehicle EU-SEMI16.5 --corridor carriageway").succeeds();
    let reasons = || {
        let answer = place.netcert("query --vehicle EU-SEMI16.5 --format json").succeeds().json();
        let edges = answer["edges"].as_array().unwrap().clone();
        edges.iter().map(|edge| format!("{}: {}", edge["verdict"], edge["reason"])).collect::<Vec<_>>()
    };
    let mapped = reasons();
    assert!(mapped.iter().any(|said| said == "\"forbidden\": \"height\""), "{mapped:?}");
    place
        .netcert("evidence add limits.csv")
        .succeeds()
        .shows("max_height 4.20 m is more than the map's tagged 3.50 m on 2 directed edges; the measurement counts")
        .shows("max_height 4.20 m replaces a tag that cannot be read on 2 directed edges; the measurement counts");
    let measured = reasons();
    assert!(measured.iter().all(|said| !said.contains("height") && !said.contains("limit")), "{measured:?}");
    place.netcert("evidence remove --all").succeeds();
    assert_eq!(reasons(), mapped);
}

#[test]
fn a_faulty_file_changes_nothing_and_names_row_and_way_out() {
    let place = drawn(WorkFolder::empty());
    place.netcert("ingest old.osm.pbf --db demo.gpkg --no-certify").succeeds();
    let before = place.read("demo.gpkg");
    let refused = |name: &str, text: &str, said: &str| {
        std::fs::write(place.path(name), text).unwrap();
        place.netcert(&format!("evidence add {name}")).fails().tells(name).tells(said);
        assert!(place.read("demo.gpkg") == before, "{name}");
    };
    let good = "lane_width,3,1,me";
    refused(
        "unit.csv",
        &format!("quantity,value,way_id,source,unit\n{good},m\n{good},yard\n"),
        "row 3: unit: `yard` is no unit",
    );
    refused(
        "wide.csv",
        &format!("quantity,value,way_id,source\n{good}\nlane_width,300,1,me\n"),
        "row 3: value: 300 m is no width",
    );
    refused("column.csv", "quantity,value,way_id,source,colour\nlane_width,3,1,me,red\n", "unknown column `colour`");
    refused("place.csv", "quantity,value,source\nlane_width,3,me\n", "no place; give `way_id`");
    refused("empty.csv", "quantity,value,way_id,source\n", "has no rows");
    place.netcert("evidence add missing.csv").fails().tells("missing.csv");
    // An edge that no longer exists is no fault of the file: it is kept and said.
    std::fs::write(place.path("gone.csv"), "quantity,value,edge_id,way_id,source\nlane_width,3,99,1,me\n").unwrap();
    place
        .netcert("evidence add gone.csv --matched-only")
        .succeeds()
        .shows("edge 99 does not exist; way 1 has today")
        .shows("1 measurement left out")
        .shows("nothing changed");
    assert!(place.read("demo.gpkg") == before);
    place.netcert("evidence remove 4").fails().tells("measurement 4 is not in the register, so nothing was removed");
    place.netcert("evidence remove").ends_as_misuse();
    assert!(place.read("demo.gpkg") == before);
}

#[test]
fn a_change_that_fails_at_its_end_leaves_everything_as_it_was() {
    let place = drawn(WorkFolder::empty());
    place.netcert("ingest old.osm.pbf --db demo.gpkg --vehicle EU-SEMI16.5").succeeds();
    let all = [&CERTIFICATES[..], &NETWORK].concat();
    place.sql("CREATE TRIGGER fails BEFORE INSERT ON run BEGIN SELECT raise(ABORT, 'no room'); END");
    let before = rows_of(&place, &all);
    let place = place.file("survey.csv", "quantity,value,way_id,source\ncarriageway_width,5,2,a\n");
    place.netcert("evidence add survey.csv").fails().tells("no room");
    assert_eq!(rows_of(&place, &all), before);
    assert_eq!(ids(&place, "SELECT count(*) FROM sqlite_schema WHERE type = 'trigger' AND tbl_name = 'edge'"), [[6]]);
    place.sql("DROP TRIGGER fails");
    place.netcert("evidence add survey.csv").succeeds();
    assert_eq!(ids(&place, "SELECT count(*) FROM sqlite_schema WHERE type = 'trigger' AND tbl_name = 'edge'"), [[6]]);
}

#[test]
fn certificates_of_a_register_that_changed_meanwhile_are_not_stored() {
    let place = drawn(WorkFolder::empty());
    place.netcert("ingest old.osm.pbf --db demo.gpkg --no-certify").succeeds();
    let mut database = netcert::store::Database::open_to_change(&place.path("demo.gpkg")).unwrap();
    let edges = database.load_network().unwrap().edges.len();
    let place = place.file("survey.csv", "quantity,value,way_id,source\ncarriageway_width,5,2,a\n");
    place.netcert("evidence add survey.csv").succeeds();
    let run = Run {
        command: "certify".into(),
        input_name: "demo.gpkg".into(),
        input_blake3: None,
        replication_timestamp: None,
        netcert_version: "0".into(),
        started: "2026-11-23T08:00:00.000Z".into(),
        finished: "2026-11-23T08:00:01.000Z".into(),
        parameters: "{}".into(),
    };
    let vehicle = netcert::pipeline::record(&netcert_testing::catalogue::catalogued(VEHICLE)).unwrap();
    let settings = Settings { policy: Policy::Lane, ..database.settings_of_new_sets().unwrap() };
    let mut replace = || {
        let certificates =
            EdgeNo::first(edges).map(|edge| EdgeCertificate::bare(edge, Verdict::Unknown(UnknownReason::Geometry)));
        database.replace_certificates(&vehicle, &settings, certificates, Vec::new(), None, &run, &[])
    };
    assert!(matches!(replace(), Err(StoreError::RegisterChanged(_))));
    assert!(place.database().certified().unwrap().is_empty());
    database.load_network().unwrap();
    let certificates =
        EdgeNo::first(edges).map(|edge| EdgeCertificate::bare(edge, Verdict::Unknown(UnknownReason::Geometry)));
    database.replace_certificates(&vehicle, &settings, certificates, Vec::new(), None, &run, &[]).unwrap();
}
