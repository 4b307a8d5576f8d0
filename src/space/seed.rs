//! The world seed, and random streams derived from (seed, layer, key of the thing being made).

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::{xxh3_64, xxh3_128};

/// Hash of words, the same on every platform and in every version.
pub fn stable_hash(words: &[u64]) -> u64 {
    let mut few = [0; 8 * FEW];
    if words.len() > FEW {
        return xxh3_64(&bytes(words));
    }
    for (bytes, word) in few.chunks_exact_mut(8).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    xxh3_64(&few[..8 * words.len()])
}

/// Number of words that are hashed without an allocation.
const FEW: usize = 8;

fn bytes(words: &[u64]) -> Vec<u8> {
    words.iter().flat_map(|w| w.to_le_bytes()).collect()
}

/// The seed of a world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Seed(pub u64);

impl Seed {
    /// The random stream for the thing that `key` names in `layer`. The same arguments give the same stream.
    pub fn stream(self, layer: &str, key: &[u64]) -> Stream {
        let mut data = bytes(&[self.0]);
        data.extend(layer.as_bytes());
        data.push(0);
        data.extend(bytes(key));
        let first = xxh3_128(&data);
        data.push(1);
        let second = xxh3_128(&data);
        let mut state = [0; 32];
        state[..16].copy_from_slice(&first.to_le_bytes());
        state[16..].copy_from_slice(&second.to_le_bytes());
        Stream(ChaCha8Rng::from_seed(state))
    }
}

/// A stream of random numbers (ChaCha8). [`Seed::stream`] makes a stream for each generated thing.
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in `low..high`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in -1..1.
    pub fn signed(&mut self) -> f64 {
        self.range(-1.0, 1.0)
    }

    /// Uniform in `0..n`; 0 when `n` is 0.
    pub fn index(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// True with probability `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    /// An index drawn in proportion to `weights` (each finite and at least 0); `None` when their sum is 0.
    pub fn weighted(&mut self, weights: &[f64]) -> Option<usize> {
        let sum: f64 = weights.iter().sum();
        let mut left = self.unit() * sum;
        let last = weights.iter().rposition(|w| *w > 0.0)?;
        for (i, w) in weights.iter().enumerate() {
            left -= w;
            if left < 0.0 {
                return Some(i);
            }
        }
        Some(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_by_seed_layer_and_key_and_never_change() {
        let first = |seed, layer, key: &[u64]| Seed(seed).stream(layer, key).bits();
        let a = first(1, "town", &[2, 3]);
        assert_eq!(a, first(1, "town", &[2, 3]));
        assert!(
            [first(2, "town", &[2, 3]), first(1, "seam", &[2, 3]), first(1, "town", &[3, 2])].iter().all(|b| *b != a)
        );
        // A change of this value would change every world whose seed anybody has saved.
        assert_eq!(stable_hash(&[1, 2, 3]), 8_964_613_590_703_056_768);
    }

    #[test]
    fn weighted_draws_follow_the_weights() {
        let mut s = Seed(7).stream("test", &[]);
        let mut counts = [0; 3];
        for _ in 0..3000 {
            counts[s.weighted(&[1.0, 0.0, 2.0]).unwrap()] += 1;
        }
        assert!(counts[1] == 0 && (850..1150).contains(&counts[0]), "{counts:?}");
        assert_eq!(s.weighted(&[0.0, 0.0]), None);
    }
}
