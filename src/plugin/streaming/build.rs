//! The task that makes a chunk and its meshes.

use super::generator::ChunkGenerator;
use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::Detail;
use crate::plugin::appearance::{PartMesh, part_meshes};
use crate::plugin::task::{BackgroundError, without_panic};
use crate::region::Outline;
use crate::space::ChunkCoord;
use bevy::platform::time::Instant;
use std::sync::Arc;

/// A finished chunk that waits to be applied.
pub(super) struct FinishedChunk {
    pub chunk: Arc<Chunk>,
    pub detail: Detail,
    /// The outlines of the chunk's settlements, in the same order.
    pub outlines: Vec<Arc<Outline>>,
    /// Meshes; none if nothing could draw them.
    pub parts: Vec<PartMesh>,
    /// Seconds that the task took.
    pub seconds: f64,
}

pub(super) type BuildOutcome = Result<Box<FinishedChunk>, BackgroundError>;

/// The order for a task: which chunk to make, and how.
pub(super) struct BuildOrder {
    pub generator: Arc<dyn ChunkGenerator>,
    pub coord: ChunkCoord,
    pub detail: Detail,
    pub with_meshes: bool,
    pub keep_meshes: bool,
    pub texture_coordinates: bool,
    pub cancel: Cancel,
}

impl BuildOrder {
    pub fn run(&self) -> BuildOutcome {
        without_panic(|| self.build()).map(Box::new)
    }

    fn build(&self) -> Result<FinishedChunk, LayerError> {
        let start = Instant::now();
        self.cancel.check()?;
        let chunk = self.generator.chunk(self.coord, &self.cancel)?;
        let outlines = self.generator.outlines(&chunk)?;
        let mut parts = Vec::new();
        if self.with_meshes {
            self.cancel.check()?;
            let mesh = self.generator.mesh(&chunk, self.detail, &self.cancel)?;
            parts = part_meshes(mesh, self.keep_meshes, self.texture_coordinates);
        }
        Ok(FinishedChunk { chunk, detail: self.detail, outlines, parts, seconds: start.elapsed().as_secs_f64() })
    }
}
