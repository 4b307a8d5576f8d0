//! The ground that `sprawl roads` reads: heights, and where there are any, water and vegetation.

use super::args::RoadsArgs;
use super::tiles::{Picture, Read, Tiles};
use crate::fail::{Fail, refuse_unused};
use crate::raster::is_picture;
use bevy_sprawl::layer::RangeError;
use bevy_sprawl::space::Geographic;
use bevy_sprawl::terrain::{Band, Holes, Raster, RasterTerrain};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// What a terrain and its table are read with.
pub struct Land {
    pub terrain: RasterTerrain,
    /// The edge of the cells in metres where that is fit for a lattice, else 0.
    pub cell: f64,
    /// Makes plan metres of degrees.
    pub geographic: Option<Geographic>,
    /// What was read.
    pub report: GroundReport,
}

/// What was read of each raster.
#[derive(Default)]
pub struct GroundReport(Vec<(&'static str, Read)>);

impl GroundReport {
    /// The report as the JSON of the command has it.
    pub fn json(&self) -> Value {
        let of = |read: &Read| {
            json!({
                "tiles": read.tiles, "columns": read.columns, "rows": read.rows, "filled_cells": read.filled,
                "differing_cells": read.disagreement.map_or(0, |d| d.cells),
            })
        };
        Value::Object(self.0.iter().map(|(name, read)| ((*name).to_owned(), of(read))).collect::<Map<_, _>>())
    }

    /// Lines for people on what is not as in the files.
    pub fn people(&self) -> String {
        let filled = |(name, read): &(&str, Read)| {
            let with = match read.fill {
                Some(value) => format!("take {value}"),
                None => "take nothing".into(),
            };
            format!("\n{name}: {} of {} cells have no value and {with}", read.filled, read.columns * read.rows)
        };
        let differing = |(name, read): &(&str, Read)| {
            let disagreement = read.disagreement?;
            let (cells, most) = (disagreement.cells, disagreement.most);
            Some(format!(
                "\n{name}: tiles overlap with different values in {cells} cells, by up to {most}; the first tile counts"
            ))
        };
        let without_value = self.0.iter().filter(|(_, read)| read.filled > 0).map(filled);
        without_value.chain(self.0.iter().filter_map(differing)).collect()
    }
}

/// Reads all rasters.
pub fn read(args: &RoadsArgs) -> Result<Land, Fail> {
    check_flags(args)?;
    let in_degrees = args.geographic;
    let picture = Picture::Placed {
        corner: args.corner.unwrap_or_default(),
        cell: args.cell,
        black: args.black.unwrap_or(0.0),
        white: args.white,
    };
    let holes = args.fill.map_or(Holes::Refuse, Holes::Value);
    let (heights, read) = Tiles { files: &args.terrain, band: Band::Height, holes, picture, in_degrees }.read()?;
    let mut report = GroundReport(vec![("terrain", read)]);
    let first = first(&args.terrain);
    // In metres or degrees.
    let bounds = heights.bounds();
    let geographic = if args.geographic { Some(heights.geographic().map_err(|e| Fail::file(first, e))?) } else { None };
    let placed = |raster: Raster| match &geographic {
        Some(geographic) => raster.projected(geographic),
        None => raster,
    };
    let heights = placed(heights);
    let cell = if args.cell.is_some() { 0.0 } else { heights.step().max_element() };
    let mut terrain = RasterTerrain::new(heights).map_err(|e| Fail::file(first, e))?;
    if let Some(level) = args.sea_level {
        terrain = terrain.with_sea_level(level).map_err(|e| Fail::input(format!("--sea-level: {e}")))?;
    }
    // Where a mask says nothing, there is nothing.
    let mask = |files: &[PathBuf], band: Band, white: f64| {
        let picture = Picture::Over { bounds, white };
        Tiles { files, band, holes: Holes::Value(0.0), picture, in_degrees }.read()
    };
    if !args.water.is_empty() {
        let wrong = |e: RangeError| Fail::file(self::first(&args.water), e);
        let (raster, read) = mask(&args.water, Band::Depth, args.water_white.unwrap_or(1.0))?;
        report.0.push(("water", read));
        terrain = terrain.with_water_depth(placed(raster)).map_err(wrong)?;
    }
    if !args.vegetation.is_empty() {
        let wrong = |e: RangeError| Fail::file(self::first(&args.vegetation), e);
        let (raster, read) = mask(&args.vegetation, Band::Vegetation, 1.0)?;
        report.0.push(("vegetation", read));
        terrain = terrain.with_vegetation(placed(raster)).map_err(wrong)?;
    }
    Ok(Land { terrain, cell, geographic, report })
}

fn first(files: &[PathBuf]) -> &Path {
    files.first().map_or(Path::new(""), PathBuf::as_path)
}

/// Fails if a flag is given that a raster's format has no use for.
fn check_flags(args: &RoadsArgs) -> Result<(), Fail> {
    let picture = is_picture(first(&args.terrain));
    let water = is_picture(first(&args.water));
    refuse_unused([
        ("--corner", "a picture of heights", args.corner.is_some() && !picture),
        ("--cell", "a picture of heights", args.cell.is_some() && !picture),
        ("--black", "a picture of heights", args.black.is_some() && !picture),
        ("--white", "a picture of heights", args.white.is_some() && !picture),
        ("--water-white", "a picture of water", args.water_white.is_some() && !water),
    ])
}
