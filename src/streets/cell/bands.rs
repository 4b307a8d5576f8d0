//! An index of the obstacles that overlap a box: the cell is cut into bands from west to east and from south to north, and
//! each band knows the obstacles that reach into it.

use crate::space::Bounds;
use glam::{DVec2, UVec2};
use std::ops::RangeInclusive;

/// Width of a band, in metres.
const WIDTH: f64 = 30.0;

/// Margin around boxes, in metres; far more than rounding errors.
const MARGIN: f64 = 0.1;

/// Obstacles, by number. Each band has one bit per obstacle.
pub struct Bands {
    corner: DVec2,
    /// Number of columns and of rows.
    size: UVec2,
    /// For every 64 obstacles, one word per column.
    columns: Vec<u64>,
    /// For every 64 obstacles, one word per row.
    rows: Vec<u64>,
}

impl Bands {
    /// The bands of a cell. Obstacles outside the bounds belong to the nearest bands.
    pub fn new(bounds: Bounds) -> Self {
        let size = (bounds.size() / WIDTH).ceil().clamp(DVec2::ONE, DVec2::splat(512.0)).as_uvec2();
        Self { corner: bounds.min, size, columns: Vec::new(), rows: Vec::new() }
    }

    /// The columns and the rows that a box reaches into.
    fn extent(&self, bounds: Bounds) -> [RangeInclusive<usize>; 2] {
        let band = |p: DVec2| ((p - self.corner) * (1.0 / WIDTH)).max(DVec2::ZERO).as_uvec2().min(self.size - 1);
        let (low, high) = (band(bounds.min - MARGIN), band(bounds.max + MARGIN));
        [low.x as usize..=high.x as usize, low.y as usize..=high.y as usize]
    }

    /// Adds an obstacle with its box. An obstacle that was added before is found at its old place as well.
    pub fn put(&mut self, obstacle: usize, bounds: Bounds) {
        let [columns, rows] = self.extent(bounds);
        for (words, bands, size) in [(&mut self.columns, columns, self.size.x), (&mut self.rows, rows, self.size.y)] {
            let first = obstacle / 64 * size as usize;
            words.resize(words.len().max(first + size as usize), 0);
            words[first..][bands].iter_mut().for_each(|word| *word |= 1 << (obstacle % 64));
        }
    }

    /// The obstacles that may overlap a box, in ascending order.
    pub fn within(&self, bounds: Bounds) -> impl Iterator<Item = usize> {
        let [columns, rows] = self.extent(bounds);
        let words = self.columns.chunks_exact(self.size.x as usize).zip(self.rows.chunks_exact(self.size.y as usize));
        words.enumerate().flat_map(move |(i, (x, y))| {
            let any = |words: &[u64]| words.iter().fold(0, |all, word| all | word);
            let mut rest = any(&x[columns.clone()]) & any(&y[rows.clone()]);
            std::iter::from_fn(move || {
                let bit = rest.trailing_zeros() as usize;
                rest &= rest.wrapping_sub(1);
                (bit < 64).then_some(64 * i + bit)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::squares::tests::segments_about;
    use super::*;

    #[test]
    fn finds_what_a_full_scan_finds() {
        for seed in 0..40 {
            let (bounds, mut segment) = segments_about(seed);
            let mut bands = Bands::new(bounds);
            let mut place = || Bounds::of(<[DVec2; 2]>::from(segment()));
            let mut boxes: Vec<_> = (0..150).map(|_| place()).collect();
            boxes.iter().enumerate().for_each(|(i, b)| bands.put(i, *b));
            // Some move.
            for i in (0..150).step_by(7) {
                boxes[i] = place();
                bands.put(i, boxes[i]);
            }
            for _ in 0..100 {
                let of = place();
                let found: Vec<usize> = bands.within(of).collect();
                assert!(found.is_sorted_by(|a, b| a < b));
                let missed = boxes.iter().enumerate().find(|(i, b)| b.overlaps(of) && !found.contains(i));
                assert!(missed.is_none(), "{seed}: {missed:?} in {of:?}");
            }
        }
    }
}
