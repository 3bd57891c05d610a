//! Calls of libraries that panic on some damaged files, where an error would do.
//!
//! A caught panic leaves no trace: the user reads the error that is made of it, and no report of a panic before it. Panics of everything else
//! are reported as before.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    /// Whether panics of this thread are caught, and made an error of.
    static CAUGHT: Cell<bool> = const { Cell::new(false) };
}

static HOOK: Once = Once::new();

/// What the call returns, or `None` if it panics. What it worked on must not be used again then.
pub fn caught<T>(call: impl FnOnce() -> T) -> Option<T> {
    HOOK.call_once(|| {
        let report = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if !CAUGHT.get() {
                report(panic);
            }
        }));
    });
    let before = CAUGHT.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(call)).ok();
    CAUGHT.set(before);
    result
}

#[cfg(test)]
#[allow(clippy::panic)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    static REPORTED: AtomicU32 = AtomicU32::new(0);

    #[test]
    fn a_caught_panic_is_not_reported_and_others_are() {
        panic::set_hook(Box::new(|_| _ = REPORTED.fetch_add(1, Ordering::Relaxed)));
        assert_eq!(caught(|| 1), Some(1));
        assert_eq!(caught(|| caught(|| panic!("inside")).unwrap_or(2) + 1), Some(3));
        assert_eq!(caught(|| -> u32 { panic!("outside") }), None);
        assert_eq!(REPORTED.load(Ordering::Relaxed), 0);
        assert!(panic::catch_unwind(|| panic!("another")).is_err());
        assert_eq!(REPORTED.load(Ordering::Relaxed), 1);
    }
}
