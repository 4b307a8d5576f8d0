//! The file that edits are loaded from, and loaded again from when it is saved.

use super::AssetRejected;
use super::folder::reject;
use super::loader::read;
use crate::edits::{Edits, RejectedEdit};
use crate::layer::FileError;
use crate::plugin::source::{Making, SprawlSource};
use bevy::asset::io::Reader;
use bevy::asset::{AssetLoadFailedEvent, AssetLoader, LoadContext};
use bevy::prelude::*;

/// A file of edits as an asset: `load::<EditsFile>("my.edits.ron")`.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct EditsFile {
    /// What it says.
    pub edits: Edits,
    file: String,
    text: String,
}

impl EditsFile {
    /// Reads and checks edits from RON text; `file` is named in errors.
    pub fn from_ron(file: impl Into<String>, text: impl Into<String>) -> Result<Self, FileError> {
        let (file, text) = (file.into(), text.into());
        Ok(Self { edits: Edits::from_ron(&file, &text)?, file, text })
    }

    /// An edit of it that a world cannot fulfil, with its line and column.
    pub fn locate(&self, rejected: &RejectedEdit) -> FileError {
        rejected.in_file(&self.file, &self.text)
    }
}

/// Loads an [`EditsFile`] from RON. Its error is a [`FileError`] with line and column.
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct EditsLoader;

impl AssetLoader for EditsLoader {
    type Asset = EditsFile;
    type Settings = ();
    type Error = FileError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<EditsFile, FileError> {
        let (file, text) = read(reader, context).await?;
        EditsFile::from_ron(file, text)
    }

    fn extensions(&self) -> &[&str] {
        &["edits.ron"]
    }
}

/// The file that the world's edits come from. Present with
/// [`SprawlPlugin::edits_from`](crate::plugin::SprawlPlugin::edits_from).
#[derive(Resource)]
pub struct SprawlEdits {
    handle: Handle<EditsFile>,
    /// The last good one.
    last: Option<EditsFile>,
}

impl SprawlEdits {
    pub(super) fn new(handle: Handle<EditsFile>) -> Self {
        Self { handle, last: None }
    }

    /// The asset.
    pub fn handle(&self) -> &Handle<EditsFile> {
        &self.handle
    }

    /// The last good file; `None` until there is one.
    pub fn file(&self) -> Option<&EditsFile> {
        self.last.as_ref()
    }
}

/// Hands over what has been loaded for the first time or again.
pub(super) fn take_edits(
    mut file: ResMut<SprawlEdits>,
    assets: Res<Assets<EditsFile>>,
    mut events: MessageReader<AssetEvent<EditsFile>>,
    mut source: ResMut<SprawlSource>,
    mut making: ResMut<Making>,
) {
    let own = |e: &AssetEvent<EditsFile>| matches!(e, AssetEvent::Added { id } | AssetEvent::Modified { id } if *id == file.handle.id());
    if events.read().filter(|e| own(e)).count() == 0 {
        return;
    }
    let Some(loaded) = assets.get(&file.handle) else { return };
    making.hold_edits = false;
    if source.edits != loaded.edits {
        source.edits = loaded.edits.clone();
    }
    file.last = Some(loaded.clone());
}

/// Tells why a file was refused; the last good one stays.
pub(super) fn refuse_edits(
    mut commands: Commands,
    file: Res<SprawlEdits>,
    mut failed: MessageReader<AssetLoadFailedEvent<EditsFile>>,
    mut rejected: MessageWriter<AssetRejected>,
    mut making: ResMut<Making>,
) {
    for event in failed.read().filter(|e| e.id == file.handle.id()) {
        making.hold_edits = false;
        reject(&mut commands, &mut rejected, &event.path, &event.error);
    }
}
