//! Commands and their flags.

use crate::towns::Kind;
use bevy_sprawl::region::Populations;
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::DVec2;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;

/// Endless worlds of towns: maps, figures and checks.
#[derive(Parser)]
#[command(name = "sprawl", version, max_term_width = 100)]
pub struct Cli {
    #[command(flatten)]
    pub common: Common,
    #[command(subcommand)]
    pub command: Command,
}

/// Flags of every command.
#[derive(Args)]
pub struct Common {
    /// Seed of the world
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Settings of the world, a RON file
    #[arg(long, global = true, value_name = "FILE")]
    pub settings: Option<PathBuf>,
    /// Folder with `styles/*.ron` and `patches/*.ron` in place of the bundled ones
    #[arg(long, global = true, value_name = "DIR")]
    pub assets: Option<PathBuf>,
    /// Wishes for settlements and roads, a RON file
    #[arg(long, global = true, value_name = "FILE")]
    pub edits: Option<PathBuf>,
    /// Threads to work on [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Write one JSON object to stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// The edits that the world cannot fulfil, once it is made with edits.
    #[arg(skip)]
    pub rejected: OnceLock<Vec<String>>,
}

#[derive(Subcommand)]
pub enum Command {
    /// Draw or export a square of the world
    Map(MapArgs),
    /// Figures of the streets, blocks and buildings of a square
    Stats(StatsArgs),
    /// Settlements of a square and the roads between them
    Settlements(SettlementsArgs),
    /// A hash per layer and chunk, to compare worlds bit for bit
    Digest(DigestArgs),
    /// Check a city of each of many worlds: ends, crossings, loose pieces, buildings on streets
    Soak(SoakArgs),
    /// Count streets near chunk borders and away from them: nothing may tell where the borders are
    Seams(SeamsArgs),
    /// Measure towns of every style, and hold them against real ones
    Towns(TownsArgs),
    /// What the parametric generator can make: connectivity against density of many networks
    ExpressiveRange(ExpressiveArgs),
    /// Roads between given settlements on given ground
    Roads(Box<RoadsArgs>),
    /// Check or draw patch sets
    Patches(PatchesArgs),
}

/// The middle of a square.
#[derive(Args)]
pub struct At {
    /// Middle of the square, metres east and north
    #[arg(long, value_name = "X,Y", default_value = "0,0", allow_hyphen_values = true, value_parser = point)]
    pub at: DVec2,
}

#[derive(Args)]
pub struct MapArgs {
    #[command(flatten)]
    pub at: At,
    /// Edge of the square in metres
    #[arg(long, value_name = "M", default_value = "2000", allow_hyphen_values = true, value_parser = size)]
    pub size: f64,
    /// File to write: .svg .png .geojson .osm or .glb
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Width and height of an SVG or PNG
    #[arg(long, value_name = "N", default_value_t = 1600, value_parser = clap::value_parser!(u32).range(64..=8192))]
    pub pixels: u32,
    /// What the colours of streets say in an SVG or PNG
    #[arg(long, value_name = "WHAT", default_value = "class")]
    pub colour_by: ColourBy,
    /// A real town to draw beside it at the same scale, in an SVG or PNG: .osm .osm.pbf or .geojson, in degrees
    #[arg(long, value_name = "FILE")]
    pub beside: Option<PathBuf>,
    /// Middle of the real town [default: that of the file's streets]
    #[arg(long, value_name = "LON,LAT", requires = "beside", allow_hyphen_values = true, value_parser = point)]
    pub beside_at: Option<DVec2>,
    /// How much an SVG or PNG shows
    #[arg(long, value_name = "WHAT", default_value = "auto")]
    pub show: Show,
    /// Buildings, parks and names in an OSM file too; some readers take every way for a street
    #[arg(long)]
    pub everything: bool,
    /// Level of detail of a GLB
    #[arg(long, value_name = "LEVEL", default_value = "full")]
    pub detail: DetailArg,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ColourBy {
    /// Class: highway, major, minor, arterial, main, local
    Class,
    /// What made it: main street, patch, growth, repair
    Origin,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Show {
    /// Streets up to 20 km, the region beyond
    Auto,
    /// Everything
    Streets,
    /// Settlements and roads alone
    Region,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DetailArg {
    /// Everything
    Full,
    /// Coarse ground, flat ribbons and boxes
    Reduced,
}

#[derive(Args)]
pub struct StatsArgs {
    #[command(flatten)]
    pub at: At,
    /// Edge of the square in metres
    #[arg(long, value_name = "M", default_value = "2000", allow_hyphen_values = true, value_parser = size)]
    pub size: f64,
}

#[derive(Args)]
pub struct SettlementsArgs {
    #[command(flatten)]
    pub at: At,
    /// Edge of the square in metres
    #[arg(long, value_name = "M", default_value = "20000", allow_hyphen_values = true, value_parser = size)]
    pub size: f64,
}

#[derive(Args)]
pub struct DigestArgs {
    /// Columns and rows of chunks, ends excluded
    #[arg(long, value_name = "X0..X1,Y0..Y1", allow_hyphen_values = true, value_parser = chunk_range)]
    pub chunks: ChunkRange,
    /// Order in which the chunks are made; the hashes do not depend on it
    #[arg(long, value_name = "ORDER", default_value = "forward")]
    pub order: Order,
}

/// Columns and rows of chunks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChunkRange {
    pub x: Range<i32>,
    pub y: Range<i32>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Order {
    /// Column by column
    Forward,
    /// The other way round
    Reverse,
    /// In an order that follows from the seed
    Shuffled,
}

#[derive(Args)]
pub struct SoakArgs {
    /// Seeds of the worlds, the end excluded
    #[arg(long, value_name = "A..B", value_parser = seed_range, required_unless_present = "towns")]
    pub seeds: Option<Range<u64>>,
    /// Check instead this many towns of every size and style, 12 to a world: seeds from that of `--seed` on
    #[arg(long, value_name = "N", conflicts_with_all = ["seeds", "edits_random", "windows"])]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub towns: Option<u32>,
    /// Check each world with edits of every kind around its city, drawn from its seed; way points and pinned settlements are
    /// checked, too
    #[arg(long, conflicts_with = "edits")]
    pub edits_random: bool,
    /// Check instead that the roads of a far window in each world are the same alone and after a larger window around it
    #[arg(long, conflicts_with_all = ["edits", "edits_random"])]
    pub windows: bool,
}

#[derive(Args)]
pub struct RoadsArgs {
    /// Heights: an ESRI ASCII grid (.asc), or a grey .png with --cell and --white
    #[arg(long, value_name = "FILE")]
    pub terrain: PathBuf,
    /// Settlements: a CSV file with the columns name,x,y,sigma (or population) and perhaps radius_m
    #[arg(long, value_name = "FILE")]
    pub settlements: PathBuf,
    /// File to write: .svg .png or .geojson
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Density of the roads, 1.01 or more: 2 is a Gabriel graph, inf the relative neighbour graph [default: as the settings
    /// have it for each class]
    #[arg(long, value_name = "G", allow_hyphen_values = true, value_parser = gamma)]
    pub gamma: Option<f64>,
    /// Places are in degrees: x is longitude, y latitude
    #[arg(long)]
    pub geographic: bool,
    /// Spacing in whole metres of the lattice that roads are found on [default: the cell of an ASCII grid, a 256th of the
    /// domain of a picture; less where settlements lie nearer to each other]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(i64).range(10..=20_000))]
    pub step: Option<i64>,
    /// Ground below this height in metres is under water
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub sea_level: Option<f64>,
    /// Height of cells without a number [default: such a file is refused]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub fill: Option<f64>,
    /// Depths of lakes and rivers in metres, 0 on land, or a mask of 0 and 1: a grid like that of the heights, though of any
    /// cells, or a grey .png over all of the domain. Heights there are those of the water's surface
    #[arg(long, value_name = "FILE")]
    pub water: Option<PathBuf>,
    /// Depth of white in a picture of water, in metres
    #[arg(long, value_name = "M", default_value = "1", requires = "water", value_parser = number)]
    pub water_white: f64,
    /// Density of vegetation, 0 (bare) to 1 (dense wood): a grid like that of the heights, though of any cells, or a grey
    /// .png over all of the domain
    #[arg(long, value_name = "FILE")]
    pub vegetation: Option<PathBuf>,
    /// Inhabitants from which on a settlement is a town, and a city, where the table has them
    #[arg(long, value_name = "T,C", default_value = "2000,20000", value_parser = populations)]
    pub populations: Populations,
    /// Real roads to compare with: .osm .osm.pbf (both with --geographic) or .geojson, in metres or degrees as the ground
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Which of the real roads: values of the tag highway, each with its `_link`
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "reference")]
    #[arg(default_values = ["motorway", "trunk", "primary", "secondary", "tertiary"])]
    pub reference_classes: Vec<String>,
    /// Real roads on a map of their own beside that of these, not under them
    #[arg(long, requires = "reference")]
    pub compare: bool,
    /// South-west corner of a picture
    #[arg(long, value_name = "X,Y", default_value = "0,0", allow_hyphen_values = true, value_parser = point)]
    pub corner: DVec2,
    /// Edge of a picture's pixel, in metres or degrees
    #[arg(long, value_name = "M", value_parser = number)]
    pub cell: Option<f64>,
    /// Height of black in a picture, in metres
    #[arg(long, value_name = "M", default_value = "0", allow_hyphen_values = true, value_parser = number)]
    pub black: f64,
    /// Height of white in a picture, in metres
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub white: Option<f64>,
    /// Longer side of an SVG or PNG
    #[arg(long, value_name = "N", default_value_t = 1600, value_parser = clap::value_parser!(u32).range(64..=8192))]
    pub pixels: u32,
}

#[derive(Args)]
pub struct SeamsArgs {
    /// Square kilometres of towns to count, around the origin
    #[arg(long, value_name = "N", default_value = "200", value_parser = size)]
    pub km2: f64,
    /// Greatest difference between what is near borders and the rest, as a share
    #[arg(long, value_name = "SHARE", default_value = "0.03", value_parser = number)]
    pub most_difference: f64,
    /// Greatest peak of the spectrum at the chunk's edge and its harmonics, over what is around them
    #[arg(long, value_name = "RATIO", default_value = "3", value_parser = number)]
    pub most_peak: f64,
}

#[derive(Args)]
pub struct TownsArgs {
    /// Seeds of the worlds, one town of each style in each, the end excluded
    #[arg(long, value_name = "A..B", default_value = "0..20", value_parser = seed_range)]
    pub seeds: Range<u64>,
    /// Names of styles [default: every style]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub style: Vec<String>,
    /// Radius of a town in metres [default: 340 for villages, 900 for others]
    #[arg(long, value_name = "M", value_parser = radius)]
    pub radius: Option<f64>,
    /// Kind of real towns to compare with [default: what the style stands for]
    #[arg(long, value_name = "KIND")]
    pub kind: Option<Kind>,
    /// File to write the tables to, as markdown
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

#[derive(Args)]
pub struct ExpressiveArgs {
    /// Networks for each pair of a range of degrees and a least angle
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub networks: u64,
    /// Folder to write `expressive-range.csv`, a figure of all pairs (`.svg`) and one of all networks (`-all.svg`) to
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

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

/// Longest edge of a square, in metres.
const MOST: f64 = 200_000.0;

fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is no number"))
}

fn point(text: &str) -> Result<DVec2, String> {
    let (x, y) = text.split_once(',').ok_or("two numbers with a comma between them are needed, such as -5,7")?;
    let point = DVec2::new(number(x)?, number(y)?);
    if point.is_finite() { Ok(point) } else { Err("both numbers must be finite".into()) }
}

fn gamma(text: &str) -> Result<f64, String> {
    let gamma = number(text)?;
    if gamma >= 1.01 { Ok(gamma) } else { Err("1.01 or more is allowed, or inf".into()) }
}

fn populations(text: &str) -> Result<Populations, String> {
    let (town, city) =
        text.split_once(',').ok_or("two numbers with a comma between them are needed, such as 2000,20000")?;
    let both = Populations { town: number(town)?, city: number(city)? };
    let rising = both.town >= 0.0 && both.town <= both.city && both.city.is_finite();
    if rising { Ok(both) } else { Err("0 or more is allowed for a town, and no less for a city".into()) }
}

fn size(text: &str) -> Result<f64, String> {
    let size = number(text)?;
    if size > 0.0 && size <= MOST { Ok(size) } else { Err(format!("more than 0 and at most {MOST} m is allowed")) }
}

fn radius(text: &str) -> Result<f64, String> {
    let radius = number(text)?;
    if (120.0..=5000.0).contains(&radius) { Ok(radius) } else { Err("120 to 5000 m is allowed".into()) }
}

fn seed_range(text: &str) -> Result<Range<u64>, String> {
    let (from, to) = text.split_once("..").ok_or("a range is needed, such as 0..100")?;
    let whole = |t: &str| t.trim().parse::<u64>().map_err(|_| format!("`{t}` is no whole number"));
    let range = whole(from)?..whole(to)?;
    match range.end.saturating_sub(range.start) {
        0 => Err(format!("{text} holds no seed: its end is excluded")),
        1..=1_000_000 => Ok(range),
        _ => Err("more than a million seeds".into()),
    }
}

fn chunk_range(text: &str) -> Result<ChunkRange, String> {
    let range = |text: &str| {
        let (from, to) = text.split_once("..").ok_or("two ranges are needed, such as -2..3,0..4")?;
        let whole = |t: &str| t.trim().parse::<i32>().map_err(|_| format!("`{t}` is no whole number of 32 bits"));
        let range = whole(from)?..whole(to)?;
        if range.is_empty() { Err(format!("{text} holds no chunk: its end is excluded")) } else { Ok(range) }
    };
    let (x, y) = text.split_once(',').ok_or("two ranges with a comma between them are needed, such as -2..3,0..4")?;
    let out = ChunkRange { x: range(x)?, y: range(y)? };
    let count = |r: &Range<i32>| i64::from(r.end) - i64::from(r.start);
    if count(&out.x).saturating_mul(count(&out.y)) > 1_000_000 {
        return Err("more than a million chunks".into());
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_flags_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn negative_numbers_work_in_both_forms() {
        for flags in [&["--at", "-5,7.5"][..], &["--at=-5,7.5"]] {
            let all = [&["sprawl", "stats"][..], flags, &["--seed", "18446744073709551615"]].concat();
            let cli = Cli::try_parse_from(all).unwrap();
            assert_eq!(cli.common.seed, u64::MAX);
            let Command::Stats(stats) = cli.command else { panic!() };
            assert_eq!(stats.at.at, DVec2::new(-5.0, 7.5));
        }
        for flags in [&["--chunks", "-2..1,-9..-8"][..], &["--chunks=-2..1,-9..-8"]] {
            let cli = Cli::try_parse_from([&["sprawl", "digest"][..], flags].concat()).unwrap();
            let Command::Digest(digest) = cli.command else { panic!() };
            assert_eq!(digest.chunks, ChunkRange { x: -2..1, y: -9..-8 });
        }
    }

    #[test]
    fn bad_values_are_refused() {
        for bad in ["0", "-1", "NaN", "inf", "200000.1", "x", ""] {
            assert!(size(bad).is_err(), "{bad}");
        }
        for bad in ["1", "1,", "a,2", "NaN,0", "0,inf", "1,2,3"] {
            assert!(point(bad).is_err(), "{bad}");
        }
        for bad in ["0..1", "1..1,0..1", "2..1,0..1", "0..1,0", "0..2000,0..2000", "-2147483648..2147483647,0..1"] {
            assert!(chunk_range(bad).is_err(), "{bad}");
        }
        assert_eq!(size("200000"), Ok(200_000.0));
    }
}
