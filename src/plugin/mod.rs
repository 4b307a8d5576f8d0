//! The Bevy plugin: streams the world around anchors as entities, with assets, messages, gizmos and diagnostics.
//!
//! Layer 10: reads chunks and meshes through [`World`](crate::world::World); padding 0. [`SprawlPlugin`] only composes
//! the small plugins of the files beside it; each can be read alone.
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
//! It needs no renderer: with `MinimalPlugins` and `AssetPlugin` the same chunks come and go, without meshes.

mod anchor;
mod appearance;
mod assets;
mod chunk;
mod diagnostics;
mod gizmos;
mod origin;
mod param;
mod rejected;
mod schedule;
mod source;
mod streaming;

pub use crate::world::TerrainSource;
pub use anchor::{AnchorMotion, StreamAnchor};
pub use appearance::{ChunkPart, SprawlMaterials};
pub use assets::{AssetRejected, EditsFile, EditsLoader, PatchSetLoader, SprawlEdits, SprawlFolder, StyleLoader};
pub use chunk::{ChunkData, ChunkDetail, ChunkFailed, ChunkReady, ChunkStatus, ChunkUnloaded};
pub use diagnostics::{
    DIAGNOSTIC_APPLY_MS, DIAGNOSTIC_CHUNKS_LOADED, DIAGNOSTIC_CHUNKS_MADE, DIAGNOSTIC_MAIN_THREAD_MS,
    DIAGNOSTIC_TASKS_IN_FLIGHT, SprawlStats,
};
pub use gizmos::SprawlGizmos;
pub use origin::{OriginSettings, OriginShifted, ShiftsWithOrigin, SprawlOrigin};
pub use param::{SpawnPoint, Sprawl};
pub use rejected::{EditRejected, RejectedEdits};
pub use schedule::SprawlSystems;
pub use source::{SprawlSource, SprawlWorld, WorldChanged, WorldRejected};
pub use streaming::StreamSettings;

use crate::edits::Edits;
use crate::space::Seed;
use crate::terrain::Terrain;
use crate::world::{Settings, WorldAssets, WorldSource};
use bevy::prelude::*;
use glam::DVec2;

/// Where the styles and patch sets of a world come from.
#[derive(Clone, Debug, Default)]
pub enum AssetOrigin {
    /// Those that come with the crate.
    #[default]
    Bundled,
    /// These.
    Given(WorldAssets),
    /// The `*.ron` files in `styles/` and `patches/` of a folder of Bevy's asset server, over the bundled ones: a file
    /// replaces the bundled style or patch set of the same name. Saved files are reloaded when Bevy watches its asset
    /// folder (its feature `file_watcher`), or on [`AssetServer::reload`].
    Folder(String),
}

/// The whole plugin. Add it after `DefaultPlugins` (or after `AssetPlugin` in an app without a renderer).
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
    /// Wishes for settlements and roads.
    pub edits: Edits,
    /// A file of Bevy's asset server that the wishes come from instead. A saved file is loaded again as those of
    /// [`AssetOrigin::Folder`] are; one with a mistake is refused ([`AssetRejected`]), and the last good one stays.
    pub edits_file: Option<String>,
    /// The ground.
    pub terrain: TerrainSource,
    /// Plan point (x east, y north, metres) that Bevy's origin starts near; it is rounded to a chunk's corner.
    pub start: DVec2,
}

impl SprawlPlugin {
    /// The world of `seed` with default settings and the bundled assets.
    pub fn new(seed: u64) -> Self {
        Self { seed: Seed(seed), ..default() }
    }

    /// The same with other settings of the generator.
    pub fn settings(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    /// The same with styles and patch sets from a folder of Bevy's asset server: [`AssetOrigin::Folder`].
    pub fn assets_from(self, folder: impl Into<String>) -> Self {
        Self { assets: AssetOrigin::Folder(folder.into()), ..self }
    }

    /// The same with wishes for settlements and roads.
    pub fn edits(self, edits: Edits) -> Self {
        Self { edits, ..self }
    }

    /// The same with wishes for settlements and roads from a file of Bevy's asset server, whose changes are followed while
    /// the game runs: `edits_from("my.edits.ron")`.
    pub fn edits_from(self, file: impl Into<String>) -> Self {
        Self { edits_file: Some(file.into()), ..self }
    }

    /// The same on a ground of your own; [`Settings::terrain`] is not used.
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
    /// // While the game runs:
    /// fn flood(mut source: bevy::prelude::ResMut<SprawlSource>) {
    ///     source.terrain = TerrainSource::own(Dunes);
    /// }
    /// ```
    pub fn terrain(self, terrain: impl Terrain) -> Self {
        Self { terrain: TerrainSource::own(terrain), ..self }
    }

    /// The same with Bevy's origin near a plan point.
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
        app.insert_resource(SprawlSource(WorldSource { seed: self.seed, settings, assets, edits, terrain }))
            .insert_resource(SprawlOrigin::near(self.start, self.settings.chunk_size))
            .insert_resource(self.streaming.clone())
            .add_plugins((
                schedule::SchedulePlugin,
                chunk::ChunkPlugin,
                anchor::AnchorPlugin,
                origin::OriginPlugin,
                streaming::StreamingPlugin,
                appearance::AppearancePlugin,
                source::SourcePlugin { hold_assets: folder.is_some(), hold_edits: self.edits_file.is_some() },
                rejected::RejectedPlugin,
                assets::AssetsPlugin { folder, edits: self.edits_file.clone() },
                diagnostics::DiagnosticsPlugin,
                gizmos::GizmosPlugin,
            ));
    }
}
