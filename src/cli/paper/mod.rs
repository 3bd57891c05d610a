//! `netcert paper`: runs the paper's scenarios from the numbers of Table I and as simulations, compares them with
//! netcert's certificates, and draws the paper's figures.
//!
//! The figures of two runs have the same bytes. Run times differ from run to run, so only `--timing` measures them.

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

/// Run the scenarios of the paper that netcert's certificate is based on.
///
/// Faruqui, Das, Kumar L, Jagtap: "Spatiotemporal Tube-Based Safety-Certificate
/// for Autonomous Navigation of Articulated Vehicles". Table I of the paper lists
/// seven vehicles with routes and says that 1, 3 and 5 are safe. This command prints
/// the paper's certificate 𝒞 = w_min − (h_Ω + r_N^max) in two ways, then netcert's:
///
///   𝒞 from the numbers in the table;
///   𝒞 by the paper's Algorithm 1, on a route as long as the paper's;
///   netcert's RSC for the same vehicles and corridors.
#[derive(Args)]
#[command(
    verbatim_doc_comment,
    after_help = "\
Examples:
  netcert paper                          print the numbers
  netcert paper --out figures            also draw the paper's figures, as SVG
  netcert paper --out figures --timing   also measure run time by number of trailers

--out writes tubes.svg, leeway.svg, rsc.svg, with --timing also timing.svg, and tubes.json:
the tubes of tubes.svg as functions of time.

This command follows the paper's formulas to the letter where that is possible. No verdict of
netcert uses them; docs/errata.md shows in numbers where the printed formulas cannot be right. The
paper gives only the length of its route, 543.62 m. The route here is netcert's own drawing
(data/paper/route.toml)."
)]
pub(crate) struct Paper {
    /// Write the figures into this folder, which is created if it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// The output format: a table for people, or JSON with all digits.
    #[arg(long, value_enum, default_value_t = Form::Table)]
    format: Form,
    /// Measure the run time with 1 to 10 trailers. These numbers differ from run to run.
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
