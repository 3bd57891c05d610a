//! Finds the database of a verb: the file of `--db`, or the only database in the current directory.

pub(crate) mod fleet;
pub(crate) mod measurements;
pub(crate) mod on_demand;
pub(crate) mod routing;

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use netcert::store::{Database, StoreError};

#[derive(Args)]
pub(crate) struct DatabaseArgs {
    /// The database that `netcert ingest` made [default: the only one in the current directory].
    #[arg(long = "db", value_name = "REGION.gpkg")]
    path: Option<PathBuf>,
}

impl DatabaseArgs {
    pub(crate) fn path(&self) -> anyhow::Result<PathBuf> {
        match &self.path {
            Some(path) => Ok(path.clone()),
            None => only_one_in(Path::new(".")),
        }
    }
}

fn only_one_in(folder: &Path) -> anyhow::Result<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let name = PathBuf::from(entry?.file_name());
        if name.extension().is_some_and(|extension| extension == "gpkg") && is_netcerts(&name) {
            found.push(name);
        }
    }
    found.sort();
    match found.as_slice() {
        [one] => Ok(one.clone()),
        [] => bail!(
            "no netcert database in the current directory; name one with --db, or make one with `netcert ingest \
             REGION.osm.pbf`"
        ),
        several => {
            let names: Vec<_> = several.iter().map(|name| name.display().to_string()).collect();
            bail!("several databases in the current directory: name one with --db ({})", names.join(", "))
        }
    }
}

/// Whether the file is a netcert database. A damaged netcert database counts, so that its error is shown; a GeoPackage
/// of another program does not.
fn is_netcerts(path: &Path) -> bool {
    !matches!(Database::open(path), Err(StoreError::NotNetcert(_) | StoreError::NotSqlite(_)))
}
