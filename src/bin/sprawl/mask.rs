//! The flags for maps that are pictures.

use crate::fail::{Fail, refuse_unused};
use crate::raster::is_picture;
use crate::values::{colour, number};
use bevy_sprawl::map::MaskOptions;
use clap::Args;
use std::path::Path;

/// How road masks among the maps are read.
#[derive(Args)]
pub struct MaskArgs {
    /// Edge of a pixel in metres, of a map that is a road mask (.png)
    #[arg(long, value_name = "M", value_parser = number)]
    metres_per_pixel: Option<f64>,
    /// Colour of roads in a road mask, #0000ff if not given
    #[arg(long, value_name = "#RRGGBB", value_parser = colour)]
    road_colour: Option<[u8; 3]>,
    /// Colour of buildings in a road mask, #ff0000 if not given
    #[arg(long, value_name = "#RRGGBB", value_parser = colour)]
    building_colour: Option<[u8; 3]>,
}

impl MaskArgs {
    /// How the masks among some maps are read. Fails if a flag is given and none of the maps is a picture.
    pub fn options<'a>(&self, maps: impl IntoIterator<Item = &'a Path>) -> Result<MaskOptions, Fail> {
        let is_unused = !maps.into_iter().any(is_picture);
        let needed = "a map that is a picture: a name that ends in .png";
        refuse_unused([
            ("--metres-per-pixel", needed, self.metres_per_pixel.is_some() && is_unused),
            ("--road-colour", needed, self.road_colour.is_some() && is_unused),
            ("--building-colour", needed, self.building_colour.is_some() && is_unused),
        ])?;
        let usual = MaskOptions::default();
        Ok(MaskOptions {
            metres_per_pixel: self.metres_per_pixel,
            roads: self.road_colour.unwrap_or(usual.roads),
            buildings: self.building_colour.unwrap_or(usual.buildings),
            ..usual
        })
    }
}
