//! A cache of finished answers by key. When the cache is full, the least recently used answers are dropped.
//!
//! All bodies and keys together never take more bytes than the bound.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use super::answer::StoredAnswer;

/// Bytes that an entry takes beside its body and key: three map nodes and the headers of their strings.
const OVERHEAD: usize = 300;

/// A bounded map that all threads share.
#[derive(Debug)]
pub(super) struct Cache {
    most_bytes: usize,
    inner: Mutex<Inner>,
}

#[derive(Debug, Default)]
struct Inner {
    entries: HashMap<Arc<str>, (u64, Arc<StoredAnswer>)>,
    /// Keys by the clock of their last use.
    order: BTreeMap<u64, Arc<str>>,
    clock: u64,
    bytes: usize,
}

impl Cache {
    pub(super) fn new(most_bytes: usize) -> Self {
        Self { most_bytes, inner: Mutex::default() }
    }

    pub(super) fn get(&self, key: &str) -> Option<Arc<StoredAnswer>> {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        inner.clock += 1;
        let now = inner.clock;
        let (used, stored) = inner.entries.get_mut(key)?;
        let before = std::mem::replace(used, now);
        let stored = Arc::clone(stored);
        if let Some(key) = inner.order.remove(&before) {
            inner.order.insert(now, key);
        }
        Some(stored)
    }

    /// Adds an answer. An answer of more than an eighth of the bound is not kept.
    pub(super) fn put(&self, key: &str, stored: Arc<StoredAnswer>) {
        let size = size(key, &stored);
        if size > self.most_bytes / 8 {
            return;
        }
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        inner.remove(key);
        inner.clock += 1;
        let (now, key) = (inner.clock, Arc::<str>::from(key));
        inner.bytes += size;
        inner.order.insert(now, Arc::clone(&key));
        inner.entries.insert(key, (now, stored));
        while inner.bytes > self.most_bytes {
            let Some((_, oldest)) = inner.order.first_key_value().map(|(when, key)| (*when, Arc::clone(key))) else {
                break;
            };
            inner.remove(&oldest);
        }
    }

    #[cfg(test)]
    fn bytes(&self) -> usize {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner).bytes
    }
}

impl Inner {
    fn remove(&mut self, key: &str) {
        if let Some((key, (used, stored))) = self.entries.remove_entry(key) {
            self.order.remove(&used);
            self.bytes -= size(&key, &stored);
        }
    }
}

fn size(key: &str, stored: &StoredAnswer) -> usize {
    stored.len() + key.len() + OVERHEAD
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn stored(bytes: usize) -> Arc<StoredAnswer> {
        // Noise (splitmix64), which does not compress.
        let noise = |i: usize| {
            let x = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            ((x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb) >> 56) as u8
        };
        Arc::new(StoredAnswer::new("text/plain", (0..bytes).map(noise).collect()))
    }

    #[test]
    fn the_least_recently_used_goes_first() {
        let cache = Cache::new(10 * (OVERHEAD + 101));
        for i in 0..10 {
            cache.put(&i.to_string(), stored(100));
        }
        assert!(cache.get("0").is_some());
        cache.put("x", stored(100));
        assert!(cache.get("1").is_none(), "1 was used longest ago");
        assert!(cache.get("0").is_some() && cache.get("2").is_some() && cache.get("x").is_some());
    }

    #[test]
    fn the_bound_holds_whatever_is_put_in() {
        let cache = Cache::new(20_000);
        for i in 0..2000_usize {
            cache.put(&(i * 7919 % 90).to_string(), stored(i * 31 % 4000));
            assert!(cache.bytes() <= 20_000);
        }
        cache.put("great", stored(30_000));
        assert!(cache.get("great").is_none());
    }

    #[test]
    fn the_same_key_counts_once() {
        let cache = Cache::new(100_000);
        for _ in 0..50 {
            cache.put("a", stored(1000));
        }
        assert_eq!(cache.bytes(), size("a", &stored(1000)));
    }
}
