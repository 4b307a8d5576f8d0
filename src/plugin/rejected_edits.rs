//! Reports of edits that the world cannot fulfil.

use super::assets::SprawlEdits;
use super::frame_time::Stopwatch;
use super::schedule::WorldSystems;
use super::source::SprawlWorld;
use super::task::{BackgroundError, without_panic};
use crate::edits::RejectedEdit;
use crate::layer::{Cancel, FileError};
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};

/// An edit that the world cannot fulfil; the world is made without it. Sent as a message and as an event, and logged.
///
/// It comes a while after [`WorldChanged`](super::WorldChanged), since the roads that edits concern have to be made first.
#[derive(Message, Event, Clone, Debug, PartialEq)]
pub struct EditRejected {
    /// The edit, and why it cannot be fulfilled.
    pub edit: RejectedEdit,
    /// Where it is written, if the edits come from a file.
    pub place: Option<FileError>,
}

/// All edits that the current world cannot fulfil, in the order of the lists.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct RejectedEdits {
    /// [`SprawlWorld::revision`] of the examined world; 0 until the first world has been examined.
    pub revision: u32,
    /// The edits.
    pub edits: Vec<EditRejected>,
}

pub(super) struct RejectedEditsPlugin;

impl Plugin for RejectedEditsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<RejectedEdits>()
            .init_resource::<Examination>()
            .add_message::<EditRejected>()
            .add_systems(PostUpdate, report_rejected_edits.in_set(WorldSystems::Check));
    }
}

/// The examination of a world's edits that is under way.
#[derive(Resource, Default)]
struct Examination {
    revision: u32,
    cancel: Cancel,
    task: Option<Task<Result<Vec<RejectedEdit>, BackgroundError>>>,
}

fn report_rejected_edits(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    current: Res<SprawlWorld>,
    file: Option<Res<SprawlEdits>>,
    mut examination: ResMut<Examination>,
    mut known: ResMut<RejectedEdits>,
    mut messages: MessageWriter<EditRejected>,
) {
    let _running = stopwatch.start();
    let Some(world) = current.get() else { return };
    if examination.revision != current.revision() {
        examination.cancel.cancel();
        (examination.revision, examination.cancel) = (current.revision(), Cancel::new());
        let (world, cancel) = (world.clone(), examination.cancel.clone());
        let examine = move || match world.edits().is_empty() {
            true => Ok(Vec::new()),
            false => world.rejected_edits(&cancel),
        };
        examination.task = Some(AsyncComputeTaskPool::get().spawn(async move { without_panic(examine) }));
    }
    let Some(outcome) = examination.task.as_mut().and_then(check_ready) else { return };
    examination.task = None;
    let edits = match outcome {
        Ok(edits) => edits,
        Err(BackgroundError::Cancelled) => return,
        Err(BackgroundError::Defect(reason)) => {
            error!("the edits could not be compared with the world: {reason}");
            return;
        }
    };
    let file = file.as_ref().and_then(|f| f.file()).filter(|f| f.edits == *world.edits());
    known.revision = examination.revision;
    let places: Vec<Option<FileError>> = match file {
        Some(file) => file.locate_all(&edits).into_iter().map(Some).collect(),
        None => vec![None; edits.len()],
    };
    known.edits = edits.into_iter().zip(places).map(|(edit, place)| EditRejected { edit, place }).collect();
    for rejected in &known.edits {
        match &rejected.place {
            Some(place) => warn!("{place}"),
            None => warn!("{}", rejected.edit),
        }
        messages.write(rejected.clone());
        commands.trigger(rejected.clone());
    }
}
