//! The tiles that are wanted or made.

use super::entry::{Piece, TileEntry};
use super::view::{View, places};
use crate::mesh::HorizonTile;
use crate::plugin::streaming::job::Stopping;
use crate::space::ChunkCoord;
use bevy::prelude::{Entity, Resource};
use std::collections::BTreeMap;

/// The tiles that are wanted or made.
#[derive(Resource, Default)]
pub(in crate::plugin) struct Horizon {
    pub(in crate::plugin::streaming) entries: BTreeMap<HorizonTile, TileEntry>,
    /// How the anchors see the land.
    pub(super) views: BTreeMap<HorizonTile, View>,
    /// Pieces of tiles that have made way. They wait to be removed.
    pub(in crate::plugin::streaming) leaving: Vec<Piece>,
    /// Whether tiles or chunks have come, gone or been planned since it was last chosen what is shown.
    pub(in crate::plugin::streaming) changed: bool,
}

impl Horizon {
    /// The number of tiles that have been made and are there, hidden or not.
    pub fn loaded(&self) -> usize {
        self.entries.values().filter(|e| e.pieces.is_some()).count()
    }

    /// The number of tiles that are wanted and have never been made.
    pub fn missing(&self) -> usize {
        self.entries.values().filter(|e| e.wanted && !e.is_ready()).count()
    }

    /// The number of tiles that are being made.
    pub fn building(&self) -> usize {
        self.entries.values().filter(|e| e.job.is_some()).count()
    }

    /// Whether a tile larger than level 1 is shown in the place of a chunk.
    pub(in crate::plugin::streaming) fn covers(&self, chunk: ChunkCoord) -> bool {
        let mut larger = places(chunk).skip(2);
        larger.any(|tile| self.entries.get(&tile).is_some_and(|entry| entry.shown))
    }

    /// Whether the tile that takes the place of a chunk is wanted and not made yet.
    pub(in crate::plugin::streaming) fn is_awaited(&self, chunk: ChunkCoord) -> bool {
        let tile = HorizonTile::of_chunk(chunk).parent();
        self.entries.get(&tile).is_some_and(|entry| entry.wanted && !entry.is_ready())
    }

    /// Forgets the tiles of which `exists` denies an entity, since a game has despawned it.
    pub(in crate::plugin::streaming) fn forget_despawned(&mut self, exists: impl Fn(Entity) -> bool) -> bool {
        let mut any = false;
        for entry in self.entries.values_mut() {
            if entry.pieces.iter().flatten().any(|piece| !exists(piece.entity)) {
                self.leaving.extend(entry.pieces.take().into_iter().flatten());
                any = true;
            }
        }
        self.changed |= any;
        any
    }

    /// Goes over to another world. Made tiles stay until they are made again, unless the chunks have another size. Returns the
    /// cancelled tasks.
    pub(in crate::plugin::streaming) fn replace(&mut self, same_grid: bool) -> Vec<Stopping> {
        self.changed = true;
        let stopping = self.entries.values_mut().filter_map(TileEntry::cancel).collect();
        if same_grid {
            for entry in self.entries.values_mut() {
                (entry.failed, entry.stale) = (false, true);
            }
        } else {
            let entries = std::mem::take(&mut self.entries).into_values();
            self.leaving.extend(entries.filter_map(|e| e.pieces).flatten());
            self.views.clear();
        }
        stopping
    }
}
