//! Styles and patch sets as Bevy assets, loaded from a folder and reloaded when a file changes.

mod folder;
mod loader;

pub use folder::{AssetRejected, SprawlFolder};
pub use loader::{PatchSetLoader, StyleLoader};

use super::schedule::SprawlSystems;
use crate::patch::PatchSet;
use crate::town::Style;
use bevy::prelude::*;

pub(super) struct AssetsPlugin {
    /// Folder of the asset server that styles and patch sets are loaded from.
    pub folder: Option<String>,
}

impl Plugin for AssetsPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<AssetRejected>();
        if !app.world().contains_resource::<AssetServer>() {
            if self.folder.is_some() {
                error!(
                    "SprawlPlugin loads assets from a folder, so it must be added after AssetPlugin; the bundled are used"
                );
                app.world_mut().resource_mut::<super::source::Making>().hold = false;
            }
            return;
        }
        app.init_asset::<Style>()
            .init_asset::<PatchSet>()
            .register_asset_loader(StyleLoader)
            .register_asset_loader(PatchSetLoader);
        if let Some(folder) = &self.folder {
            app.insert_resource(SprawlFolder::new(folder)).add_systems(
                PostUpdate,
                (folder::list_files, folder::take_loaded, folder::take_failed, folder::hand_over)
                    .chain()
                    .in_set(SprawlSystems::World)
                    .before(super::source::start_making),
            );
        }
    }
}
