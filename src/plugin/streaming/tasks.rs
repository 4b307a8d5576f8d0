//! The tasks that make chunks and their meshes.

use super::maker::ChunkMaker;
use super::slot::Job;
use super::{StreamSettings, Streaming};
use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::Detail;
use crate::plugin::appearance::{PartMesh, part_meshes};
use crate::plugin::chunk::{ChunkFailed, ChunkStatus};
use crate::space::ChunkCoord;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, futures::check_ready};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

/// A chunk that waits to be applied.
pub(super) struct Built {
    pub chunk: Arc<Chunk>,
    pub detail: Detail,
    /// Empty where nothing can draw them.
    pub parts: Vec<PartMesh>,
    /// How long it took, in seconds.
    pub seconds: f64,
}

/// Why a task gave no chunk.
pub(super) enum Failure {
    Cancelled,
    Because(String),
}

pub(super) type Outcome = Result<Box<Built>, Failure>;

/// What a task does.
struct Order {
    maker: Arc<dyn ChunkMaker>,
    coord: ChunkCoord,
    detail: Detail,
    with_meshes: bool,
    keep_meshes: bool,
    cancel: Cancel,
}

impl Order {
    fn run(&self) -> Outcome {
        // A defect in the generator costs a chunk, not the game.
        match catch_unwind(AssertUnwindSafe(|| self.make())) {
            Ok(Ok(built)) => Ok(Box::new(built)),
            Ok(Err(LayerError::Cancelled)) => Err(Failure::Cancelled),
            Ok(Err(error)) => Err(Failure::Because(error.to_string())),
            Err(panic) => {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
                Err(Failure::Because(format!("the generator panicked: {text}")))
            }
        }
    }

    fn make(&self) -> Result<Built, LayerError> {
        let start = Instant::now();
        self.cancel.check()?;
        let chunk = self.maker.chunk(self.coord, &self.cancel)?;
        let mut parts = Vec::new();
        if self.with_meshes {
            self.cancel.check()?;
            parts = part_meshes(self.maker.mesh(&chunk, self.detail, &self.cancel)?, self.keep_meshes);
        }
        Ok(Built { chunk, detail: self.detail, parts, seconds: start.elapsed().as_secs_f64() })
    }
}

/// Takes results, and keeps as many tasks busy as the settings allow.
pub(super) fn run_tasks(
    mut commands: Commands,
    mut streaming: ResMut<Streaming>,
    settings: Res<StreamSettings>,
    mut statuses: Query<&mut ChunkStatus>,
    mut failed: MessageWriter<ChunkFailed>,
) {
    let start = Instant::now();
    let streaming = &mut *streaming;
    streaming.cancelled.retain_mut(|task| check_ready(task).is_none());
    for (coord, slot) in &mut streaming.slots {
        let Some(outcome) = slot.job.as_mut().and_then(|job| check_ready(&mut job.task)) else { continue };
        slot.job = None;
        match outcome {
            Ok(built) => {
                streaming.counts.made += 1;
                streaming.counts.task_seconds += built.seconds;
                slot.built = Some(*built);
            }
            Err(Failure::Cancelled) => {}
            Err(Failure::Because(reason)) => {
                streaming.counts.failed += 1;
                slot.failed = true;
                warn_once!("chunk {coord} could not be made (later ones are not logged): {reason}");
                let event = ChunkFailed { entity: slot.entity, coord: *coord, reason };
                failed.write(event.clone());
                commands.trigger(event);
            }
        }
    }
    start_tasks(streaming, &settings);
    for slot in streaming.slots.values_mut() {
        let status = slot.status();
        if slot.told != status
            && let Ok(mut told) = statuses.get_mut(slot.entity)
        {
            *told = status;
            slot.told = status;
        }
    }
    streaming.counts.frame_ms += start.elapsed().as_secs_f32() * 1000.0;
}

fn start_tasks(streaming: &mut Streaming, settings: &StreamSettings) {
    let Some(maker) = streaming.maker.clone() else { return };
    let pool = AsyncComputeTaskPool::get();
    let most = match settings.max_tasks {
        0 => 3 * pool.thread_num().max(1),
        n => n as usize,
    };
    let free = most.saturating_sub(streaming.tasks_in_flight());
    if free == 0 {
        return;
    }
    let mut waiting: Vec<_> = streaming.slots.iter_mut().filter(|(_, s)| s.needs_work()).collect();
    waiting.sort_by(|a, b| a.1.priority.total_cmp(&b.1.priority).then(a.0.cmp(b.0)));
    for (coord, slot) in waiting.into_iter().take(free) {
        let order = Order {
            maker: maker.clone(),
            coord: *coord,
            detail: slot.want,
            with_meshes: streaming.with_meshes,
            keep_meshes: settings.keep_meshes,
            cancel: Cancel::new(),
        };
        let cancel = order.cancel.clone();
        slot.job = Some(Job { cancel, task: pool.spawn(async move { order.run() }) });
    }
}
