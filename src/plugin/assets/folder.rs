//! The folder that styles and patch sets are loaded from.

use crate::layer::FileError;
use crate::patch::PatchSet;
use crate::plugin::source::{Making, SprawlSource};
use crate::style::Style;
use crate::world::WorldAssets;
use bevy::asset::{AssetLoadError, AssetLoadFailedEvent, AssetPath};
use bevy::prelude::*;
use bevy::tasks::futures_lite::StreamExt;
use bevy::tasks::{IoTaskPool, Task, futures::check_ready};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// A style, a patch set or a file of edits was refused; the last good one of that name stays. Sent as a message and as an event. Bevy's
/// asset server logs the same.
#[derive(Message, Event, Clone, Debug, PartialEq, Eq)]
pub struct AssetRejected {
    /// The file, as the asset server names it.
    pub file: String,
    /// Line, from 1; 0 when the file could not be read at all.
    pub line: usize,
    /// Column, from 1; 0 when the file could not be read at all.
    pub column: usize,
    /// What is wrong, and what is allowed.
    pub reason: String,
}

/// The folder that styles and patch sets are loaded from. Present with
/// [`AssetOrigin::Folder`](crate::plugin::AssetOrigin::Folder).
#[derive(Resource)]
pub struct SprawlFolder {
    path: String,
    bundled: WorldAssets,
    /// By path, as the asset server writes it.
    styles: BTreeMap<String, Handle<Style>>,
    patch_sets: BTreeMap<String, Handle<PatchSet>>,
    /// Files that have neither been loaded nor been refused yet.
    waiting: BTreeSet<String>,
    listing: Option<Task<Result<Listing, FileError>>>,
    list: bool,
    /// When it was last looked at, in seconds of real time.
    looked: f32,
    /// Why it could not be listed the last time.
    unlisted: Option<FileError>,
    /// Something has been loaded since the assets were handed over.
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
            listing: None,
            list: true,
            looked: 0.0,
            unlisted: None,
            changed: true,
        }
    }

    /// Looks for files that have come or gone. Where the asset server watches files, the plugin does so by itself.
    pub fn rescan(&mut self) {
        self.list = true;
    }

    /// Whether files are still being read.
    pub fn is_loading(&self) -> bool {
        self.list || self.listing.is_some() || !self.waiting.is_empty()
    }
}

/// Seconds between two looks at a folder that is watched: the asset server tells of files that change, not of new ones.
const LOOK_EVERY: f32 = 1.0;

/// Lists the folder, and starts to load the files in it.
pub(super) fn list_files(
    mut commands: Commands,
    time: Option<Res<Time<Real>>>,
    mut folder: ResMut<SprawlFolder>,
    server: Res<AssetServer>,
    mut rejected: MessageWriter<AssetRejected>,
) {
    let folder = &mut *folder;
    let seconds = time.map_or(0.0, |t| t.elapsed_secs());
    folder.list |= server.watching_for_changes() && seconds - folder.looked > LOOK_EVERY;
    if folder.list && folder.listing.is_none() {
        (folder.list, folder.looked) = (false, seconds);
        let (server, path) = (server.clone(), folder.path.clone());
        folder.listing = Some(IoTaskPool::get().spawn(async move { listing(&server, &path).await }));
    }
    let Some(listing) = folder.listing.as_mut().and_then(check_ready) else { return };
    folder.listing = None;
    match listing {
        Ok(Listing { styles, patches }) => {
            folder.unlisted = None;
            folder.changed |= load(&mut folder.styles, &mut folder.waiting, &server, styles);
            folder.changed |= load(&mut folder.patch_sets, &mut folder.waiting, &server, patches);
        }
        Err(error) if folder.unlisted.as_ref() == Some(&error) => {}
        Err(error) => {
            folder.unlisted = Some(error.clone());
            error!("{error}; the bundled styles and patch sets are used");
            tell(&mut commands, &mut rejected, error);
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
                    if entry.extension().is_some_and(|e| e == "ron") {
                        let file = AssetPath::from_path_buf(entry).with_source(root.source().clone());
                        files.insert(file.to_string());
                    }
                }
            }
            Err(error) => missing = Some(FileError::unreadable(inner.to_string_lossy(), error)),
        }
    }
    // One of the two may be missing: the bundled ones are used.
    let [styles, patches] = found;
    match missing {
        Some(error) if styles.is_empty() && patches.is_empty() => Err(error),
        _ => Ok(Listing { styles, patches }),
    }
}

/// Loads the files that are new, and forgets those that are gone; says whether there were any.
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

/// Notices what has been loaded for the first time or again.
pub(super) fn take_loaded(
    mut folder: ResMut<SprawlFolder>,
    mut styles: MessageReader<AssetEvent<Style>>,
    mut patch_sets: MessageReader<AssetEvent<PatchSet>>,
) {
    let folder = &mut *folder;
    let styles = styles.read().filter_map(|e| loaded(&folder.styles, e));
    let patch_sets = patch_sets.read().filter_map(|e| loaded(&folder.patch_sets, e));
    for file in styles.chain(patch_sets) {
        folder.waiting.remove(file);
        folder.changed = true;
    }
}

fn loaded<'a, A: Asset>(known: &'a BTreeMap<String, Handle<A>>, event: &AssetEvent<A>) -> Option<&'a String> {
    let (AssetEvent::Added { id } | AssetEvent::Modified { id }) = event else { return None };
    known.iter().find(|(_, handle)| handle.id() == *id).map(|(path, _)| path)
}

/// Tells what has been refused.
pub(super) fn take_failed(
    mut commands: Commands,
    mut folder: ResMut<SprawlFolder>,
    mut styles: MessageReader<AssetLoadFailedEvent<Style>>,
    mut patch_sets: MessageReader<AssetLoadFailedEvent<PatchSet>>,
    mut rejected: MessageWriter<AssetRejected>,
) {
    let styles = styles.read().map(|e| (&e.path, &e.error));
    for (path, error) in styles.chain(patch_sets.read().map(|e| (&e.path, &e.error))) {
        folder.waiting.remove(&path.to_string());
        reject(&mut commands, &mut rejected, path, error);
    }
}

/// Tells of a file that could not be loaded.
pub(super) fn reject(
    commands: &mut Commands,
    rejected: &mut MessageWriter<AssetRejected>,
    path: &AssetPath,
    error: &AssetLoadError,
) {
    let known = match error {
        AssetLoadError::AssetLoaderError(e) => e.error().downcast_ref::<FileError>().cloned(),
        _ => None,
    };
    tell(commands, rejected, known.unwrap_or_else(|| FileError::unreadable(path.to_string(), error)));
}

fn tell(commands: &mut Commands, rejected: &mut MessageWriter<AssetRejected>, error: FileError) {
    let FileError { file, line, column, reason } = error;
    let event = AssetRejected { file, line, column, reason };
    rejected.write(event.clone());
    commands.trigger(event);
}

/// Hands everything over for the next world, once no file is being read any more.
pub(super) fn hand_over(
    mut folder: ResMut<SprawlFolder>,
    styles: Res<Assets<Style>>,
    patch_sets: Res<Assets<PatchSet>>,
    mut source: ResMut<SprawlSource>,
    mut making: ResMut<Making>,
) {
    if folder.is_loading() || !folder.changed {
        return;
    }
    folder.changed = false;
    making.hold_assets = false;
    let mut assets = folder.bundled.clone();
    for (file, handle) in &folder.styles {
        put(&mut assets.styles, file, styles.get(handle), &source.assets.styles);
    }
    for (file, handle) in &folder.patch_sets {
        put(&mut assets.patch_sets, file, patch_sets.get(handle), &source.assets.patch_sets);
    }
    source.assets = assets;
}

/// Puts a loaded asset under its file's name. What has not changed keeps its `Arc`, so that it is known to be the same.
fn put<A: Clone + PartialEq>(
    into: &mut BTreeMap<String, Arc<A>>,
    file: &str,
    asset: Option<&A>,
    before: &BTreeMap<String, Arc<A>>,
) {
    let name = Path::new(file).file_stem().map(|s| s.to_string_lossy().into_owned());
    let (Some(name), Some(asset)) = (name, asset) else { return };
    let same = before.get(&name).filter(|b| ***b == *asset).cloned();
    into.insert(name, same.unwrap_or_else(|| Arc::new(asset.clone())));
}
