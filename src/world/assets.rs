//! Styles and patch sets by name.

use super::error::WorldError;
use crate::layer::{FileError, read_text, ron_files};
use crate::patch::PatchSet;
use crate::style::Style;
use crate::world::Settings;
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
    /// The files of the styles that were read from one, by name.
    style_files: BTreeMap<String, AssetFile<Style>>,
    /// The files of the patch sets that were read from one, by name.
    set_files: BTreeMap<String, AssetFile<PatchSet>>,
}

/// A file that an asset was read from.
#[derive(Clone, Debug)]
struct AssetFile<T> {
    name: String,
    text: Arc<str>,
    asset: Arc<T>,
}

impl<T> AssetFile<T> {
    fn new(file: &str, text: &str, asset: &Arc<T>) -> Self {
        Self { name: file.to_owned(), text: text.into(), asset: asset.clone() }
    }

    /// The file of the asset of this name, if that is still the one that was read.
    fn of<'a>(files: &'a BTreeMap<String, Self>, assets: &BTreeMap<String, Arc<T>>, name: &str) -> Option<&'a Self> {
        files.get(name).filter(|file| assets.get(name).is_some_and(|asset| Arc::ptr_eq(asset, &file.asset)))
    }
}

macro_rules! bundled {
    ($($file:literal),* $(,)?) => { [$(($file, include_str!(concat!("../../assets/", $file)))),*] };
}

/// Larger files of assets are refused, in bytes.
const LARGEST_FILE: u64 = 64 << 20;

/// The styles that come with the crate.
const STYLES: [(&str, &str); 9] = bundled![
    "styles/european.ron",
    "styles/grid.ron",
    "styles/hillside.ron",
    "styles/industrial.ron",
    "styles/organic.ron",
    "styles/patchwork.ron",
    "styles/radial.ron",
    "styles/suburb.ron",
    "styles/village.ron",
];
/// The patch sets that come with the crate.
const PATCH_SETS: [(&str, &str); 8] = bundled![
    "patches/common.ron",
    "patches/european.ron",
    "patches/grid.ron",
    "patches/industrial.ron",
    "patches/organic.ron",
    "patches/patchwork.ron",
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

    /// Reads the `*.ron` files under `styles/` and `patches/` in a folder, without hidden files and locks of editors. Styles that
    /// name no patch set need no folder `patches/`.
    ///
    /// # Errors
    ///
    /// If a folder or a file in it cannot be read, or if a file has a mistake: then with line and column.
    pub fn from_dir(dir: &Path) -> Result<Self, FileError> {
        let mut out = Self::default();
        for folder in ["styles", "patches"] {
            if folder == "patches" && !dir.join(folder).exists() {
                continue;
            }
            for file in ron_files(&dir.join(folder))? {
                out.add(&file.to_string_lossy(), &read_text(&file, LARGEST_FILE)?)?;
            }
        }
        Ok(out)
    }

    /// Reads the text of a style if `file` lies in a folder `styles`, otherwise of a patch set. It replaces a style or set of the
    /// same name. On an error, which has line and column, nothing changes.
    pub fn add(&mut self, file: &str, text: &str) -> Result<(), FileError> {
        let folder = Path::new(file).parent().and_then(Path::file_name);
        if folder.is_some_and(|f| f == "styles") {
            let style = Arc::new(Style::from_ron(file, text)?);
            self.style_files.insert(style.name.clone(), AssetFile::new(file, text, &style));
            self.styles.insert(style.name.clone(), style);
        } else {
            let set = Arc::new(PatchSet::from_ron(file, text)?);
            self.set_files.insert(set.name.clone(), AssetFile::new(file, text, &set));
            self.patch_sets.insert(set.name.clone(), set);
        }
        Ok(())
    }

    /// The error of a world at its place in the file of a style. `None` where no style is at fault, or it is of no file.
    pub fn locate(&self, error: &WorldError) -> Option<FileError> {
        let file = AssetFile::of(&self.style_files, &self.styles, error.style()?)?;
        Some(error.in_style(&file.asset, &file.name, &file.text))
    }

    /// The file that a style was read from, and its content.
    pub(super) fn style_file(&self, style: &str) -> Option<(&str, &str)> {
        AssetFile::of(&self.style_files, &self.styles, style).map(|file| (&*file.name, &*file.text))
    }

    /// The file that a patch set was read from, and its content.
    pub(super) fn set_file(&self, set: &str) -> Option<(&str, &str)> {
        AssetFile::of(&self.set_files, &self.patch_sets, set).map(|file| (&*file.name, &*file.text))
    }

    /// Checks that all named styles, patch sets and patches exist, and that the tags of every style leave it patches.
    pub(super) fn check(&self, settings: &Settings) -> Result<(), WorldError> {
        if let Some(style) = settings.settlements.style_names().find(|s| !self.styles.contains_key(*s)) {
            return Err(WorldError::MissingStyle { style: style.to_owned(), known: names(&self.styles) });
        }
        self.check_styles()
    }

    /// Checks that the patch sets and patches that styles name exist, and that the tags of every style leave it patches.
    ///
    /// # Errors
    ///
    /// What the first such style names in vain; [`locate`](Self::locate) finds its place.
    pub fn check_styles(&self) -> Result<(), WorldError> {
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

/// The names of all assets of a kind, for people.
fn names<T>(assets: &BTreeMap<String, T>) -> String {
    assets.keys().cloned().collect::<Vec<_>>().join(", ")
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
    fn a_folder_without_patches_serves_styles_that_name_none() {
        let dir = std::env::temp_dir().join(format!("bevy-sprawl-no-patches-{}", std::process::id()));
        std::fs::create_dir_all(dir.join("styles")).unwrap();
        std::fs::write(dir.join("styles/bare.ron"), "(patch_sets: [])").unwrap();
        let assets = WorldAssets::from_dir(&dir).unwrap();
        std::fs::remove_dir_all(dir.join("styles")).unwrap();
        let missing = WorldAssets::from_dir(&dir);
        std::fs::remove_dir_all(&dir).unwrap();
        assert_eq!(assets.styles.keys().collect::<Vec<_>>(), ["bare"]);
        assert!(assets.patch_sets.is_empty() && missing.is_err());
    }

    #[test]
    fn what_is_missing_is_named_in_the_file_that_names_it() {
        let text = "(\n  // fringe, exclude: \"forest\" \"wooden\"\n  patch_sets: [\"common\", \"grid\"],\n  FIELD\n)";
        for (field, expected) in [
            (
                "fringe: (style: \"forest\", begins: 0.5, complete: 0.8),",
                ":4:12: style `mine` names the style `forest` for its fringe",
            ),
            ("patches: [(patch: \"barn\")],", ":4:13: style `mine` counts the patch `barn`"),
            ("allow: [\"typo\"],", ":4:3: style `mine` has no patch left"),
            ("exclude: [\"straight\", \"curved\"],", ":4:3: style `mine` has no patch left"),
        ] {
            let mut assets = WorldAssets::bundled();
            assets.add("my/styles/mine.ron", &text.replace("FIELD", field)).unwrap();
            let error = assets.check(&Settings::default()).unwrap_err();
            let found = assets.locate(&error).unwrap().to_string();
            assert!(found.starts_with(&format!("my/styles/mine.ron{expected}")), "{found}");
            // A style that is not the one of the file has no place there.
            let other = Arc::new((*assets.styles["mine"]).clone());
            assets.styles.insert("mine".into(), other);
            assert_eq!(assets.locate(&error), None);
        }
        let mut assets = WorldAssets::bundled();
        assets.add("styles/mine.ron", &text.replace("\"grid\"", "\"wooden\"").replace("FIELD", "")).unwrap();
        let error = assets.check(&Settings::default()).unwrap_err();
        let found = assets.locate(&error).unwrap().to_string();
        assert!(found.starts_with("styles/mine.ron:3:26: style `mine` names the patch set `wooden`"), "{found}");
        // Settings are at fault for what they say, not for what they leave as it is.
        let cities = "  settlements: (styles: (city: [(\"grid\", 1), (\"roman\", 2)],";
        let text = &format!("(\n{cities} town: [(\"grid\", 1)], village: [(\"grid\", 1)])),\n)");
        let settings = Settings::from_ron("s.ron", text).unwrap();
        let error = WorldAssets::bundled().check(&settings).unwrap_err();
        let found = error.in_settings(&settings, "s.ron", text).unwrap().to_string();
        assert!(found.starts_with("s.ron:2:46: settings name the style `roman`"), "{found}");
        let missing = WorldAssets::default().check(&Settings::default()).unwrap_err();
        assert_eq!(missing.in_settings(&Settings::default(), "s.ron", "()"), None);
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
