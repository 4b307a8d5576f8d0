//! One bounded cache per layer.

use crate::layer::LayerError;
use quick_cache::Weighter;
use quick_cache::sync::Cache;
use std::hash::Hash;
use std::sync::Arc;

/// Bytes that a cached value keeps alive.
pub trait Weigh {
    /// Approximate size in bytes, heap included.
    fn bytes(&self) -> usize;
}

#[derive(Clone, Debug)]
struct ByBytes;

impl<K, V: Weigh> Weighter<K, Arc<V>> for ByBytes {
    fn weight(&self, _: &K, value: &Arc<V>) -> u64 {
        (value.bytes() + size_of::<K>() + 64) as u64
    }
}

/// Values of a layer by key, within a limit of bytes. A value is made once even when two tasks ask for it together: the second
/// task waits for the first. When the first is cancelled or fails, the second makes the value itself.
pub struct LayerCache<K, V: Weigh> {
    cache: Cache<K, Arc<V>, ByBytes>,
}

impl<K: Clone + Eq + Hash, V: Weigh> LayerCache<K, V> {
    /// A cache that holds at most about `bytes` bytes.
    pub fn new(bytes: usize) -> Self {
        // One shard only: a value larger than a shard's share would never be held.
        let options = quick_cache::OptionsBuilder::new()
            .estimated_items_capacity(1024)
            .weight_capacity(bytes as u64)
            .shards(1)
            .build()
            .expect("capacities are set");
        Self { cache: Cache::with_options(options, ByBytes, Default::default(), Default::default()) }
    }

    /// The value of `key`, made by `make` if it is not there.
    pub fn get(&self, key: &K, make: impl FnOnce() -> Result<V, LayerError>) -> Result<Arc<V>, LayerError> {
        self.get_shared(key, || make().map(Arc::new))
    }

    /// Like [`get`](Self::get), for a value that is shared with something else.
    pub fn get_shared(&self, key: &K, make: impl FnOnce() -> Result<Arc<V>, LayerError>) -> Result<Arc<V>, LayerError> {
        self.cache.get_or_insert_with(key, make)
    }

    /// The value of `key` if it is held.
    pub fn peek(&self, key: &K) -> Option<Arc<V>> {
        self.cache.get(key)
    }

    /// Forgets everything.
    pub fn clear(&self) {
        self.cache.clear();
    }

    /// Bytes held now.
    pub fn bytes(&self) -> u64 {
        self.cache.weight()
    }
}

impl<K, V: Weigh> std::fmt::Debug for LayerCache<K, V> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("LayerCache")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    struct Block;

    impl Weigh for Block {
        fn bytes(&self) -> usize {
            1000
        }
    }

    #[test]
    fn stays_within_its_bytes_and_makes_each_value_once() {
        let cache = LayerCache::<u32, Block>::new(20_000);
        let made = AtomicUsize::new(0);
        std::thread::scope(|s| {
            for _ in 0..4 {
                s.spawn(|| {
                    for key in 0..10 {
                        cache
                            .get(&key, || {
                                made.fetch_add(1, Ordering::Relaxed);
                                std::thread::sleep(std::time::Duration::from_millis(2));
                                Ok(Block)
                            })
                            .unwrap();
                    }
                });
            }
        });
        assert_eq!(made.load(Ordering::Relaxed), 10);
        for key in 0..1000 {
            cache.get(&key, || Ok(Block)).unwrap();
        }
        assert!(cache.bytes() <= 20_000, "{}", cache.bytes());
    }

    #[test]
    fn a_failure_is_not_kept() {
        let cache = LayerCache::<u32, Block>::new(20_000);
        assert!(cache.get(&1, || Err(LayerError::Cancelled)).is_err());
        assert!(cache.get(&1, || Ok(Block)).is_ok());
    }
}
