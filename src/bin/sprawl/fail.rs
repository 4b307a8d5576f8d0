//! How a command fails: one line on stderr, and an exit code.

use bevy_sprawl::export::ExportError;
use bevy_sprawl::layer::{FileError, LayerError};
use bevy_sprawl::map::MapError;
use bevy_sprawl::world::WorldError;
use std::io;
use std::process::ExitCode;

/// Why a command stops.
#[derive(Debug)]
pub enum Fail {
    /// What the user gave cannot be used: exit code 2.
    Input(String),
    /// The generator failed: exit code 1.
    World(String),
    /// Nobody reads the output any more.
    Closed,
}

impl Fail {
    /// Bad input, in one line.
    pub fn input(reason: impl std::fmt::Display) -> Self {
        Self::Input(reason.to_string())
    }

    /// A file that cannot be read or written.
    pub fn file(path: &std::path::Path, reason: impl std::fmt::Display) -> Self {
        Self::Input(format!("{}: {reason}", path.display()))
    }

    /// Prints the reason and gives the exit code.
    pub fn report(self) -> ExitCode {
        let (reason, code) = match self {
            Self::Input(reason) => (reason, 2),
            Self::World(reason) => (reason, 1),
            Self::Closed => return ExitCode::SUCCESS,
        };
        let line = reason.split_whitespace().collect::<Vec<_>>().join(" ");
        // What a terminal would obey is shown instead.
        let escaped = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
        eprintln!("sprawl: {}", line.chars().map(escaped).collect::<String>());
        ExitCode::from(code)
    }
}

/// Fails if one of these flags is given and has no use: its name, what it needs, and whether that is so.
pub fn refuse_unused<'a>(flags: impl IntoIterator<Item = (&'a str, &'a str, bool)>) -> Result<(), Fail> {
    match flags.into_iter().find(|(_, _, is_unused)| *is_unused) {
        Some((flag, needed, _)) => Err(Fail::input(format!("{flag} needs {needed}"))),
        None => Ok(()),
    }
}

impl From<clap::Error> for Fail {
    fn from(error: clap::Error) -> Self {
        let text = error.to_string();
        // What is wrong comes first; tips and usage follow after an empty line.
        let first = text.split("\n\n").next().unwrap_or_default();
        let reason = match error.kind() {
            clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                "a command is missing; see `sprawl --help`"
            }
            _ => first.strip_prefix("error: ").unwrap_or(first),
        };
        Self::input(reason)
    }
}

impl From<FileError> for Fail {
    fn from(error: FileError) -> Self {
        Self::input(error)
    }
}

impl From<MapError> for Fail {
    fn from(error: MapError) -> Self {
        Self::input(error)
    }
}

impl From<WorldError> for Fail {
    fn from(error: WorldError) -> Self {
        Self::input(error)
    }
}

impl From<LayerError> for Fail {
    fn from(error: LayerError) -> Self {
        Self::World(error.to_string())
    }
}

impl From<ExportError> for Fail {
    fn from(error: ExportError) -> Self {
        Self::input(error)
    }
}

impl From<io::Error> for Fail {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe { Self::Closed } else { Self::input(error) }
    }
}
