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
mod schedule;
mod source;
mod streaming;

pub use anchor::{AnchorMotion, StreamAnchor};
pub use appearance::{ChunkPart, SprawlMaterials};
pub use assets::{AssetRejected, PatchSetLoader, SprawlFolder, StyleLoader};
pub use chunk::{ChunkData, ChunkDetail, ChunkFailed, ChunkReady, ChunkStatus, ChunkUnloaded};
pub use diagnostics::{
    DIAGNOSTIC_APPLY_MS, DIAGNOSTIC_CHUNKS_LOADED, DIAGNOSTIC_CHUNKS_MADE, DIAGNOSTIC_MAIN_THREAD_MS,
    DIAGNOSTIC_TASKS_IN_FLIGHT, SprawlStats,
};
pub use gizmos::SprawlGizmos;
pub use origin::{OriginSettings, OriginShifted, ShiftsWithOrigin, SprawlOrigin};
pub use param::{SpawnPoint, Sprawl};
pub use schedule::SprawlSystems;
pub use source::{SprawlSource, SprawlWorld, WorldChanged, WorldRejected};
pub use streaming::StreamSettings;

use crate::region::Edits;
use crate::space::Seed;
use crate::world::{Settings, WorldAssets};
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
        let (settings, edits) = (self.settings.clone(), self.edits.clone());
        app.insert_resource(SprawlSource { seed: self.seed, settings, assets, edits })
            .insert_resource(SprawlOrigin::near(self.start, self.settings.chunk_size))
            .insert_resource(self.streaming.clone())
            .add_plugins((
                schedule::SchedulePlugin,
                chunk::ChunkPlugin,
                anchor::AnchorPlugin,
                origin::OriginPlugin,
                streaming::StreamingPlugin,
                appearance::AppearancePlugin,
                source::SourcePlugin { wait_for_assets: folder.is_some() },
                assets::AssetsPlugin { folder },
                diagnostics::DiagnosticsPlugin,
                gizmos::GizmosPlugin,
            ));
    }
}
