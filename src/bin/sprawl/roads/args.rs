//! The flags of `sprawl roads`.

use crate::values::{gamma, number, point, populations};
use bevy_sprawl::region::Populations;
use clap::Args;
use glam::DVec2;
use std::path::PathBuf;

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
    /// Depth of white in a picture of water, in metres [default: 1]
    #[arg(long, value_name = "M", requires = "water", value_parser = number)]
    pub water_white: Option<f64>,
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
    /// South-west corner of a picture [default: 0,0]
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    pub corner: Option<DVec2>,
    /// Edge of a picture's pixel, in metres or degrees
    #[arg(long, value_name = "M", value_parser = number)]
    pub cell: Option<f64>,
    /// Height of black in a picture, in metres [default: 0]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub black: Option<f64>,
    /// Height of white in a picture, in metres
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub white: Option<f64>,
    /// Longer side of an SVG or PNG [default: 1600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(64..=8192))]
    pub pixels: Option<u32>,
}
