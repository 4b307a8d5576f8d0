//! The tasks in flight.

use super::build::Builder;
use super::entry::ChunkEntry;
use super::generator::ChunkGenerator;
use super::horizon::{Horizon, TileEntry};
use super::index::ChunkIndex;
use super::job::{Job, Made, Stopping};
use crate::mesh::HorizonTile;
use crate::plugin::chunk::{ChunkFailed, ChunkStatus};
use crate::plugin::frame_time::Stopwatch;
use crate::plugin::stream_settings::StreamSettings;
use crate::plugin::task::BackgroundError;
use crate::space::ChunkCoord;
use bevy::prelude::*;
use bevy::tasks::AsyncComputeTaskPool;
use std::sync::Arc;

/// Makes chunks and tiles in tasks.
#[derive(Resource, Default)]
pub(in crate::plugin) struct Scheduler {
    /// `None` until there is a world.
    pub(super) generator: Option<Arc<dyn ChunkGenerator>>,
    /// Cancelled tasks that have not stopped yet and may still occupy a thread.
    pub(super) cancelled: Vec<Stopping>,
    pub chunks: Tally,
    pub tiles: Tally,
}

/// What tasks have done since the start.
#[derive(Default)]
pub(in crate::plugin) struct Tally {
    pub made: u64,
    pub failed: u64,
    /// Seconds of background threads that all that was made took.
    seconds: f64,
}

impl Tally {
    /// Mean milliseconds of a background thread to make one.
    pub fn mean_ms(&self) -> f32 {
        (self.seconds * 1000.0 / self.made.max(1) as f64) as f32
    }

    /// Counts the outcome of a task, and gives what it has made or why it failed; `None` if it was cancelled.
    fn count<T>(&mut self, outcome: Result<Made<T>, BackgroundError>) -> Option<Result<T, String>> {
        match outcome {
            Ok(Made { value, seconds }) => {
                self.made += 1;
                self.seconds += seconds;
                Some(Ok(value))
            }
            Err(BackgroundError::Cancelled) => None,
            Err(BackgroundError::Defect(reason)) => {
                self.failed += 1;
                Some(Err(reason))
            }
        }
    }
}

impl Scheduler {
    /// Number of tasks in flight, including cancelled tasks that have not stopped yet.
    pub fn tasks_in_flight(&self, index: &ChunkIndex, horizon: &Horizon) -> usize {
        index.building() + horizon.building() + self.cancelled.len()
    }
}

/// Takes the results of tasks, and starts as many tasks as the settings allow.
pub(super) fn run_tasks(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    (mut index, mut horizon, mut scheduler): (ResMut<ChunkIndex>, ResMut<Horizon>, ResMut<Scheduler>),
    (settings, meshes): (Res<StreamSettings>, Option<Res<Assets<Mesh>>>),
    mut statuses: Query<&mut ChunkStatus>,
    mut failed: MessageWriter<ChunkFailed>,
) {
    let _running = stopwatch.start();
    let (index, horizon, scheduler) = (&mut *index, &mut *horizon, &mut *scheduler);
    scheduler.cancelled.retain_mut(|task| !task.is_over());
    for (coord, entry) in &mut index.entries {
        let Some(outcome) = entry.job.as_mut().and_then(Job::poll) else { continue };
        entry.job = None;
        match scheduler.chunks.count(outcome) {
            Some(Ok(finished)) => entry.finished = Some(finished),
            None => {}
            Some(Err(reason)) => {
                entry.failed = true;
                warn_once!("chunk {coord} could not be made (later failures are not logged): {reason}");
                let event = ChunkFailed { entity: entry.entity, coord: *coord, reason };
                failed.write(event.clone());
                commands.trigger(event);
            }
        }
    }
    for (tile, entry) in &mut horizon.entries {
        let Some(outcome) = entry.job.as_mut().and_then(Job::poll) else { continue };
        entry.job = None;
        match scheduler.tiles.count(outcome) {
            Some(Ok(finished)) => entry.finished = Some(finished),
            None => {}
            Some(Err(reason)) => {
                entry.failed = true;
                horizon.changed = true;
                warn_once!("{tile:?} could not be made (later failures are not logged): {reason}");
            }
        }
    }
    start_tasks(index, horizon, scheduler, &settings, meshes.is_some());
    for entry in index.entries.values_mut() {
        let status = entry.status();
        if entry.status_set != status
            && let Ok(mut on_entity) = statuses.get_mut(entry.entity)
        {
            *on_entity = status;
            entry.status_set = status;
        }
    }
}

/// What a task can be started for.
enum Waiting<'a> {
    Chunk(ChunkCoord, &'a mut ChunkEntry),
    Tile(HorizonTile, &'a mut TileEntry),
}

fn start_tasks(
    index: &mut ChunkIndex,
    horizon: &mut Horizon,
    scheduler: &Scheduler,
    settings: &StreamSettings,
    with_meshes: bool,
) {
    let Some(generator) = &scheduler.generator else { return };
    let most = match settings.max_tasks {
        // On the web, tasks run on the main thread.
        0 if cfg!(target_family = "wasm") => 1,
        0 => 3 * AsyncComputeTaskPool::get().thread_num().max(1),
        n => n as usize,
    };
    let free = most.saturating_sub(scheduler.tasks_in_flight(index, horizon));
    if free == 0 {
        return;
    }
    let chunks = index.entries.iter_mut().filter(|(_, e)| e.needs_work());
    let tiles = horizon.entries.iter_mut().filter(|(_, e)| e.needs_work());
    let mut waiting: Vec<_> = chunks.map(|(coord, e)| (e.priority, Waiting::Chunk(*coord, e))).collect();
    waiting.extend(tiles.map(|(tile, e)| (e.priority, Waiting::Tile(*tile, e))));
    waiting.sort_by(|a, b| a.0.total_cmp(&b.0));
    let builder = Builder::new(generator, settings, with_meshes);
    for (_, next) in waiting.into_iter().take(free) {
        let builder = builder.clone();
        match next {
            Waiting::Chunk(coord, entry) => {
                let detail = entry.want;
                entry.job = Some(Job::start(move |cancel| builder.chunk(coord, detail, cancel)));
            }
            Waiting::Tile(tile, entry) => {
                entry.job = Some(Job::start(move |cancel| builder.tile(tile, cancel)));
            }
        }
    }
}
