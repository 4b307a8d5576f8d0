//! `sprawl map`: draws or exports a square.

use crate::beside;
use crate::common::{At, Common};
use crate::fail::{Fail, refuse_unused};
use crate::mask::MaskArgs;
use crate::output::{FileOptions, Format, Output, spelled_in_latin, write, write_pair};
use crate::values::{point, size};
use crate::work;
use bevy_sprawl::export::glb::PlacedMesh;
use bevy_sprawl::export::svg::{Colouring, MapStyle};
use bevy_sprawl::export::{self, Plan, geojson, glb, osm};
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::mesh::{self, Detail, HorizonTile};
use bevy_sprawl::space::Bounds;
use bevy_sprawl::world::{Area, World};
use clap::{Args, ValueEnum};
use glam::DVec2;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

/// Largest square that is written as one GLB file, in metres.
const GLB_MOST: f64 = 16_000.0;
/// Largest square of the land as seen from its middle, in metres.
const HORIZON_MOST: f64 = 200_000.0;
/// Beyond this, a picture shows the region unless told otherwise.
const REGION_FROM: f64 = 20_000.0;

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
    /// Width and height of an SVG or PNG [default: 1600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(64..=8192))]
    pub pixels: Option<u32>,
    /// What the colours of streets show in an SVG or PNG [default: class]
    #[arg(long, value_name = "WHAT")]
    pub colour_by: Option<ColourBy>,
    /// A real town to draw beside it at the same scale, in an SVG or PNG: .osm .osm.pbf or .geojson, in degrees, or a road
    /// mask .png with --metres-per-pixel
    #[arg(long, value_name = "FILE")]
    pub beside: Option<PathBuf>,
    /// Middle of the real town [default: that of the file's streets]
    #[arg(long, value_name = "LON,LAT", requires = "beside", allow_hyphen_values = true, value_parser = point)]
    pub beside_at: Option<DVec2>,
    #[command(flatten)]
    pub mask: MaskArgs,
    /// How much an SVG or PNG shows [default: auto]
    #[arg(long, value_name = "WHAT")]
    pub show: Option<Show>,
    /// Buildings, parks and names in an OSM file too; some readers take every way for a street
    #[arg(long)]
    pub everything: bool,
    /// Plan point that an OSM file has at latitude 0, longitude 0: squares of one world with the same origin fit together, with
    /// the same ids for what they share [default: the middle of the square]
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    pub origin: Option<DVec2>,
    /// Cut streets, blocks and buildings at the border of the square, in a GeoJSON or OSM file
    #[arg(long)]
    pub clip: bool,
    /// Lanes, and turns through junctions, in a GeoJSON file too
    #[arg(long)]
    pub lanes: bool,
    /// Level of detail of a GLB [default: full]
    #[arg(long, value_name = "LEVEL")]
    pub detail: Option<DetailArg>,
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
    /// The land as seen from the middle of the square: tiles that get larger the farther they lie
    Horizon,
}

/// Runs the command.
pub fn run(common: &Common, args: &MapArgs) -> Result<(), Fail> {
    let formats = [
        ("svg", Format::Svg),
        ("png", Format::Png),
        ("geojson", Format::GeoJson),
        ("osm", Format::Osm),
        ("glb", Format::Glb),
    ];
    let format = Format::of(&args.output, &formats)?;
    let most = if args.detail == Some(DetailArg::Horizon) { HORIZON_MOST } else { GLB_MOST };
    if format == Format::Glb && args.size > most {
        return Err(Fail::input(format!("--size {} is too large for a GLB: at most {most} m", args.size)));
    }
    check_flags(args, format)?;
    // Whatever may be refused is read before the world is made.
    let mask = args.mask.options(args.beside.as_deref())?;
    let real = args.beside.as_ref().map(|path| beside::read(path, args.beside_at, args.size, mask)).transpose()?;
    let world = work::world(common)?;
    let bounds = work::square(&world, &args.at, args.size)?;
    // A file that cannot be written is refused before the work.
    let inputs: Vec<PathBuf> = common.inputs().into_iter().chain(args.beside.clone()).collect();
    let mut file = Output::create(&args.output, &inputs)?;
    let start = Instant::now();
    let mut report = json!({ "file": args.output.to_string_lossy(), "at": args.at.at.to_array(), "size_m": args.size });
    let mut names = String::new();
    let content = if format == Format::Glb {
        let meshes = meshes(common, &world, bounds, args.detail.unwrap_or(DetailArg::Full))?;
        file.write_all(&glb::write(&meshes, bounds.centre())?)?;
        report["chunks"] = json!(meshes.len());
        format!("{} chunks", meshes.len())
    } else {
        let picture = matches!(format, Format::Svg | Format::Png);
        let region = picture
            && match args.show.unwrap_or(Show::Auto) {
                Show::Auto => args.size > REGION_FROM,
                Show::Streets => false,
                Show::Region => true,
            };
        let area =
            if region { export::region(&world, bounds, &Cancel::new())? } else { work::area(common, &world, bounds)? };
        let area = if args.clip { export::clipped(&area) } else { area };
        let outlines = export::outlines(&world, &area)?;
        let terrain = world.terrain().clone();
        let plan = Plan {
            area: &area,
            outlines: &outlines,
            terrain: &*terrain,
            chunk_size: world.settings().chunk_size,
            driving: world.settings().driving,
            real: None,
            projection: None,
        };
        let colouring = match args.colour_by.unwrap_or(ColourBy::Class) {
            ColourBy::Class => Colouring::Class,
            ColourBy::Origin => Colouring::Origin,
        };
        let usual = MapStyle::default();
        let style = MapStyle { pixels: args.pixels.unwrap_or(usual.pixels), colouring, ..usual };
        let real = real.as_ref().map(|map| beside::area(map, world.settings().chunk_size));
        let draw = || match &real {
            Some(real) => {
                let real = Plan { area: real, outlines: &[], terrain: &beside::Plain, ..plan };
                let [ours, theirs] = ["this world", "a real town"].map(|title| MapStyle { title, ..style });
                write_pair([(&plan, &ours), (&real, &theirs)], format, &mut file)
            }
            None => {
                let options = FileOptions {
                    osm: osm::Options { everything: args.everything, origin: args.origin },
                    geojson: geojson::Options { lanes: args.lanes },
                };
                write(&plan, format, &style, options, &mut file)
            }
        };
        work::pool(common)?.install(draw)?;
        if format == Format::Osm {
            let origin = args.origin.unwrap_or_else(|| bounds.centre());
            report["osm_origin"] = json!({ "plan": origin.to_array(), "metres_per_degree": osm::METRES_PER_DEGREE });
        }
        for (key, count) in counts(&area) {
            report[key] = json!(count);
        }
        let (spelled_json, spelled) = spelled_in_latin(&plan, format);
        report["spelled_in_latin"] = spelled_json;
        names = spelled;
        if let Some(real) = &real {
            report["beside"] = counts(real).into_iter().map(|(key, count)| (key.to_owned(), json!(count))).collect();
        }
        counts(&area).map(|(key, count)| format!("{count} {key}")).join(", ")
    };
    report["bytes"] = json!(file.finish()?);
    report["seconds"] = json!((start.elapsed().as_secs_f64() * 1000.0).round() / 1000.0);
    let people = format!("{}: {content} ({} s){names}", args.output.display(), report["seconds"]);
    work::print(common, &report, &people)
}

/// Fails if a flag is given that a format has no use for.
fn check_flags(args: &MapArgs, format: Format) -> Result<(), Fail> {
    let picture = matches!(format, Format::Svg | Format::Png);
    refuse_unused([
        ("--beside", "a picture: a name that ends in .svg or .png", args.beside.is_some() && !picture),
        ("--pixels", "a picture: a name that ends in .svg or .png", args.pixels.is_some() && !picture),
        ("--colour-by", "a picture: a name that ends in .svg or .png", args.colour_by.is_some() && !picture),
        ("--show", "a picture: a name that ends in .svg or .png", args.show.is_some() && !picture),
        ("--origin", "an OSM file: a name that ends in .osm", args.origin.is_some() && format != Format::Osm),
        (
            "--clip",
            "a GeoJSON or OSM file: a name that ends in .geojson or .osm",
            args.clip && !matches!(format, Format::GeoJson | Format::Osm),
        ),
        ("--lanes", "a GeoJSON file: a name that ends in .geojson", args.lanes && format != Format::GeoJson),
        ("--everything", "an OSM file: a name that ends in .osm", args.everything && format != Format::Osm),
        ("--detail", "a GLB file: a name that ends in .glb", args.detail.is_some() && format != Format::Glb),
    ])
}

fn counts(area: &Area) -> [(&'static str, usize); 5] {
    [
        ("streets", area.streets.len()),
        ("junctions", area.junctions.len()),
        ("blocks", area.blocks.len()),
        ("buildings", area.footprints.len()),
        ("settlements", area.settlements.len()),
    ]
}

fn meshes(common: &Common, world: &World, bounds: Bounds, detail: DetailArg) -> Result<Vec<PlacedMesh>, Fail> {
    let cancel = Cancel::new();
    let detail = match detail {
        DetailArg::Full => Detail::Full,
        DetailArg::Reduced => Detail::Reduced,
        DetailArg::Horizon => {
            let chunk_size = world.settings().chunk_size;
            let tiles = mesh::horizon_tiles(bounds.centre(), bounds.size().x / 2.0, chunk_size);
            return work::each(common, "building meshes", &tiles, |tile| {
                let HorizonTile { level, x, y } = *tile;
                let (name, origin) = (format!("level {level} tile {x},{y}"), tile.origin(chunk_size));
                Ok(PlacedMesh { name, origin, mesh: world.horizon(*tile, &cancel)? })
            });
        }
    };
    work::each(common, "building meshes", &work::chunks(world, bounds), |coord| {
        let chunk = world.chunk(*coord, &cancel)?;
        Ok(PlacedMesh {
            name: format!("chunk {coord}"),
            origin: chunk.origin,
            mesh: mesh::build(&chunk, &**world.terrain(), detail, &cancel)?,
        })
    })
}
