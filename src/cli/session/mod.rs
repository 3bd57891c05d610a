//! What every verb has: the output for people, the clock, requests to stop.

mod clock;
pub(crate) mod logger;
pub(crate) mod progress;
pub(crate) mod stage;
pub(crate) mod stop;

use std::time::Duration;

use netcert::watch::{self, Patience};

use super::Cli;
use clock::Clock;
use progress::Progress;

/// The output for people and the clock, which every verb uses.
pub(crate) struct Session {
    pub(crate) progress: Progress,
    pub(crate) clock: Clock,
}

impl Session {
    /// Sets the number of threads and the patience, listens for requests to stop, and reads `SOURCE_DATE_EPOCH`.
    pub(crate) fn begin(cli: &Cli) -> anyhow::Result<Self> {
        if let Some(then) = cli.verb.when_stopped() {
            stop::say_when_stopped(then);
        }
        let usual = cli.verb.patience();
        let patience = cli.patience.map(Duration::from_secs).map(|end_after| Patience { end_after, ..usual });
        watch::set_patience(patience.unwrap_or(usual));
        if let Some(threads) = cli.threads {
            rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global()?;
        }
        Ok(Self { progress: Progress::new(cli.quiet), clock: Clock::from_environment()? })
    }
}
