//! The folder that styles and patch sets are loaded from.

use super::contents::FileContents;
use super::rejection::FileReports;
use crate::layer::{FileError, decode_text, is_asset_file};
use crate::patch::PatchSet;
use crate::plugin::frame_time::Stopwatch;
use crate::plugin::source::{AwaitedFiles, SprawlSource};
use crate::style::Style;
use crate::world::{WorldAssets, WorldError};
use bevy::asset::{AssetLoadFailedEvent, AssetPath};
use bevy::prelude::*;
use bevy::tasks::futures_lite::StreamExt;
use bevy::tasks::{IoTaskPool, Task, futures::check_ready};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// The folder that styles and patch sets are loaded from. Present with
/// [`AssetOrigin::Folder`](crate::plugin::AssetOrigin::Folder).
#[derive(Resource)]
pub struct SprawlFolder {
    path: String,
    bundled: WorldAssets,
    /// The files by their paths, as the asset server writes them.
    styles: BTreeMap<String, Handle<Style>>,
    patch_sets: BTreeMap<String, Handle<PatchSet>>,
    /// Files that have neither been loaded nor refused yet.
    waiting: BTreeSet<String>,
    /// Files whose current version is refused.
    refused: BTreeSet<String>,
    listing: Option<Task<Result<Listing, FileError>>>,
    rescan: bool,
    /// When the folder was last listed, in seconds of real time.
    listed_at: f32,
    /// Why the last listing failed, if it did.
    listing_error: Option<FileError>,
    /// Whether something has been loaded since the assets were handed over.
    changed: bool,
}

/// Paths of the files under `styles/` and `patches/`.
struct Listing {
    styles: BTreeSet<String>,
    patches: BTreeSet<String>,
}

impl SprawlFolder {
    pub(super) fn new(path: &str) -> Self {
        Self {
            path: path.trim_end_matches('/').to_owned(),
            bundled: WorldAssets::bundled(),
            styles: BTreeMap::new(),
            patch_sets: BTreeMap::new(),
            waiting: BTreeSet::new(),
            refused: BTreeSet::new(),
            listing: None,
            rescan: true,
            listed_at: 0.0,
            listing_error: None,
            changed: true,
        }
    }

    /// Looks for files that have come or gone. The plugin does so by itself if the asset server watches files.
    pub fn rescan(&mut self) {
        self.rescan = true;
    }

    /// The files that have been loaded or refused.
    pub(super) fn loaded_files(&self) -> impl Iterator<Item = String> {
        let styles = self.styles.iter().map(|(file, handle)| (file, handle.path()));
        let patch_sets = self.patch_sets.iter().map(|(file, handle)| (file, handle.path()));
        let files = styles.chain(patch_sets).filter(|(file, _)| !self.waiting.contains(*file));
        files.filter_map(|(_, path)| Some(path?.to_string()))
    }

    /// The place of a world's error in the file of the style that causes it. `None` if no loaded style causes it.
    pub(in crate::plugin) fn locate(&self, error: &WorldError, contents: &FileContents) -> Option<FileError> {
        let style = error.style()?;
        let (_, handle) = self.styles.iter().find(|(file, _)| asset_name(file).as_deref() == Some(style))?;
        let file = handle.path()?.to_string();
        let content = contents.get(&file)?;
        let text = decode_text(&file, &content).ok()?;
        Some(error.in_style(&Style::from_ron(&file, text).ok()?, &file, text))
    }

    /// Whether files are still being read.
    pub fn is_loading(&self) -> bool {
        self.rescan || self.listing.is_some() || !self.waiting.is_empty()
    }
}

/// Seconds between listings of a watched folder: the asset server reports files that change, but not new files.
const LIST_EVERY: f32 = 1.0;

/// Lists the folder, and starts to load the files in it.
pub(super) fn list_files(
    mut stopwatch: Stopwatch,
    mut reports: FileReports,
    time: Option<Res<Time<Real>>>,
    mut folder: ResMut<SprawlFolder>,
    server: Res<AssetServer>,
) {
    let _running = stopwatch.start();
    let folder = &mut *folder;
    let seconds = time.map_or(0.0, |t| t.elapsed_secs());
    folder.rescan |= server.watching_for_changes() && seconds - folder.listed_at > LIST_EVERY;
    if folder.rescan && folder.listing.is_none() {
        (folder.rescan, folder.listed_at) = (false, seconds);
        let (server, path) = (server.clone(), folder.path.clone());
        folder.listing = Some(IoTaskPool::get().spawn(async move { listing(&server, &path).await }));
    }
    let Some(listing) = folder.listing.as_mut().and_then(check_ready) else { return };
    folder.listing = None;
    match listing {
        Ok(Listing { styles, patches }) => {
            if let Some(error) = folder.listing_error.take() {
                reports.mend(error.file);
            }
            folder.changed |= load(&mut folder.styles, &mut folder.waiting, &server, styles);
            folder.changed |= load(&mut folder.patch_sets, &mut folder.waiting, &server, patches);
            let (styles, patch_sets) = (&folder.styles, &folder.patch_sets);
            for deleted in folder.refused.extract_if(.., |f| !styles.contains_key(f) && !patch_sets.contains_key(f)) {
                reports.mend(deleted);
            }
        }
        Err(error) if folder.listing_error.as_ref() == Some(&error) => {}
        Err(error) => {
            folder.listing_error = Some(error.clone());
            error!("{error}; the last styles and patch sets stay");
            reports.refuse(error);
        }
    }
}

async fn listing(server: &AssetServer, path: &str) -> Result<Listing, FileError> {
    let root = AssetPath::parse(path).into_owned();
    let source = server.get_source(root.source().clone()).map_err(|e| FileError::unreadable(path, e))?;
    let mut found = [BTreeSet::new(), BTreeSet::new()];
    let mut missing = None;
    for (files, name) in found.iter_mut().zip(["styles", "patches"]) {
        let inner = root.path().join(name);
        match source.reader().read_directory(&inner).await {
            Ok(mut entries) => {
                while let Some(entry) = entries.next().await {
                    if is_asset_file(&entry) {
                        let file = AssetPath::from_path_buf(entry).with_source(root.source().clone());
                        files.insert(file.to_string());
                    }
                }
            }
            Err(error) => missing = Some(FileError::unreadable(inner.to_string_lossy(), error)),
        }
    }
    // One of the two folders may be missing; its bundled files are then used.
    let [styles, patches] = found;
    match missing {
        Some(error) if styles.is_empty() && patches.is_empty() => Err(error),
        _ => Ok(Listing { styles, patches }),
    }
}

/// Loads new files and forgets files that are gone. Returns whether any file has come or gone.
fn load<A: Asset>(
    known: &mut BTreeMap<String, Handle<A>>,
    waiting: &mut BTreeSet<String>,
    server: &AssetServer,
    files: BTreeSet<String>,
) -> bool {
    let same = known.keys().eq(&files);
    known.retain(|path, _| files.contains(path));
    for path in files {
        known.entry(path.clone()).or_insert_with(|| {
            waiting.insert(path.clone());
            server.load(path)
        });
    }
    !same
}

/// Notices files that have been loaded for the first time or again.
pub(super) fn take_loaded(
    mut stopwatch: Stopwatch,
    mut reports: FileReports,
    mut folder: ResMut<SprawlFolder>,
    mut styles: MessageReader<AssetEvent<Style>>,
    mut patch_sets: MessageReader<AssetEvent<PatchSet>>,
) {
    let _running = stopwatch.start();
    let folder = &mut *folder;
    let styles = styles.read().filter_map(|e| loaded(&folder.styles, e));
    let patch_sets = patch_sets.read().filter_map(|e| loaded(&folder.patch_sets, e));
    for file in styles.chain(patch_sets) {
        folder.waiting.remove(file);
        folder.changed = true;
        if folder.refused.remove(file) {
            reports.mend(file.clone());
        }
    }
}

fn loaded<'a, A: Asset>(known: &'a BTreeMap<String, Handle<A>>, event: &AssetEvent<A>) -> Option<&'a String> {
    let (AssetEvent::Added { id } | AssetEvent::Modified { id }) = event else { return None };
    known.iter().find(|(_, handle)| handle.id() == *id).map(|(path, _)| path)
}

/// Reports files that have been refused.
pub(super) fn take_failed(
    mut stopwatch: Stopwatch,
    mut reports: FileReports,
    mut folder: ResMut<SprawlFolder>,
    mut styles: MessageReader<AssetLoadFailedEvent<Style>>,
    mut patch_sets: MessageReader<AssetLoadFailedEvent<PatchSet>>,
) {
    let _running = stopwatch.start();
    let styles = styles.read().map(|e| (&e.path, &e.error));
    for (path, error) in styles.chain(patch_sets.read().map(|e| (&e.path, &e.error))) {
        let file = path.to_string();
        folder.waiting.remove(&file);
        if folder.styles.contains_key(&file) || folder.patch_sets.contains_key(&file) {
            folder.refused.insert(file);
        }
        reports.refuse_load(path, error);
    }
}

/// Hands all assets over for the next world, once no file is being read any more.
pub(super) fn hand_over(
    mut stopwatch: Stopwatch,
    mut folder: ResMut<SprawlFolder>,
    styles: Res<Assets<Style>>,
    patch_sets: Res<Assets<PatchSet>>,
    mut source: ResMut<SprawlSource>,
    mut awaited: ResMut<AwaitedFiles>,
) {
    let _running = stopwatch.start();
    if folder.is_loading() || !folder.changed {
        return;
    }
    folder.changed = false;
    awaited.assets = false;
    let mut assets = folder.bundled.clone();
    for (file, handle) in &folder.styles {
        put(&mut assets.styles, file, styles.get(handle), &source.assets.styles);
    }
    for (file, handle) in &folder.patch_sets {
        put(&mut assets.patch_sets, file, patch_sets.get(handle), &source.assets.patch_sets);
    }
    source.assets = assets;
}

/// Puts a loaded asset under its file's name. An asset that has not changed keeps its `Arc`, so that it compares quickly.
fn put<A: Clone + PartialEq>(
    into: &mut BTreeMap<String, Arc<A>>,
    file: &str,
    asset: Option<&A>,
    before: &BTreeMap<String, Arc<A>>,
) {
    let (Some(name), Some(asset)) = (asset_name(file), asset) else { return };
    let same = before.get(&name).filter(|b| ***b == *asset).cloned();
    into.insert(name, same.unwrap_or_else(|| Arc::new(asset.clone())));
}

/// The name of the style or patch set in a file: the file's name without its ending.
fn asset_name(file: &str) -> Option<String> {
    Path::new(file).file_stem().map(|stem| stem.to_string_lossy().into_owned())
}
