//! Values that are made on first use: [`Late`] for one value, [`Recent`] for the last few values of one kind. With them, two
//! requests that need the same value, such as the words and the picture of one explanation, make it once.
//!
//! A value is never made twice at the same time: other callers wait for it. An error is not stored.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// One value.
pub(super) struct Late<T>(Mutex<Option<T>>);

impl<T> Default for Late<T> {
    fn default() -> Self {
        Self(Mutex::new(None))
    }
}

impl<T: Clone> Late<T> {
    pub(super) fn get<E>(&self, make: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        let mut slot = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*slot {
            Some(made) => Ok(made.clone()),
            None => Ok(slot.insert(make()?).clone()),
        }
    }

    /// The value, if it is made. Never waits.
    pub(super) fn known(&self) -> Option<T> {
        self.0.try_lock().ok()?.clone()
    }
}

/// A value with its key.
type Kept<T> = (String, Arc<Late<Arc<T>>>);

/// Keeps the `most` values that were made last.
pub(super) struct Recent<T> {
    most: usize,
    kept: Mutex<VecDeque<Kept<T>>>,
}

impl<T> Recent<T> {
    pub(super) fn new(most: usize) -> Self {
        Self { most, kept: Mutex::default() }
    }

    /// The value of this key. Makes the value if it is missing; callers with other keys do not wait meanwhile.
    pub(super) fn get<E>(&self, key: &str, make: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let slot = {
            let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            match kept.iter().find(|one| one.0 == key) {
                Some(known) => Arc::clone(&known.1),
                None => {
                    let slot = Arc::<Late<Arc<T>>>::default();
                    kept.truncate(self.most.saturating_sub(1));
                    kept.push_front((key.to_owned(), Arc::clone(&slot)));
                    slot
                }
            }
        };
        let made = slot.get(|| make().map(Arc::new));
        if made.is_err() {
            self.forget(key);
        }
        made
    }

    /// Removes the value of this key.
    pub(super) fn forget(&self, key: &str) {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).retain(|one| one.0 != key);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn the_last_few_are_kept_and_a_failure_is_not() {
        let recent: Recent<u32> = Recent::new(2);
        let made = |key: &str, value: u32| *recent.get(key, || Ok::<_, ()>(value)).unwrap();
        assert_eq!([made("a", 1), made("a", 2), made("b", 3), made("c", 4), made("a", 5)], [1, 1, 3, 4, 5]);
        assert!(recent.get("d", || Err(())).is_err());
        assert_eq!(made("d", 6), 6);
        recent.forget("d");
        assert_eq!(made("d", 7), 7);
    }

    #[test]
    fn who_asks_while_it_is_made_waits_for_it() {
        let (recent, made) = (Recent::<()>::new(2), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..6 {
                scope.spawn(|| {
                    recent.get("a", || {
                        std::thread::sleep(std::time::Duration::from_millis(30));
                        made.fetch_add(1, Ordering::SeqCst);
                        Ok::<_, ()>(())
                    })
                });
            }
        });
        assert_eq!(made.load(Ordering::SeqCst), 1);
    }
}
