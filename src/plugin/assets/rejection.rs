//! Reports of files that were refused.

use crate::layer::FileError;
use bevy::asset::{AssetLoadError, AssetPath};
use bevy::prelude::*;

/// A style, a patch set or a file of edits was refused, and its last good version stays. Sent as a message and as an
/// event. Bevy's asset server logs the same.
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

/// Reports a file that could not be loaded.
pub(super) fn report_load_error(
    commands: &mut Commands,
    rejected: &mut MessageWriter<AssetRejected>,
    path: &AssetPath,
    error: &AssetLoadError,
) {
    let located = match error {
        AssetLoadError::AssetLoaderError(e) => e.error().downcast_ref::<FileError>().cloned(),
        _ => None,
    };
    report(commands, rejected, located.unwrap_or_else(|| FileError::unreadable(path.to_string(), error)));
}

/// Reports an error of a file.
pub(super) fn report(commands: &mut Commands, rejected: &mut MessageWriter<AssetRejected>, error: FileError) {
    let FileError { file, line, column, reason } = error;
    let event = AssetRejected { file, line, column, reason };
    rejected.write(event.clone());
    commands.trigger(event);
}
