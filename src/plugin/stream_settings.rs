//! How chunks and tiles of the horizon are streamed.

use bevy::prelude::*;

/// How chunks and tiles of the horizon are streamed.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct StreamSettings {
    /// Most chunks and tiles that are made at a time. 0 means three for each thread of Bevy's `AsyncComputeTaskPool`, and one on the
    /// web, where tasks run on the main thread.
    pub max_tasks: u32,
    /// Milliseconds per frame for giving finished chunks and tiles to their entities and for removing unwanted ones. At least one
    /// is applied in each frame, however long it takes.
    pub apply_ms: f32,
    /// Most chunks and tiles that are applied in a frame; 0 counts as 1.
    pub applies_per_frame: u32,
    /// Most chunks and pieces of tiles that are removed in a frame; 0 counts as 1.
    pub removals_per_frame: u32,
    /// Seconds to look ahead: chunks are also loaded around the places that the anchors will reach by then, at most half a
    /// load radius away. A negative value counts as 0.
    pub lookahead_s: f32,
    /// Keeps vertices in main memory after they have gone to the GPU, for games that read meshes back. This needs about
    /// twice the memory. Colliders do not need it.
    pub keep_meshes: bool,
    /// Gives meshes texture coordinates in metres, for materials with textures. A vertex takes 24 bytes without and 32 with them.
    pub texture_coordinates: bool,
    /// Gives chunks in full detail a [`ChunkCollision`](crate::plugin::ChunkCollision), also where nothing is drawn. It is made in the
    /// task of the chunk.
    pub collision: bool,
}

impl Default for StreamSettings {
    fn default() -> Self {
        Self {
            max_tasks: 0,
            apply_ms: 0.5,
            applies_per_frame: 4,
            removals_per_frame: 4,
            lookahead_s: 4.0,
            keep_meshes: false,
            texture_coordinates: false,
            collision: false,
        }
    }
}
