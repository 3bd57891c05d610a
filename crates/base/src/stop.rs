//! Work that may be told to stop: it asks now and then, and whoever started it says so from another thread.
//!
//! Promises nothing about how soon: each kind of work says where it asks. What has been stopped has no result, and what
//! has not been stopped has the result that it would have without asking. No clock: who has one tells.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Whether work is to stop; copies speak of the same work. [`Stop::default`]: never, unless a copy is told. Once told it
/// stays so.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<State>);

#[derive(Debug, Default)]
struct State {
    told: AtomicBool,
    /// How often it may still be asked.
    left: Option<AtomicUsize>,
}

/// Work that has been stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped before it was done")]
pub struct Stopped;

impl Stop {
    /// For work that nobody cancels.
    #[must_use]
    pub fn never() -> Self {
        Self::default()
    }

    /// Tells itself once it has been asked so often: a bound on work that does not depend on the machine.
    #[must_use]
    pub fn after(questions: usize) -> Self {
        Self(Arc::new(State { told: AtomicBool::new(false), left: Some(AtomicUsize::new(questions)) }))
    }

    /// Tells the work to stop.
    pub fn tell(&self) {
        self.0.told.store(true, Ordering::Relaxed);
    }

    /// Whether it has been told.
    #[must_use]
    pub fn told(&self) -> bool {
        let less = |left: usize| left.checked_sub(1);
        let used_up = |left: &AtomicUsize| left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_err();
        self.0.told.load(Ordering::Relaxed) || self.0.left.as_ref().is_some_and(used_up)
    }

    /// For `?`.
    ///
    /// # Errors
    /// It has been told to stop.
    pub fn check(&self) -> Result<(), Stopped> {
        if self.told() { Err(Stopped) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_speak_of_the_same_work_and_what_was_told_stays_told() {
        let (never, stop) = (Stop::default(), Stop::default());
        let copy = stop.clone();
        assert_eq!((stop.check(), copy.told()), (Ok(()), false));
        copy.tell();
        assert_eq!((stop.check(), copy.check(), never.check()), (Err(Stopped), Err(Stopped), Ok(())));
        let some = Stop::after(2);
        let copy = some.clone();
        assert_eq!([some.told(), copy.told(), some.told(), copy.told(), some.told()], [false, false, true, true, true]);
        let told = Stop::after(9);
        told.tell();
        assert!(told.told());
    }
}
