//! Tests the walls of the code: that the checker shares nothing with what it checks, which crate knows which, and that modules lie in folders
//! in one way. Cargo keeps the crates apart: no manifest of a checker names the prover.

use std::path::{Path, PathBuf};

/// Rust files of a folder of the repository.
pub(super) fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push((path.clone(), std::fs::read_to_string(path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

/// The crates of this workspace that a crate names among its dependencies, optional ones too.
fn dependencies(name: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates").join(name).join("Cargo.toml");
    let manifest: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let named = manifest.get("dependencies").and_then(toml::Value::as_table).into_iter().flatten();
    let package = |(key, value): (&String, &toml::Value)| {
        value.get("package").and_then(toml::Value::as_str).unwrap_or(key).to_owned()
    };
    let mut own: Vec<String> =
        named.map(package).filter_map(|package| Some(package.strip_prefix("netcert-")?.to_owned())).collect();
    own.sort();
    own
}

/// The crates in `crates/`.
pub(super) fn crates() -> Vec<String> {
    let folders = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("crates")).unwrap();
    let mut names: Vec<String> =
        folders.map(|folder| folder.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    assert!(names.len() > 15, "{names:?}");
    names
}

#[test]
fn kernel_checker_and_simulator_share_only_the_base_and_roads_and_databases_know_none_of_them() {
    assert!(dependencies("base").is_empty());
    for name in ["kernel", "check", "oracle", "osm"] {
        assert_eq!(dependencies(name), ["base"], "{name}");
    }
    // What both sides are told of roads, and what keeps it, is made without either.
    assert_eq!(dependencies("roads"), ["base", "osm"]);
    assert_eq!(dependencies("rows"), ["base", "osm", "roads"]);
    assert!(dependencies("files").is_empty());
    assert_eq!(dependencies("evidence"), ["base", "files", "osm", "roads", "rows"]);
    assert_eq!(dependencies("store"), ["base", "evidence", "files", "osm", "roads", "rows"]);
    assert_eq!(dependencies("overture"), ["base", "files", "osm", "rows"]);
    // What checks files and databases knows neither the prover nor the library that calls it.
    let checks = ["base", "check", "evidence", "files", "osm", "overture", "roads", "rows", "store"];
    assert_eq!(dependencies("verify"), checks);
    for name in crates() {
        let named = dependencies(&name);
        let (prover, checker) = (["kernel", "certify"], ["check", "verify"]);
        let names = |side: [&str; 2]| side.iter().any(|one| name == *one || named.iter().any(|other| other == one));
        assert!(!(names(prover) && names(checker)), "{name} names both the prover and the checker");
    }
}

/// What makes, explains and draws certificates takes rows as values, wherever they come from.
#[test]
fn what_makes_and_explains_certificates_does_not_know_databases() {
    assert_eq!(dependencies("certify"), ["base", "kernel", "osm", "roads", "rows"]);
    assert_eq!(dependencies("explain"), ["base", "certify", "kernel", "osm", "roads", "rows"]);
    // A picture of a route takes the route, which is read from a database.
    assert_eq!(dependencies("picture"), ["base", "certify", "evidence", "explain", "kernel", "osm", "roads", "route"]);
    let reads = |text: &str| text.lines().any(|line| !line.trim_start().starts_with("//") && line.contains("store::"));
    for (path, text) in sources("src/certificate") {
        assert!(!reads(&text), "{}", path.display());
    }
    let of_routes: Vec<PathBuf> =
        sources("crates/route/src").into_iter().filter(|(_, text)| reads(text)).map(|(path, _)| path).collect();
    assert!(of_routes.len() == 1 && of_routes[0].ends_with("database.rs"), "{of_routes:?}");
}

#[test]
fn the_checker_of_one_corridor_is_smaller_than_the_prover() {
    let lines = |folder: &str| sources(folder).iter().map(|(_, text)| text.lines().count()).sum::<usize>();
    let (checker, prover) = (lines("crates/check/src"), lines("crates/kernel/src/stet"));
    println!("check {checker} lines, stet {prover}");
    assert!(checker < prover);
}

#[test]
fn a_module_with_parts_is_a_folder_with_its_own_text_in_mod_rs() {
    let folders = crates().into_iter().map(|name| format!("crates/{name}/src")).chain(["src".to_owned()]);
    let files: Vec<PathBuf> = folders.flat_map(|folder| sources(&folder)).map(|(path, _)| path).collect();
    assert!(files.len() > 400, "{}", files.len());
    let beside: Vec<_> = files.iter().filter(|path| path.with_extension("").is_dir()).collect();
    assert!(beside.is_empty(), "a file beside a folder of its name: {beside:?}");
}
