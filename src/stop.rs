//! Work that may be told to stop: it asks now and then, and whoever started it says so from another thread.
//!
//! Promises nothing about how soon: each kind of work says where it asks. What has been stopped has no result.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether work is to stop; copies speak of the same work. [`Stop::default`]: never, unless a copy is told.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

/// Work that has been stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped before it was done")]
pub struct Stopped;

impl Stop {
    /// Tells the work to stop.
    pub fn tell(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it has been told.
    #[must_use]
    pub fn told(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// For `?`.
    ///
    /// # Errors
    /// It has been told to stop.
    pub fn check(&self) -> Result<(), Stopped> {
        if self.told() { Err(Stopped) } else { Ok(()) }
    }
}
