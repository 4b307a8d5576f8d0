//! Loading changed files again.
//!
//! Bevy's file watcher reports files that are written in place. Many editors write a new file and move it over the old one;
//! nothing is reloaded then. So the plugin regularly compares the files with their contents as last read.

use super::contents::FileContents;
use super::edits::SprawlEdits;
use super::folder::SprawlFolder;
use crate::plugin::frame_time::Stopwatch;
use bevy::asset::AssetPath;
use bevy::prelude::*;
use bevy::tasks::{IoTaskPool, Task, futures::check_ready};

/// Seconds of real time between comparisons.
const COMPARE_EVERY: f32 = 1.0;

/// The comparison that is under way.
#[derive(Resource, Default)]
pub(super) struct Comparison {
    task: Option<Task<Vec<String>>>,
    started_at: f32,
}

/// If the asset server watches files, compares them with their contents as last read, and loads changed files again.
pub(super) fn reload_changed(
    mut stopwatch: Stopwatch,
    time: Option<Res<Time<Real>>>,
    mut comparison: ResMut<Comparison>,
    (server, contents): (Res<AssetServer>, Res<FileContents>),
    (folder, edits): (Option<Res<SprawlFolder>>, Option<Res<SprawlEdits>>),
) {
    let _running = stopwatch.start();
    let seconds = time.map_or(0.0, |t| t.elapsed_secs());
    if let Some(task) = &mut comparison.task {
        let Some(changed) = check_ready(task) else { return };
        comparison.task = None;
        for file in changed {
            server.reload(file);
        }
    }
    if !server.watching_for_changes() || seconds - comparison.started_at < COMPARE_EVERY {
        return;
    }
    comparison.started_at = seconds;
    let mut files: Vec<String> = folder.iter().flat_map(|f| f.loaded_files()).collect();
    files.extend(edits.iter().filter_map(|e| Some(e.handle().path()?.to_string())));
    let (server, contents) = (server.clone(), contents.clone());
    comparison.task = Some(IoTaskPool::get().spawn(async move {
        let mut changed = Vec::new();
        for file in files {
            // A file that is gone or cannot be read at the moment does not count as changed.
            if let Some(content) = read_file(&server, &file).await
                && contents.get(&file).is_none_or(|known| *known != *content)
            {
                changed.push(file);
            }
        }
        changed
    }));
}

async fn read_file(server: &AssetServer, file: &str) -> Option<Vec<u8>> {
    let path = AssetPath::parse(file);
    let source = server.get_source(path.source().clone()).ok()?;
    let mut reader = source.reader().read(path.path()).await.ok()?;
    let mut content = Vec::new();
    reader.read_to_end(&mut content).await.ok()?;
    Some(content)
}
