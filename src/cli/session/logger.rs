//! Prints the lines that the library logs to standard error, unchanged.

use log::{LevelFilter, Log, Metadata, Record};

use crate::cli::output::tell;

struct Lines;

impl Log for Lines {
    /// Only netcert's own lines are printed. Other crates log details that users did not ask for.
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("netcert::")
    }

    fn log(&self, record: &Record<'_>) {
        if self.enabled(record.metadata()) {
            tell(&record.args().to_string());
        }
    }

    fn flush(&self) {}
}

/// Makes this the program's logger.
pub(crate) fn install() {
    // `set_logger` fails if a logger is installed already; lines then go to that logger.
    if log::set_logger(&Lines).is_ok() {
        log::set_max_level(LevelFilter::Info);
    }
}
