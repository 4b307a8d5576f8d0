//! The entity of a chunk: its components, and the messages about its life.
//!
//! A chunk is a root entity at its south-west corner and height 0, with its meshes as children. A game may add further
//! children; they are despawned with the chunk.
//!
//! The land beyond the chunks is made of tiles: root entities with a [`HorizonTile`], with their meshes as children.

use crate::chunk::Chunk;
use crate::mesh::{Detail, HorizonTile};
use crate::space::ChunkCoord;
use bevy::ecs::component::{Immutable, StorageType};
use bevy::prelude::*;
use bevy::reflect::impl_reflect_opaque;
use std::sync::Arc;

impl_reflect_opaque!((in bevy_sprawl::space) ChunkCoord(Component, Default, Debug, PartialEq, Hash, Clone));

/// The name of a chunk. Every chunk entity has it.
impl Component for ChunkCoord {
    const STORAGE_TYPE: StorageType = StorageType::Table;
    type Mutability = Immutable;
}

/// The name of a tile of the horizon. Each root entity of the land beyond the chunks has it, hidden or not.
impl Component for HorizonTile {
    const STORAGE_TYPE: StorageType = StorageType::Table;
    type Mutability = Immutable;
}

/// Whether a chunk waits, is being made, is loaded or has failed.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Hash, Clone)]
pub enum ChunkStatus {
    /// It waits for its turn. It shows nothing yet.
    #[default]
    Queued,
    /// It is being made. It shows nothing yet.
    Building,
    /// It is loaded.
    Ready,
    /// It is loaded and being made again, in another detail or from changed inputs. It shows its old state until then.
    Refreshing,
    /// It could not be made; [`ChunkFailed`] says why. It is tried again when it comes back into reach, and in the next
    /// world.
    Failed,
}

impl ChunkStatus {
    /// Whether the chunk is loaded: its ground, streets and buildings are there.
    pub fn is_there(self) -> bool {
        matches!(self, Self::Ready | Self::Refreshing)
    }
}

/// The content of a chunk: streets, lots, buildings, the ground. The entity has it while the chunk is loaded.
#[derive(Component, Clone, Debug, Deref)]
#[component(immutable)]
pub struct ChunkData(pub Arc<Chunk>);

/// The detail of the meshes that a chunk shows. The entity has it while the chunk is loaded.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable)]
pub struct ChunkDetail(pub Detail);

/// A chunk has been loaded, or made again. Sent as a message, and as an event on its entity, once its meshes and
/// [`ChunkData`] are in place.
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChunkReady {
    /// The entity of the chunk.
    pub entity: Entity,
    /// The name of the chunk.
    pub coord: ChunkCoord,
    /// The detail of its meshes.
    pub detail: Detail,
    /// What has changed.
    pub change: ChunkChange,
}

/// What has changed about a chunk that is ready.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Reflect)]
pub enum ChunkChange {
    /// It was not loaded before.
    Loaded,
    /// It comes from a new world: its [`ChunkData`] and its meshes have been replaced.
    Data,
    /// Only the detail of its meshes has changed; [`ChunkData`] has stayed.
    Detail,
}

impl ChunkChange {
    /// Whether [`ChunkData`] is new: a game that places its own things in chunks places them now.
    pub fn is_data(self) -> bool {
        matches!(self, Self::Loaded | Self::Data)
    }
}

/// A loaded chunk is unloaded: it is no longer wanted, or the game has despawned it. Sent as a message, and as an event on
/// its entity. A chunk that was still waiting for its first data goes without notice.
///
/// The event comes while everything is still in place, unless the game has despawned the entity. The message comes once
/// the entity is gone.
#[derive(Message, EntityEvent, Clone, Debug)]
pub struct ChunkUnloaded {
    /// The entity of the chunk.
    pub entity: Entity,
    /// The name of the chunk.
    pub coord: ChunkCoord,
    /// The content that the chunk had.
    pub data: ChunkData,
}

/// A chunk could not be made. Sent as a message, and as an event on its entity.
#[derive(Message, EntityEvent, Clone, Debug, PartialEq, Eq)]
pub struct ChunkFailed {
    /// The entity of the chunk.
    pub entity: Entity,
    /// The name of the chunk.
    pub coord: ChunkCoord,
    /// Why, in one line.
    pub reason: String,
}

pub(super) struct ChunkPlugin;

impl Plugin for ChunkPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(ChunkCoord, ChunkStatus, ChunkChange, HorizonTile)>()
            .register_type_data::<HorizonTile, ReflectComponent>()
            .add_message::<ChunkReady>()
            .add_message::<ChunkUnloaded>()
            .add_message::<ChunkFailed>();
    }
}
