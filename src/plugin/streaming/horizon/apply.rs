//! Giving finished tiles their entities, showing and hiding them, and removing those that have made way.

use super::cut;
use super::entry::Piece;
use super::index::Horizon;
use crate::mesh::HorizonTile;
use crate::plugin::origin::SprawlOrigin;
use crate::plugin::streaming::index::ChunkIndex;
use crate::plugin::streaming::parts::spawn_parts;
use crate::space::ChunkCoord;
use bevy::light::NotShadowCaster;
use bevy::prelude::*;

/// Gives a finished tile its entities. They take the place of older ones at once; otherwise they are hidden until
/// [`show_and_hide`].
pub(in crate::plugin::streaming) fn apply(world: &mut World, tile: HorizonTile) {
    let (origin, size) = (*world.resource::<SprawlOrigin>(), world.resource::<ChunkIndex>().size);
    let mut horizon = world.resource_mut::<Horizon>();
    let Some(finished) = horizon.entries.get_mut(&tile).and_then(|entry| entry.finished.take()) else { return };
    let mut pieces = Vec::with_capacity(finished.len());
    for (tile, parts) in finished {
        let HorizonTile { level, x, y } = tile;
        let place = Transform::from_translation(origin.translation(tile.origin(size)));
        let name = Name::new(format!("horizon {level}: {x},{y}"));
        let entity = world.spawn((name, tile, place, Visibility::Hidden)).id();
        for part in spawn_parts(world, entity, parts) {
            // So far away shadows cost more than they show.
            world.entity_mut(part).insert(NotShadowCaster);
        }
        pieces.push(Piece { tile, entity, visible: false });
    }
    let mut horizon = world.resource_mut::<Horizon>();
    let horizon = &mut *horizon;
    if let Some(entry) = horizon.entries.get_mut(&tile) {
        horizon.leaving.extend(entry.pieces.replace(pieces).into_iter().flatten());
        entry.stale = false;
    }
    horizon.changed = true;
}

/// Shows and hides tiles after a change, all in the same frame. Tiles that have made way begin to leave.
pub(in crate::plugin::streaming) fn show_and_hide(world: &mut World) {
    world.resource_scope(|world, mut horizon: Mut<Horizon>| {
        if !horizon.changed {
            return;
        }
        let Horizon { entries, views, leaving, changed } = &mut *horizon;
        let index = world.resource::<ChunkIndex>();
        // Chunks of another size go first: their squares are none of these.
        *changed = !index.retired.is_empty();
        let shown = if *changed { default() } else { cut::shown(views, entries) };
        let mut switched = Vec::new();
        entries.retain(|tile, entry| {
            entry.shown = shown.contains(tile);
            if !entry.shown && !entry.wanted {
                leaving.extend(entry.pieces.take().into_iter().flatten());
                return false;
            }
            for piece in entry.pieces.iter_mut().flatten() {
                let is_chunk = piece.tile.level == 0 && index.is_loaded(ChunkCoord::new(piece.tile.x, piece.tile.y));
                switch(piece, entry.shown && !is_chunk, &mut switched);
            }
            true
        });
        leaving.iter_mut().for_each(|piece| switch(piece, false, &mut switched));
        for Piece { entity, visible, .. } in switched {
            if let Some(mut visibility) = world.get_mut::<Visibility>(entity) {
                *visibility = if visible { Visibility::Inherited } else { Visibility::Hidden };
            }
        }
    });
}

fn switch(piece: &mut Piece, visible: bool, switched: &mut Vec<Piece>) {
    if piece.visible != visible {
        piece.visible = visible;
        switched.push(*piece);
    }
}

/// Removes a piece that has made way. Returns whether there was one.
pub(in crate::plugin::streaming) fn remove(world: &mut World) -> bool {
    let Some(piece) = world.resource_mut::<Horizon>().leaving.pop() else { return false };
    // The game may have despawned it.
    if let Ok(entity) = world.get_entity_mut(piece.entity) {
        entity.despawn();
    }
    true
}
