//! The last few results of long work of one kind, so that two questions about one thing (its words, its picture) cost
//! one.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Keeps the `most` last ones.
pub(super) struct Recent<T> {
    most: usize,
    kept: Mutex<VecDeque<(String, Arc<T>)>>,
}

impl<T> Recent<T> {
    pub(super) fn new(most: usize) -> Self {
        Self { most, kept: Mutex::default() }
    }

    /// The one of this key, else it is made. Made outside the lock: two may make the same at a time, both the same
    /// thing.
    pub(super) fn get<E>(&self, key: &str, make: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let known =
            |kept: &VecDeque<(String, Arc<T>)>| kept.iter().find(|one| one.0 == key).map(|one| Arc::clone(&one.1));
        if let Some(found) = known(&self.kept.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(found);
        }
        let made = Arc::new(make()?);
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if known(&kept).is_none() {
            kept.truncate(self.most.saturating_sub(1));
            kept.push_front((key.to_owned(), Arc::clone(&made)));
        }
        Ok(made)
    }

    /// Takes it out.
    pub(super) fn forget(&self, key: &str) {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).retain(|one| one.0 != key);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

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
}
