//! Styles and patch sets by name.

use crate::layer::FileError;
use crate::patch::PatchSet;
use crate::town::Style;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// The styles and patch sets that a world is made from, by name.
#[derive(Clone, Debug, Default)]
pub struct WorldAssets {
    /// Styles by name.
    pub styles: BTreeMap<String, Arc<Style>>,
    /// Patch sets by name.
    pub patch_sets: BTreeMap<String, Arc<PatchSet>>,
}

impl WorldAssets {
    /// The styles and patch sets that come with the crate.
    pub fn bundled() -> Self {
        todo!()
    }

    /// The `*.ron` files under `styles/` and `patches/` in a folder.
    pub fn from_dir(_dir: &Path) -> Result<Self, FileError> {
        todo!()
    }
}
