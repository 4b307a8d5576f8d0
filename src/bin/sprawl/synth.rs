//! `sprawl synth`: a square made from maps, without a world.

use crate::beside::{self, Building, Plain};
use crate::common::{Common, Flag};
use crate::extract::{extract, left_out_in_words, map_name};
use crate::fail::{Fail, refuse_unused};
use crate::mask::MaskArgs;
use crate::output::{FileOptions, Format, Output, write, write_pair};
use crate::text;
use crate::values::{Turn, number, size, turn};
use crate::work;
use bevy_sprawl::export::svg::MapStyle;
use bevy_sprawl::export::{self, Plan, osm};
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::map::ExtractOptions;
use bevy_sprawl::network::Side;
use bevy_sprawl::patch::{Patch, PatchSet};
use bevy_sprawl::space::{Bounds, CHUNK_SIZE, Seed, line_length};
use bevy_sprawl::streets::{Synthesis, TileTable, synthesize};
use clap::Args;
use glam::DVec2;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Least length of streets in a window, in metres: any that has streets.
const LEAST_STREETS: f64 = 1.0;

/// About how large the parts are in which one of several maps prevails, in metres.
const BLEND: f64 = 500.0;

/// A size of parts.
fn blend(text: &str) -> Result<f64, String> {
    let size = number(text)?;
    if (50.0..=10_000.0).contains(&size) { Ok(size) } else { Err(format!("{size} is not from 50 to 10000")) }
}

#[derive(Args)]
pub struct SynthArgs {
    /// Maps: .osm .osm.pbf .geojson, road masks .png with --metres-per-pixel, or patch sets .ron with windows of maps
    #[arg(required = true, value_name = "MAP")]
    pub maps: Vec<PathBuf>,
    /// Edge of the square in metres
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = size)]
    pub size: f64,
    /// File to write: .svg .png .geojson or .osm
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub mask: MaskArgs,
    /// Edge of a tile in metres, 40 to 1000 [default: 200]
    #[arg(long, value_name = "M", value_parser = number)]
    pub tile: Option<f64>,
    /// Distance between the windows of a map that become tiles, in metres [default: 50]
    #[arg(long, value_name = "M", value_parser = number)]
    pub interval: Option<f64>,
    /// How far a tile may be moved over its map to fit its neighbours, in metres [default: 20]
    #[arg(long, value_name = "M", value_parser = number)]
    pub margin: Option<f64>,
    /// Angle of tiles in the map, in degrees counter-clockwise from east, or auto: as most streets run [default: auto]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = turn)]
    pub turn: Option<Turn>,
    /// Use tiles by quarter turns, too, not only as they lie in the map
    #[arg(long)]
    pub quarter_turns: bool,
    /// About how large the parts are in which one of several maps prevails, in metres, 50 to 10000 [default: 500]
    #[arg(long, value_name = "M", value_parser = blend)]
    pub blend: Option<f64>,
    /// Draw the first map beside it at the same scale, in an SVG or PNG
    #[arg(long)]
    pub beside: bool,
    /// Buildings in an OSM file too; some readers take every way for a street
    #[arg(long)]
    pub everything: bool,
    /// Width and height of an SVG or PNG [default: 1600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(64..=8192))]
    pub pixels: Option<u32>,
}

fn is_set(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ron"))
}

/// Runs the command.
pub fn run(common: &Common, args: &SynthArgs) -> Result<(), Fail> {
    common.refuse("`sprawl synth`", &[Flag::Settings, Flag::Assets, Flag::Edits])?;
    let formats = [("svg", Format::Svg), ("png", Format::Png), ("geojson", Format::GeoJson), ("osm", Format::Osm)];
    let format = Format::of(&args.output, &formats)?;
    let picture = matches!(format, Format::Svg | Format::Png);
    let all_sets = args.maps.iter().all(|path| is_set(path));
    let tiles = "a map: the windows of a patch set are cut already";
    refuse_unused([
        ("--beside", "a picture: a name that ends in .svg or .png", args.beside && !picture),
        ("--beside", "a map as its first file, not a patch set", args.beside && is_set(&args.maps[0])),
        ("--pixels", "a picture: a name that ends in .svg or .png", args.pixels.is_some() && !picture),
        ("--blend", "several maps", args.blend.is_some() && args.maps.len() == 1 && !all_sets),
        ("--everything", "an OSM file: a name that ends in .osm", args.everything && format != Format::Osm),
        ("--tile", tiles, args.tile.is_some() && all_sets),
        ("--interval", tiles, args.interval.is_some() && all_sets),
        ("--margin", tiles, args.margin.is_some() && all_sets),
        ("--turn", tiles, args.turn.is_some() && all_sets),
    ])?;
    let (patches, left_out) = patches(common, args)?;
    let named = patches.iter().map(|patch| (patch, Arc::from(patch.name.as_str())));
    let table = TileTable::new(named, args.quarter_turns);
    if table.is_empty() {
        let left_out = if all_sets { String::new() } else { format!("; left out: {}", left_out.join("; ")) };
        return Err(Fail::input(format!(
            "no window of a map is among the patches; extract windows, not pieces, and of no more than the map has room for{left_out}"
        )));
    }
    let mut file = Output::create(&args.output, &args.maps)?;
    let start = Instant::now();
    let made = synthesize(&table, args.size, args.blend.unwrap_or(BLEND), Seed(common.seed()), &Cancel::new())?;
    let seconds = start.elapsed().as_secs_f64();
    let bounds = Bounds::square(DVec2::ZERO, args.size);
    let mut area = export::streets(bounds, &made.network, CHUNK_SIZE);
    beside::build(
        &mut area,
        made.buildings.iter().map(|b| Building { outline: &b.outline, height: b.height, storeys: b.storeys }),
    );
    let plan = Plan {
        area: &area,
        outlines: &[],
        terrain: &Plain,
        chunk_size: CHUNK_SIZE,
        driving: Side::Right,
        real: None,
        projection: None,
    };
    let usual = MapStyle::default();
    let style = MapStyle { pixels: args.pixels.unwrap_or(usual.pixels), ..usual };
    let real = args.beside.then(|| {
        let mask = args.mask.options(args.maps.iter().map(PathBuf::as_path))?;
        Ok::<_, Fail>(beside::area(&beside::read(&args.maps[0], None, args.size, mask)?, CHUNK_SIZE))
    });
    match real.transpose()? {
        Some(real) => {
            let real = Plan { area: &real, ..plan };
            let [ours, theirs] = ["made from it", "a real map"].map(|title| MapStyle { title, ..style });
            write_pair([(&plan, &ours), (&real, &theirs)], format, &mut file)?;
        }
        None => {
            let osm = osm::Options { everything: args.everything, origin: None };
            write(&plan, format, &style, FileOptions { osm, ..FileOptions::default() }, &mut file)?;
        }
    }
    let bytes = file.finish()?;
    report(common, args, &made, patches.len(), seconds, bytes)
}

/// The patches of all maps and patch sets, and what was left out of each map.
fn patches(common: &Common, args: &SynthArgs) -> Result<(Vec<Arc<Patch>>, Vec<String>), Fail> {
    let (sets, maps): (Vec<PathBuf>, Vec<PathBuf>) = args.maps.iter().cloned().partition(|path| is_set(path));
    let usual = ExtractOptions::default();
    let options = ExtractOptions {
        size: args.tile.unwrap_or(usual.size),
        interval: args.interval.unwrap_or(usual.interval),
        margin: args.margin.unwrap_or(usual.margin),
        turn_deg: args.turn.and_then(|turn| turn.0),
        // Thin places of a map are a part of it, too.
        least_streets: LEAST_STREETS,
        // What a map has often is chosen often.
        keep_duplicates: true,
        ..usual
    };
    let mut out = Vec::new();
    for path in &sets {
        let set = PatchSet::from_ron(&path.to_string_lossy(), &text::read(path)?)?;
        out.extend(set.patches.into_iter().map(Arc::new));
    }
    let found = extract(common, &maps, &args.mask, &options)?;
    let left_out = found.iter().map(|map| format!("{}: {}", map.map, left_out_in_words(map))).collect();
    out.extend(found.into_iter().flat_map(|map| map.patches).map(|found| Arc::new(found.patch)));
    Ok((out, left_out))
}

/// Prints the figures.
fn report(
    common: &Common,
    args: &SynthArgs,
    made: &Synthesis,
    patches: usize,
    seconds: f64,
    bytes: u64,
) -> Result<(), Fail> {
    let metres: f64 = made.network.streets.iter().map(|s| line_length(&s.line)).sum();
    let junctions = made.junctions;
    let report = json!({
        "file": args.output.to_string_lossy(), "seconds": (seconds * 1e6).round() / 1e6,
        "area_km2": args.size * args.size / 1e6, "street_km": (metres / 10.0).round() / 100.0,
        "junctions": junctions, "dead_ends": made.dead_ends, "components": made.components,
        "mismatched_seams": made.mismatched_seams, "buildings": made.buildings.len(), "patches": patches, "tiles": made.tiles,
        "repeats_within_400_m": made.repeats, "bytes": bytes,
    });
    let names: Vec<String> = args.maps.iter().map(|path| map_name(path)).collect();
    let people = format!(
        "{}: {:.1} km of streets, {junctions} junctions, {} dead ends, {} parts; {} tiles of {patches} patches of {} ({:.0} ms)",
        args.output.display(),
        metres / 1000.0,
        made.dead_ends,
        made.components,
        made.tiles,
        names.join(", "),
        seconds * 1000.0
    );
    work::print(common, &report, &people)
}
