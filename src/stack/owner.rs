//! Which chunk owns a thing.

use crate::network::Street;
use crate::space::{ChunkCoord, Origin, line_length, point_at};
use glam::DVec2;

/// The chunk of edge `size` metres whose square holds the point `at`, local to `origin`.
pub fn owner_of(origin: Origin, at: DVec2, size: i64) -> ChunkCoord {
    ChunkCoord::containing(origin.to_plan(at), size)
}

/// The chunk of edge `size` metres whose square holds the midpoint of a street that is local to `origin`.
pub fn street_owner(origin: Origin, street: &Street, size: i64) -> ChunkCoord {
    owner_of(origin, point_at(&street.line, line_length(&street.line) / 2.0).0, size)
}
