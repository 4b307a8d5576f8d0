//! Styles, patch sets and edits as Bevy assets: loaded from a folder and a file, and loaded again when a file changes.

mod edits;
mod folder;
mod loader;
mod rejection;

pub use edits::{EditsFile, EditsLoader, SprawlEdits};
pub use folder::SprawlFolder;
pub use loader::{PatchSetLoader, StyleLoader};
pub use rejection::AssetRejected;

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
        app.add_message::<AssetRejected>();
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
            .register_asset_loader(StyleLoader)
            .init_asset::<EditsFile>()
            .register_asset_loader(PatchSetLoader)
            .register_asset_loader(EditsLoader);
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
