//! What is known about a tile.

use crate::mesh::HorizonTile;
use crate::plugin::streaming::build::FinishedTile;
use crate::plugin::streaming::job::{Job, Stopping};
use bevy::prelude::Entity;

/// A tile that is wanted or made.
#[derive(Default)]
pub(in crate::plugin::streaming) struct TileEntry {
    /// Whether the tile is wanted now.
    pub wanted: bool,
    /// Whether the tile is shown, pieces in the place of loaded chunks aside.
    pub shown: bool,
    /// What has been made of the tile.
    pub pieces: Option<Vec<Piece>>,
    /// Whether the pieces come from an older world.
    pub stale: bool,
    /// Whether the last attempt failed. The tile is not tried again in the same world.
    pub failed: bool,
    pub job: Option<Job<FinishedTile>>,
    /// A result that waits to be applied.
    pub finished: Option<FinishedTile>,
    /// Tiles are made in the order of this number, the lowest first, together with chunks.
    pub priority: f64,
}

/// A part of a tile that is shown and hidden alone: a root entity with its meshes as children.
#[derive(Clone, Copy)]
pub(in crate::plugin::streaming) struct Piece {
    pub tile: HorizonTile,
    pub entity: Entity,
    pub visible: bool,
}

impl TileEntry {
    /// Whether the tile can be shown. One that cannot be made counts: others do not wait for it.
    pub fn is_ready(&self) -> bool {
        self.pieces.is_some() || self.failed
    }

    /// Whether a task should be started for the tile.
    pub fn needs_work(&self) -> bool {
        let idle = self.job.is_none() && self.finished.is_none() && !self.failed;
        idle && self.wanted && (self.stale || self.pieces.is_none())
    }

    /// Cancels the task, if there is one, and drops a result that has not been applied.
    pub fn cancel(&mut self) -> Option<Stopping> {
        self.finished = None;
        self.job.take().map(Job::stop)
    }
}
