//! Rectangles of lattice nodes.

use crate::space::Bounds;
use glam::I64Vec2;

/// A rectangle of lattice nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// South-west node.
    pub min: I64Vec2,
    /// Number of columns and rows.
    pub size: I64Vec2,
}

impl Window {
    /// All nodes of the lattice of spacing `step` in a box of the plan, with one more node on each side.
    pub fn around(bounds: Bounds, step: i64) -> Self {
        let s = step as f64;
        let min = (bounds.min / s).floor().as_i64vec2() - 1;
        let max = (bounds.max / s).ceil().as_i64vec2() + 1;
        Self { min, size: max - min + 1 }
    }

    pub fn contains(&self, node: I64Vec2) -> bool {
        let d = node - self.min;
        d.cmpge(I64Vec2::ZERO).all() && d.cmplt(self.size).all()
    }

    pub fn index(&self, node: I64Vec2) -> usize {
        let d = node - self.min;
        (d.y * self.size.x + d.x) as usize
    }

    pub fn node(&self, index: usize) -> I64Vec2 {
        self.min + I64Vec2::new(index as i64 % self.size.x, index as i64 / self.size.x)
    }

    /// The nodes in the order of their indices.
    pub fn nodes(self) -> impl Iterator<Item = I64Vec2> {
        let end = self.min + self.size;
        (self.min.y..end.y).flat_map(move |y| (self.min.x..end.x).map(move |x| I64Vec2::new(x, y)))
    }

    pub fn len(&self) -> usize {
        (self.size.x * self.size.y) as usize
    }
}
