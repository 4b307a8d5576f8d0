//! Endless streamed worlds of towns.
//!
//! Terrain, settlements, the roads between them, main streets, local streets from example patches, blocks, lots and
//! buildings, all a pure function of a seed, settings, styles and patch sets: the same in any order, on any number of
//! threads, on any machine. [`world::World`] is the generator; with the feature `bevy`, `plugin::SprawlPlugin` streams it
//! around the player.
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `bevy` | yes | the plugin |
//! | `window` | yes | what the examples need besides: a window and an egui panel |
//! | `noise` | no | terrain from the functions of the crate `noise` |
//! | `maps` | no | real maps: OpenStreetMap and GeoJSON |
//! | `cli` | no | the `sprawl` command line, the exporters, terrain from PNG, and `maps` |
//!
//! The modules are layers, bottom to top: [`space`], [`network`], [`patch`] and [`layer`] know no other; then
//! [`terrain`], [`region`], [`town`], [`seam`], [`streets`], [`surface`], [`parcel`], [`chunk`] and [`mesh`], each reading only
//! those below it; and [`world`] over all of them. [`analysis`] measures worlds.
//!
//! The plan's axes are x east and y north in metres; angles are radians, counter-clockwise from east. In Bevy a plan point
//! is `(x, height, -y)`.

#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod analysis;
pub mod chunk;
pub mod edits;
#[cfg(feature = "cli")]
pub mod export;
pub mod layer;
#[cfg(feature = "maps")]
pub mod map;
pub mod mesh;
pub mod network;
pub mod parcel;
pub mod patch;
#[cfg(feature = "bevy")]
pub mod plugin;
pub mod region;
pub mod seam;
pub mod space;
pub mod stack;
pub mod streets;
pub mod style;
pub mod surface;
pub mod terrain;
#[cfg(test)]
mod testing;
pub mod texture;
pub mod town;
pub mod world;

/// What most programs need: with the feature `bevy` the plugin, without it the generator alone.
pub mod prelude {
    #[cfg(feature = "bevy")]
    pub use crate::plugin::{
        AssetMended, AssetOrigin, AssetRejected, ChunkChange, ChunkCollision, ChunkData, ChunkDetail, ChunkFailed,
        ChunkPart, ChunkReady, ChunkStatus, ChunkUnloaded, EditRejected, NoAnswer, OriginSettings, OriginShifted,
        RejectedEdits, ShiftsWithOrigin, SpawnPoint, Sprawl, SprawlGizmos, SprawlMaterial, SprawlMaterials,
        SprawlOrigin, SprawlPlugin, SprawlSource, SprawlStats, SprawlSystems, SprawlTask, SprawlTextures, SprawlWorld,
        StartOnStreet, StreamAnchor, StreamSettings, SurfaceTextures, TerrainSource, WorldChanged, WorldMended,
        WorldRejected,
    };
    pub use crate::space::{ChunkCoord, Origin, Seed};
}
