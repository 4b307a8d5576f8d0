//! Going over to another world.

use super::generator::ChunkGenerator;
use super::horizon::Horizon;
use super::index::{ChunkIndex, Unloading};
use super::plan::Planned;
use super::scheduler::Scheduler;
use crate::space::ChunkCoord;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The chunks that have to be made again for a new world.
#[derive(Debug)]
pub(in crate::plugin) enum Stale {
    All,
    /// All chunks except the given ones, which are known to be the same.
    AllBut(BTreeSet<ChunkCoord>),
}

/// Everything that streaming remembers.
#[derive(SystemParam)]
pub(in crate::plugin) struct Streaming<'w> {
    index: ResMut<'w, ChunkIndex>,
    horizon: ResMut<'w, Horizon>,
    scheduler: ResMut<'w, Scheduler>,
    planned: ResMut<'w, Planned>,
}

impl Streaming<'_> {
    /// Goes over to another world. Shown chunks and tiles stay until their replacements are ready. Tiles take little time, so all
    /// of them are made again.
    pub fn replace<G: ChunkGenerator + Clone>(&mut self, generator: &G, stale: Stale) {
        let size = generator.chunk_size();
        let same_grid = size == self.index.size;
        self.index.size = size;
        self.scheduler.generator = Some(Arc::new(generator.clone()));
        self.planned.again();
        for entry in self.index.entries.values_mut() {
            self.scheduler.cancelled.extend(entry.cancel());
        }
        self.scheduler.cancelled.extend(self.horizon.replace(same_grid));
        if !same_grid {
            for (coord, entry) in std::mem::take(&mut self.index.entries) {
                match entry.shown {
                    Some(shown) => {
                        self.index.retired.push(Unloading { coord, entity: entry.entity, chunk: shown.chunk });
                    }
                    None => self.index.abandoned.push(entry.entity),
                }
            }
            return;
        }
        for (coord, entry) in &mut self.index.entries {
            entry.failed = false;
            entry.stale |= match &stale {
                Stale::All => true,
                Stale::AllBut(chunks) => !chunks.contains(coord),
            };
        }
    }
}
