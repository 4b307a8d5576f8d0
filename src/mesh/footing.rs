//! The ground that buildings and piers stand on.

use crate::chunk::Chunk;
use crate::terrain::{DrawnGround, Terrain};
use glam::DVec2;

/// The ground in and around a chunk.
pub(super) struct Footing<'a> {
    chunk: &'a Chunk,
    around: DrawnGround<'a>,
}

impl<'a> Footing<'a> {
    pub fn new(chunk: &'a Chunk, terrain: &'a dyn Terrain) -> Self {
        Self { chunk, around: DrawnGround::new(terrain) }
    }

    /// Height at a local point, in metres: of the surface in the chunk's square, of the natural ground outside.
    pub fn height(&mut self, p: DVec2) -> f64 {
        match self.chunk.tin.at(p) {
            Some(point) => point.height,
            None => self.around.height(self.chunk.origin.to_plan(p)),
        }
    }
}
