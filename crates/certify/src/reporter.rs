//! Reports the progress of a run to the caller.

/// Receives the progress of a run. Methods are called from many threads.
pub trait Reporter: Sync {
    /// A stage begins. `total` is its number of items (bytes when reading, edges when certifying), or 0 if unknown.
    fn begin(&self, stage: &'static str, total: u64);
    /// `done` items of the stage are done.
    fn advance(&self, done: u64);
    /// The stage has ended.
    fn end(&self);
    /// A remark for people.
    fn note(&self, text: &str);
}

/// A reporter that ignores all reports.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Reporter for Silent {
    fn begin(&self, _: &'static str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn end(&self) {}
    fn note(&self, _: &str) {}
}
