//! The inputs of the world, and the world that is streamed.

use crate::edits::Edits;
use crate::layer::FileError;
use crate::world::{Settings, World, WorldError, WorldSource};
use bevy::prelude::{App, Deref, DerefMut, Event, Message, Plugin, Resource};

/// The inputs of the world. A game may change them at any time: the plugin makes the next world in the background, and
/// replaces the chunks that differ one by one. A change of the chunk size unloads every chunk.
///
/// The world is made without the edits that it cannot fulfil; they are reported by [`EditRejected`](super::EditRejected).
#[derive(Resource, Clone, Debug, Deref, DerefMut)]
pub struct SprawlSource(pub WorldSource);

/// The world that is streamed.
#[derive(Resource, Default)]
pub struct SprawlWorld {
    world: Option<World>,
    revision: u32,
}

impl SprawlWorld {
    /// The generator. `None` until it has been made: assets from a folder and edits from a file are loaded first.
    pub fn get(&self) -> Option<&World> {
        self.world.as_ref()
    }

    /// The number of worlds so far. It grows when anything in the [`SprawlSource`] has changed.
    pub fn revision(&self) -> u32 {
        self.revision
    }

    /// Puts the next world in the place of this one.
    pub(super) fn replace(&mut self, world: World) {
        self.world = Some(world);
        self.revision += 1;
    }
}

/// There is a new world, or the first one. Sent as a message and as an event, before the chunks of that world are loaded.
#[derive(Message, Event, Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorldChanged {
    /// [`SprawlWorld::revision`].
    pub revision: u32,
}

/// No world can be made from the [`SprawlSource`], and the last world stays. Sent as a message and as an event.
#[derive(Message, Event, Clone, Debug, PartialEq)]
pub struct WorldRejected {
    /// What is wrong with the source.
    pub error: WorldError,
    /// Where the error is written, if it is in a file of [`AssetOrigin::Folder`](super::AssetOrigin::Folder).
    pub place: Option<FileError>,
}

/// After a [`WorldRejected`], a world can be made from the [`SprawlSource`] again. Sent as a message and as an event.
#[derive(Message, Event, Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorldMended {
    /// [`SprawlWorld::revision`]. It has not changed if the source is again the source of the current world.
    pub revision: u32,
}

/// The files that have to be loaded before the first world is made.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(super) struct AwaitedFiles {
    /// Styles and patch sets from a folder.
    pub assets: bool,
    /// Edits from a file.
    pub edits: bool,
}

impl AwaitedFiles {
    /// Whether anything is still awaited.
    pub fn any(self) -> bool {
        self.assets || self.edits
    }
}

pub(super) struct SourcePlugin {
    pub source: WorldSource,
    pub awaited: AwaitedFiles,
}

impl Plugin for SourcePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Settings>()
            .register_type::<Edits>()
            .insert_resource(SprawlSource(self.source.clone()))
            .insert_resource(self.awaited)
            .init_resource::<SprawlWorld>()
            .add_message::<WorldChanged>()
            .add_message::<WorldRejected>()
            .add_message::<WorldMended>();
    }
}
