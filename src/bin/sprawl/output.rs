//! The files that commands write: formats by name, and files that appear only once they are whole.

use crate::fail::Fail;
use bevy_sprawl::export::svg::MapStyle;
use bevy_sprawl::export::{ExportError, Plan, geojson, osm, png, svg};
use serde_json::{Map, Value as Json, json};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// What a file's extension asks for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Svg,
    Png,
    GeoJson,
    Osm,
    Glb,
}

impl Format {
    /// The format that a file's name ends in, if it is one of `allowed`.
    pub fn of(path: &Path, allowed: &[(&str, Self)]) -> Result<Self, Fail> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        let names: Vec<String> = allowed.iter().map(|(name, _)| format!(".{name}")).collect();
        let unknown = || Fail::file(path, format!("unknown kind of file; the name must end in {}", names.join(" ")));
        allowed.iter().find(|(name, _)| *name == extension).map(|(_, format)| *format).ok_or_else(unknown)
    }
}

/// Options of the formats that have some.
#[derive(Clone, Copy, Default)]
pub struct FileOptions {
    pub osm: osm::Options,
    pub geojson: geojson::Options,
}

/// Writes a plan in any format but GLB.
pub fn write(
    plan: &Plan<'_>,
    format: Format,
    style: &MapStyle,
    options: FileOptions,
    file: &mut dyn Write,
) -> Result<(), ExportError> {
    match format {
        Format::Svg => file.write_all(svg::write(plan, style)?.as_bytes())?,
        Format::Png => file.write_all(&png::write(plan, style)?)?,
        Format::GeoJson => geojson::write(plan, options.geojson, file)?,
        Format::Osm => osm::write(plan, options.osm, file)?,
        Format::Glb => {}
    }
    Ok(())
}

/// Writes two plans beside each other, as a picture.
pub fn write_pair(plans: [(&Plan<'_>, &MapStyle); 2], format: Format, file: &mut dyn Write) -> Result<(), ExportError> {
    match format {
        Format::Svg => file.write_all(svg::write_pair(plans)?.as_bytes())?,
        _ => file.write_all(&png::write_pair(plans)?)?,
    }
    Ok(())
}

/// A file being written under a name of its own beside the wanted one, so that a run that fails or is stopped leaves no half
/// file. A link is followed, a file keeps its permissions, and what is no file (a pipe) is written as it is.
pub struct Output {
    file: BufWriter<File>,
    /// The name as it was given.
    name: PathBuf,
    /// The file that is written until it is whole, and where it goes then.
    part: Option<(PathBuf, PathBuf)>,
    /// Bytes written so far.
    bytes: u64,
}

/// Files that are not whole yet.
static PARTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn parts() -> std::sync::MutexGuard<'static, Vec<PathBuf>> {
    PARTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes files that are not whole when the user stops the program.
pub fn clean_up_when_stopped() {
    // Where signals cannot be handled, a stopped run leaves its part behind.
    let _ = ctrlc::set_handler(|| {
        for part in parts().iter() {
            let _ = std::fs::remove_file(part);
        }
        std::process::exit(130);
    });
}

impl Output {
    /// Opens a file to write, which must be none of the files that are read.
    pub fn create(path: &Path, inputs: &[PathBuf]) -> Result<Self, Fail> {
        let fail = |e: io::Error| Fail::file(path, e);
        if path.is_dir() {
            return Err(Fail::file(path, "is a folder"));
        }
        let target = target(path);
        if inputs.iter().any(|input| input.canonicalize().is_ok_and(|i| i == target)) {
            return Err(Fail::file(path, "is a file that is read; write to another one"));
        }
        let old = std::fs::metadata(&target).ok();
        if old.as_ref().is_some_and(|m| !m.is_file()) {
            let file = File::options().write(true).open(&target).map_err(fail)?;
            return Ok(Self { file: BufWriter::new(file), name: path.to_owned(), part: None, bytes: 0 });
        }
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.part", std::process::id()));
        let part = target.with_file_name(name);
        // Before there is a file: a signal may come at any time.
        parts().push(part.clone());
        let file = File::create(&part).map_err(fail);
        let file = file.inspect_err(|_| forget(&part))?;
        let (file, name) = (BufWriter::new(file), path.to_owned());
        let out = Self { file, name, part: Some((part.clone(), target)), bytes: 0 };
        if let Some(old) = old {
            std::fs::set_permissions(&part, old.permissions()).map_err(fail)?;
        }
        Ok(out)
    }

    /// Puts the file in its place and gives its size in bytes.
    pub fn finish(mut self) -> Result<u64, Fail> {
        self.flush()?;
        let fail = |e| Fail::file(&self.name, e);
        if let Some((part, target)) = &self.part {
            std::fs::rename(part, target).map_err(fail)?;
            forget(part);
            self.part = None;
        }
        Ok(self.bytes)
    }

    /// An error of writing that says which file it is about.
    fn named(&self, error: io::Error) -> io::Error {
        io::Error::new(error.kind(), format!("{}: {error}", self.name.display()))
    }
}

/// The file that a path leads to, through links, also where the last of them leads to none yet.
fn target(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    // As many links as systems follow.
    for _ in 0..40 {
        let Ok(next) = std::fs::read_link(&path) else { break };
        path = path.parent().unwrap_or(Path::new("")).join(next);
    }
    path.canonicalize().unwrap_or(path)
}

fn forget(part: &Path) {
    parts().retain(|p| p != part);
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes).map_err(|e| self.named(e))?;
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush().map_err(|e| self.named(e))
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if let Some((part, _)) = &self.part {
            // The reason for the failure matters more than a file left behind.
            let _ = std::fs::remove_file(part);
            forget(part);
        }
    }
}

/// Names that a picture has in Latin letters, for `--json`, and the line on them for people.
pub fn spelled_in_latin(plan: &Plan<'_>, format: Format) -> (Json, String) {
    let names = if format == Format::Png { png::spelled_in_latin(plan) } else { Vec::new() };
    (names.iter().map(|(name, latin)| (name.clone(), json!(latin))).collect::<Map<_, _>>().into(), spelled(&names))
}

fn spelled(names: &[(String, String)]) -> String {
    const MOST: usize = 5;
    if names.is_empty() {
        return String::new();
    }
    let named: Vec<String> = names.iter().take(MOST).map(|(name, latin)| format!("{name} as {latin}")).collect();
    let more = if names.len() > MOST { format!(" and {} more", names.len() - MOST) } else { String::new() };
    format!("\nspelled in Latin letters (an .svg has them as they are): {}{more}", named.join(", "))
}
