//! Terrain from rasters: heights and, optionally, water and vegetation. Reads files that the user gives.

mod ascii;
mod grid;
mod holes;
#[cfg(feature = "cli")]
mod png;
mod surface;
mod terrain;
#[cfg(test)]
mod tests;

#[cfg(feature = "cli")]
pub use self::png::PngPlace;
pub use grid::{Band, MOST_CELLS, Raster};
pub use holes::Holes;
pub use terrain::RasterTerrain;
