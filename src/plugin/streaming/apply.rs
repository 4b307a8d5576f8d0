//! Giving finished chunks and tiles to their entities, and removing unwanted ones.
//!
//! This is an exclusive system: its work is done when it returns, so it measures the true time of the work against the budget.

use super::build::FinishedChunk;
use super::entry::{ChunkEntry, ShownChunk};
use super::horizon::{self, Horizon};
use super::index::{ChunkIndex, Unloading};
use super::parts::spawn_parts;
use crate::mesh::HorizonTile;
use crate::plugin::chunk::{ChunkChange, ChunkData, ChunkDetail, ChunkReady, ChunkUnloaded};
use crate::plugin::collision::MadeCollision;
use crate::plugin::frame_time::FrameTime;
use crate::plugin::stream_settings::StreamSettings;
use crate::space::ChunkCoord;
use bevy::platform::time::Instant;
use bevy::prelude::*;

pub(super) fn apply_finished(world: &mut World) {
    let start = Instant::now();
    let settings = world.resource::<StreamSettings>().clone();
    let is_over_budget = || start.elapsed().as_secs_f32() * 1000.0 > settings.apply_ms;
    let most = settings.applies_per_frame.max(1) as usize;
    let (index, horizon) = (world.resource::<ChunkIndex>(), world.resource::<Horizon>());
    for (i, next) in finished(index, horizon).into_iter().take(most).enumerate() {
        if i > 0 && is_over_budget() {
            break;
        }
        match next {
            Next::Chunk(coord) => apply(world, coord),
            Next::Tile(tile) => horizon::apply(world, tile),
        }
    }
    for i in 0..settings.removals_per_frame.max(1) {
        if (i > 0 && is_over_budget()) || !remove(world) {
            break;
        }
    }
    horizon::show_and_hide(world);
    let mut time = world.resource_mut::<FrameTime>();
    time.apply = start.elapsed();
    time.total += start.elapsed();
}

/// What can be applied next.
enum Next {
    Chunk(ChunkCoord),
    Tile(HorizonTile),
}

/// What waits to be applied, in the order of priorities. A new chunk waits on until no large tile is shown in its place.
fn finished(index: &ChunkIndex, horizon: &Horizon) -> Vec<Next> {
    let may_come = |coord, entry: &ChunkEntry| entry.shown.is_some() || !horizon.covers(coord);
    let chunks = index.entries.iter().filter(|(coord, e)| e.finished.is_some() && may_come(**coord, e));
    let tiles = horizon.entries.iter().filter(|(_, e)| e.finished.is_some());
    let mut waiting: Vec<(f64, Next)> = chunks.map(|(coord, e)| (e.priority, Next::Chunk(*coord))).collect();
    waiting.extend(tiles.map(|(tile, e)| (e.priority, Next::Tile(*tile))));
    waiting.sort_by(|a, b| a.0.total_cmp(&b.0));
    waiting.into_iter().map(|(_, next)| next).collect()
}

/// Removes a chunk, or a piece of the horizon, that is not wanted. Returns whether there was one.
fn remove(world: &mut World) -> bool {
    let next = world.resource_scope(|world, horizon: Mut<Horizon>| {
        // The tile below comes first, so that the ground has no hole.
        world.resource_mut::<ChunkIndex>().next_to_unload(|coord| !horizon.is_awaited(coord))
    });
    match next {
        Some(unloading) => unload(world, unloading),
        None => return horizon::remove(world),
    }
    true
}

/// Replaces what the entity of a chunk shows. Messages and events come last, when everything is in place: their observers
/// may use every resource.
fn apply(world: &mut World, coord: ChunkCoord) {
    let mut index = world.resource_mut::<ChunkIndex>();
    let Some(entry) = index.entries.get_mut(&coord) else { return };
    let (parent, Some(finished)) = (entry.entity, entry.finished.take()) else { return };
    if world.get_entity(parent).is_err() {
        // The game has just despawned the entity. The chunk will be planned anew.
        return;
    }
    let FinishedChunk { chunk, detail, outlines, parts, collision } = finished;
    let parts = spawn_parts(world, parent, parts);
    let mut index = world.resource_mut::<ChunkIndex>();
    let Some(entry) = index.entries.get_mut(&coord) else { return };
    let change = match &entry.shown {
        None => ChunkChange::Loaded,
        Some(_) if entry.stale => ChunkChange::Data,
        Some(_) => ChunkChange::Detail,
    };
    let chunk = match &entry.shown {
        Some(shown) if change == ChunkChange::Detail => shown.chunk.clone(),
        _ => chunk,
    };
    let old = entry.shown.replace(ShownChunk { detail, parts, chunk: chunk.clone(), outlines });
    entry.stale = false;
    let status = entry.status();
    entry.status_set = status;
    for part in old.into_iter().flat_map(|o| o.parts) {
        if let Ok(part) = world.get_entity_mut(part) {
            part.despawn();
        }
    }
    if let Ok(mut entity) = world.get_entity_mut(parent) {
        entity.insert((ChunkDetail(detail), status));
        MadeCollision::put(collision, &mut entity);
        if change != ChunkChange::Detail {
            entity.insert(ChunkData(chunk));
        }
    }
    world.resource_mut::<Horizon>().changed = true;
    let event = ChunkReady { entity: parent, coord, detail, change };
    world.write_message(event);
    world.trigger(event);
}

/// Announces a loaded chunk and despawns it. The game may have despawned it already.
fn unload(world: &mut World, Unloading { coord, entity, chunk }: Unloading) {
    let event = ChunkUnloaded { entity, coord, data: ChunkData(chunk) };
    world.trigger(event.clone());
    world.resource_mut::<Horizon>().changed = true;
    if let Ok(entity) = world.get_entity_mut(entity) {
        entity.despawn();
    }
    world.write_message(event);
}
