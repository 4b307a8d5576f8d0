//! `sprawl patches`: checks and draws patch sets.

use crate::common::{Common, Flag};
use crate::fail::Fail;
use crate::output::{Format, Output};
use crate::text;
use crate::work;
use bevy_sprawl::export::png;
use bevy_sprawl::layer::{FileError, ron_files};
use bevy_sprawl::patch::{self, PatchSet};
use clap::{Args, Subcommand};
use serde_json::{Map, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct PatchesArgs {
    #[command(subcommand)]
    pub command: PatchesCommand,
}

#[derive(Subcommand)]
pub enum PatchesCommand {
    /// Read patch sets and name what is wrong with them
    Check {
        /// Patch sets, or folders of them
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
    },
    /// Draw the patches of one or more sets on a sheet
    Draw {
        /// Patch sets, or folders of them
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// File to write: .svg or .png
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
    },
}

/// Runs the command.
pub fn run(common: &Common, args: &PatchesArgs) -> Result<(), Fail> {
    common.refuse("`sprawl patches`", &[Flag::Seed, Flag::Settings, Flag::Assets, Flag::Edits])?;
    match &args.command {
        PatchesCommand::Check { files } => check(common, files),
        PatchesCommand::Draw { files, output } => draw(common, files, output),
    }
}

fn read(path: &Path) -> Result<PatchSet, FileError> {
    PatchSet::from_ron(&path.to_string_lossy(), &text::read(path)?)
}

/// The files themselves, and the `*.ron` files of folders (of their folder `patches`, if they have one).
fn expand(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Fail> {
    let mut out = Vec::new();
    for path in paths {
        if !path.is_dir() {
            out.push(path.clone());
            continue;
        }
        let inner = path.join("patches");
        let folder = if inner.is_dir() { &inner } else { path };
        let files = ron_files(folder)?;
        if files.is_empty() {
            return Err(Fail::file(folder, "holds no .ron file"));
        }
        out.extend(files);
    }
    Ok(out)
}

/// Names every set with its patches and tags, and every file that is not one with its place and reason.
fn check(common: &Common, paths: &[PathBuf]) -> Result<(), Fail> {
    let (mut sets, mut errors, mut people) = (Vec::new(), Vec::new(), String::new());
    for path in expand(paths)? {
        match read(&path) {
            Ok(set) => {
                let mut tags: BTreeMap<&str, usize> = BTreeMap::new();
                set.patches.iter().flat_map(|p| &p.tags).for_each(|tag| *tags.entry(tag).or_default() += 1);
                // Writing to a string cannot fail.
                let _ = write!(
                    people,
                    "{}: {} patches, {} patterns;",
                    path.display(),
                    set.patches.len(),
                    set.patterns.len()
                );
                let tags: Map<_, _> = tags.into_iter().map(|(tag, n)| (tag.to_owned(), json!(n))).collect();
                for (tag, count) in &tags {
                    let _ = write!(people, " {tag} {count}");
                }
                people.push('\n');
                sets.push(json!({
                    "file": path.to_string_lossy(), "name": set.name, "patches": set.patches.len(),
                    "patterns": set.patterns.len(), "tags": tags,
                }));
            }
            Err(error) => errors.push(error),
        }
    }
    let reasons: Vec<_> = errors
        .iter()
        .map(|e| json!({ "file": e.file, "line": e.line, "column": e.column, "reason": e.reason }))
        .collect();
    work::print(common, &json!({ "sets": sets, "errors": reasons }), &people)?;
    let mut errors = errors.iter();
    let Some(first) = errors.next() else { return Ok(()) };
    let more = errors.len();
    let more = if more > 0 { format!(" (and {more} more)") } else { String::new() };
    Err(Fail::input(format!("{first}{more}")))
}

/// One sheet of all patches of the sets.
fn draw(common: &Common, paths: &[PathBuf], output: &Path) -> Result<(), Fail> {
    let format = Format::of(output, &[("svg", Format::Svg), ("png", Format::Png)])?;
    let files = expand(paths)?;
    let sets = files.iter().map(|p| read(p)).collect::<Result<Vec<_>, _>>()?;
    let sheet = patch::draw_sheet(&sets.iter().collect::<Vec<_>>());
    let mut file = Output::create(output, &files)?;
    match format {
        Format::Png => file.write_all(&png::from_svg(&sheet)?)?,
        _ => file.write_all(sheet.as_bytes())?,
    }
    let bytes = file.finish()?;
    let patches: usize = sets.iter().map(|s| s.patches.len()).sum();
    let report = json!({ "file": output.to_string_lossy(), "sets": sets.len(), "patches": patches, "bytes": bytes });
    work::print(common, &report, &format!("{}: {patches} patches of {} sets", output.display(), sets.len()))
}
