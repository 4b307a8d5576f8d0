//! Streaming: which chunks are wanted, the tasks that make them, and turning results into entities within a budget.

mod apply;
mod maker;
mod plan;
mod slot;
mod tasks;
#[cfg(test)]
mod tests;

pub(super) use maker::ChunkMaker;
use slot::Slot;

use super::anchor::AnchorView;
use super::schedule::SprawlSystems;
use crate::region::Settlement;
use crate::space::ChunkCoord;
use bevy::prelude::*;
use bevy::tasks::Task;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// How chunks are streamed.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct StreamSettings {
    /// Number of chunks that are being made at a time; 0 is three for each thread of Bevy's `AsyncComputeTaskPool`.
    pub max_tasks: u32,
    /// Milliseconds per frame for turning finished chunks into entities and removing old ones. One chunk is always
    /// applied, however long it takes.
    pub apply_ms: f32,
    /// Number of chunks that are applied in a frame at most.
    pub applies_per_frame: u32,
    /// Number of chunks that are removed in a frame at most.
    pub removals_per_frame: u32,
    /// Chunks are also loaded around where anchors will be in so many seconds.
    pub lookahead_s: f32,
    /// Keeps vertices in main memory after they have gone to the GPU, for games that read meshes back. Needs about
    /// twice the memory. Colliders need it not: they can be made from [`ChunkData`](super::ChunkData).
    pub keep_meshes: bool,
}

impl Default for StreamSettings {
    fn default() -> Self {
        Self {
            max_tasks: 0,
            apply_ms: 0.5,
            applies_per_frame: 4,
            removals_per_frame: 4,
            lookahead_s: 4.0,
            keep_meshes: false,
        }
    }
}

/// What has to be made again for a new world.
#[derive(Debug)]
pub(super) enum Dirty {
    All,
    /// All chunks but those that are known to be the same.
    AllBut(BTreeSet<ChunkCoord>),
}

/// Everything that streaming remembers.
#[derive(Resource, Default)]
pub(super) struct Streaming {
    /// Makes chunks; `None` until there is a world.
    maker: Option<Arc<dyn ChunkMaker>>,
    /// Edge of a chunk in metres.
    pub size: i64,
    /// Anchors of this frame.
    pub anchors: Vec<AnchorView>,
    /// Whether meshes are made: only where something could draw them.
    pub with_meshes: bool,
    /// Chunks that have an entity.
    slots: BTreeMap<ChunkCoord, Slot>,
    /// Cancelled tasks that have not noticed yet; they still occupy a thread.
    cancelled: Vec<Task<tasks::Outcome>>,
    /// Entities of chunks of another chunk size.
    retired: Vec<(ChunkCoord, Entity)>,
    /// Anchors for which chunks were last planned.
    planned: Vec<AnchorView>,
    /// Plan again even when no anchor has moved.
    replan: bool,
    pub counts: Counts,
}

/// Figures that only grow, and those of this frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub made: u64,
    pub failed: u64,
    pub task_seconds: f64,
    pub frame_ms: f32,
    pub apply_ms: f32,
}

impl Streaming {
    /// Goes over to another world. What is shown stays until what replaces it is there.
    pub fn replace<M: ChunkMaker + Clone>(&mut self, maker: &M, dirty: Dirty) {
        let size = maker.chunk_size();
        let same_grid = size == self.size;
        self.size = size;
        self.maker = Some(Arc::new(maker.clone()));
        self.replan = true;
        for slot in self.slots.values_mut() {
            self.cancelled.extend(slot.cancel());
        }
        if !same_grid {
            let old = std::mem::take(&mut self.slots);
            self.retired.extend(old.into_iter().map(|(coord, slot)| (coord, slot.entity)));
            return;
        }
        for (coord, slot) in &mut self.slots {
            slot.failed = false;
            slot.stale |= match &dirty {
                Dirty::All => true,
                Dirty::AllBut(chunks) => !chunks.contains(coord),
            };
        }
    }

    /// The settlements that each chunk that is there shows.
    pub fn settlements(&self) -> Vec<(ChunkCoord, Vec<Arc<Settlement>>)> {
        let shown = self.slots.iter().filter_map(|(coord, slot)| Some((*coord, slot.shown.as_ref()?)));
        shown.map(|(coord, shown)| (coord, shown.settlements.clone())).collect()
    }

    /// The entity of a chunk.
    pub fn entity(&self, coord: ChunkCoord) -> Option<Entity> {
        self.slots.get(&coord).map(|s| s.entity)
    }

    /// (chunks there, chunks waiting or being made for the first time, tasks in flight)
    pub fn load(&self) -> (usize, usize, usize) {
        let there = self.slots.values().filter(|s| s.shown.is_some()).count();
        let missing = self.slots.values().filter(|s| s.shown.is_none() && !s.leaving && !s.failed).count();
        (there, missing, self.tasks_in_flight())
    }

    fn tasks_in_flight(&self) -> usize {
        self.slots.values().filter(|s| s.job.is_some()).count() + self.cancelled.len()
    }
}

pub(super) struct StreamingPlugin;

impl Plugin for StreamingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Streaming>()
            .register_type::<StreamSettings>()
            .add_systems(PostUpdate, (plan::plan_chunks, tasks::run_tasks).chain().in_set(SprawlSystems::Stream))
            .add_systems(PostUpdate, apply::apply_chunks.in_set(SprawlSystems::Apply));
    }
}
