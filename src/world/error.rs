//! Why a world cannot be made, and where that is written.

use crate::edits::RejectedEdit;
use crate::layer::{FileError, RangeError, error_at, is_written};
use crate::style::Style;
use crate::world::settings::Settings;

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

impl WorldError {
    /// The name of the style whose file is at fault. `None` where it is no style.
    pub fn style(&self) -> Option<&str> {
        match self {
            Self::MissingFringe { style, .. }
            | Self::MissingPatch { style, .. }
            | Self::MissingPatchSet { style, .. }
            | Self::NoPatches { style, .. } => Some(style),
            Self::Range(_) | Self::MissingStyle { .. } | Self::Defect(_) | Self::Edit(_) => None,
        }
    }

    /// The error at its place in the file of the [`style`](Self::style), which was read from `text`.
    pub fn in_style(&self, style: &Style, file: &str, text: &str) -> FileError {
        let path = match self {
            Self::MissingFringe { .. } => "fringe.style".to_owned(),
            Self::MissingPatchSet { set, .. } => element("patch_sets", style.patch_sets.iter().position(|s| s == set)),
            Self::MissingPatch { patch, .. } => {
                element("patches", style.patches.iter().position(|c| c.patch == *patch))
            }
            Self::NoPatches { .. } if style.allow.is_empty() => "exclude".to_owned(),
            _ => "allow".to_owned(),
        };
        error_at(file, text, &path, self)
    }

    /// The error at its place in the file of settings, which was read from `text`. `None` where these are not at fault: what they
    /// say by default counts as said by nobody.
    pub fn in_settings(&self, settings: &Settings, file: &str, text: &str) -> Option<FileError> {
        match self {
            Self::Range(error) => Some(error.in_file(file, text)),
            Self::MissingStyle { style, .. } => {
                let paths = settings.settlements.styles_by_path().filter(|(_, name)| name == style);
                let path = paths.map(|(path, _)| format!("settlements.{path}")).find(|path| is_written(text, path))?;
                Some(error_at(file, text, &path, self))
            }
            _ => None,
        }
    }
}

fn element(list: &str, index: Option<usize>) -> String {
    index.map_or_else(|| list.to_owned(), |i| format!("{list}[{i}]"))
}
