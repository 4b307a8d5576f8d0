//! Spawning and despawning the entities of chunks, and planning tiles of the horizon, as the anchors want.

use super::entry::ChunkEntry;
use super::horizon::{self, Horizon};
use super::index::ChunkIndex;
use super::scheduler::Scheduler;
use super::wanted::wanted;
use crate::mesh::HorizonTile;
use crate::plugin::anchor::{AnchorView, Anchors};
use crate::plugin::chunk::{ChunkData, ChunkStatus, ChunkUnloaded};
use crate::plugin::frame_time::{Stopwatch, measure_commands};
use crate::plugin::origin::SprawlOrigin;
use crate::plugin::stream_settings::StreamSettings;
use crate::space::ChunkCoord;
use bevy::prelude::*;

/// Anchors may move this far before chunks are planned again, in metres.
const TOLERANCE: f64 = 4.0;

/// Metres of distance that are added to the priority of a chunk that is loaded and only needs other meshes.
const REFRESH_PENALTY: f64 = 400.0;

/// The anchors for which chunks were last planned.
#[derive(Resource, Default)]
pub(in crate::plugin) struct Planned {
    anchors: Vec<AnchorView>,
    again: bool,
}

impl Planned {
    /// Plans in the next frame even if no anchor moves.
    pub fn again(&mut self) {
        self.again = true;
    }

    fn is_current(&self, anchors: &[AnchorView]) -> bool {
        let still = |a: &AnchorView, b: &AnchorView| {
            (a.load, a.unload, a.detail, a.horizon) == (b.load, b.unload, b.detail, b.horizon)
                && a.at.distance(b.at) < TOLERANCE
                && a.ahead.distance(b.ahead) < TOLERANCE
        };
        !self.again
            && anchors.len() == self.anchors.len()
            && anchors.iter().zip(&self.anchors).all(|(a, b)| still(a, b))
    }
}

/// Announces loaded chunks that a game has despawned itself, and plans them anew. Despawned tiles of the horizon are made anew.
pub(super) fn notice_despawned(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    (mut index, mut horizon): (ResMut<ChunkIndex>, ResMut<Horizon>),
    (mut scheduler, mut planned): (ResMut<Scheduler>, ResMut<Planned>),
    (entities, tiles): (Query<(), With<ChunkCoord>>, Query<(), With<HorizonTile>>),
    mut unloaded: MessageWriter<ChunkUnloaded>,
) {
    let _running = stopwatch.start();
    if horizon.forget_despawned(|entity| tiles.contains(entity)) {
        planned.again();
    }
    let gone = index.entries.iter().filter(|(_, entry)| !entities.contains(entry.entity));
    for coord in gone.map(|(coord, _)| *coord).collect::<Vec<_>>() {
        let Some(mut entry) = index.entries.remove(&coord) else { continue };
        scheduler.cancelled.extend(entry.cancel());
        planned.again();
        if let Some(shown) = entry.shown {
            let event = ChunkUnloaded { entity: entry.entity, coord, data: ChunkData(shown.chunk) };
            unloaded.write(event.clone());
            commands.trigger(event);
        }
    }
}

/// Plans when an anchor has moved, come, gone or changed, or when there is a new world.
pub(super) fn plan_chunks(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    (mut index, mut horizon): (ResMut<ChunkIndex>, ResMut<Horizon>),
    (mut scheduler, mut planned): (ResMut<Scheduler>, ResMut<Planned>),
    (anchors, origin, settings): (Res<Anchors>, Res<SprawlOrigin>, Res<StreamSettings>),
    meshes: Option<Res<Assets<Mesh>>>,
) {
    let _running = stopwatch.start();
    if scheduler.generator.is_none() || (planned.is_current(&anchors) && !settings.is_changed()) {
        return;
    }
    planned.again = false;
    planned.anchors.clone_from(&anchors);
    let index = &mut *index;
    let entries = &index.entries;
    let current_detail = |coord: ChunkCoord| {
        let entry = entries.get(&coord)?;
        Some(entry.shown.as_ref().map_or(entry.want, |s| s.detail.min(entry.want)))
    };
    let wanted = wanted(&anchors, index.size, current_detail);
    let abandoned = &mut index.abandoned;
    index.entries.retain(|coord, entry| {
        if let Some(want) = wanted.get(coord) {
            entry.leaving = false;
            entry.want = want.detail;
            entry.priority = want.priority + if entry.shown.is_some() { REFRESH_PENALTY } else { 0.0 };
            return true;
        }
        if !entry.leaving {
            entry.leaving = true;
            scheduler.cancelled.extend(entry.cancel());
        }
        if entry.shown.is_none() {
            abandoned.push(entry.entity);
        }
        entry.shown.is_some()
    });
    measure_commands(&mut commands, |commands| {
        for entity in index.abandoned.drain(..) {
            commands.entity(entity).try_despawn();
        }
        for (coord, want) in wanted {
            index.entries.entry(coord).or_insert_with(|| {
                let entity = commands.spawn((
                    Name::new(format!("chunk {coord}")),
                    coord,
                    ChunkStatus::Queued,
                    Transform::from_translation(origin.chunk_translation(coord, index.size)),
                    Visibility::default(),
                ));
                ChunkEntry::new(entity.id(), want.detail, want.priority)
            });
        }
    });
    scheduler.cancelled.extend(horizon::plan(&mut horizon, index, &anchors, meshes.is_some()));
}
