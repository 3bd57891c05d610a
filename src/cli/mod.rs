//! The command line: one file for each verb. The text of arguments is parsed here, and the library gets typed values. What verbs share lies in
//! folders: arguments, the database with its vehicles and certificates, what is written, and the session.
//!
//! Results go to standard output; progress, counts and warnings go to standard error.

mod arguments;
mod assemble;
mod cells;
mod certify;
mod corners;
mod corridor;
mod database;
mod diff;
mod evidence;
mod explain;
mod export;
mod ingest;
mod keygen;
mod manoeuvres;
pub(crate) mod output;
mod paper;
mod query;
mod reach;
mod route;
mod serve;
mod session;
mod sign;
mod stats;
mod survey;
mod update;
mod vehicles;
mod verify;

use clap::{Parser, Subcommand};
use netcert::watch::Patience;

pub(crate) use session::Session;

/// Certify which roads of an OpenStreetMap extract an articulated vehicle fits.
#[derive(Parser)]
#[command(
    version,
    max_term_width = 100,
    after_help = "\
Start with:
  netcert ingest data/demo.osm.pbf        make demo.gpkg, with certificates
  netcert query --vehicle AU-ATRIPLE53    list the roads and whether a 3-trailer road train fits
  netcert help VERB                       describe a verb, with examples

Results go to standard output, everything else to standard error.
Exit status: 0 done (also when the answer is `unsafe`), 1 failed, 2 wrong usage.

`safe` holds within the stated model, widths and error bounds; it is no permit to drive."
)]
pub(crate) struct Cli {
    /// Print only results and errors.
    #[arg(long, short, global = true, display_order = 900)]
    quiet: bool,
    /// Number of threads; results do not depend on it [default: one for each processor].
    #[arg(long, global = true, display_order = 901, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// End one stroke, turn or search after so many seconds of processor time; its verdict is `unknown: took_too_long` [default: 600 for
    /// `ingest`, `certify`, `survey`, `verify`, `sign` and `corners`, 120 for other verbs].
    #[arg(long, global = true, display_order = 902, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(..=1_000_000))]
    patience: Option<u64>,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Subcommand)]
pub(crate) enum Verb {
    Ingest(ingest::Ingest),
    Update(update::Update),
    Certify(certify::Certify),
    Evidence(evidence::Evidence),
    Query(query::Query),
    Diff(diff::Diff),
    Explain(explain::Explain),
    Route(route::Route),
    Reach(reach::ReachQuery),
    Survey(survey::Survey),
    Corridor(corridor::Corridor),
    Export(export::Export),
    Vehicles(vehicles::Vehicles),
    Manoeuvres(manoeuvres::Manoeuvres),
    Corners(corners::Corners),
    Paper(paper::Paper),
    Stats(stats::Stats),
    Serve(serve::Serve),
    Cells(cells::Cells),
    Assemble(assemble::Assemble),
    Verify(verify::Verify),
    Sign(sign::Sign),
    Keygen(keygen::Keygen),
}

impl Verb {
    /// How long one stroke, turn or search may take.
    fn patience(&self) -> Patience {
        match self {
            Self::Ingest(_)
            | Self::Certify(_)
            | Self::Survey(_)
            | Self::Verify(_)
            | Self::Sign(_)
            | Self::Corners(_) => Patience::REGION,
            _ => Patience::ANSWER,
        }
    }

    /// What becomes of the work if the program is asked to stop; `None` for a verb that ends by itself.
    fn when_stopped(&self) -> Option<&'static str> {
        match self {
            Self::Serve(_) => None,
            Self::Ingest(_) => Some("; the same command goes on from there"),
            Self::Update(_) | Self::Certify(_) | Self::Evidence(_) | Self::Sign(_) => {
                Some("; the database is as it was")
            }
            _ => Some(""),
        }
    }
}
