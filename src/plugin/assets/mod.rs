//! Styles, patch sets and edits as Bevy assets: loaded from a folder and a file, and loaded again when a file changes.

mod contents;
mod edits;
mod folder;
mod loader;
mod rejection;
mod watch;

pub(super) use contents::FileContents;
pub use edits::{EditsFile, EditsLoader, SprawlEdits};
pub use folder::SprawlFolder;
pub use loader::{PatchSetLoader, StyleLoader};
pub use rejection::{AssetMended, AssetRejected};

use super::schedule::WorldSystems;
use super::source::AwaitedFiles;
use crate::patch::PatchSet;
use crate::style::Style;
use bevy::prelude::*;

pub(super) struct AssetsPlugin {
    /// A folder of the asset server that styles and patch sets are loaded from.
    pub folder: Option<String>,
    /// A file of the asset server that edits are loaded from.
    pub edits: Option<String>,
}

impl Plugin for AssetsPlugin {
    fn build(&self, app: &mut App) {
        let contents = FileContents::default();
        app.add_message::<AssetRejected>().add_message::<AssetMended>().insert_resource(contents.clone());
        if !app.world().contains_resource::<AssetServer>() {
            if self.folder.is_some() || self.edits.is_some() {
                error!(
                    "SprawlPlugin must be added after AssetPlugin, since it loads assets from a folder or edits from a \
                     file. It uses the bundled assets and no edits instead"
                );
                app.insert_resource(AwaitedFiles::default());
            }
            return;
        }
        app.init_asset::<Style>()
            .init_asset::<PatchSet>()
            .init_asset::<EditsFile>()
            .register_asset_loader(StyleLoader(contents.clone()))
            .register_asset_loader(PatchSetLoader(contents.clone()))
            .register_asset_loader(EditsLoader(contents));
        if self.folder.is_some() || self.edits.is_some() {
            app.init_resource::<watch::Comparison>()
                .add_systems(PostUpdate, watch::reload_changed.in_set(WorldSystems::Load));
        }
        if let Some(file) = &self.edits {
            let handle = app.world().resource::<AssetServer>().load(file.clone());
            app.insert_resource(SprawlEdits::new(handle))
                .add_systems(PostUpdate, (edits::take_edits, edits::refuse_edits).chain().in_set(WorldSystems::Load));
        }
        if let Some(folder) = &self.folder {
            app.insert_resource(SprawlFolder::new(folder)).add_systems(
                PostUpdate,
                (folder::list_files, folder::take_loaded, folder::take_failed, folder::hand_over)
                    .chain()
                    .in_set(WorldSystems::Load),
            );
        }
    }
}
