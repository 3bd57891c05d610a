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
