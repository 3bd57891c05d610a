//! `netcert paper`: the paper's scenarios, from Table I's own numbers, as simulations, and beside what netcert says; its
//! figures.
//!
//! The figures of two runs are the same bytes; times are not, and stand apart behind `--timing`.

mod answer;
mod figures;
mod simulate;
mod timing;
mod tubes_file;

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use clap::{Args, ValueEnum};
use netcert::published::{drawn_route, scenarios};

use super::Session;
use super::output::results;
use simulate::Simulated;

/// Run the scenarios of the paper that netcert's certificate comes from.
///
/// Faruqui, Das, Kumar L, Jagtap: "Spatiotemporal Tube-Based Safety-Certificate
/// for Autonomous Navigation of Articulated Vehicles". Its Table I lists seven
/// vehicles with routes and says that 1, 3 and 5 are safe. This prints its
/// certificate 𝒞 = w_min − (h_Ω + r_N^max) twice, with netcert's own beside it:
///
///   from the table's own numbers;
///   by its Algorithm 1, on a route as long as the paper's;
///   netcert's RSC for the same vehicles and corridors.
#[derive(Args)]
#[command(
    verbatim_doc_comment,
    after_help = "\
Examples:
  netcert paper                          the numbers
  netcert paper --out figures            the paper's figures as well, as SVG
  netcert paper --out figures --timing   run time against trailers, too

The folder gets tubes.svg, leeway.svg and rsc.svg, timing.svg if asked for, and
tubes.json: what tubes.svg draws, as functions of time.

The paper's formulas are kept to the letter where they can be followed. They
decide nothing in netcert: docs/errata.md shows in numbers where the print cannot
be right. The route is netcert's own drawing (data/paper/route.toml); of its own
the paper gives the length, 543.62 m."
)]
pub(crate) struct Paper {
    /// Write the figures into this folder; it is made if it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// A table for people, or JSON with all digits.
    #[arg(long, value_enum, default_value_t = Form::Table)]
    format: Form,
    /// Measure run time against the number of trailers, 1 to 10: other numbers every time.
    #[arg(long)]
    timing: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    Table,
    Json,
}

impl Paper {
    pub(crate) fn run(&self, session: &Session) -> anyhow::Result<()> {
        let (table, route) = (scenarios()?, drawn_route()?);
        let simulated: Vec<Simulated> =
            table.iter().map(|scenario| simulate::run(scenario, &route)).collect::<anyhow::Result<_>>()?;
        let timing = if self.timing { Some(timing::measure(&table, &route)?) } else { None };
        let mut out = results();
        match self.format {
            Form::Table => answer::table(&mut out, &simulated, timing.as_ref())?,
            Form::Json => answer::json(&mut out, &simulated, &route, timing.as_ref())?,
        }
        std::io::Write::flush(&mut out)?;
        if let Some(folder) = &self.out {
            let drawn = simulated.iter().find(|s| s.scenario.number == figures::DRAWN);
            let tubes = drawn.map(|s| ("tubes.json", tubes_file::json(s)));
            for (name, text) in figures::all(&simulated, &route, timing.as_ref())?.into_iter().chain(tubes) {
                write(folder, name, &text)?;
                session.progress.say(&format!("{}", folder.join(name).display()));
            }
        }
        Ok(())
    }
}

fn write(folder: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    let path = folder.join(name);
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(&path, text))
        .map_err(|e| anyhow!("{}: cannot write it: {e}; give another folder with --out", path.display()))
}
