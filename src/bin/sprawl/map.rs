//! `sprawl map`: draws or exports a square.

use crate::args::{ColourBy, Common, DetailArg, MapArgs, Show};
use crate::beside;
use crate::fail::Fail;
use crate::work;
use bevy_sprawl::export::glb::PlacedMesh;
use bevy_sprawl::export::svg::{Colouring, MapStyle};
use bevy_sprawl::export::{self, ExportError, Plan, geojson, glb, osm, png, svg};
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::mesh::{self, Detail};
use bevy_sprawl::space::Bounds;
use bevy_sprawl::world::{Area, World};
use serde_json::json;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

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

/// Largest square that is written as one GLB file, in metres.
const GLB_MOST: f64 = 16_000.0;
/// Beyond this, a picture shows the region unless told otherwise.
const REGION_FROM: f64 = 20_000.0;

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
    if format == Format::Glb && args.size > GLB_MOST {
        return Err(Fail::input(format!("--size {} is too large for a GLB: at most {GLB_MOST} m", args.size)));
    }
    if args.beside.is_some() && !matches!(format, Format::Svg | Format::Png) {
        return Err(Fail::input("--beside needs a picture: a name that ends in .svg or .png"));
    }
    let world = work::world(common)?;
    let bounds = work::square(&world, &args.at, args.size)?;
    // Before the work, not after it.
    let mut file = Output::create(&args.output)?;
    let start = Instant::now();
    let mut report = json!({ "file": args.output.to_string_lossy(), "at": args.at.at.to_array(), "size_m": args.size });
    let content = if format == Format::Glb {
        let meshes = meshes(common, &world, bounds, args.detail)?;
        file.write_all(&glb::write(&meshes, bounds.centre())?)?;
        report["chunks"] = json!(meshes.len());
        format!("{} chunks", meshes.len())
    } else {
        let picture = matches!(format, Format::Svg | Format::Png);
        let region = picture && (args.show == Show::Region || args.show == Show::Auto && args.size > REGION_FROM);
        let area =
            if region { export::region(&world, bounds, &Cancel::new())? } else { work::area(common, &world, bounds)? };
        let outlines = export::outlines(&world, &area)?;
        let terrain = world.terrain().clone();
        let plan = Plan {
            area: &area,
            outlines: &outlines,
            terrain: &*terrain,
            chunk_size: world.settings().chunk_size,
            real: None,
        };
        let colouring = match args.colour_by {
            ColourBy::Class => Colouring::Class,
            ColourBy::Origin => Colouring::Origin,
        };
        let style = MapStyle { pixels: args.pixels, colouring, ..MapStyle::default() };
        let size = world.settings().chunk_size;
        let real = args.beside.as_ref().map(|path| beside::area(path, args.beside_at, args.size, size)).transpose()?;
        let draw = || match &real {
            Some(real) => {
                let real = Plan { area: real, outlines: &[], terrain: &beside::Plain, ..plan };
                let [ours, theirs] = ["this world", "a real town"].map(|title| MapStyle { title, ..style });
                write_pair([(&plan, &ours), (&real, &theirs)], format, &mut file)
            }
            None => write(&plan, format, &style, args.everything, &mut file),
        };
        work::pool(common)?.install(draw)?;
        for (key, count) in counts(&area) {
            report[key] = json!(count);
        }
        counts(&area).map(|(key, count)| format!("{count} {key}")).join(", ")
    };
    report["bytes"] = json!(file.finish()?);
    report["seconds"] = json!((start.elapsed().as_secs_f64() * 1000.0).round() / 1000.0);
    let people = format!("{}: {content} ({} s)", args.output.display(), report["seconds"]);
    work::print(common, &report, &people)
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

/// Writes a plan in any format but GLB.
pub fn write(
    plan: &Plan<'_>,
    format: Format,
    style: &MapStyle,
    everything: bool,
    file: &mut dyn Write,
) -> Result<(), ExportError> {
    match format {
        Format::Svg => file.write_all(svg::write(plan, style)?.as_bytes())?,
        Format::Png => file.write_all(&png::write(plan, style)?)?,
        Format::GeoJson => geojson::write(plan, file)?,
        Format::Osm => osm::write(plan, osm::Options { everything }, file)?,
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

fn meshes(common: &Common, world: &World, bounds: Bounds, detail: DetailArg) -> Result<Vec<PlacedMesh>, Fail> {
    let detail = match detail {
        DetailArg::Full => Detail::Full,
        DetailArg::Reduced => Detail::Reduced,
    };
    let cancel = Cancel::new();
    work::each(common, "building meshes", &work::chunks(world, bounds), |coord| {
        let chunk = world.chunk(*coord, &cancel)?;
        Ok(PlacedMesh {
            coord: *coord,
            origin: chunk.origin,
            mesh: mesh::build(&chunk, &**world.terrain(), detail, &cancel)?,
        })
    })
}

/// A file being written under a name of its own beside the wanted one, so that a run that fails leaves no half file.
pub struct Output {
    file: std::io::BufWriter<std::fs::File>,
    part: std::path::PathBuf,
    path: std::path::PathBuf,
    done: bool,
}

impl Output {
    /// Opens it.
    pub fn create(path: &Path) -> Result<Self, Fail> {
        if path.is_dir() {
            return Err(Fail::file(path, "is a folder"));
        }
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.part", std::process::id()));
        let part = path.with_file_name(name);
        let file = std::fs::File::create(&part).map_err(|e| Fail::file(path, e))?;
        Ok(Self { file: std::io::BufWriter::new(file), part, path: path.to_owned(), done: false })
    }

    /// Puts the file in its place and gives its size in bytes.
    pub fn finish(mut self) -> Result<u64, Fail> {
        let fail = |e| Fail::file(&self.path, e);
        self.file.flush().map_err(fail)?;
        let bytes = self.file.get_ref().metadata().map_err(fail)?.len();
        std::fs::rename(&self.part, &self.path).map_err(fail)?;
        self.done = true;
        Ok(bytes)
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if !self.done {
            // The reason for the failure matters more than a file left behind.
            let _ = std::fs::remove_file(&self.part);
        }
    }
}
