//! `sprawl patches`: checks and draws patch sets, and extracts them from maps.

use crate::common::{Common, Flag};
use crate::extract::{self, ExtractArgs};
use crate::fail::Fail;
use crate::output::{Format, Output};
use crate::text;
use crate::work;
use bevy_sprawl::export::png;
use bevy_sprawl::layer::{FileError, ron_files};
use bevy_sprawl::patch::{self, PatchSet};
use bevy_sprawl::world::{WorldAssets, set_warnings};
use clap::{Args, Subcommand};
use serde_json::{Map, Value, json};
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
    /// Read patch sets and name what is wrong with them, and what of them can never be used; `--assets DIR` holds all sets
    /// of a folder against all its styles
    Check {
        /// Patch sets, or folders of them
        #[arg(value_name = "FILE")]
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
    /// Extract patches from real maps
    Extract(Box<ExtractArgs>),
}

/// Runs the command.
pub fn run(common: &Common, args: &PatchesArgs) -> Result<(), Fail> {
    common.refuse("`sprawl patches`", &[Flag::Seed, Flag::Settings, Flag::Edits])?;
    match &args.command {
        PatchesCommand::Check { files } => check(common, files),
        PatchesCommand::Draw { files, output } => {
            common.refuse("`sprawl patches draw`", &[Flag::Assets])?;
            draw(common, files, output)
        }
        PatchesCommand::Extract(args) => {
            common.refuse("`sprawl patches extract`", &[Flag::Assets])?;
            extract::run(common, args)
        }
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

/// What a check found.
#[derive(Default)]
struct Checked {
    sets: Vec<Value>,
    /// The sets, a line each.
    people: String,
    warnings: Vec<FileError>,
    errors: Vec<FileError>,
}

impl Checked {
    /// Notes a set with its patches and tags, or the error of its file; returns the set.
    fn note(&mut self, file: &str, set: Result<PatchSet, FileError>) -> Option<PatchSet> {
        let set = set.map_err(|error| self.errors.push(error)).ok()?;
        let mut tags: BTreeMap<&str, usize> = BTreeMap::new();
        set.patches.iter().flat_map(|p| &p.tags).for_each(|tag| *tags.entry(tag).or_default() += 1);
        let (patches, patterns) = (set.patches.len(), set.patterns.len());
        // Writing to a string cannot fail.
        let _ = write!(self.people, "{file}: {patches} patches, {patterns} patterns;");
        let tags: Map<_, _> = tags.into_iter().map(|(tag, n)| (tag.to_owned(), json!(n))).collect();
        for (tag, count) in &tags {
            let _ = write!(self.people, " {tag} {count}");
        }
        self.people.push('\n');
        self.sets.push(json!({
            "file": file, "name": set.name, "patches": patches, "patterns": patterns, "tags": tags,
        }));
        Some(set)
    }

    /// Sets alone, without styles.
    fn sets(files: &[PathBuf]) -> Self {
        let mut out = Self::default();
        for path in files {
            let file = path.to_string_lossy();
            let text = text::read(path);
            let set = text.clone().and_then(|text| PatchSet::from_ron(&file, &text));
            if let (Some(set), Ok(text)) = (out.note(&file, set), text) {
                out.warnings.extend(set_warnings(&set, &file, &text));
            }
        }
        out
    }

    /// The styles and sets of a folder of assets, held against each other.
    fn assets(folder: &Path) -> Result<Self, Fail> {
        let (mut out, mut assets) = (Self::default(), WorldAssets::default());
        for path in ron_files(&folder.join("styles"))?.into_iter().chain(ron_files(&folder.join("patches"))?) {
            let file = path.to_string_lossy();
            let added = text::read(&path).and_then(|text| assets.add(&file, &text).map(|()| text));
            match added {
                Err(error) => out.errors.push(error),
                Ok(text) if path.starts_with(folder.join("patches")) => {
                    out.note(&file, PatchSet::from_ron(&file, &text));
                }
                Ok(_) => {}
            }
        }
        if !out.errors.is_empty() {
            return Ok(out);
        }
        match assets.check_styles() {
            Ok(()) => out.warnings = assets.warnings()?,
            Err(error) => out.errors.push(assets.locate(&error).ok_or_else(|| Fail::file(folder, error))?),
        }
        Ok(out)
    }
}

/// Names every set with its patches and tags, what of it can never be used, and every file that has an error.
fn check(common: &Common, paths: &[PathBuf]) -> Result<(), Fail> {
    let checked = match (&common.assets, paths) {
        (Some(folder), []) => Checked::assets(folder)?,
        (None, [_, ..]) => Checked::sets(&expand(paths)?),
        (Some(_), _) => return Err(Fail::input("`sprawl patches check` takes files or --assets, not both")),
        (None, []) => return Err(Fail::input("`sprawl patches check` needs patch sets, or --assets with a folder")),
    };
    let Checked { sets, mut people, warnings, errors } = checked;
    for warning in &warnings {
        let _ = writeln!(people, "warning: {warning}");
    }
    let list = |errors: &[FileError]| -> Vec<Value> {
        let one = |e: &FileError| json!({ "file": e.file, "line": e.line, "column": e.column, "reason": e.reason });
        errors.iter().map(one).collect()
    };
    let report = json!({ "sets": sets, "warnings": list(&warnings), "errors": list(&errors) });
    work::print(common, &report, &people)?;
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
