//! The task that makes a chunk and its meshes.

use super::generator::ChunkGenerator;
use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::Detail;
use crate::plugin::appearance::{PartMesh, part_meshes};
use crate::space::ChunkCoord;
use bevy::platform::time::Instant;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// A finished chunk that waits to be applied.
pub(super) struct FinishedChunk {
    pub chunk: Arc<Chunk>,
    pub detail: Detail,
    /// Empty where nothing could draw meshes.
    pub parts: Vec<PartMesh>,
    /// How long it took, in seconds.
    pub seconds: f64,
}

/// Why a task gave no chunk.
pub(super) enum BuildFailure {
    Cancelled,
    /// A defect of the generator, in one line.
    Defect(String),
}

pub(super) type BuildOutcome = Result<Box<FinishedChunk>, BuildFailure>;

/// What a task does.
pub(super) struct BuildOrder {
    pub generator: Arc<dyn ChunkGenerator>,
    pub coord: ChunkCoord,
    pub detail: Detail,
    pub with_meshes: bool,
    pub keep_meshes: bool,
    pub cancel: Cancel,
}

impl BuildOrder {
    pub fn run(&self) -> BuildOutcome {
        // A defect in the generator costs a chunk, not the game.
        match catch_unwind(AssertUnwindSafe(|| self.build())) {
            Ok(Ok(finished)) => Ok(Box::new(finished)),
            Ok(Err(LayerError::Cancelled)) => Err(BuildFailure::Cancelled),
            Ok(Err(error)) => Err(BuildFailure::Defect(error.to_string())),
            Err(panic) => {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
                Err(BuildFailure::Defect(format!("the generator panicked: {text}")))
            }
        }
    }

    fn build(&self) -> Result<FinishedChunk, LayerError> {
        let start = Instant::now();
        self.cancel.check()?;
        let chunk = self.generator.chunk(self.coord, &self.cancel)?;
        let mut parts = Vec::new();
        if self.with_meshes {
            self.cancel.check()?;
            parts = part_meshes(self.generator.mesh(&chunk, self.detail, &self.cancel)?, self.keep_meshes);
        }
        Ok(FinishedChunk { chunk, detail: self.detail, parts, seconds: start.elapsed().as_secs_f64() })
    }
}
