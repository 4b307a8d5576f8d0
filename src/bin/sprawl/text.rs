//! Files of text.

use bevy_sprawl::layer::{FileError, read_text};
use std::path::Path;

/// Text files are read up to this size, in bytes.
const LARGEST_TEXT: u64 = 64 << 20;

/// Reads a file as text.
pub fn read(path: &Path) -> Result<String, FileError> {
    read_text(path, LARGEST_TEXT)
}
