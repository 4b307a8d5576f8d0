//! Asset loaders of styles and patch sets.
//!
//! They claim no file extension, since other crates use `.ron` too. Name the type to load a file:
//! `load::<Style>("styles/mine.ron")`.

use super::contents::FileContents;
use crate::layer::{FileError, decode_text};
use crate::patch::PatchSet;
use crate::style::Style;
use bevy::asset::io::Reader;
use bevy::asset::{Asset, AssetLoader, LoadContext, UntypedAssetId, VisitAssetDependencies};
use bevy::reflect::TypePath;

impl Asset for Style {}
impl Asset for PatchSet {}

impl VisitAssetDependencies for Style {
    fn visit_dependencies(&self, _: &mut impl FnMut(UntypedAssetId)) {}
}

impl VisitAssetDependencies for PatchSet {
    fn visit_dependencies(&self, _: &mut impl FnMut(UntypedAssetId)) {}
}

impl TypePath for Style {
    fn type_path() -> &'static str {
        "bevy_sprawl::style::Style"
    }

    fn short_type_path() -> &'static str {
        "Style"
    }
}

impl TypePath for PatchSet {
    fn type_path() -> &'static str {
        "bevy_sprawl::patch::PatchSet"
    }

    fn short_type_path() -> &'static str {
        "PatchSet"
    }
}

/// Loads a [`Style`] from RON. Its error is a [`FileError`] with line and column.
#[derive(Clone, Debug, Default, TypePath)]
pub struct StyleLoader(pub(super) FileContents);

/// Loads a [`PatchSet`] from RON. Its error is a [`FileError`] with line and column.
#[derive(Clone, Debug, Default, TypePath)]
pub struct PatchSetLoader(pub(super) FileContents);

impl AssetLoader for StyleLoader {
    type Asset = Style;
    type Settings = ();
    type Error = FileError;

    async fn load(&self, reader: &mut dyn Reader, _: &(), context: &mut LoadContext<'_>) -> Result<Style, FileError> {
        let (file, text) = read(reader, context, &self.0).await?;
        Style::from_ron(&file, &text)
    }
}

impl AssetLoader for PatchSetLoader {
    type Asset = PatchSet;
    type Settings = ();
    type Error = FileError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<PatchSet, FileError> {
        let (file, text) = read(reader, context, &self.0).await?;
        PatchSet::from_ron(&file, &text)
    }
}

/// The name and the text of the file. The content is noted in `contents`.
pub(super) async fn read(
    reader: &mut dyn Reader,
    context: &LoadContext<'_>,
    contents: &FileContents,
) -> Result<(String, String), FileError> {
    let file = context.path().to_string();
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).await.map_err(|e| FileError::unreadable(&*file, e))?;
    contents.set(&file, &bytes);
    let text = decode_text(&file, &bytes)?.to_owned();
    Ok((file, text))
}
