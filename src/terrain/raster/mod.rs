//! Terrain from rasters: heights and, optionally, water and vegetation. Reads files that the user gives.

mod ascii;
mod band;
#[cfg(feature = "cli")]
mod geotiff;
mod grid;
mod holes;
mod join;
#[cfg(all(test, feature = "cli"))]
mod picture_tests;
#[cfg(feature = "cli")]
mod png;
mod surface;
mod terrain;
#[cfg(test)]
mod tests;

#[cfg(feature = "cli")]
pub use self::geotiff::GeoUnits;
#[cfg(feature = "cli")]
pub use self::png::PngPlace;
pub use band::Band;
pub use grid::{Disagreement, MOST_CELLS, Raster};
pub use holes::Holes;
pub use join::JoinError;
pub use terrain::RasterTerrain;
