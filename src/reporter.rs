//! How far a run has come, for whoever shows it.

/// What the caller shows while a run goes on. Called from many threads.
pub trait Reporter: Sync {
    /// A stage begins; `total` items are to be done (bytes when reading, edges when certifying).
    fn begin(&self, stage: &'static str, total: u64);
    /// So many of them are done.
    fn advance(&self, done: u64);
    /// The stage is over.
    fn end(&self);
    /// A remark for people.
    fn note(&self, text: &str);
}

/// Shows nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Reporter for Silent {
    fn begin(&self, _: &'static str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn end(&self) {}
    fn note(&self, _: &str) {}
}
