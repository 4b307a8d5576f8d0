//! Reports of files that are refused, and of errors that are mended.

use crate::layer::FileError;
use bevy::asset::{AssetLoadError, AssetPath};
use bevy::ecs::system::SystemParam;
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

/// A file that was refused ([`AssetRejected`]) is good again, or has been deleted. Sent as a message and as an event.
#[derive(Message, Event, Clone, Debug, PartialEq, Eq)]
pub struct AssetMended {
    /// The file, as the asset server names it.
    pub file: String,
}

/// Sends reports about files.
#[derive(SystemParam)]
pub(super) struct FileReports<'w, 's> {
    commands: Commands<'w, 's>,
    rejected: MessageWriter<'w, AssetRejected>,
    mended: MessageWriter<'w, AssetMended>,
}

impl FileReports<'_, '_> {
    /// Reports a file that could not be loaded.
    pub fn refuse_load(&mut self, path: &AssetPath, error: &AssetLoadError) {
        let located = match error {
            AssetLoadError::AssetLoaderError(e) => e.error().downcast_ref::<FileError>().cloned(),
            _ => None,
        };
        self.refuse(located.unwrap_or_else(|| FileError::unreadable(path.to_string(), error)));
    }

    /// Reports an error of a file.
    pub fn refuse(&mut self, error: FileError) {
        let FileError { file, line, column, reason } = error;
        let event = AssetRejected { file, line, column, reason };
        self.rejected.write(event.clone());
        self.commands.trigger(event);
    }

    /// Reports that an error of a file is mended.
    pub fn mend(&mut self, file: String) {
        info!("{file} is good again");
        let event = AssetMended { file };
        self.mended.write(event.clone());
        self.commands.trigger(event);
    }
}
