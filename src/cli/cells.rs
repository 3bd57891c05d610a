//! `netcert cells`: divides an extract into tasks for the machines of a cluster.

use std::path::PathBuf;

use anyhow::{anyhow, bail};
use clap::{Args, ValueHint};
use netcert::cluster::{ABOUT, ExtractOrigin, RegionFolder, TASKS, TaskWriter};
use netcert::export::{Destination, ExportError, Layout, Out, Unfinished};
use netcert::pipeline::{self, EDGES_OF_A_TASK, RunError};

use super::Session;
use super::ingest::Roads;
use crate::cli::output::grouped;
use crate::cli::session::stop::when_stopped;

/// Divide an extract into tasks that machines of a cluster certify, each by itself.
///
/// A task is a rectangle of cells with the roads around it. It needs no other file. `netcert.spark.certify` of the Python package
/// certifies tasks with Apache Spark, and `netcert assemble` makes the database of the results. It has the bytes of `netcert ingest`.
#[derive(Args)]
#[command(after_help = "\
Examples:
  netcert cells country.osm.pbf --out country
  python -c 'import netcert, netcert.spark; netcert.spark.certify(\"country\", [netcert.vehicles()[\"EU-SEMI16.5\"]])'
  netcert assemble country --db country.gpkg

All machines need the same build of netcert. docs/how-to/spark.md goes through it step by step.")]
pub(crate) struct Cells {
    /// The OpenStreetMap extract; or a folder with Overture's files of segments and connectors.
    #[arg(value_name = "REGION.osm.pbf", value_hint = ValueHint::AnyPath)]
    input: PathBuf,
    /// The folder to write: tasks.parquet and netcert.json. An older folder of tasks is replaced, results included.
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
    /// How many directed edges a task has at most, unless a single cell has more. Smaller tasks repeat more of the roads around them.
    #[arg(long, value_name = "N", default_value_t = EDGES_OF_A_TASK, value_parser = clap::value_parser!(u64).range(1..))]
    edges_at_once: u64,
    #[command(flatten)]
    roads: Roads,
}

const LAYOUT: Layout = Layout::Folder { target: "cells", instead: "" };

/// Dividing fails in the extract or in the folder.
enum Failed {
    Run(RunError),
    Export(ExportError),
}

impl From<RunError> for Failed {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl From<ExportError> for Failed {
    fn from(error: ExportError) -> Self {
        Self::Export(error)
    }
}

impl Cells {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let countries = self.roads.countries()?;
        let extract = self.input.canonicalize().map_err(|e| anyhow!("{}: {e}", self.input.display()))?;
        let unfinished = Unfinished::default();
        let on_disk = unfinished.clone();
        when_stopped(move || on_disk.remove());
        let mut destination = Destination::begin(Out::Path(self.out.clone()), LAYOUT, unfinished)?;
        let mut table = TaskWriter::begin(destination.create(TASKS)?)?;
        let divided = pipeline::divide(&self.input, &countries, self.edges_at_once, &session.progress, |task| {
            table.push(task).map_err(Failed::from)
        });
        let divided = match divided {
            Ok(divided) => divided,
            Err(Failed::Run(error)) => bail!(error),
            Err(Failed::Export(error)) => bail!(destination.name(error)),
        };
        table.close().map_err(|error| destination.name(error))?;
        let (tasks, edges) = (divided.tasks, divided.edges);
        let (country, driving_side, roads) = self.roads.given();
        let origin = ExtractOrigin { extract, country, driving_side, roads };
        let about = RegionFolder { divided, edges_at_once: self.edges_at_once, origin };
        destination.write_whole(ABOUT, about.text().as_bytes()).map_err(|error| destination.name(error))?;
        destination.finish()?;
        session.progress.say(&format!(
            "{}: {} directed edges in {} {}",
            self.out.display(),
            grouped(u64::from(edges)),
            grouped(u64::from(tasks)),
            if tasks == 1 { "task" } else { "tasks" }
        ));
        Ok(())
    }
}
