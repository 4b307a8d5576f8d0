//! Turning finished chunks into entities, and removing those that are not wanted.
//!
//! An exclusive system: what it does is done when it returns, so that the time it measures against the budget is the
//! time it really takes.

use super::slot::Shown;
use super::tasks::Built;
use super::{StreamSettings, Streaming};
use crate::plugin::appearance::{PartMesh, SprawlMaterials};
use crate::plugin::chunk::{ChunkData, ChunkDetail, ChunkReady, ChunkUnloaded};
use crate::space::ChunkCoord;
use bevy::camera::visibility::NoAutoAabb;
use bevy::prelude::*;
use std::time::Instant;

pub(super) fn apply_chunks(world: &mut World) {
    let start = Instant::now();
    let milliseconds = || start.elapsed().as_secs_f32() * 1000.0;
    let settings = world.resource::<StreamSettings>().clone();
    let most = settings.applies_per_frame.max(1) as usize;
    for (i, coord) in world.resource::<Streaming>().finished(most).into_iter().enumerate() {
        if i > 0 && milliseconds() > settings.apply_ms {
            break;
        }
        apply(world, coord);
    }
    for i in 0..settings.removals_per_frame.max(1) {
        if i > 0 && milliseconds() > settings.apply_ms {
            break;
        }
        let Some((coord, entity)) = world.resource_mut::<Streaming>().next_to_remove() else { break };
        remove(world, coord, entity);
    }
    let mut streaming = world.resource_mut::<Streaming>();
    streaming.counts.apply_ms = milliseconds();
    streaming.counts.frame_ms += milliseconds();
}

impl Streaming {
    /// Chunks that wait to be applied, in order.
    fn finished(&self, most: usize) -> Vec<ChunkCoord> {
        let mut built: Vec<_> =
            self.slots.iter().filter(|(_, s)| s.built.is_some()).map(|(coord, s)| (s.priority, *coord)).collect();
        built.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        built.into_iter().take(most).map(|(_, coord)| coord).collect()
    }

    /// Forgets one chunk that is not wanted.
    fn next_to_remove(&mut self) -> Option<(ChunkCoord, Entity)> {
        let leaving = self.slots.iter().find(|(_, s)| s.leaving).map(|(coord, _)| *coord);
        match leaving {
            Some(coord) => self.slots.remove(&coord).map(|slot| (coord, slot.entity)),
            None => self.retired.pop(),
        }
    }
}

/// Puts a finished chunk in the place of what its entity shows. Messages and events come last, when all is in place:
/// their observers may use every resource.
fn apply(world: &mut World, coord: ChunkCoord) {
    let mut streaming = world.resource_mut::<Streaming>();
    let Some(slot) = streaming.slots.get_mut(&coord) else { return };
    let (parent, Some(built)) = (slot.entity, slot.built.take()) else { return };
    if world.get_entity(parent).is_err() {
        // Despawned by the game: planned anew.
        let mut streaming = world.resource_mut::<Streaming>();
        streaming.slots.remove(&coord);
        streaming.replan = true;
        return;
    }
    let Built { chunk, detail, parts, .. } = built;
    let parts = spawn_parts(world, parent, parts);
    let mut streaming = world.resource_mut::<Streaming>();
    let Some(slot) = streaming.slots.get_mut(&coord) else { return };
    let old = slot.shown.replace(Shown { detail, parts, settlements: chunk.settlements.clone() });
    slot.stale = false;
    slot.told = slot.status();
    let status = slot.told;
    let first = old.is_none();
    for part in old.into_iter().flat_map(|o| o.parts) {
        if let Ok(part) = world.get_entity_mut(part) {
            part.despawn();
        }
    }
    if let Ok(mut entity) = world.get_entity_mut(parent) {
        entity.insert((ChunkData(chunk), ChunkDetail(detail), status));
    }
    let event = ChunkReady { entity: parent, coord, detail, first };
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
            child.insert(MeshMaterial3d(materials.of(part).clone()));
        }
        child.id()
    });
    spawned.collect()
}

fn remove(world: &mut World, coord: ChunkCoord, entity: Entity) {
    if world.get_entity(entity).is_ok() {
        let event = ChunkUnloaded { entity, coord };
        world.trigger(event);
        world.despawn(entity);
        world.write_message(event);
    }
}
