//! A terrain from rasters: heights, and where there are any, water and vegetation.

mod ascii;
mod grid;
mod holes;
#[cfg(feature = "cli")]
mod png;
mod surface;

#[cfg(feature = "cli")]
pub use self::png::PngPlace;
pub use grid::{Band, MOST_CELLS, Raster};
pub use holes::Holes;

use super::{Terrain, TerrainSample};
use crate::layer::RangeError;
use crate::space::Bounds;
use glam::DVec2;
use surface::Surface;

/// Depth of the water table under ground without any water, in metres.
const DRY: f64 = 100.0;

/// A finite piece of ground from rasters in plan metres, in place of the endless noise.
///
/// Between the samples of the height raster the ground is a Catmull-Rom surface: it passes through every sample and its
/// slope is continuous. Bilinear interpolation is cheaper, but creases the ground along the lines of the raster, and roads,
/// whose cost is slope, would follow the creases. At a cliff the surface overshoots by up to an eighth of its height. Outside of
/// the raster everything is as at the nearest point of its border.
///
/// Ground below [`with_sea_level`](Self::with_sea_level) is under water; lakes and rivers come from
/// [`with_water_depth`](Self::with_water_depth). Without these there is no water, without
/// [`with_vegetation`](Self::with_vegetation) the ground is bare.
///
/// ```
/// use bevy_sprawl::terrain::{Band, Holes, Raster, RasterTerrain, Terrain};
/// use glam::DVec2;
///
/// let file = b"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 50\n 12 14 20\n -3 8 11\n";
/// let heights = Raster::from_ascii("island.asc", file, Band::Height, Holes::Refuse)?;
/// let terrain = RasterTerrain::new(heights)?.with_sea_level(0.0)?;
/// assert_eq!(terrain.height(DVec2::new(75.0, 75.0)), 14.0);
/// assert_eq!(terrain.sample(DVec2::new(25.0, 25.0)).depth(), 3.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RasterTerrain {
    bounds: Bounds,
    heights: Surface,
    sea_level: Option<f64>,
    water: Option<Surface>,
    vegetation: Option<Surface>,
}

impl RasterTerrain {
    /// Dry, bare ground. Fails on a height out of range (see [`Band::range`]), and on cells of less than 0.1 m, as those of a
    /// raster in degrees seem to be.
    pub fn new(heights: Raster) -> Result<Self, RangeError> {
        heights.check(Band::Height)?;
        let bounds = heights.bounds();
        Ok(Self { bounds, heights: Surface::sloping(heights), sea_level: None, water: None, vegetation: None })
    }

    /// With ground below `level` metres (a height) under water. The raster then holds the height of the sea's bed.
    pub fn with_sea_level(self, level: f64) -> Result<Self, RangeError> {
        let (low, high) = Band::Height.range();
        RangeError::check("sea_level", level, low, high)?;
        Ok(Self { sea_level: Some(level), ..self })
    }

    /// With lakes and rivers of the depths that a second raster has, in metres, 0 on land; a mask of 0 and 1 makes water
    /// one metre deep. There the height raster holds the height of the water's surface, as surveys from the air have it. The
    /// shore lies about half way between a wet and a dry sample; wet samples that touch at their corners are connected.
    /// Where the raster ends, its border goes on. Fails on a depth out of range, and when the raster lies elsewhere.
    pub fn with_water_depth(self, depths: Raster) -> Result<Self, RangeError> {
        self.check_place(&depths, Band::Depth)?;
        Ok(Self { water: Some(Surface::flat(surface::with_shores(depths))), ..self })
    }

    /// With the vegetation density of a raster, 0 to 1. Under water there is none. Fails on a density out of range, and
    /// when the raster lies elsewhere.
    pub fn with_vegetation(self, densities: Raster) -> Result<Self, RangeError> {
        self.check_place(&densities, Band::Vegetation)?;
        Ok(Self { vegetation: Some(Surface::flat(densities)), ..self })
    }

    fn check_place(&self, raster: &Raster, band: Band) -> Result<(), RangeError> {
        raster.check(band)?;
        if raster.bounds().overlaps(self.bounds) {
            return Ok(());
        }
        let name = |b: Bounds| format!("{},{} to {},{}", b.min.x, b.min.y, b.max.x, b.max.y);
        Err(RangeError {
            field: format!("place of the {}", band.name()),
            value: name(raster.bounds()),
            allowed: format!("a box that overlaps that of the heights, {}", name(self.bounds)),
        })
    }

    /// The box of the height raster, its outermost cells whole, in plan metres.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }
}

impl Terrain for RasterTerrain {
    fn sample(&self, p: DVec2) -> TerrainSample {
        let surface = self.heights.smooth(p);
        // Below 0 on land.
        let depth = self.water.as_ref().map_or(-DRY, |w| w.bilinear(p));
        let height = surface - depth.max(0.0);
        let table = surface + depth.min(0.0);
        let water_level = match (self.sea_level, &self.water) {
            (None, _) => table,
            (Some(sea), None) => sea,
            (Some(sea), Some(_)) => table.max(sea),
        };
        let vegetation = match &self.vegetation {
            Some(v) if height >= water_level => v.bilinear(p),
            _ => 0.0,
        };
        TerrainSample { height, water_level, vegetation }
    }

    fn height(&self, p: DVec2) -> f64 {
        let surface = self.heights.smooth(p);
        self.water.as_ref().map_or(surface, |w| surface - w.bilinear(p).max(0.0))
    }
}

#[cfg(test)]
mod tests;
