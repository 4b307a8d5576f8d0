//! The tasks in flight.

use super::build::{BuildOrder, BuildOutcome};
use super::entry::Job;
use super::generator::ChunkGenerator;
use super::index::ChunkIndex;
use crate::layer::Cancel;
use crate::plugin::chunk::{ChunkFailed, ChunkStatus};
use crate::plugin::frame_time::Stopwatch;
use crate::plugin::stream_settings::StreamSettings;
use crate::plugin::task::BackgroundError;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use std::sync::Arc;

/// Makes chunks in tasks.
#[derive(Resource, Default)]
pub(in crate::plugin) struct Scheduler {
    /// `None` until there is a world.
    pub(super) generator: Option<Arc<dyn ChunkGenerator>>,
    /// Cancelled tasks that have not stopped yet and may still occupy a thread.
    pub(super) cancelled: Vec<Task<BuildOutcome>>,
    /// Chunks made since the start.
    pub made: u64,
    /// Chunks that could not be made since the start.
    pub failed: u64,
    /// Seconds of background threads that all made chunks took.
    pub task_seconds: f64,
}

impl Scheduler {
    /// Number of tasks in flight, including cancelled tasks that have not stopped yet.
    pub fn tasks_in_flight(&self, index: &ChunkIndex) -> usize {
        index.building() + self.cancelled.len()
    }
}

/// Takes the results of tasks, and starts as many tasks as the settings allow.
pub(super) fn run_tasks(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    (mut index, mut scheduler): (ResMut<ChunkIndex>, ResMut<Scheduler>),
    (settings, meshes): (Res<StreamSettings>, Option<Res<Assets<Mesh>>>),
    mut statuses: Query<&mut ChunkStatus>,
    mut failed: MessageWriter<ChunkFailed>,
) {
    let _running = stopwatch.start();
    let (index, scheduler) = (&mut *index, &mut *scheduler);
    scheduler.cancelled.retain_mut(|task| check_ready(task).is_none());
    for (coord, entry) in &mut index.entries {
        let Some(outcome) = entry.job.as_mut().and_then(|job| check_ready(&mut job.task)) else { continue };
        entry.job = None;
        match outcome {
            Ok(finished) => {
                scheduler.made += 1;
                scheduler.task_seconds += finished.seconds;
                entry.finished = Some(*finished);
            }
            Err(BackgroundError::Cancelled) => {}
            Err(BackgroundError::Defect(reason)) => {
                scheduler.failed += 1;
                entry.failed = true;
                warn_once!("chunk {coord} could not be made (later failures are not logged): {reason}");
                let event = ChunkFailed { entity: entry.entity, coord: *coord, reason };
                failed.write(event.clone());
                commands.trigger(event);
            }
        }
    }
    // Meshes are made only where something could draw them.
    start_tasks(index, scheduler, &settings, meshes.is_some());
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

fn start_tasks(index: &mut ChunkIndex, scheduler: &Scheduler, settings: &StreamSettings, with_meshes: bool) {
    let Some(generator) = &scheduler.generator else { return };
    let pool = AsyncComputeTaskPool::get();
    let most = match settings.max_tasks {
        // On the web, tasks run on the main thread.
        0 if cfg!(target_family = "wasm") => 1,
        0 => 3 * pool.thread_num().max(1),
        n => n as usize,
    };
    let free = most.saturating_sub(scheduler.tasks_in_flight(index));
    if free == 0 {
        return;
    }
    let mut waiting: Vec<_> = index.entries.iter_mut().filter(|(_, e)| e.needs_work()).collect();
    waiting.sort_by(|a, b| a.1.priority.total_cmp(&b.1.priority).then(a.0.cmp(b.0)));
    for (coord, entry) in waiting.into_iter().take(free) {
        let order = BuildOrder {
            generator: generator.clone(),
            coord: *coord,
            detail: entry.want,
            with_meshes,
            keep_meshes: settings.keep_meshes,
            texture_coordinates: settings.texture_coordinates,
            cancel: Cancel::new(),
        };
        let cancel = order.cancel.clone();
        entry.job = Some(Job { cancel, task: pool.spawn(async move { order.run() }) });
    }
}
