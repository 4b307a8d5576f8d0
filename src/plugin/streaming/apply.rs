//! Giving finished chunks to their entities, and removing unwanted chunks.
//!
//! This is an exclusive system: its work is done when it returns, so it measures the true time of the work against the budget.

use super::build::FinishedChunk;
use super::entry::ShownChunk;
use super::index::{ChunkIndex, Unloading};
use crate::plugin::appearance::{PartMesh, SprawlMaterials};
use crate::plugin::chunk::{ChunkChange, ChunkData, ChunkDetail, ChunkReady, ChunkUnloaded};
use crate::plugin::frame_time::FrameTime;
use crate::plugin::stream_settings::StreamSettings;
use crate::space::ChunkCoord;
use bevy::camera::visibility::NoAutoAabb;
use bevy::platform::time::Instant;
use bevy::prelude::*;

pub(super) fn apply_chunks(world: &mut World) {
    let start = Instant::now();
    let settings = world.resource::<StreamSettings>().clone();
    let is_over_budget = || start.elapsed().as_secs_f32() * 1000.0 > settings.apply_ms;
    let most = settings.applies_per_frame.max(1) as usize;
    for (i, coord) in finished(world.resource::<ChunkIndex>(), most).into_iter().enumerate() {
        if i > 0 && is_over_budget() {
            break;
        }
        apply(world, coord);
    }
    for i in 0..settings.removals_per_frame.max(1) {
        if i > 0 && is_over_budget() {
            break;
        }
        let Some(unloading) = world.resource_mut::<ChunkIndex>().next_to_unload() else { break };
        unload(world, unloading);
    }
    let mut time = world.resource_mut::<FrameTime>();
    time.apply = start.elapsed();
    time.total += start.elapsed();
}

/// Chunks that wait to be applied, at most `most`, in the order of their priorities.
fn finished(index: &ChunkIndex, most: usize) -> Vec<ChunkCoord> {
    let waiting = index.entries.iter().filter(|(_, e)| e.finished.is_some());
    let mut waiting: Vec<_> = waiting.map(|(coord, entry)| (entry.priority, *coord)).collect();
    waiting.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    waiting.into_iter().take(most).map(|(_, coord)| coord).collect()
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
    let FinishedChunk { chunk, detail, outlines, parts, .. } = finished;
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
        if change != ChunkChange::Detail {
            entity.insert(ChunkData(chunk));
        }
    }
    let event = ChunkReady { entity: parent, coord, detail, change };
    world.write_message(event);
    world.trigger(event);
}

fn spawn_parts(world: &mut World, parent: Entity, parts: Vec<PartMesh>) -> Vec<Entity> {
    let materials = world.get_resource::<SprawlMaterials>().cloned();
    let mut handles = Vec::with_capacity(parts.len());
    if let Some(mut meshes) = world.get_resource_mut::<Assets<Mesh>>() {
        handles.extend(parts.into_iter().map(|p| (p.part, meshes.add(p.mesh), p.bounds)));
    }
    let spawned = handles.into_iter().map(|(part, mesh, bounds)| {
        let mut child = world.spawn((part, Mesh3d(mesh), bounds, NoAutoAabb, Visibility::default(), ChildOf(parent)));
        if let Some(materials) = &materials {
            child.insert(MeshMaterial3d(materials[part].clone()));
        }
        child.id()
    });
    spawned.collect()
}

/// Announces a loaded chunk and despawns it. The game may have despawned it already.
fn unload(world: &mut World, Unloading { coord, entity, chunk }: Unloading) {
    let event = ChunkUnloaded { entity, coord, data: ChunkData(chunk) };
    world.trigger(event.clone());
    if let Ok(entity) = world.get_entity_mut(entity) {
        entity.despawn();
    }
    world.write_message(event);
}
