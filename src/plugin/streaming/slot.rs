//! What is known about a chunk that has an entity.

use super::tasks::{Built, Outcome};
use crate::layer::Cancel;
use crate::mesh::Detail;
use crate::plugin::chunk::ChunkStatus;
use crate::region::Settlement;
use bevy::prelude::Entity;
use bevy::tasks::Task;
use std::sync::Arc;

/// A chunk that has an entity.
pub(super) struct Slot {
    pub entity: Entity,
    /// Detail that it should have.
    pub want: Detail,
    /// What there is to see.
    pub shown: Option<Shown>,
    /// Whether what is shown, or was to be shown, comes from an older world.
    pub stale: bool,
    /// Whether the last attempt failed; it is not tried again in the same world.
    pub failed: bool,
    /// No longer wanted; waits to be removed.
    pub leaving: bool,
    pub job: Option<Job>,
    /// A result that waits to be applied.
    pub built: Option<Built>,
    /// Order in which chunks are made; the lowest first.
    pub priority: f64,
    /// The status that its entity has.
    pub told: ChunkStatus,
}

pub(super) struct Shown {
    pub detail: Detail,
    /// Entities of its meshes.
    pub parts: Vec<Entity>,
    pub settlements: Vec<Arc<Settlement>>,
}

pub(super) struct Job {
    pub cancel: Cancel,
    pub task: Task<Outcome>,
}

impl Slot {
    pub fn new(entity: Entity, want: Detail, priority: f64) -> Self {
        Self {
            entity,
            want,
            shown: None,
            stale: false,
            failed: false,
            leaving: false,
            job: None,
            built: None,
            priority,
            told: ChunkStatus::Queued,
        }
    }

    /// Whether a task should be started for it.
    pub fn needs_work(&self) -> bool {
        let idle = self.job.is_none() && self.built.is_none() && !self.leaving && !self.failed;
        idle && (self.stale || self.shown.as_ref().is_none_or(|s| s.detail != self.want))
    }

    /// The status that its entity should have.
    pub fn status(&self) -> ChunkStatus {
        match (&self.shown, self.job.is_some() || self.built.is_some()) {
            (Some(_), true) => ChunkStatus::Refreshing,
            (Some(_), false) => ChunkStatus::Ready,
            (None, true) => ChunkStatus::Building,
            (None, false) if self.failed => ChunkStatus::Failed,
            (None, false) => ChunkStatus::Queued,
        }
    }

    /// Stops work on it and drops what has not been applied. The task, if any, is returned: it may still run for a
    /// moment.
    pub fn cancel(&mut self) -> Option<Task<Outcome>> {
        self.built = None;
        let job = self.job.take()?;
        job.cancel.cancel();
        Some(job.task)
    }
}
