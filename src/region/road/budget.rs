//! How the caches of roads share their memory.

use crate::layer::{LayerCache, Weigh};
use std::hash::Hash;

/// Number of parts that all caches of roads take together.
const PARTS: usize = 39;

/// The memory for all caches of roads.
#[derive(Clone, Copy)]
pub(super) struct Budget {
    part: usize,
}

impl Budget {
    pub fn new(bytes: usize) -> Self {
        Self { part: bytes / PARTS }
    }

    /// An empty cache that takes some parts of the memory.
    pub fn cache<K: Clone + Eq + Hash, V: Weigh>(self, parts: usize) -> LayerCache<K, V> {
        LayerCache::new(self.part * parts)
    }
}
