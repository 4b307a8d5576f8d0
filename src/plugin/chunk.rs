//! The entity of a chunk: its components, and the messages about its life.
//!
//! A chunk is a root entity with its meshes as children, placed at its south-west corner at height 0. Entities of a game
//! may be added as further children: they go when the chunk is unloaded.

use crate::chunk::Chunk;
use crate::mesh::Detail;
use crate::space::ChunkCoord;
use bevy::ecs::component::{Immutable, StorageType};
use bevy::prelude::*;
use bevy::reflect::impl_reflect_opaque;
use std::sync::Arc;

impl_reflect_opaque!((in bevy_sprawl::space) ChunkCoord(Component, Default, Debug, PartialEq, Hash, Clone));

/// On the entity of every chunk.
impl Component for ChunkCoord {
    const STORAGE_TYPE: StorageType = StorageType::Table;
    type Mutability = Immutable;
}

/// What is being done for a chunk.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Hash, Clone)]
pub enum ChunkStatus {
    /// It waits for its turn; there is nothing to see yet.
    #[default]
    Queued,
    /// It is being made; there is nothing to see yet.
    Building,
    /// It is there.
    Ready,
    /// It is there, and is being made again, in another detail or from changed assets. What is there stays until then.
    Refreshing,
    /// It could not be made; [`ChunkFailed`] says why. It is tried again when it is next wanted, and in the next world.
    Failed,
}

impl ChunkStatus {
    /// Whether ground, streets and buildings are there.
    pub fn is_there(self) -> bool {
        matches!(self, Self::Ready | Self::Refreshing)
    }
}

/// What a chunk is made of: streets, lots, buildings, the ground. On the entity while the chunk is there.
#[derive(Component, Clone, Debug, Deref)]
#[component(immutable)]
pub struct ChunkData(pub Arc<Chunk>);

/// Detail of the meshes that a chunk shows. On the entity while the chunk is there.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable)]
pub struct ChunkDetail(pub Detail);

/// A chunk is there. Sent as a message, and as an event on its entity, once its meshes and [`ChunkData`] are in place.
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChunkReady {
    /// Its entity.
    pub entity: Entity,
    /// Its name.
    pub coord: ChunkCoord,
    /// Detail of its meshes.
    pub detail: Detail,
    /// Whether it was not there before: false when its meshes were replaced.
    pub first: bool,
}

/// A chunk goes. The event on its entity comes while everything is still in place; the message when it is gone.
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChunkUnloaded {
    /// Its entity.
    pub entity: Entity,
    /// Its name.
    pub coord: ChunkCoord,
}

/// A chunk could not be made. Sent as a message, and as an event on its entity.
#[derive(Message, EntityEvent, Clone, Debug, PartialEq, Eq)]
pub struct ChunkFailed {
    /// Its entity.
    pub entity: Entity,
    /// Its name.
    pub coord: ChunkCoord,
    /// Why, in one line.
    pub reason: String,
}

pub(super) struct ChunkPlugin;

impl Plugin for ChunkPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(ChunkCoord, ChunkStatus)>()
            .add_message::<ChunkReady>()
            .add_message::<ChunkUnloaded>()
            .add_message::<ChunkFailed>();
    }
}
