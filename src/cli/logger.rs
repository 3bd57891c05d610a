//! Where the lines go that the library logs: to standard error, each as it is.

use log::{LevelFilter, Log, Metadata, Record};

use super::output::tell;

struct Lines;

impl Log for Lines {
    /// The library's own lines alone. Other crates log, too, and nobody asked for that.
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

/// From now on, lines are printed.
pub(super) fn install() {
    // It fails where a logger is there already, and then lines go to that one.
    if log::set_logger(&Lines).is_ok() {
        log::set_max_level(LevelFilter::Info);
    }
}
