//! Disjoint sets of keys that are united one pair at a time (union-find).

use std::collections::BTreeMap;

/// Disjoint sets of keys. Every key is a set of its own until it is united with another, so keys need not be added first.
///
/// Paths are compressed: `n` operations take O(n log² n) time.
#[derive(Clone, Debug)]
pub struct DisjointSets<K> {
    /// The next key on the way to the representative; representatives have none.
    parents: BTreeMap<K, K>,
}

impl<K> Default for DisjointSets<K> {
    fn default() -> Self {
        Self { parents: BTreeMap::new() }
    }
}

impl<K: Copy + Ord> DisjointSets<K> {
    /// Every key in a set of its own.
    pub fn new() -> Self {
        Self::default()
    }

    /// The key that represents the set of `key`: the same for all keys of a set, until the set is united with another.
    pub fn find(&mut self, key: K) -> K {
        let mut root = key;
        while let Some(&parent) = self.parents.get(&root) {
            root = parent;
        }
        let mut at = key;
        while at != root {
            // Every key on the way points at the representative from now on.
            at = self.parents.insert(at, root).unwrap_or(root);
        }
        root
    }

    /// Unites the sets of two keys; the representative of `b` then represents both. Returns whether the sets were different.
    pub fn union(&mut self, a: K, b: K) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a != b {
            self.parents.insert(a, b);
        }
        a != b
    }

    /// Whether two keys are in one set.
    pub fn same(&mut self, a: K, b: K) -> bool {
        self.find(a) == self.find(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;

    #[test]
    fn keys_are_in_one_set_if_a_chain_of_unions_joins_them() {
        let mut stream = Seed(3).stream("disjoint sets test", &[]);
        let mut sets = DisjointSets::new();
        // The set of each key, kept by brute force.
        let mut label: Vec<usize> = (0..200).collect();
        for _ in 0..150 {
            let (a, b) = (stream.index(200), stream.index(200));
            let (from, to) = (label[a], label[b]);
            assert_eq!(sets.union(a, b), from != to);
            label.iter_mut().filter(|l| **l == from).for_each(|l| *l = to);
        }
        for a in 0..200 {
            assert!(label[a] == label[sets.find(a)]);
            assert!((0..200).all(|b| sets.same(a, b) == (label[a] == label[b])));
        }
    }

    #[test]
    fn a_key_without_a_union_represents_itself() {
        let mut sets = DisjointSets::new();
        assert!(sets.union('a', 'b') && !sets.union('b', 'a'));
        assert_eq!((sets.find('a'), sets.find('b'), sets.find('c')), ('b', 'b', 'c'));
    }
}
