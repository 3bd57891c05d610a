//! The checker shares no code with what it checks: no path from `src/check` leads to `stet` or `pipeline`, nor back, and it is
//! the smaller of the two.

use std::path::{Path, PathBuf};

fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(folder);
    let mut found = Vec::new();
    let mut folders = vec![root];
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

/// Names of modules that appear in a path or a `use`, comments aside.
fn names(text: &str, module: &str) -> bool {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.into_iter().any(|line| {
        let line = line.split("//").next().unwrap();
        [
            format!("{module}::"),
            format!("::{module};"),
            format!("{{{module}"),
            format!(" {module},"),
            format!("::{module} "),
        ]
        .iter()
        .any(|form| line.contains(form.as_str()))
    })
}

#[test]
fn checker_and_prover_do_not_know_each_other() {
    for (folder, strange) in [("check", ["stet", "pipeline"]), ("stet", ["check", "pipeline"])] {
        let sources = sources(folder);
        assert!(sources.len() > 8, "{folder} has {} files", sources.len());
        for (path, text) in sources {
            for module in strange {
                assert!(!names(&text, module), "{} uses {module}", path.display());
            }
        }
    }
    assert!(names("use crate::stet::Model;", "stet") && !names("// like stet::Model", "stet"));
}

/// What the checker is told of roads is made without the prover: the choice between a turn's paths alone looks at a vehicle's motion,
/// and the checker takes the path that the database names.
#[test]
fn roads_and_turns_are_made_without_the_prover() {
    for folder in ["corridor", "network", "turns"] {
        for (path, text) in sources(folder).into_iter().filter(|(path, _)| !path.ends_with("turns/rank.rs")) {
            for module in ["stet", "pipeline"] {
                assert!(!names(&text, module), "{} uses {module}", path.display());
            }
        }
    }
    assert!(sources("check").iter().all(|(_, text)| !text.contains("nominal_leeway_m")));
}

#[test]
fn the_checker_of_one_corridor_is_smaller_than_the_prover() {
    let lines = |folder: &str, without: &[&str]| -> usize {
        let counted = sources(folder).into_iter().filter(|(path, _)| !without.iter().any(|name| path.ends_with(name)));
        counted.map(|(_, text)| text.lines().count()).sum()
    };
    // Files and databases are read by other code on the prover's side, too.
    let checker = lines("check", &["file.rs", "document.rs", "members.rs", "database.rs"]);
    let prover = lines("stet", &[]);
    println!("check {checker} lines, stet {prover}");
    assert!(checker < prover);
}
