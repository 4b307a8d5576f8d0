//! Telling of edits that the world cannot fulfil.

use super::assets::SprawlEdits;
use super::schedule::SprawlSystems;
use super::source::SprawlWorld;
use crate::edits::RejectedEdit;
use crate::layer::{Cancel, FileError, LayerError};
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};

/// An edit that the world cannot fulfil; it is the one without it. Sent as a message and as an event, and logged, a while after
/// [`WorldChanged`](super::WorldChanged): finding out makes the roads that edits want.
#[derive(Message, Event, Clone, Debug, PartialEq)]
pub struct EditRejected {
    /// Which, and why.
    pub edit: RejectedEdit,
    /// Where it is written, if the edits come from a file.
    pub place: Option<FileError>,
}

/// The edits that the world of this revision cannot fulfil, in the order of the lists.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct RejectedEdits {
    /// [`SprawlWorld::revision`]; 0 while none has been looked at.
    pub revision: u32,
    /// All of them.
    pub edits: Vec<EditRejected>,
}

pub(super) struct RejectedPlugin;

impl Plugin for RejectedPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<RejectedEdits>()
            .init_resource::<Looking>()
            .add_message::<EditRejected>()
            .add_systems(PostUpdate, tell_rejected.in_set(SprawlSystems::World).after(super::source::finish_making));
    }
}

/// The look at a world's edits that is under way.
#[derive(Resource, Default)]
struct Looking {
    revision: u32,
    cancel: Cancel,
    task: Option<Task<Result<Vec<RejectedEdit>, LayerError>>>,
}

fn tell_rejected(
    mut commands: Commands,
    current: Res<SprawlWorld>,
    file: Option<Res<SprawlEdits>>,
    mut looking: ResMut<Looking>,
    mut known: ResMut<RejectedEdits>,
    mut messages: MessageWriter<EditRejected>,
) {
    let Some(world) = current.get() else { return };
    if looking.revision != current.revision() {
        looking.cancel.cancel();
        (looking.revision, looking.cancel) = (current.revision(), Cancel::new());
        let (world, cancel) = (world.clone(), looking.cancel.clone());
        let look = async move { if world.edits().is_empty() { Ok(Vec::new()) } else { world.rejected_edits(&cancel) } };
        looking.task = Some(AsyncComputeTaskPool::get().spawn(look));
    }
    let Some(found) = looking.task.as_mut().and_then(check_ready) else { return };
    looking.task = None;
    let found = match found {
        Ok(found) => found,
        Err(error) => {
            error!("it is not known which edits cannot be: {error}");
            return;
        }
    };
    let file = file.as_ref().and_then(|f| f.file()).filter(|f| f.edits == *world.edits());
    known.revision = looking.revision;
    known.edits = found.into_iter().map(|edit| EditRejected { place: file.map(|f| f.locate(&edit)), edit }).collect();
    for rejected in &known.edits {
        match &rejected.place {
            Some(place) => warn!("{place}"),
            None => warn!("{}", rejected.edit),
        }
        messages.write(rejected.clone());
        commands.trigger(rejected.clone());
    }
}
