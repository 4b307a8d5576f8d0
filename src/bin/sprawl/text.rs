//! Files of text.

use bevy_sprawl::layer::{FileError, decode_text, read_file};
use std::path::Path;

/// Text files are read up to this size, in bytes.
const LARGEST_TEXT: u64 = 64 << 20;

/// Reads a file as text.
pub fn read(path: &Path) -> Result<String, FileError> {
    let content = read_file(path, LARGEST_TEXT)?;
    Ok(decode_text(&path.to_string_lossy(), &content)?.to_owned())
}
