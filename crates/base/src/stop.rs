//! Cancellation: work polls a shared [`Stop`], and another thread sets it.
//!
//! Each kind of work documents where it polls; no latency is promised. Cancelled work has no result. Work that is not
//! cancelled has the same result as without polling. This module has no clock: a caller with a deadline calls
//! [`Stop::tell`].

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A cancellation flag. Clones share one flag. [`Stop::default`] stays unset until [`Stop::tell`] sets it, and a set
/// flag stays set.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<State>);

#[derive(Debug, Default)]
struct State {
    told: AtomicBool,
    /// How many polls are left before the flag sets itself.
    left: Option<AtomicUsize>,
}

/// The error of cancelled work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled before it finished")]
pub struct Stopped;

impl Stop {
    /// For work that nobody cancels.
    #[must_use]
    pub fn never() -> Self {
        Self::default()
    }

    /// A flag that sets itself after `questions` polls. It bounds work independently of the machine's speed.
    #[must_use]
    pub fn after(questions: usize) -> Self {
        Self(Arc::new(State { told: AtomicBool::new(false), left: Some(AtomicUsize::new(questions)) }))
    }

    /// Cancels the work.
    pub fn tell(&self) {
        self.0.told.store(true, Ordering::Relaxed);
    }

    /// Polls the flag: whether the work is cancelled.
    #[must_use]
    pub fn told(&self) -> bool {
        let less = |left: usize| left.checked_sub(1);
        let used_up = |left: &AtomicUsize| left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_err();
        self.0.told.load(Ordering::Relaxed) || self.0.left.as_ref().is_some_and(used_up)
    }

    /// Polls the flag, for use with `?`.
    ///
    /// # Errors
    /// [`Stopped`] if the work is cancelled.
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
