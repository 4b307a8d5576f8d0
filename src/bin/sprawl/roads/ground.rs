//! The ground that `sprawl roads` reads: heights, and where there are any, water and vegetation.

use super::args::RoadsArgs;
use crate::fail::{Fail, refuse_unused};
use crate::raster::{is_picture, read as raster};
use bevy_sprawl::layer::RangeError;
use bevy_sprawl::space::{Bounds, Geographic};
use bevy_sprawl::terrain::{Band, Holes, PngPlace, Raster, RasterTerrain};
use glam::DVec2;
use std::path::Path;

/// What a terrain and its table are read with.
pub struct Land {
    pub terrain: RasterTerrain,
    /// The edge of the cells in metres where that is fit for a lattice, else 0.
    pub cell: f64,
    /// Makes plan metres of degrees.
    pub geographic: Option<Geographic>,
}

/// Reads all rasters.
pub fn read(args: &RoadsArgs) -> Result<Land, Fail> {
    check_flags(args)?;
    let heights = heights(args)?;
    // In metres or degrees.
    let bounds = heights.bounds();
    let geographic =
        if args.geographic { Some(heights.geographic().map_err(|e| Fail::file(&args.terrain, e))?) } else { None };
    let placed = |raster: Raster| match &geographic {
        Some(geographic) => raster.projected(geographic),
        None => raster,
    };
    let heights = placed(heights);
    let cell = if args.cell.is_some() { 0.0 } else { heights.step().max_element() };
    let mut terrain = RasterTerrain::new(heights).map_err(|e| Fail::file(&args.terrain, e))?;
    if let Some(level) = args.sea_level {
        terrain = terrain.with_sea_level(level).map_err(|e| Fail::input(format!("--sea-level: {e}")))?;
    }
    if let Some(path) = &args.water {
        let wrong = |e: RangeError| Fail::file(path, e);
        let raster =
            placed(raster(path, Band::Depth, Holes::Refuse, || whole(path, bounds, args.water_white.unwrap_or(1.0)))?);
        terrain = terrain.with_water_depth(raster).map_err(wrong)?;
    }
    if let Some(path) = &args.vegetation {
        let wrong = |e: RangeError| Fail::file(path, e);
        let raster = placed(raster(path, Band::Vegetation, Holes::Refuse, || whole(path, bounds, 1.0))?);
        terrain = terrain.with_vegetation(raster).map_err(wrong)?;
    }
    Ok(Land { terrain, cell, geographic })
}

/// Fails if a flag is given that a raster's format has no use for.
fn check_flags(args: &RoadsArgs) -> Result<(), Fail> {
    let picture = is_picture(&args.terrain);
    let water = args.water.as_deref().is_some_and(is_picture);
    refuse_unused([
        ("--corner", "a picture of heights", args.corner.is_some() && !picture),
        ("--cell", "a picture of heights", args.cell.is_some() && !picture),
        ("--black", "a picture of heights", args.black.is_some() && !picture),
        ("--white", "a picture of heights", args.white.is_some() && !picture),
        ("--fill", "an ASCII grid of heights", args.fill.is_some() && picture),
        ("--water-white", "a picture of water", args.water_white.is_some() && !water),
    ])
}

fn heights(args: &RoadsArgs) -> Result<Raster, Fail> {
    raster(&args.terrain, Band::Height, args.fill.map_or(Holes::Refuse, Holes::Value), || {
        let (Some(cell), Some(white)) = (args.cell, args.white) else {
            let needed = "a picture needs --cell and --white: the edge of a pixel, and the height of white";
            return Err(Fail::file(&args.terrain, needed));
        };
        Ok(PngPlace {
            corner: args.corner.unwrap_or_default(),
            step: DVec2::splat(cell),
            black: args.black.unwrap_or(0.0),
            white,
        })
    })
}

/// The place of a picture that covers a box, black being 0.
fn whole(path: &Path, bounds: Bounds, white: f64) -> Result<PngPlace, Fail> {
    let failed = |e: &dyn std::fmt::Display| Fail::file(path, format!("no readable PNG: {e}"));
    let file = std::fs::File::open(path).map_err(|e| failed(&e))?;
    let mut decoder = png::Decoder::new(std::io::BufReader::new(file));
    let info = decoder.read_header_info().map_err(|e| failed(&e))?;
    let pixels = DVec2::new(f64::from(info.width), f64::from(info.height));
    Ok(PngPlace { corner: bounds.min, step: bounds.size() / pixels, black: 0.0, white })
}
