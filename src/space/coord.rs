//! Coordinates: integer origins, quantized local positions, chunks.

use crate::space::Bounds;
use glam::{DVec2, I64Vec2, IVec2};
use serde::{Deserialize, Serialize};

/// Spacing of the grid to which published positions are rounded: 2^-10 m. An `f64` holds sums of such numbers and whole metres
/// exactly up to 4e12 m from the world's origin, so a position can move between local frames without rounding.
pub const QUANTUM: f64 = 1.0 / 1024.0;

/// Default edge length of a chunk, in metres.
pub const CHUNK_SIZE: i64 = 512;

/// Rounds a local position to the [`QUANTUM`] grid.
pub fn quantize(p: DVec2) -> DVec2 {
    (p / QUANTUM).round() * QUANTUM
}

/// Words that name a local position, for ids and random streams: the indices of the nearest point of the [`QUANTUM`] grid.
pub fn quantum_key(p: DVec2) -> [u64; 2] {
    (p / QUANTUM).round().as_i64vec2().to_array().map(|index| index as u64)
}

/// The whole-metre plan point that local positions are relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Origin(pub I64Vec2);

impl Origin {
    /// The origin at `p` (plan metres), both coordinates rounded down to whole metres.
    pub fn at(p: DVec2) -> Self {
        Self(p.floor().as_i64vec2())
    }

    /// This origin in plan metres.
    pub fn plan(self) -> DVec2 {
        self.0.as_dvec2()
    }

    /// The plan position of a local one, both in metres.
    pub fn to_plan(self, local: DVec2) -> DVec2 {
        self.plan() + local
    }

    /// The local position of a plan one, both in metres.
    pub fn to_local(self, plan: DVec2) -> DVec2 {
        plan - self.plan()
    }

    /// The offset in metres that turns a position local to `self` into one local to `other`. Exact.
    pub fn offset_to(self, other: Origin) -> DVec2 {
        (self.0 - other.0).as_dvec2()
    }
}

/// Name of a chunk: column and row of a square of the streaming grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ChunkCoord(pub IVec2);

impl ChunkCoord {
    /// The chunk at column `x`, row `y`.
    pub const fn new(x: i32, y: i32) -> Self {
        Self(IVec2::new(x, y))
    }

    /// The chunk of edge `size` metres that holds the plan point `p`. A chunk's west and south borders belong to it.
    pub fn containing(p: DVec2, size: i64) -> Self {
        let cell = p.floor().as_i64vec2().div_euclid(I64Vec2::splat(size));
        Self(IVec2::new(cell.x as i32, cell.y as i32))
    }

    /// South-west corner of the chunk, whose edge is `size` metres.
    pub fn origin(self, size: i64) -> Origin {
        Origin(self.0.as_i64vec2() * size)
    }

    /// The square of the chunk in plan metres; its edge is `size` metres.
    pub fn bounds(self, size: i64) -> Bounds {
        let min = self.origin(size).plan();
        Bounds::new(min, min + size as f64)
    }
}

impl std::fmt::Display for ChunkCoord {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{},{}", self.0.x, self.0.y)
    }
}

impl Ord for ChunkCoord {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.to_array().cmp(&other.0.to_array())
    }
}

impl PartialOrd for ChunkCoord {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_of_negative_points_do_not_truncate() {
        assert_eq!(ChunkCoord::containing(DVec2::new(-0.5, 0.0), 512), ChunkCoord::new(-1, 0));
        assert_eq!(ChunkCoord::containing(DVec2::new(-512.0, -513.0), 512), ChunkCoord::new(-1, -2));
        assert_eq!(ChunkCoord::containing(DVec2::new(511.9, 512.0), 512), ChunkCoord::new(0, 1));
    }

    #[test]
    fn frames_far_out_lose_nothing() {
        let a = Origin(I64Vec2::new(1_000_000_000_000, -7));
        let b = Origin(I64Vec2::new(1_000_000_000_512, 1_000));
        let p = quantize(DVec2::new(12.345_678, -9.876_543));
        assert_eq!(p + a.offset_to(b) + b.offset_to(a), p);
        assert_eq!(a.to_local(a.to_plan(p)), p);
    }
}
