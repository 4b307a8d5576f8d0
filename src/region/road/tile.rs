//! Tiles of the graph of roads.

use super::lattice::node_at;
use crate::space::Bounds;
use glam::I64Vec2;

/// Edge length of a tile, in steps of the lattice.
pub(super) const TILE_STEPS: i64 = 8;

/// Box of a tile in plan metres.
pub(super) fn tile_bounds(tile: I64Vec2, step: i64) -> Bounds {
    let min = node_at(tile * TILE_STEPS, step);
    Bounds::new(min, min + (TILE_STEPS * step) as f64)
}

/// Number of rings of tiles around a tile that cover everything within `distance` metres of it.
pub(super) fn rings(distance: f64, step: i64) -> i64 {
    (distance / (TILE_STEPS * step) as f64).ceil() as i64
}

/// The tiles up to `ring` columns and rows from one, row by row.
pub(super) fn tiles_around(tile: I64Vec2, ring: i64) -> impl Iterator<Item = I64Vec2> {
    (-ring..=ring).flat_map(move |y| (-ring..=ring).map(move |x| tile + I64Vec2::new(x, y)))
}

/// The tiles that overlap a box (plan metres), row by row.
pub(super) fn tiles_in(bounds: Bounds, step: i64) -> impl Iterator<Item = I64Vec2> {
    let size = (TILE_STEPS * step) as f64;
    let (min, max) = ((bounds.min / size).floor().as_i64vec2(), (bounds.max / size).floor().as_i64vec2());
    (min.y..=max.y).flat_map(move |y| (min.x..=max.x).map(move |x| I64Vec2::new(x, y)))
}
