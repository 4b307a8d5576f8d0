//! `sprawl patches extract`: patches from real maps.

use crate::common::Common;
use crate::fail::Fail;
use crate::mask::MaskArgs;
use crate::output::{Format, Output};
use crate::values::{Turn, number, turn};
use crate::work;
use bevy_sprawl::export::png;
use bevy_sprawl::map::{self, ExtractOptions, Map, MapOptions, MapPatches, PatchKind};
use bevy_sprawl::patch::{self, PatchDrawing, PatchSet};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::{Display, Write as _};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// What patches are extracted.
#[derive(Args)]
pub struct ExtractArgs {
    /// Maps: .osm .osm.pbf .geojson, or road masks .png with --metres-per-pixel
    #[arg(required = true, value_name = "MAP")]
    pub maps: Vec<PathBuf>,
    /// Patch set to write: .ron
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub mask: MaskArgs,
    #[command(flatten)]
    pub options: OptionArgs,
    /// Draw the patches on a sheet, too: .svg or .png
    #[arg(long, value_name = "FILE")]
    pub sheet: Option<PathBuf>,
}

/// The options of an extraction.
#[derive(Args)]
pub struct OptionArgs {
    /// What a patch is
    #[arg(long = "as", value_name = "KIND", default_value = "windows")]
    pub kind: KindArg,
    /// Edge of a window, or greatest width of a piece, in metres: 40 to 1000
    #[arg(long, value_name = "M", default_value = "200", value_parser = number)]
    pub size: f64,
    /// Distance between the middles of patches, in metres
    #[arg(long, value_name = "M", default_value = "50", value_parser = number)]
    pub interval: f64,
    /// How far beyond a window its streets are drawn, in metres, so that it can be moved to fit its neighbours
    #[arg(long, value_name = "M", default_value = "20", value_parser = number)]
    pub margin: f64,
    /// Angle of the windows in the map, in degrees counter-clockwise from east, or auto: as most streets run
    #[arg(long, value_name = "DEG", default_value = "auto", allow_hyphen_values = true, value_parser = turn)]
    pub turn: Turn,
    /// Least length of streets in a patch, in metres
    #[arg(long, value_name = "M", default_value = "150", value_parser = number)]
    pub least_streets: f64,
    /// Keep patches of the same shape
    #[arg(long)]
    pub keep_duplicates: bool,
    /// Greatest number of patches, of all maps together: the most varied ones [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub most: Option<u32>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum KindArg {
    /// Square windows that slide over the map, for the filler PatchCity
    Windows,
    /// Connected pieces of local streets around main streets, for the filler SemanticPatches
    Pieces,
}

impl OptionArgs {
    /// The options of the library.
    pub fn options(&self) -> ExtractOptions {
        ExtractOptions {
            kind: if self.kind == KindArg::Windows { PatchKind::Windows } else { PatchKind::Pieces },
            size: self.size,
            interval: self.interval,
            margin: self.margin,
            turn_deg: self.turn.0,
            least_streets: self.least_streets,
            keep_duplicates: self.keep_duplicates,
            most: self.most.map(|most| most as usize),
        }
    }
}

/// The name of a map: that of its file, without folders and endings.
pub fn map_name(path: &Path) -> String {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    name.split('.').next().unwrap_or_default().to_owned()
}

/// Reads maps and extracts their patches, each map on a thread.
pub fn extract(
    common: &Common,
    paths: &[PathBuf],
    mask: &MaskArgs,
    options: &ExtractOptions,
) -> Result<Vec<MapPatches>, Fail> {
    let mask = mask.options(paths.iter().map(PathBuf::as_path))?;
    let read = |path: &PathBuf| {
        let map = Map::read(path, &MapOptions { mask, ..MapOptions::default() })?;
        map::extract(&map, &map_name(path), options).map_err(|e| Fail::file(path, e))
    };
    let mut maps = work::each(common, "extracting patches", paths, read)?;
    map::select(&mut maps, options);
    Ok(maps)
}

/// Runs the command.
pub fn run(common: &Common, args: &ExtractArgs) -> Result<(), Fail> {
    if args.output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("ron")) {
        return Err(Fail::file(&args.output, "the name of a patch set must end in .ron"));
    }
    let formats = [("svg", Format::Svg), ("png", Format::Png)];
    let sheet = args.sheet.as_ref().map(|path| Ok::<_, Fail>((path, Format::of(path, &formats)?))).transpose()?;
    let mut file = Output::create(&args.output, &args.maps)?;
    let maps = extract(common, &args.maps, &args.mask, &args.options.options())?;
    let drawings: Vec<PatchDrawing> = maps.iter().flat_map(|m| &m.patches).map(|p| p.drawing.clone()).collect();
    if drawings.is_empty() {
        let reasons: Vec<String> = maps.iter().map(left_out_in_words).collect();
        return Err(Fail::input(format!("no patch was found; left out: {}", reasons.join("; "))));
    }
    file.write_all(patch::to_ron(&drawings).as_bytes())?;
    let bytes = file.finish()?;
    if let Some((path, format)) = sheet {
        let patches = maps.iter().flat_map(|m| &m.patches).map(|p| p.patch.clone()).collect();
        let set = PatchSet { name: map_name(&args.output), patches, patterns: Vec::new() };
        let drawn = patch::draw_sheet(&[&set]);
        let mut file = Output::create(path, &args.maps)?;
        match format {
            Format::Png => file.write_all(&png::from_svg(&drawn)?)?,
            _ => file.write_all(drawn.as_bytes())?,
        }
        file.finish()?;
    }
    let report = |(path, map): (&PathBuf, &MapPatches)| {
        let left_out: BTreeMap<&str, usize> = map.left_out.iter().map(|(reason, n)| (reason.key(), *n)).collect();
        let not_read: BTreeMap<&str, usize> = map.not_read.iter().map(|(reason, n)| (reason.key(), *n)).collect();
        json!({
            "file": path.to_string_lossy(), "km": (map.length / 10.0).round() / 100.0, "junctions": map.junctions,
            "buildings": map.buildings, "patches": map.patches.len(), "left_out": left_out,
            "not_read": not_read,
        })
    };
    let list: Vec<Value> = args.maps.iter().zip(&maps).map(report).collect();
    let mut people = String::new();
    for map in &maps {
        let (km, patches) = (map.length / 1000.0, map.patches.len());
        // Writing to a string cannot fail.
        let _ = writeln!(
            people,
            "{}: {km:.1} km of streets, {} junctions, {} buildings; {patches} patches, left out: {}; of the file: {}",
            map.map,
            map.junctions,
            map.buildings,
            left_out_in_words(map),
            in_words(&map.not_read)
        );
    }
    let _ = writeln!(people, "{}: {} patches", args.output.display(), drawings.len());
    let output = args.output.to_string_lossy();
    work::print(common, &json!({ "file": output, "maps": list, "patches": drawings.len(), "bytes": bytes }), &people)
}

/// What was left out of a map and why, in words.
pub fn left_out_in_words(map: &MapPatches) -> String {
    in_words(&map.left_out)
}

fn in_words<R: Display>(counts: &BTreeMap<R, usize>) -> String {
    let reasons: Vec<String> = counts.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    if reasons.is_empty() { "none".into() } else { reasons.join(", ") }
}
