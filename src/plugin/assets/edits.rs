//! The file that edits come from, which is loaded again when it is saved.

use super::contents::FileContents;
use super::loader::read;
use super::rejection::FileReports;
use crate::edits::{Edits, RejectedEdit};
use crate::layer::FileError;
use crate::plugin::frame_time::Stopwatch;
use crate::plugin::source::{AwaitedFiles, SprawlSource};
use bevy::asset::io::Reader;
use bevy::asset::{AssetLoadFailedEvent, AssetLoader, LoadContext};
use bevy::prelude::*;

/// A file of edits as an asset: `load::<EditsFile>("my.edits.ron")`.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct EditsFile {
    /// The edits.
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

    /// The place in the file of an edit that a world cannot fulfil.
    pub fn locate(&self, rejected: &RejectedEdit) -> FileError {
        rejected.in_file(&self.file, &self.text)
    }

    /// The places of many of them, in the same order.
    pub fn locate_all(&self, rejected: &[RejectedEdit]) -> Vec<FileError> {
        RejectedEdit::all_in_file(rejected, &self.file, &self.text)
    }
}

/// Loads an [`EditsFile`] from RON. Its error is a [`FileError`] with line and column.
#[derive(Clone, Debug, Default, TypePath)]
pub struct EditsLoader(pub(super) FileContents);

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
        let (file, text) = read(reader, context, &self.0).await?;
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
    /// The last good version.
    last: Option<EditsFile>,
    is_refused: bool,
}

impl SprawlEdits {
    pub(super) fn new(handle: Handle<EditsFile>) -> Self {
        Self { handle, last: None, is_refused: false }
    }

    /// The asset.
    pub fn handle(&self) -> &Handle<EditsFile> {
        &self.handle
    }

    /// The last good version of the file. `None` until there is one.
    pub fn file(&self) -> Option<&EditsFile> {
        self.last.as_ref()
    }
}

/// Hands over edits that have been loaded for the first time or again.
pub(super) fn take_edits(
    mut stopwatch: Stopwatch,
    mut reports: FileReports,
    mut file: ResMut<SprawlEdits>,
    assets: Res<Assets<EditsFile>>,
    mut events: MessageReader<AssetEvent<EditsFile>>,
    mut source: ResMut<SprawlSource>,
    mut awaited: ResMut<AwaitedFiles>,
) {
    let _running = stopwatch.start();
    let file_id = file.handle.id();
    let is_loaded = |e: &AssetEvent<EditsFile>| matches!(e, AssetEvent::Added { id } | AssetEvent::Modified { id } if *id == file_id);
    if events.read().filter(|e| is_loaded(e)).count() == 0 {
        return;
    }
    let Some(loaded) = assets.get(&file.handle) else { return };
    awaited.edits = false;
    if source.edits != loaded.edits {
        source.edits = loaded.edits.clone();
    }
    file.last = Some(loaded.clone());
    if std::mem::take(&mut file.is_refused) {
        reports.mend(loaded.file.clone());
    }
}

/// Reports why the file was refused; its last good version stays.
pub(super) fn refuse_edits(
    mut stopwatch: Stopwatch,
    mut reports: FileReports,
    mut file: ResMut<SprawlEdits>,
    mut failed: MessageReader<AssetLoadFailedEvent<EditsFile>>,
    mut awaited: ResMut<AwaitedFiles>,
) {
    let _running = stopwatch.start();
    let id = file.handle.id();
    for event in failed.read().filter(|e| e.id == id) {
        awaited.edits = false;
        file.is_refused = true;
        reports.refuse_load(&event.path, &event.error);
    }
}
