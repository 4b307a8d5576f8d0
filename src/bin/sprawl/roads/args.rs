//! The flags of `sprawl roads`.

use crate::mask::MaskArgs;
use crate::values::{gamma, least_zero, number, point, populations};
use bevy_sprawl::region::Populations;
use clap::Args;
use glam::DVec2;
use std::path::PathBuf;

#[derive(Args)]
pub struct RoadsArgs {
    /// Heights: an ESRI ASCII grid (.asc), a GeoTIFF (.tif), or a grey .png with --cell and --white. Several grids or GeoTIFFs
    /// are tiles that are joined
    #[arg(long, value_name = "FILE", num_args = 1.., required = true)]
    pub terrain: Vec<PathBuf>,
    /// Settlements: a table (CSV, or with semicolons or tabs) with the columns name,x,y,sigma (or population) and perhaps
    /// radius_m; others are left out
    #[arg(long, value_name = "FILE")]
    pub settlements: PathBuf,
    /// Leave out rows of the table that are wrong, outside of the domain or in water, and name them
    #[arg(long)]
    pub skip_bad: bool,
    /// Move settlements in water to the nearest land within M metres
    #[arg(long, value_name = "M", value_parser = least_zero)]
    pub snap: Option<f64>,
    /// File to write: .svg .png .geojson or .osm
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Density of the roads, 1.01 or more: 2 is a Gabriel graph, inf the relative neighbour graph [default: as the settings
    /// have it for each class]
    #[arg(long, value_name = "G", allow_hyphen_values = true, value_parser = gamma)]
    pub gamma: Option<f64>,
    /// Places are in degrees: x (or lon) is longitude, y (or lat) latitude. Maps are written in degrees, too
    #[arg(long)]
    pub geographic: bool,
    /// Spacing in whole metres of the lattice that roads are found on [default: the cell of an ASCII grid, a 256th of the
    /// domain of a picture; less where settlements lie nearer to each other]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(i64).range(10..=20_000))]
    pub step: Option<i64>,
    /// Ground below this height in metres is under water
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub sea_level: Option<f64>,
    /// Height of cells without a value, of transparent pixels and between tiles [default: such a file is refused]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = number)]
    pub fill: Option<f64>,
    /// Depths of lakes and rivers in metres, 0 on land, or a mask of 0 and 1: a grid or GeoTIFF like that of the heights, though
    /// of any cells, or a grey .png over all of the domain. Cells without a value are land. Heights in water are those of its
    /// surface
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub water: Vec<PathBuf>,
    /// Depth of white in a picture of water, in metres [default: 1]
    #[arg(long, value_name = "M", requires = "water", value_parser = number)]
    pub water_white: Option<f64>,
    /// Density of vegetation, 0 (bare) to 1 (dense wood): a grid or GeoTIFF like that of the heights, though of any cells, or a
    /// grey .png over all of the domain. Cells without a value are bare
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub vegetation: Vec<PathBuf>,
    /// Inhabitants from which on a settlement is a town, and a city, where the table has them
    #[arg(long, value_name = "T,C", default_value = "2000,20000", value_parser = populations)]
    pub populations: Populations,
    /// Real roads to compare with: .osm .osm.pbf (both with --geographic) or .geojson, in metres or degrees as the ground, or a
    /// road mask .png with --metres-per-pixel, whose middle is that of the domain and whose roads are all real ones
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    #[command(flatten)]
    pub mask: MaskArgs,
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
