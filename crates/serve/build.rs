//! Embeds the page in the program: lists every file of `web/dist` in a table that `assets.rs` includes.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let project = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../..");
    let root = project.join("web/dist");
    println!("cargo:rerun-if-changed={}", root.display());
    let mut addresses = Vec::new();
    collect(&root, "", &mut addresses);
    addresses.sort();
    let mut table = String::from("/// Addresses and contents.\nconst PAGE: &[(&str, &[u8])] = &[\n");
    for address in &addresses {
        let file = format!("/../../web/dist{address}");
        let _ = writeln!(table, "    ({address:?}, include_bytes!(concat!(env!(\"CARGO_MANIFEST_DIR\"), {file:?}))),");
    }
    table.push_str("];\n");
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default()).join("page.rs");
    // The old file is removed, not overwritten: in a copied target folder it may share its content with the original.
    let _ = fs::remove_file(&out);
    if let Err(error) = fs::write(&out, table) {
        println!("cargo:error={}: cannot write: {error}", out.display());
    }
}

fn collect(folder: &Path, address: &str, addresses: &mut Vec<String>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let address = format!("{address}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            collect(&entry.path(), &address, addresses);
        } else {
            addresses.push(address);
        }
    }
}
