//! The chunks that have an entity.

use super::entry::ChunkEntry;
use crate::chunk::Chunk;
use crate::region::Settlement;
use crate::space::{Bounds, ChunkCoord};
use bevy::prelude::{Entity, Resource};
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The chunks that have an entity.
#[derive(Resource, Default)]
pub(in crate::plugin) struct ChunkIndex {
    /// Edge of a chunk in metres; 0 until there is a world.
    pub size: i64,
    pub(super) entries: BTreeMap<ChunkCoord, ChunkEntry>,
    /// Loaded chunks of another chunk size, which wait to be removed.
    pub(super) retired: Vec<Unloading>,
    /// Entities of chunks that were never loaded and are no longer wanted. They are despawned at once.
    pub(super) abandoned: Vec<Entity>,
}

/// A loaded chunk that is to be removed.
pub(super) struct Unloading {
    pub coord: ChunkCoord,
    pub entity: Entity,
    pub chunk: Arc<Chunk>,
}

impl ChunkIndex {
    /// The entity of a chunk.
    pub fn entity(&self, coord: ChunkCoord) -> Option<Entity> {
        self.entries.get(&coord).map(|e| e.entity)
    }

    /// The settlements that each loaded chunk shows.
    pub fn settlements(&self) -> Vec<(ChunkCoord, Vec<Arc<Settlement>>)> {
        let shown = self.entries.iter().filter_map(|(coord, entry)| Some((*coord, entry.shown.as_ref()?)));
        shown.map(|(coord, shown)| (coord, shown.chunk.settlements.clone())).collect()
    }

    /// The loaded chunks within `reach` metres of a plan point.
    pub fn loaded_near(&self, p: DVec2, reach: f64) -> impl Iterator<Item = &Arc<Chunk>> {
        let near = Bounds::square(p, 2.0 * reach);
        let loaded = self.entries.iter().filter(move |(coord, _)| coord.bounds(self.size).overlaps(near));
        loaded.filter_map(|(_, entry)| Some(&entry.shown.as_ref()?.chunk))
    }

    /// The settlement whose outline holds a plan point, if the chunk there is loaded.
    pub fn settlement_at(&self, p: DVec2) -> Option<&Arc<Settlement>> {
        let shown = self.entries.get(&ChunkCoord::containing(p, self.size.max(1)))?.shown.as_ref()?;
        let mut settlements = shown.chunk.settlements.iter().zip(&shown.outlines);
        settlements.find(|(_, outline)| outline.contains(p)).map(|(settlement, _)| settlement)
    }

    /// All loaded chunks.
    pub fn loaded_chunks(&self) -> impl Iterator<Item = &Arc<Chunk>> {
        self.entries.values().filter_map(|entry| Some(&entry.shown.as_ref()?.chunk))
    }

    /// The number of loaded chunks.
    pub fn loaded(&self) -> usize {
        self.entries.values().filter(|e| e.shown.is_some()).count()
    }

    /// Whether a chunk is loaded.
    pub(super) fn is_loaded(&self, coord: ChunkCoord) -> bool {
        self.entries.get(&coord).is_some_and(|entry| entry.shown.is_some())
    }

    /// The number of chunks that are wanted and have never been loaded.
    pub fn missing(&self) -> usize {
        self.entries.values().filter(|e| e.shown.is_none() && !e.leaving && !e.failed).count()
    }

    /// The number of chunks that are being made.
    pub fn building(&self) -> usize {
        self.entries.values().filter(|e| e.job.is_some()).count()
    }

    /// Takes out one loaded chunk that is not wanted and `may` go.
    pub(super) fn next_to_unload(&mut self, may: impl Fn(ChunkCoord) -> bool) -> Option<Unloading> {
        let mut leaving = self.entries.iter().filter(|(_, e)| e.leaving && e.shown.is_some()).map(|(coord, _)| *coord);
        let Some(coord) = leaving.find(|coord| may(*coord)) else { return self.retired.pop() };
        let ChunkEntry { entity, shown, .. } = self.entries.remove(&coord)?;
        Some(Unloading { coord, entity, chunk: shown?.chunk })
    }
}
