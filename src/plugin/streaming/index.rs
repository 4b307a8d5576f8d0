//! The chunks that have an entity.

use super::entry::ChunkEntry;
use crate::region::Settlement;
use crate::space::ChunkCoord;
use bevy::prelude::{Entity, Resource};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The chunks that have an entity.
#[derive(Resource, Default)]
pub(in crate::plugin) struct ChunkIndex {
    /// Edge of a chunk in metres; 0 until there is a world.
    pub size: i64,
    pub(super) entries: BTreeMap<ChunkCoord, ChunkEntry>,
    /// Entities of chunks of another chunk size, which wait to be removed.
    pub(super) retired: Vec<(ChunkCoord, Entity)>,
}

impl ChunkIndex {
    /// The entity of a chunk.
    pub fn entity(&self, coord: ChunkCoord) -> Option<Entity> {
        self.entries.get(&coord).map(|e| e.entity)
    }

    /// The settlements that each loaded chunk shows.
    pub fn settlements(&self) -> Vec<(ChunkCoord, Vec<Arc<Settlement>>)> {
        let shown = self.entries.iter().filter_map(|(coord, entry)| Some((*coord, entry.shown.as_ref()?)));
        shown.map(|(coord, shown)| (coord, shown.settlements.clone())).collect()
    }

    /// The number of loaded chunks.
    pub fn loaded(&self) -> usize {
        self.entries.values().filter(|e| e.shown.is_some()).count()
    }

    /// The number of chunks that are wanted and have never been loaded.
    pub fn missing(&self) -> usize {
        self.entries.values().filter(|e| e.shown.is_none() && !e.leaving && !e.failed).count()
    }

    /// The number of chunks that are being made.
    pub fn building(&self) -> usize {
        self.entries.values().filter(|e| e.job.is_some()).count()
    }

    /// Takes out one chunk that is not wanted.
    pub(super) fn next_to_remove(&mut self) -> Option<(ChunkCoord, Entity)> {
        let leaving = self.entries.iter().find(|(_, e)| e.leaving).map(|(coord, _)| *coord);
        match leaving {
            Some(coord) => self.entries.remove(&coord).map(|entry| (coord, entry.entity)),
            None => self.retired.pop(),
        }
    }
}
