//! The program: a list of verbs. What was typed stops in `cli`; the work is the library's.
//!
//! Exit status: 0 done (also when the answer is "unsafe"), 1 failed, 2 wrong usage.

mod cli;

use std::process::ExitCode;

use clap::Parser as _;

use cli::{Cli, Verb};

fn main() -> ExitCode {
    let cli = Cli::parse();
    match run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if cli::output::is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            cli::output::complain(&error);
            ExitCode::FAILURE
        }
    }
}

fn run(cli: &Cli) -> anyhow::Result<()> {
    let session = cli::Session::begin(cli)?;
    match &cli.verb {
        Verb::Ingest(verb) => verb.run(&session),
        Verb::Update(verb) => verb.run(&session),
        Verb::Certify(verb) => verb.run(&session),
        Verb::Evidence(verb) => verb.run(&session),
        Verb::Query(verb) => verb.run(&session),
        Verb::Diff(verb) => verb.run(&session),
        Verb::Explain(verb) => verb.run(&session),
        Verb::Route(verb) => verb.run(&session),
        Verb::Reach(verb) => verb.run(&session),
        Verb::Survey(verb) => verb.run(&session),
        Verb::Corridor(verb) => verb.run(&session),
        Verb::Export(verb) => verb.run(&session),
        Verb::Vehicles(verb) => verb.run(&session),
        Verb::Manoeuvres(verb) => verb.run(&session),
        Verb::Corners(verb) => verb.run(&session),
        Verb::Paper(verb) => verb.run(&session),
        Verb::Stats(verb) => verb.run(),
        Verb::Serve(verb) => verb.run(&session),
        Verb::Cells(verb) => verb.run(&session),
        Verb::Assemble(verb) => verb.run(&session),
        Verb::Verify(verb) => verb.run(&session),
        Verb::Sign(verb) => verb.run(&session),
        Verb::Keygen(verb) => verb.run(&session),
    }
}
