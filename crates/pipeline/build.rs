//! Gives the program a hash of its sources, which tells two builds of one version apart.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    name_the_sources(&PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../.."));
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

/// What certificates depend on: the code, the data and the versions of the packages.
const SOURCES: [&str; 5] = ["Cargo.lock", "Cargo.toml", "crates", "data", "src"];

/// Sets `NETCERT_SOURCES` to a hash of the sources: FNV-1a over 64 bits, which suffices against chance.
fn name_the_sources(project: &Path) {
    let mut files = Vec::new();
    for source in SOURCES {
        let path = project.join(source);
        println!("cargo:rerun-if-changed={}", path.display());
        if path.is_dir() { collect(&path, source, &mut files) } else { files.push(source.to_owned()) }
    }
    files.sort();
    if files.len() < SOURCES.len() * 2 {
        println!("cargo:error={}: no sources of netcert", project.display());
    }
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bytes: &[u8]| {
        bytes.iter().for_each(|&byte| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    };
    for file in files {
        add(file.as_bytes());
        add(&fs::read(project.join(&file)).unwrap_or_default());
    }
    println!("cargo:rustc-env=NETCERT_SOURCES={hash:016x}");
}
