//! What is known about a chunk that has an entity.

use super::build::FinishedChunk;
use super::job::{Job, Stopping};
use crate::chunk::Chunk;
use crate::mesh::Detail;
use crate::plugin::chunk::ChunkStatus;
use crate::region::Outline;
use bevy::prelude::Entity;
use std::sync::Arc;

/// A chunk that has an entity.
pub(super) struct ChunkEntry {
    pub entity: Entity,
    /// The detail that the chunk should have.
    pub want: Detail,
    /// What the entity shows.
    pub shown: Option<ShownChunk>,
    /// Whether the shown or awaited chunk comes from an older world.
    pub stale: bool,
    /// Whether the last attempt failed. The chunk is not tried again in the same world.
    pub failed: bool,
    /// Whether the chunk is no longer wanted and waits to be removed.
    pub leaving: bool,
    pub job: Option<Job<FinishedChunk>>,
    /// A result that waits to be applied.
    pub finished: Option<FinishedChunk>,
    /// Chunks are made in the order of this number, the lowest first.
    pub priority: f64,
    /// The status that the entity has.
    pub status_set: ChunkStatus,
}

/// What the entity of a chunk shows.
pub(super) struct ShownChunk {
    pub detail: Detail,
    /// Entities of the chunk's meshes.
    pub parts: Vec<Entity>,
    pub chunk: Arc<Chunk>,
    /// The outlines of the chunk's settlements, in the same order.
    pub outlines: Vec<Arc<Outline>>,
}

impl ChunkEntry {
    pub fn new(entity: Entity, want: Detail, priority: f64) -> Self {
        Self {
            entity,
            want,
            shown: None,
            stale: false,
            failed: false,
            leaving: false,
            job: None,
            finished: None,
            priority,
            status_set: ChunkStatus::Queued,
        }
    }

    /// Whether a task should be started for the chunk.
    pub fn needs_work(&self) -> bool {
        let idle = self.job.is_none() && self.finished.is_none() && !self.leaving && !self.failed;
        idle && (self.stale || self.shown.as_ref().is_none_or(|s| s.detail != self.want))
    }

    /// The status that the entity should have.
    pub fn status(&self) -> ChunkStatus {
        match (&self.shown, self.job.is_some() || self.finished.is_some()) {
            (Some(_), true) => ChunkStatus::Refreshing,
            (Some(_), false) => ChunkStatus::Ready,
            (None, true) => ChunkStatus::Building,
            (None, false) if self.failed => ChunkStatus::Failed,
            (None, false) => ChunkStatus::Queued,
        }
    }

    /// Cancels the task, if there is one, and drops a result that has not been applied.
    pub fn cancel(&mut self) -> Option<Stopping> {
        self.finished = None;
        self.job.take().map(Job::stop)
    }
}
