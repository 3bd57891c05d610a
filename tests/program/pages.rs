//! The commands of `docs/export`, run as they stand on the pages, one page after the other in one folder.
//!
//! A page's commands are its blocks that begin with "```sh". A comment on the line before a block says which programs and packages the
//! block needs (`<!-- needs jq curl -->`), or why no test runs it (`<!-- not run: needs GraphHopper -->`). Where something is missing
//! the test says so by name and leaves out the rest of that page. The first lines of the first block are settings, `NAME=value`;
//! those of [`settings`] are replaced.

use crate::engines;
use netcert_testing::program;
use netcert_testing::python;
use netcert_testing::skip::skipped;

use std::collections::BTreeMap;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Command;

use netcert::osm::LonLat;
use netcert::osm::pbf::write::{NodeRecord, WayRecord, write_extract};
use program::WorkFolder;

/// What the commands of a page print if they do what the page says.
const ANSWERS: [(&str, &[&str]); 6] = [
    ("csv", &["edge_id,"]),
    ("geoparquet", &["primary", "no legal permit"]),
    ("osm-pbf", &["Objects ordered (by type and id): yes", r#""code":"Ok""#]),
    ("osrm", &[r#""code":"Ok""#]),
    ("pgrouting", &["(2 rows)", "(3 rows)"]),
    ("valhalla", &["Found route between points"]),
];

/// Run before a page's commands. Whatever a page leaves running ends with the page.
const PREAMBLE: &str = r#"set -euo pipefail; trap 'echo "line $LINENO: $BASH_COMMAND" >&2' ERR; trap 'code=$?; trap "" TERM; kill 0; exit $code' EXIT"#;

struct Page {
    name: String,
    lines: Vec<String>,
    blocks: Vec<Block>,
}

/// Lines `first..last` of a page, without the fences.
struct Block {
    first: usize,
    last: usize,
    needs: Vec<String>,
    not_run: Option<String>,
}

fn pages() -> Vec<Page> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/export");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "md") && path.file_stem().unwrap() != "README");
    paths.sort();
    paths.iter().map(|path| page(path)).collect()
}

fn page(path: &Path) -> Page {
    let text = std::fs::read_to_string(path).unwrap();
    let lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut blocks = Vec::new();
    let mut open: Option<usize> = None;
    for (i, line) in lines.iter().enumerate() {
        match open {
            Some(first) if line == "```" => {
                blocks.extend((lines[first - 1] == "```sh").then(|| block(&lines, first, i)));
                open = None;
            }
            None if line.starts_with("```") => open = Some(i + 1),
            _ => {}
        }
    }
    assert!(open.is_none(), "{}: a block without an end", path.display());
    Page { name: path.file_stem().unwrap().to_string_lossy().into_owned(), lines, blocks }
}

fn block(lines: &[String], first: usize, last: usize) -> Block {
    let before = first.checked_sub(2).map_or("", |i| lines[i].as_str());
    let comment = before.strip_prefix("<!-- ").and_then(|text| text.strip_suffix(" -->")).unwrap_or_default();
    let needs = comment.strip_prefix("needs ").unwrap_or_default().split_whitespace().map(str::to_owned).collect();
    Block { first, last, needs, not_run: comment.strip_prefix("not run: ").map(str::to_owned) }
}

/// What stands in the place of a page's own settings.
fn settings() -> BTreeMap<&'static str, String> {
    let hgv = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/export/hgv.lua");
    // Taken by nobody a moment ago.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    BTreeMap::from([
        ("EXTRACT", "drawn.osm.pbf".to_owned()),
        ("HGV", hgv.to_string_lossy().into_owned()),
        ("PORT", port.to_string()),
        ("FROM_EDGE", "1".to_owned()),
        ("TO_EDGE", "3".to_owned()),
        ("FROM_NODE", "1".to_owned()),
        ("TO_NODE", "21".to_owned()),
    ])
}

/// A line of settings with some of them replaced; `None`: it is another line.
fn set(line: &str, settings: &BTreeMap<&str, String>) -> Option<String> {
    let words = line.split('#').next()?.split_whitespace();
    let replaced = |word: &str| {
        let (name, value) = word.split_once('=')?;
        let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_uppercase() || c == '_');
        let value = settings.get(name).map_or(value, String::as_str);
        (is_name && !value.contains('$')).then(|| format!("{name}='{value}'"))
    };
    let words: Option<Vec<String>> = words.map(replaced).collect();
    words.filter(|words| !words.is_empty()).map(|words| words.join(" "))
}

/// The road that the pages' places lie on, with a side road that is too narrow. Nodes 1 to 21; edge 1 leads to the side road, edge
/// 3 on from it.
fn drawn() -> Vec<u8> {
    let ([lon, lat], [to_lon, to_lat]) = ([8.9746, 49.4650], [9.0674, 49.3998]);
    let e7 = |degrees: f64| (degrees * 1e7).round() as i32;
    let at = |share: f64| LonLat { lon_e7: e7(lon + share * (to_lon - lon)), lat_e7: e7(lat + share * (to_lat - lat)) };
    let node = |id: i64, place| NodeRecord { id, place, tags: Vec::new() };
    let mut nodes: Vec<NodeRecord> = (1..=21).map(|id| node(id, at((id - 2) as f64 / 18.0))).collect();
    let middle = at(0.5);
    nodes.push(node(22, LonLat { lon_e7: middle.lon_e7 + 30_000, lat_e7: middle.lat_e7 + 30_000 }));
    let way = |id, refs: Vec<i64>, [highway, width]: [&str; 2]| {
        let tags = [("highway", highway), ("width", width), ("ref", "B 37")];
        WayRecord { id, refs, tags: tags.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec() }
    };
    let ways = [
        way(1, (1..=11).collect(), ["primary", "14"]),
        way(2, (11..=21).collect(), ["primary", "14"]),
        way(3, vec![11, 22], ["residential", "1.8"]),
    ];
    write_extract(&nodes, &ways)
}

/// Where a needed program or package lies; `None`: it is missing.
fn folder_of(need: &str) -> Option<PathBuf> {
    let beside = |python: &Path| python.parent().map(Path::to_owned);
    match need {
        "osrm-bindings" | "pyvalhalla" | "overture-schema" => beside(engines::python()?),
        "duckdb" => beside(&python::tables()?),
        "pgrouting" => engines::pgrouting().then(|| folder_of("psql"))?,
        program => {
            let path = std::env::var_os("PATH")?;
            std::env::split_paths(&path).find(|folder| folder.join(program).is_file())
        }
    }
}

/// A page's commands on the lines on which the page has them; and what is missing for the rest.
fn script(page: &Page) -> (String, Option<String>) {
    let settings = settings();
    let mut lines = vec![String::new(); page.lines.len()];
    lines[0] = PREAMBLE.to_owned();
    let mut may_set = true;
    for block in &page.blocks {
        if let Some(why) = &block.not_run {
            println!("not run: {}.md, line {}: {why}", page.name, block.first);
            continue;
        }
        let folders: Vec<Option<PathBuf>> = block.needs.iter().map(|need| folder_of(need)).collect();
        if let Some(missing) = folders.iter().position(Option::is_none) {
            return (lines.join("\n"), Some(block.needs[missing].clone()));
        }
        let folders: Vec<String> = folders.iter().flatten().map(|path| path.to_string_lossy().into_owned()).collect();
        lines[block.first - 1] = format!("PATH='{}':$NETCERT_PATH", folders.join(":"));
        let own = block.first..block.last;
        for (line, written) in lines[own.clone()].iter_mut().zip(&page.lines[own]) {
            let setting = may_set.then(|| set(written, &settings)).flatten();
            may_set &= setting.is_some();
            *line = setting.unwrap_or_else(|| written.clone());
        }
    }
    (lines.join("\n"), None)
}

/// Runs a page in a folder: what it prints.
fn run(page: &Page, place: &WorkFolder) -> String {
    let (script, missing) = script(page);
    if let Some(missing) = &missing {
        skipped(missing, &format!("commands of {}.md", page.name));
    }
    let file = format!("{}.sh", page.name);
    std::fs::write(place.path(&file), script).unwrap();
    let bash = ["setsid", "--wait", "bash", &file];
    let needs_postgres = page.blocks.iter().any(|block| block.needs.iter().any(|need| need == "pgrouting"));
    let mut command = match (needs_postgres, engines::python()) {
        (true, Some(python)) if missing.is_none() => {
            engines::open_to_all(place);
            let mut command = Command::new(python);
            command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/engines/postgres.py"));
            command.arg(place.path("postgres")).args(bash);
            command
        }
        _ => {
            let mut command = Command::new(bash[0]);
            command.args(&bash[1..]);
            command
        }
    };
    let netcert = Path::new(env!("CARGO_BIN_EXE_netcert")).parent().unwrap().display();
    let path = format!("{netcert}:{}", std::env::var("PATH").unwrap());
    // What `pip install` asks for is there: nothing is fetched.
    command.current_dir(place.path(".")).env("PIP_NO_INDEX", "1").env("PIP_DISABLE_PIP_VERSION_CHECK", "1");
    command.env("NETCERT_PATH", &path).env("PATH", &path).env("NO_PROXY", "localhost");
    let done = command.output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "docs/export/{}.md does not run:\n{out}\n{err}", page.name);
    if missing.is_none() {
        let answers = ANSWERS.iter().filter(|(name, _)| *name == page.name).flat_map(|(_, answers)| *answers);
        answers.for_each(|answer| assert!(out.contains(answer), "{}.md: no {answer:?} in\n{out}\n{err}", page.name));
    }
    out.into_owned()
}

#[test]
fn the_commands_of_every_page_run_as_they_stand() {
    let place = WorkFolder::empty().file("drawn.osm.pbf", drawn());
    for page in pages() {
        run(&page, &place);
    }
}

#[test]
fn every_page_has_its_commands_in_blocks_and_writes_to_a_place_of_its_own() {
    let mut written: BTreeMap<String, String> = BTreeMap::new();
    for page in pages() {
        assert!(page.blocks.iter().any(|block| block.not_run.is_none()), "{}.md has no commands", page.name);
        let inside = |i: usize| page.blocks.iter().any(|block| (block.first..block.last).contains(&i));
        for (i, line) in page.lines.iter().enumerate() {
            let command =
                ["netcert ", "osrm-", "python ", "pip ", "valhalla_"].iter().any(|word| line.trim().starts_with(word));
            assert!(inside(i) || !(line.starts_with("    ") && command), "{}.md, line {}: {line}", page.name, i + 1);
            let out = line.split_once(" --out ").and_then(|(_, rest)| rest.split_whitespace().next());
            if let Some(out) = out.filter(|&out| inside(i) && out != "-") {
                let other = written.insert(out.to_owned(), page.name.clone());
                assert!(other.is_none(), "{}.md and {}.md write {out}", page.name, other.unwrap_or_default());
            }
        }
    }
    assert!(written.len() >= 10, "{written:?}");
}

#[test]
fn a_command_that_fails_is_told_by_its_line() {
    let place =
        WorkFolder::empty().file("x.md", "# X\n\nText.\n\n```sh\nEXTRACT=a.osm.pbf\n\ntrue\ncat $EXTRACT\n```\n");
    let (script, missing) = script(&page(&place.path("x.md")));
    assert_eq!(missing, None);
    std::fs::write(place.path("x.sh"), script).unwrap();
    let mut command = Command::new("setsid");
    command
        .args(["--wait", "bash", "x.sh"])
        .current_dir(place.path("."))
        .env("NETCERT_PATH", std::env::var("PATH").unwrap());
    let done = command.output().unwrap();
    let err = String::from_utf8_lossy(&done.stderr);
    assert!(!done.status.success() && err.contains("line 9: cat $EXTRACT") && err.contains("drawn.osm.pbf"), "{err}");
}
