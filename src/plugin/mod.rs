//! The Bevy plugin: streams the world around anchors as entities, with assets, messages, gizmos and diagnostics.
//!
//! Layer 13: it takes chunks and meshes from [`World`](crate::world::World). [`SprawlPlugin`] only composes the small plugins of
//! the files beside it, and each file can be read alone:
//!
//! | file | has |
//! |---|---|
//! | `schedule`, `frame_time` | the order of all systems, and the time they take |
//! | `source`, `regenerate` | the inputs of the world; making the next world when they change |
//! | `assets`, `rejected_edits` | inputs from files |
//! | `origin`, `anchor`, `shift` | coordinates, the anchors that the world is streamed around, moving the origin |
//! | `chunk`, `appearance`, `material`, `collision`, `stream_settings`, `streaming` | the entities of chunks and of the horizon, their meshes, materials, textures and colliders, how they come and go |
//! | `queries`, `task`, `spawn_point`, `start` | questions of games to the world |
//! | `diagnostics`, `gizmos` | figures and debug lines |
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_sprawl::prelude::*;
//!
//! fn main() {
//!     App::new().add_plugins((DefaultPlugins, SprawlPlugin::new(42))).add_systems(Startup, setup).run();
//! }
//!
//! fn setup(mut commands: Commands) {
//!     commands.spawn((Camera3d::default(), StreamAnchor::default()));
//!     commands.spawn(DirectionalLight::default());
//! }
//! ```
//!
//! The plugin needs no renderer: with `MinimalPlugins` and `AssetPlugin` the same chunks come and go, without meshes.

mod anchor;
mod appearance;
mod assets;
mod chunk;
mod collision;
mod diagnostics;
mod frame_time;
mod gizmos;
mod material;
mod origin;
mod queries;
mod regenerate;
mod rejected_edits;
mod schedule;
mod shift;
mod source;
mod spawn_point;
mod start;
mod stream_settings;
mod streaming;
mod task;

pub use crate::mesh::HorizonTile;
pub use crate::world::TerrainSource;
pub use anchor::{AnchorMotion, StartOnStreet, StreamAnchor};
pub use appearance::{ChunkPart, SprawlMaterials};
pub use assets::{
    AssetMended, AssetRejected, EditsFile, EditsLoader, PatchSetLoader, SprawlEdits, SprawlFolder, StyleLoader,
};
pub use chunk::{ChunkChange, ChunkData, ChunkDetail, ChunkFailed, ChunkReady, ChunkStatus, ChunkUnloaded};
pub use collision::ChunkCollision;
pub use diagnostics::{
    DIAGNOSTIC_APPLY_MS, DIAGNOSTIC_CHUNKS_LOADED, DIAGNOSTIC_CHUNKS_MADE, DIAGNOSTIC_MAIN_THREAD_MS,
    DIAGNOSTIC_TASKS_IN_FLIGHT, DIAGNOSTIC_TILES_LOADED, DIAGNOSTIC_TILES_MADE, SprawlStats,
};
pub use gizmos::SprawlGizmos;
pub use material::{SprawlMaterial, SprawlTextures, SurfaceTextures};
pub use origin::SprawlOrigin;
pub use queries::Sprawl;
pub use rejected_edits::{EditRejected, RejectedEdits};
pub use schedule::SprawlSystems;
pub use shift::{OriginSettings, OriginShifted, ShiftsWithOrigin};
pub use source::{SprawlSource, SprawlWorld, WorldChanged, WorldMended, WorldRejected};
pub use spawn_point::SpawnPoint;
pub use stream_settings::StreamSettings;
pub use task::{NoAnswer, SprawlTask};

use crate::edits::Edits;
use crate::space::Seed;
use crate::terrain::Terrain;
use crate::world::{Settings, WorldAssets, WorldSource};
use bevy::prelude::*;
use glam::DVec2;
use source::AwaitedFiles;

/// Where the styles and patch sets of a world come from.
#[derive(Clone, Debug, Default)]
pub enum AssetOrigin {
    /// The files that come with the crate.
    #[default]
    Bundled,
    /// Values that a game gives.
    Given(WorldAssets),
    /// The `*.ron` files in `styles/` and `patches/` of a folder of Bevy's asset server. A file replaces the bundled style
    /// or patch set of the same name; the other bundled ones stay. Saved files are loaded again when Bevy watches its
    /// asset folder (its feature `file_watcher`), or on [`AssetServer::reload`].
    Folder(String),
}

/// The whole plugin. Add it after `DefaultPlugins`, or after `AssetPlugin` in an app without a renderer.
#[derive(Clone, Debug, Default)]
pub struct SprawlPlugin {
    /// The seed of the world.
    pub seed: Seed,
    /// Settings of the generator.
    pub settings: Settings,
    /// Settings of the streaming.
    pub streaming: StreamSettings,
    /// Styles and patch sets.
    pub assets: AssetOrigin,
    /// Wishes for settlements, roads and patches.
    pub edits: Edits,
    /// A file of Bevy's asset server that the wishes come from instead of `edits`. A saved file is loaded again like the files of
    /// [`AssetOrigin::Folder`]. A file with a mistake is refused ([`AssetRejected`]), and its last good version stays.
    pub edits_file: Option<String>,
    /// The ground.
    pub terrain: TerrainSource,
    /// The plan point (x east, y north, metres) that Bevy's origin begins near. It is rounded to the corner of a chunk.
    pub start: DVec2,
}

impl SprawlPlugin {
    /// The world of `seed` with default settings and the bundled assets.
    pub fn new(seed: u64) -> Self {
        Self { seed: Seed(seed), ..default() }
    }

    /// Sets the settings of the generator.
    pub fn settings(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    /// Takes styles and patch sets from a folder of Bevy's asset server: [`AssetOrigin::Folder`].
    pub fn assets_from(self, folder: impl Into<String>) -> Self {
        Self { assets: AssetOrigin::Folder(folder.into()), ..self }
    }

    /// Sets the wishes for settlements, roads and patches.
    pub fn edits(self, edits: Edits) -> Self {
        Self { edits, ..self }
    }

    /// Takes the wishes for settlements, roads and patches from a file of Bevy's asset server:
    /// `edits_from("my.edits.ron")`. Changes of the file are followed while the game runs.
    pub fn edits_from(self, file: impl Into<String>) -> Self {
        Self { edits_file: Some(file.into()), ..self }
    }

    /// Sets a ground of the game's own; [`Settings::terrain`] is not used.
    ///
    /// ```
    /// use bevy_sprawl::prelude::*;
    /// use bevy_sprawl::terrain::{Terrain, TerrainSample};
    ///
    /// struct Dunes;
    ///
    /// impl Terrain for Dunes {
    ///     fn sample(&self, p: glam::DVec2) -> TerrainSample {
    ///         let height = 20.0 + 8.0 * libm::sin(p.x / 900.0) * libm::sin(p.y / 700.0);
    ///         TerrainSample { height, water_level: 0.0, vegetation: 0.1 }
    ///     }
    /// }
    ///
    /// let plugin = SprawlPlugin::new(7).terrain(Dunes);
    /// # let mut app = bevy::prelude::App::new();
    /// # app.add_plugins((bevy::prelude::MinimalPlugins, bevy::prelude::AssetPlugin::default(), plugin));
    /// # let made = app.world().resource::<bevy_sprawl::plugin::SprawlWorld>().get().unwrap();
    /// # assert_eq!(made.terrain().height(glam::DVec2::ZERO), 20.0);
    /// // While the game runs, another ground makes another world:
    /// fn flood(mut source: bevy::prelude::ResMut<SprawlSource>) {
    ///     source.terrain = TerrainSource::own(Dunes);
    /// }
    /// ```
    pub fn terrain(self, terrain: impl Terrain) -> Self {
        Self { terrain: TerrainSource::own(terrain), ..self }
    }

    /// Puts Bevy's origin near a plan point (x east, y north, metres).
    pub fn starting_at(self, start: DVec2) -> Self {
        Self { start, ..self }
    }
}

impl Plugin for SprawlPlugin {
    fn build(&self, app: &mut App) {
        let (assets, folder) = match &self.assets {
            AssetOrigin::Bundled => (WorldAssets::bundled(), None),
            AssetOrigin::Given(assets) => (assets.clone(), None),
            AssetOrigin::Folder(folder) => (WorldAssets::bundled(), Some(folder.clone())),
        };
        let (settings, edits, terrain) = (self.settings.clone(), self.edits.clone(), self.terrain.clone());
        let awaited = AwaitedFiles { assets: folder.is_some(), edits: self.edits_file.is_some() };
        app.insert_resource(SprawlOrigin::near(self.start, self.settings.chunk_size)).add_plugins((
            schedule::SchedulePlugin,
            frame_time::FrameTimePlugin,
            source::SourcePlugin { source: WorldSource { seed: self.seed, settings, assets, edits, terrain }, awaited },
            assets::AssetsPlugin { folder, edits: self.edits_file.clone() },
            chunk::ChunkPlugin,
            material::SprawlMaterialPlugin,
            appearance::AppearancePlugin,
            anchor::AnchorPlugin,
            start::StartPlugin,
            shift::ShiftPlugin,
            streaming::StreamingPlugin { settings: self.streaming.clone() },
            regenerate::RegeneratePlugin,
            rejected_edits::RejectedEditsPlugin,
            diagnostics::DiagnosticsPlugin,
            gizmos::GizmosPlugin,
        ));
    }
}
