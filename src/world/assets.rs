//! Styles and patch sets by name.

use crate::edits::RejectedEdit;
use crate::layer::{FileError, RangeError, decode_text, read_file};
use crate::patch::PatchSet;
use crate::style::Style;
use crate::world::Settings;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Why a world cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorldError {
    /// A setting is outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The settings name a style that the assets lack.
    #[error("settings name the style `{style}`, which is not among the styles: {known}")]
    MissingStyle {
        /// Name of the style.
        style: String,
        /// Names of the styles that the assets have.
        known: String,
    },
    /// A style names a style for its fringe that the assets lack.
    #[error("style `{style}` names the style `{fringe}` for its fringe, which is not among the styles: {known}")]
    MissingFringe {
        /// Name of the style.
        style: String,
        /// Name of the fringe's style.
        fringe: String,
        /// Names of the styles that the assets have.
        known: String,
    },
    /// A style limits how often a patch stands that none of its sets has.
    #[error("style `{style}` counts the patch `{patch}`, which none of its patch sets has")]
    MissingPatch {
        /// Name of the style.
        style: String,
        /// Name of the patch.
        patch: String,
    },
    /// A style names a patch set that the assets lack.
    #[error("style `{style}` names the patch set `{set}`, which is not among the patch sets: {known}")]
    MissingPatchSet {
        /// Name of the style.
        style: String,
        /// Name of the patch set.
        set: String,
        /// Names of the patch sets that the assets have.
        known: String,
    },
    /// A defect of the generator, in one line. Only the plugin reports it; elsewhere a defect panics.
    #[error("{0}")]
    Defect(String),
    /// An edit is outside its range.
    #[error(transparent)]
    Edit(#[from] RejectedEdit),
    /// A style's tags leave it without any patch.
    #[error(
        "style `{style}` has no patch left: its allowed and excluded tags rule out all {patches} patches of its sets"
    )]
    NoPatches {
        /// Name of the style.
        style: String,
        /// Number of patches in its sets.
        patches: usize,
    },
}

/// The styles and patch sets that a world is made from, by name.
#[derive(Clone, Debug, Default)]
pub struct WorldAssets {
    /// Styles by name.
    pub styles: BTreeMap<String, Arc<Style>>,
    /// Patch sets by name.
    pub patch_sets: BTreeMap<String, Arc<PatchSet>>,
}

macro_rules! bundled {
    ($($file:literal),* $(,)?) => { [$(($file, include_str!(concat!("../../assets/", $file)))),*] };
}

/// Larger files of assets are refused, in bytes.
const LARGEST_FILE: u64 = 64 << 20;

/// The styles that come with the crate.
const STYLES: [(&str, &str); 8] = bundled![
    "styles/european.ron",
    "styles/grid.ron",
    "styles/hillside.ron",
    "styles/industrial.ron",
    "styles/organic.ron",
    "styles/radial.ron",
    "styles/suburb.ron",
    "styles/village.ron",
];
/// The patch sets that come with the crate.
const PATCH_SETS: [(&str, &str); 7] = bundled![
    "patches/common.ron",
    "patches/european.ron",
    "patches/grid.ron",
    "patches/industrial.ron",
    "patches/organic.ron",
    "patches/suburb.ron",
    "patches/village.ron",
];

impl WorldAssets {
    /// The styles and patch sets that come with the crate.
    pub fn bundled() -> Self {
        let mut out = Self::default();
        for (file, text) in STYLES.into_iter().chain(PATCH_SETS) {
            out.add(file, text).expect("the bundled files are checked by tests");
        }
        out
    }

    /// Reads the `*.ron` files under `styles/` and `patches/` in a folder.
    ///
    /// # Errors
    ///
    /// If either folder or a file in it cannot be read, or if a file has a mistake: then with line and column.
    pub fn from_dir(dir: &Path) -> Result<Self, FileError> {
        let mut out = Self::default();
        for folder in ["styles", "patches"] {
            let folder = dir.join(folder);
            let unreadable = |e: std::io::Error| FileError::unreadable(folder.to_string_lossy(), e);
            let entries = std::fs::read_dir(&folder).map_err(unreadable)?;
            let mut files = entries.map(|e| e.map(|e| e.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
            files.retain(|f| f.extension().is_some_and(|e| e == "ron"));
            files.sort();
            for file in files {
                let name = file.to_string_lossy();
                let content = read_file(&file, LARGEST_FILE)?;
                out.add(&name, decode_text(&name, &content)?)?;
            }
        }
        Ok(out)
    }

    /// Reads the text of a style if `file` lies in a folder `styles`, otherwise of a patch set. It replaces a style or set of the
    /// same name. On an error, which has line and column, nothing changes.
    pub fn add(&mut self, file: &str, text: &str) -> Result<(), FileError> {
        let folder = Path::new(file).parent().and_then(Path::file_name);
        if folder.is_some_and(|f| f == "styles") {
            let style = Style::from_ron(file, text)?;
            self.styles.insert(style.name.clone(), Arc::new(style));
        } else {
            let set = PatchSet::from_ron(file, text)?;
            self.patch_sets.insert(set.name.clone(), Arc::new(set));
        }
        Ok(())
    }

    /// Checks that all named styles, patch sets and patches exist, and that the tags of every style leave it patches.
    pub(super) fn check(&self, settings: &Settings) -> Result<(), WorldError> {
        fn names<T>(map: &BTreeMap<String, T>) -> String {
            map.keys().cloned().collect::<Vec<_>>().join(", ")
        }
        if let Some(style) = settings.settlements.style_names().find(|s| !self.styles.contains_key(*s)) {
            return Err(WorldError::MissingStyle { style: style.to_owned(), known: names(&self.styles) });
        }
        self.styles.iter().try_for_each(|(name, style)| {
            let find = |set: &String| {
                self.patch_sets.get(set).cloned().ok_or_else(|| WorldError::MissingPatchSet {
                    style: name.clone(),
                    set: set.clone(),
                    known: names(&self.patch_sets),
                })
            };
            let sets = style.patch_sets.iter().map(find).collect::<Result<Vec<_>, _>>()?;
            let of = sets.iter().map(|s| s.patches.len()).sum();
            let known = |patch: &String| sets.iter().any(|s| s.patches.iter().any(|p| p.name == *patch));
            if let Some(count) = style.patches.iter().find(|c| !known(&c.patch)) {
                return Err(WorldError::MissingPatch { style: name.clone(), patch: count.patch.clone() });
            }
            if let Some(fringe) = style.fringe.as_ref().filter(|f| !self.styles.contains_key(&f.style)) {
                let (fringe, known) = (fringe.style.clone(), names(&self.styles));
                return Err(WorldError::MissingFringe { style: name.clone(), fringe, known });
            }
            if of > 0 && !sets.iter().flat_map(|s| &s.patches).any(|p| p.is_allowed(&style.allow, &style.exclude)) {
                return Err(WorldError::NoPatches { style: name.clone(), patches: of });
            }
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bundled_assets_make_a_world() {
        let assets = WorldAssets::bundled();
        assert!(assets.check(&Settings::default()).is_ok());
        assert!(assets.patch_sets.values().map(|s| s.patches.len()).sum::<usize>() >= 30);
    }

    #[test]
    fn what_is_missing_is_named() {
        let mut assets = WorldAssets::bundled();
        assets.patch_sets.remove("common");
        let error = assets.check(&Settings::default()).unwrap_err();
        assert!(error.to_string().contains("`common`"), "{error}");
        assets.styles.clear();
        assert!(matches!(assets.check(&Settings::default()), Err(WorldError::MissingStyle { .. })));
    }
}
