//! Python with packages from PyPI, in an environment under `target/engines` that is made once.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use crate::repository;
use crate::skip::skipped;

/// The interpreter of the environment that reads and writes tables.
pub fn tables() -> Option<PathBuf> {
    python("tables", &["duckdb", "pyarrow"])
}

/// The interpreter of the environment with this name. If it cannot be made, prints why and returns `None`.
pub fn python(name: &str, packages: &[&str]) -> Option<PathBuf> {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _guard = ONE_AT_A_TIME.lock().unwrap();
    let folder = repository().join("target/engines").join(name);
    let (python, made) = (folder.join("bin/python"), folder.join("packages"));
    let wanted = packages.join("\n");
    if std::fs::read_to_string(&made).is_ok_and(|text| text == wanted) && runs(&python, &["--version"]) {
        return Some(python);
    }
    let recent = ["python3.13", "python3.12", "python3.11", "python3"].into_iter().find(|python| {
        runs(Path::new(python), &["-c", "import sys, venv, ensurepip; assert sys.version_info >= (3, 10)"])
    });
    let Some(recent) = recent else {
        skipped("python", "at least 3.10, with venv");
        return None;
    };
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    let folder = folder.to_string_lossy();
    let done = runs(Path::new(recent), &["-m", "venv", "--clear", &folder])
        && runs(&python, &[&install[..], packages].concat())
        && std::fs::write(&made, wanted).is_ok();
    if !done {
        skipped("packages of PyPI", &packages.join(" "));
    }
    done.then_some(python)
}

fn runs(program: &Path, arguments: &[&str]) -> bool {
    Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
}
