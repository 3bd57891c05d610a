//! Tests of `netcert update`: the database is that of ingesting what osmium makes of the extract and the changes.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};

use netcert_testing::extracts;
use netcert_testing::program::{ProgramRun, WorkFolder};
use netcert_testing::skip::skipped;

/// Vehicle and options of every database.
const MADE: &str = "--vehicle AU-SEMI19 --corridor carriageway --country AU --needs off";

pub(crate) fn run(place: &WorkFolder, line: &str) -> ProgramRun {
    ProgramRun::of(line, place.command(line).env("SOURCE_DATE_EPOCH", "1700000000"))
}

fn osmium(place: &WorkFolder, arguments: &[&str]) -> Option<()> {
    let done = Command::new("osmium").args(arguments).current_dir(place.path(".")).output().ok()?;
    assert!(done.status.success(), "osmium {arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
    Some(())
}

/// What SQLite's shell answers to a statement.
pub(crate) fn sql(db: &Path, text: &str) -> String {
    let done = Command::new("sqlite3").arg(db).arg(text).output().expect("the sqlite3 program");
    assert!(done.status.success(), "{text}: {}", String::from_utf8_lossy(&done.stderr));
    String::from_utf8(done.stdout).unwrap()
}

/// Whether two databases say the same, but for their runs, the account of what was read, and what the next update needs. A spatial index says
/// which boxes it has. How it keeps them in nodes depends on the order in which they came.
fn same(a: &Path, b: &Path) {
    let sql = |text: &str| sql(a, text);
    let tables =
        sql("SELECT name FROM pragma_table_list WHERE schema = 'main' AND type IN ('table', 'virtual') ORDER BY name");
    let mut compared = 0;
    for table in tables.lines().filter(|t| !["run", "account", "map_change", "sqlite_sequence"].contains(t)) {
        let attached = format!("ATTACH '{}' AS b;", b.display());
        let differ = sql(&format!(
            "{attached} SELECT 'a', * FROM (SELECT * FROM {table} EXCEPT SELECT * FROM b.{table}) LIMIT 3; \
             SELECT 'b', * FROM (SELECT * FROM b.{table} EXCEPT SELECT * FROM {table}) LIMIT 3; \
             SELECT 'rows differ' WHERE (SELECT count(*) FROM {table}) <> (SELECT count(*) FROM b.{table});"
        ));
        assert!(differ.is_empty(), "{table}: {differ}");
        compared += 1;
    }
    assert!(compared > 20 && tables.contains("rtree_edge_geom"), "{compared} tables: {tables}");
}

pub(crate) fn place_of(east_m: f64, north_m: f64) -> LonLat {
    let e7 = |metres: f64| (metres / 111_319.5 * 1e7).round() as i32;
    LonLat { lon_e7: e7(east_m), lat_e7: e7(north_m) }
}

/// A grid of wide roads, 5 by 5, 200 m apart: way 1 to 5 from west to east, 6 to 10 from south to north. Node 10 · row + column.
fn grid() -> Vec<u8> {
    let nodes: Vec<NodeRecord> = (0..25)
        .map(|k| (k / 5, k % 5))
        .map(|(row, column)| NodeRecord {
            id: 10 * row + column + 1,
            place: place_of(200.0 * column as f64, 200.0 * row as f64),
            tags: Vec::new(),
        })
        .collect();
    let tags = || vec![("highway".to_owned(), "primary".to_owned()), ("width".to_owned(), "14".to_owned())];
    let along = |row: i64| (0..5).map(|column| 10 * row + column + 1).collect();
    let across = |column: i64| (0..5).map(|row| 10 * row + column + 1).collect();
    let ways = (0..5).map(|row| WayRecord { id: row + 1, refs: along(row), tags: tags() });
    let ways: Vec<WayRecord> =
        ways.chain((0..5).map(|column| WayRecord { id: column + 6, refs: across(column), tags: tags() })).collect();
    write_extract(&nodes, &ways)
}

/// Woods with a clearing, in two ways, around the grid's middle; a pond, a river, a town, and a lake that the file has in part.
pub(crate) fn backdrop() -> String {
    let node = |id: i64, east_m: f64, north_m: f64, tags: &str| {
        let (lon, lat) = place_of(east_m, north_m).degrees();
        format!("<node id=\"{id}\" version=\"1\" lon=\"{lon:.7}\" lat=\"{lat:.7}\">{tags}</node>")
    };
    let square = |first: i64, from_m: f64, to_m: f64| -> String {
        let corners = [(from_m, from_m), (to_m, from_m), (to_m, to_m), (from_m, to_m)];
        (first..).zip(corners).map(|(id, (east_m, north_m))| node(id, east_m, north_m, "")).collect()
    };
    let way = |id: i64, refs: &[i64], tags: &str| {
        let refs: String = refs.iter().map(|id| format!("<nd ref=\"{id}\"/>")).collect();
        format!("<way id=\"{id}\" version=\"1\">{refs}{tags}</way>")
    };
    let relation = |id: i64, members: &[(i64, &str)], tags: &str| {
        let member = |(id, role): &(i64, &str)| format!("<member type=\"way\" ref=\"{id}\" role=\"{role}\"/>");
        let members: String = members.iter().map(member).collect();
        format!("<relation id=\"{id}\" version=\"1\">{members}<tag k=\"type\" v=\"multipolygon\"/>{tags}</relation>")
    };
    let tag = |key: &str, value: &str| format!("<tag k=\"{key}\" v=\"{value}\"/>");
    [
        square(200, 250.0, 550.0),
        square(210, 350.0, 450.0),
        square(220, 20.0, 120.0),
        node(230, 700.0, 100.0, &[tag("place", "town"), tag("name", "Midgrid")].concat()),
        way(100, &[200, 201, 202], ""),
        way(101, &[200, 203, 202], ""),
        way(102, &[210, 211, 212, 213, 210], ""),
        way(103, &[220, 221, 222, 223, 220], &tag("natural", "water")),
        way(104, &[220, 202, 999], &[tag("waterway", "river"), tag("name", "Gridder")].concat()),
        relation(8, &[(100, "outer"), (101, "outer"), (102, "inner")], &tag("landuse", "forest")),
        relation(9, &[(104, "outer"), (998, "outer")], &tag("natural", "water")),
    ]
    .concat()
}

const HEAD: &str = "<?xml version='1.0' encoding='UTF-8'?>\n<osmChange version=\"0.6\">\n";

/// A road gets narrow, a node moves, a way goes, a way comes, and a left turn is forbidden.
fn changes() -> String {
    let at = |east_m, north_m| {
        let (lon, lat) = place_of(east_m, north_m).degrees();
        format!("lon=\"{lon:.7}\" lat=\"{lat:.7}\"")
    };
    let narrow =
        "<tag k=\"highway\" v=\"primary\"/><tag k=\"width\" v=\"2.4\"/><tag k=\"name\" v=\"A &amp; &quot;B&quot;\"/>";
    let refs = |ids: [i64; 5]| ids.map(|id| format!("<nd ref=\"{id}\"/>")).concat();
    format!(
        "{HEAD}<modify><way id=\"2\" version=\"2\">{}{narrow}</way><node id=\"33\" version=\"2\" {}/></modify>\n\
         <delete><way id=\"10\" version=\"3\"/></delete>\n\
         <create><node id=\"90\" version=\"1\" {}/><way id=\"20\" version=\"1\"><nd ref=\"1\"/><nd ref=\"90\"/>{narrow}</way>\
         <relation id=\"7\" version=\"1\"><member type=\"way\" ref=\"3\" role=\"from\"/><member type=\"node\" ref=\"22\" role=\"via\"/>\
         <member type=\"way\" ref=\"7\" role=\"to\"/><tag k=\"type\" v=\"restriction\"/>\
         <tag k=\"restriction\" v=\"no_left_turn\"/></relation>{}</create>\n</osmChange>\n",
        refs([11, 12, 13, 14, 15]),
        at(412.0, 607.0),
        at(-150.0, -90.0),
        backdrop(),
    )
}

pub(crate) fn place() -> WorkFolder {
    let place = WorkFolder::empty().file("grid.osm.pbf", grid()).file("1.osc", changes());
    run(&place, &format!("ingest grid.osm.pbf {MADE}")).succeeds();
    place
}

#[test]
fn the_result_is_that_of_ingesting_what_osmium_makes() {
    let place = place();
    let back = format!(
        "{HEAD}<modify><way id=\"2\" version=\"3\">{}<tag k=\"highway\" v=\"primary\"/><tag k=\"width\" v=\"14\"/></way></modify>\
         <delete><relation id=\"7\" version=\"2\"/><way id=\"103\" version=\"2\"/><node id=\"230\" version=\"2\"/></delete></osmChange>",
        [11, 12, 13, 14, 15].map(|id| format!("<nd ref=\"{id}\"/>")).concat()
    );
    let place = place.file("2.osc", back);
    let Some(()) = osmium(&place, &["apply-changes", "grid.osm.pbf", "1.osc", "-o", "one.osm.pbf"]) else {
        return skipped("osmium", "Debian: osmium-tool");
    };
    osmium(&place, &["apply-changes", "grid.osm.pbf", "1.osc", "2.osc", "-o", "two.osm.pbf"]).unwrap();
    for name in ["one", "two"] {
        run(&place, &format!("ingest {name}.osm.pbf {MADE}")).succeeds();
        let again = run(&place, &format!("update --db grid.gpkg {}.osc", if name == "one" { 1 } else { 2 }));
        again.succeeds().tells("up to date");
        same(&place.path(&format!("{name}.gpkg")), &place.path("grid.gpkg"));
        let things = sql(&place.path("grid.gpkg"), "SELECT kind, object, name FROM backdrop ORDER BY fid");
        let rest = "river|way 104|Gridder\ntown|node 230|Midgrid\n";
        match name {
            "one" => assert_eq!(things, format!("wood|relation 8|\nwater|way 103|\n{rest}")),
            _ => assert_eq!(things, "wood|relation 8|\nriver|way 104|Gridder\n"),
        }
        let account = "SELECT outcome, reason, count FROM account WHERE item = 'backdrop' AND run_id = \
                       (SELECT max(run_id) FROM account) ORDER BY account_no";
        let kept = if name == "one" { 4 } else { 2 };
        let expected = format!("read||{}\nkept||{kept}\nleft_out|incomplete|1\n", kept + 1);
        assert_eq!(sql(&place.path("grid.gpkg"), account), expected);
    }
    // Applied again, an old change changes nothing, because a later version is known.
    run(&place, "update --db grid.gpkg 1.osc").succeeds();
    same(&place.path("two.gpkg"), &place.path("grid.gpkg"));
    // A newer extract gives the same.
    run(&place, &format!("ingest grid.osm.pbf {MADE}")).succeeds();
    run(&place, "update --db grid.gpkg --new-extract two.osm.pbf").succeeds();
    same(&place.path("two.gpkg"), &place.path("grid.gpkg"));
}

/// A number for each step, the same in every run.
fn drawn(last: &mut u64) -> u64 {
    *last = *last * 48_271 % 0x7fff_ffff;
    *last / 8
}

/// Changes of a real region, made from osmium's text form: nodes move by some metres, ways get a width or go.
fn real_changes(opl: &str, seed: u64) -> String {
    let mut last = seed;
    let mut text = format!("{HEAD}<modify>\n");
    let mut gone = String::new();
    for line in opl.lines() {
        let mut fields = line.split(' ');
        let id = &fields.next().unwrap_or_default()[1..];
        let field = |letter: char| line.split(' ').skip(1).find_map(|field| field.strip_prefix(letter));
        match (line.as_bytes().first(), drawn(&mut last) % 40) {
            (Some(b'n'), 0) if field('T').is_none_or(str::is_empty) => {
                let (Some(x), Some(y)) = (field('x'), field('y')) else { continue };
                let moved = |at: &str, by: u64| at.parse::<f64>().unwrap() + (by % 100) as f64 * 1e-6 - 5e-5;
                let (x, y) = (moved(x, drawn(&mut last)), moved(y, drawn(&mut last)));
                let _ = writeln!(text, "<node id=\"{id}\" version=\"9999\" lon=\"{x:.7}\" lat=\"{y:.7}\"/>");
            }
            (Some(b'w'), 1) => {
                let _ = writeln!(gone, "<way id=\"{id}\" version=\"9999\"/>");
            }
            (Some(b'w'), 2) => {
                let tags = field('T').unwrap_or_default();
                let Some(class) = tags.split(',').find_map(|tag| tag.strip_prefix("highway=")) else { continue };
                let refs = field('N').unwrap_or_default().split(',').filter(|node| !node.is_empty());
                let refs: String = refs.map(|node| format!("<nd ref=\"{}\"/>", &node[1..])).collect();
                let width = 4 + drawn(&mut last) % 9;
                let _ = writeln!(
                    text,
                    "<way id=\"{id}\" version=\"9999\">{refs}<tag k=\"highway\" v=\"{class}\"/><tag k=\"width\" v=\"{width}\"/></way>"
                );
            }
            _ => {}
        }
    }
    format!("{text}</modify><delete>{gone}</delete></osmChange>")
}

/// Databases of Sydney, `old.gpkg` and `new.gpkg`: before and after the changes `c.osc`, which are made from osmium's text form of the extract.
fn sydney_before_and_after(changes: impl Fn(&str) -> String) -> Option<WorkFolder> {
    let path = extracts::extract("sydney_au.osm.pbf")?;
    let place = WorkFolder::empty().file("none.osc", format!("{HEAD}</osmChange>"));
    // osmium does not keep the box of the header, by which edges near the border are marked.
    if osmium(&place, &["apply-changes", path.to_str().unwrap(), "none.osc", "-o", "old.osm.pbf"]).is_none() {
        skipped("osmium", "Debian: osmium-tool");
        return None;
    }
    osmium(&place, &["cat", "old.osm.pbf", "-o", "old.opl"]).unwrap();
    let opl = String::from_utf8(place.read("old.opl")).unwrap();
    std::fs::write(place.path("c.osc"), changes(&opl)).unwrap();
    osmium(&place, &["apply-changes", "old.osm.pbf", "c.osc", "-o", "new.osm.pbf"]).unwrap();
    for name in ["old", "new"] {
        run(&place, &format!("ingest {name}.osm.pbf {MADE}")).succeeds();
    }
    Some(place)
}

#[test]
fn a_real_region_with_hundreds_of_changes_is_that_of_ingesting_it_anew() {
    let Some(place) = sydney_before_and_after(|opl| real_changes(opl, 5)) else { return };
    run(&place, "update --db old.gpkg c.osc").succeeds();
    same(&place.path("new.gpkg"), &place.path("old.gpkg"));
}

/// Changes of a real region that leave all numbers of edges and turns: one road in fifty gets a width and a name, another one a speed limit, and
/// some get a node more, so that all positions after it move.
fn few_changes(opl: &str) -> String {
    let mut text = format!("{HEAD}<modify>\n");
    let mut created = String::new();
    let places: std::collections::HashMap<&str, (f64, f64)> = opl
        .lines()
        .filter_map(|line| line.strip_prefix('n'))
        .filter_map(|line| {
            let field = |letter: char| line.split(' ').find_map(|field| field.strip_prefix(letter));
            Some((line.split(' ').next()?, (field('x')?.parse().ok()?, field('y')?.parse().ok()?)))
        })
        .collect();
    let (mut roads, mut longer) = (0, 0);
    for line in opl.lines().filter_map(|line| line.strip_prefix('w')) {
        let field = |letter: char| line.split(' ').find_map(|field| field.strip_prefix(letter));
        let (Some(id), Some(tags), Some(refs)) = (line.split(' ').next(), field('T'), field('N')) else { continue };
        let mut refs: Vec<String> = refs.split(',').map(|node| node[1..].to_owned()).collect();
        if tags.contains('%') || !tags.contains("highway=") || tags.contains("width") || refs.len() < 3 {
            continue;
        }
        roads += 1;
        let own = match roads % 50 {
            0 => "<tag k=\"width\" v=\"7.3\"/><tag k=\"name\" v=\"Another Street\"/>",
            25 => "<tag k=\"maxspeed\" v=\"30\"/>",
            _ => continue,
        };
        if roads % 200 == 100 {
            let [from, to] = [&refs[0], &refs[1]].map(|node| places[node.as_str()]);
            longer += 1;
            let (x, y) = ((from.0 + to.0) / 2.0 + 2e-6, (from.1 + to.1) / 2.0);
            let new = format!("99999999{longer}");
            let _ = writeln!(created, "<node id=\"{new}\" version=\"1\" lon=\"{x:.7}\" lat=\"{y:.7}\"/>");
            refs.insert(1, new);
        }
        let refs: String = refs.iter().map(|node| format!("<nd ref=\"{node}\"/>")).collect();
        let tags = tags.split(',').filter_map(|tag| tag.split_once('='));
        let tags = tags.filter(|(key, _)| !["name", "maxspeed"].contains(key));
        let tags: String = tags.map(|(key, value)| format!("<tag k=\"{key}\" v=\"{value}\"/>")).collect();
        let _ = writeln!(text, "<way id=\"{id}\" version=\"9999\">{refs}{tags}{own}</way>");
    }
    assert!(roads > 200 && longer > 0, "{roads} roads, {longer} with another node");
    format!("{text}</modify><create>{created}</create></osmChange>")
}

#[test]
fn a_few_changes_of_a_real_region_change_few_pages() {
    let Some(place) = sydney_before_and_after(few_changes) else { return };
    // A set with settings of its own is brought up to date, too.
    for name in ["old", "new"] {
        run(&place, &format!("certify --db {name}.gpkg --vehicle AU-BDOUBLE26 --corridor lane")).succeeds();
    }
    let before = place.read("old.gpkg");
    run(&place, "update --db old.gpkg c.osc").succeeds();
    // An update makes all sets in one run.
    for table in ["certified_set", "certified_turns"] {
        sql(&place.path("new.gpkg"), &format!("UPDATE {table} SET run_id = 1"));
    }
    same(&place.path("new.gpkg"), &place.path("old.gpkg"));
    let after = place.read("old.gpkg");
    let pages = |bytes: &[u8]| bytes.chunks(8192).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let (before, after) = (pages(&before), pages(&after));
    let changed = before.iter().zip(&after).filter(|(a, b)| a != b).count();
    assert!(changed > 10 && changed * 3 < before.len(), "{changed} of {} pages", before.len());
    // Without changes nothing is certified again.
    run(&place, "update --db old.gpkg none.osc").succeeds().tells(" 0  certificates");
    same(&place.path("new.gpkg"), &place.path("old.gpkg"));
}

#[test]
fn a_folder_is_applied_in_its_sequence_and_nothing_may_be_missing() {
    let place = place();
    let folder = place.path("minutes/000/000");
    std::fs::create_dir_all(&folder).unwrap();
    let put = |name: &str, bytes: &str| std::fs::write(folder.join(name), bytes).unwrap();
    let state = |last: i64| {
        std::fs::write(place.path("minutes/state.txt"), format!("#today\nsequenceNumber={last}\ntimestamp=x\n"))
            .unwrap();
    };
    put("201.osc.gz", &changes());
    state(201);
    let update = "update --db grid.gpkg --from minutes";
    let before = place.read("grid.gpkg");
    run(&place, update).fails().tells("--after NUMBER");
    run(&place, &format!("{update} --after 199")).fails().tells("change 200 is missing").tells("000/000/200.osc.gz");
    run(&place, &format!("{update} --after 202")).fails().tells("older or of another sequence");
    assert!(place.read("grid.gpkg") == before, "a refused update changes nothing");
    run(&place, &format!("{update} --after 200")).succeeds().tells("up to date");
    run(&place, update).succeeds().tells("already");
    put("202.osc.gz", &format!("{HEAD}<delete><way id=\"9\" version=\"2\"/></delete></osmChange>"));
    state(202);
    run(&place, update).succeeds();
    run(&place, "query --db grid.gpkg --vehicle AU-SEMI19 --format csv").succeeds();
    let left = String::from_utf8(
        Command::new("sqlite3")
            .arg(place.path("grid.gpkg"))
            .arg("SELECT DISTINCT way_id FROM edge ORDER BY 1")
            .output()
            .unwrap()
            .stdout,
    )
    .unwrap();
    assert_eq!(left.split_whitespace().collect::<Vec<_>>(), ["1", "2", "3", "4", "5", "6", "7", "8", "20"]);
}

#[test]
fn broken_changes_and_another_extract_are_refused_and_the_database_stays() {
    let place = place();
    let before = place.read("grid.gpkg");
    let whole = changes();
    let broken = [
        (whole[..whole.len() / 2].to_owned(), "broken.osc"),
        ("<osm version=\"0.6\"></osm>".to_owned(), "no osmChange"),
        (String::new(), "ends too soon"),
        (whole.replace("id=\"33\"", "id=\"x\""), "id=\"x\" cannot be read"),
        (whole.replace("lon=", "long="), "a node has no lon"),
        (whole.replace("type=\"way\"", "type=\"path\""), "a member is neither"),
    ];
    for (text, told) in broken {
        std::fs::write(place.path("broken.osc"), text).unwrap();
        run(&place, "update --db grid.gpkg 1.osc broken.osc").fails().tells("broken.osc").tells(told);
    }
    run(&place, "update --db grid.gpkg gone.osc").fails().tells("gone.osc");
    run(&place, "update --db grid.gpkg").ends_as_misuse();
    run(&place, "update --db grid.gpkg grid.osm.pbf").fails().tells("--new-extract grid.osm.pbf");
    std::fs::write(place.path("other.osm.pbf"), write_extract(&[], &[])).unwrap();
    run(&place, "update --db grid.gpkg --extract other.osm.pbf 1.osc").fails().tells("not the grid.osm.pbf");
    assert!(place.read("grid.gpkg") == before);
}

/// An extract of yesterday is not brought back to the day before.
#[test]
fn changes_that_are_older_than_the_extract_are_refused() {
    let place = place();
    let header = "--output-header=osmosis_replication_timestamp=2026-11-20T00:00:00Z";
    let Some(()) = osmium(&place, &["cat", "grid.osm.pbf", header, "-o", "dated.osm.pbf"]) else {
        return skipped("osmium", "Debian: osmium-tool");
    };
    run(&place, &format!("ingest dated.osm.pbf {MADE}")).succeeds();
    let at = |time: &str| changes().replace("version=\"2\"", &format!("version=\"2\" timestamp=\"{time}\""));
    std::fs::write(place.path("early.osc"), at("2026-11-19T23:59:59Z")).unwrap();
    std::fs::write(place.path("late.osc"), at("2026-11-20T00:00:01Z")).unwrap();
    let before = place.read("dated.gpkg");
    run(&place, "update --db dated.gpkg early.osc").fails().tells("2026-11-19T23:59:59Z").tells("fetch newer changes");
    assert!(place.read("dated.gpkg") == before);
    // What follows may make up for it, so only the latest change counts.
    run(&place, "update --db dated.gpkg early.osc late.osc").succeeds();
}

#[test]
fn an_updated_database_is_exported() {
    let place = place();
    run(&place, "update --db grid.gpkg 1.osc").succeeds();
    let rows =
        run(&place, "export csv --db grid.gpkg --vehicle AU-SEMI19 --corridor carriageway --layer edges --out -")
            .succeeds();
    assert!(rows.out().lines().count() > 10);
}

#[test]
fn vehicles_and_their_settings_stay() {
    let place = place();
    run(&place, "certify --db grid.gpkg --vehicle EU-SEMI16.5 --corridor lane --needs off").succeeds();
    run(&place, "update --db grid.gpkg 1.osc").succeeds().tells("certified again, with its own settings");
    let sets = run(&place, "stats --db grid.gpkg --format json").succeeds().out();
    assert!(sets.contains("EU-SEMI16.5") && sets.contains("AU-SEMI19"), "{sets}");
    run(&place, "query --db grid.gpkg --vehicle EU-SEMI16.5 --corridor lane --turns").succeeds().shows("safe");
}

#[test]
fn measurements_stay_and_count_on_what_is_taken_over_and_on_what_is_new() {
    let place = place();
    let Some(()) = osmium(&place, &["apply-changes", "grid.osm.pbf", "1.osc", "-o", "new.osm.pbf"]) else {
        return skipped("osmium", "Debian: osmium-tool");
    };
    // One on a road that stays, one on the road that gets narrow.
    let mut rows = "quantity,value,sigma,source,way_id\n".to_owned();
    for way in [1, 2] {
        let _ = writeln!(rows, "carriageway_width,9.5,0.05,tape,{way}");
    }
    std::fs::write(place.path("m.csv"), rows).unwrap();
    run(&place, "evidence add m.csv --db grid.gpkg").succeeds();
    std::fs::copy(place.path("grid.gpkg"), place.path("anew.gpkg")).unwrap();
    run(&place, &format!("ingest new.osm.pbf --db anew.gpkg {MADE}")).succeeds();
    run(&place, "update --db grid.gpkg 1.osc").succeeds().tells("2 measurements taken over");
    same(&place.path("anew.gpkg"), &place.path("grid.gpkg"));
}
