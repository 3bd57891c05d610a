//! The migrations are embedded in the program: a new or changed file must rebuild it. So is the page: every file of
//! `web/dist` goes into a table that `src/serve/assets.rs` includes.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=migrations");
    println!("cargo:rerun-if-changed=web/dist");
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("web/dist");
    let mut files = Vec::new();
    collect(&root, "", &mut files);
    files.sort();
    let mut table = String::from("/// Addresses and contents.\nconst PAGE: &[(&str, &[u8])] = &[\n");
    for (address, file) in &files {
        let _ = writeln!(table, "    ({address:?}, include_bytes!({:?})),", file.display().to_string());
    }
    table.push_str("];\n");
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default()).join("page.rs");
    if let Err(error) = fs::write(&out, table) {
        println!("cargo:error={}: cannot write: {error}", out.display());
    }
}

fn collect(folder: &Path, address: &str, files: &mut Vec<(String, PathBuf)>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let address = format!("{address}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            collect(&entry.path(), &address, files);
        } else {
            files.push((address, entry.path()));
        }
    }
}
