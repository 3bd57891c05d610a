//! The progress of one portion as a share of the progress of all.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::reporter::Reporter;

/// Reports a stage of one portion as a part of the stage of all portions, which has begun already.
pub(super) struct Share<'r> {
    reporter: &'r dyn Reporter,
    /// Items of the portions before, and of this one.
    before: u64,
    own: u64,
    /// Items that this portion counts by.
    total: AtomicU64,
}

impl<'r> Share<'r> {
    pub(super) fn new(reporter: &'r dyn Reporter, before: u64, own: u64) -> Self {
        Self { reporter, before, own, total: AtomicU64::new(0) }
    }
}

impl Reporter for Share<'_> {
    fn begin(&self, _: &'static str, total: u64) {
        self.total.store(total, Ordering::Relaxed);
    }

    fn advance(&self, done: u64) {
        let total = self.total.load(Ordering::Relaxed).max(1);
        let own = u128::from(self.own) * u128::from(done.min(total)) / u128::from(total);
        self.reporter.advance(self.before + own as u64);
    }

    fn end(&self) {}

    fn note(&self, text: &str) {
        self.reporter.note(text);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// What it hears; a stage that begins or ends as a number that no progress is.
    struct Heard(Mutex<Vec<u64>>);

    impl Reporter for Heard {
        fn begin(&self, _: &'static str, _: u64) {
            self.advance(u64::MAX);
        }
        fn advance(&self, done: u64) {
            self.0.lock().unwrap().push(done);
        }
        fn end(&self) {
            self.advance(u64::MAX);
        }
        fn note(&self, _: &str) {}
    }

    #[test]
    fn portions_add_up_to_the_whole() {
        let heard = Heard(Mutex::new(Vec::new()));
        for (before, own, total) in [(0, 100, 10), (100, 50, 200), (150, 7, 0)] {
            let share = Share::new(&heard, before, own);
            share.begin("turns", total);
            share.advance(total / 2);
            share.advance(total);
            share.end();
        }
        assert_eq!(*heard.0.lock().unwrap(), [50, 100, 125, 150, 150, 150]);
    }
}
