//! The terrain of a finite piece of ground, from rasters.

use super::band::Band;
use super::grid::Raster;
use super::surface::{self, Surface};
use crate::layer::RangeError;
use crate::space::Bounds;
use crate::terrain::contract::{Terrain, TerrainSample};
use glam::DVec2;

/// Depth of the water table below ground without any water, in metres.
const DRY: f64 = 100.0;

/// A finite piece of ground from rasters in plan metres.
///
/// Between the samples of the height raster, the ground is a Catmull-Rom surface: it passes through every sample, and its slope
/// is continuous. Bilinear interpolation is cheaper, but it creases the ground along the lines of the raster, and roads would
/// follow the creases because their cost depends on slope. At a cliff the surface overshoots by up to an eighth of the cliff's
/// height. Outside the raster, everything is as at the nearest point of its border.
///
/// Ground below [`with_sea_level`](Self::with_sea_level) is under water; lakes and rivers come from
/// [`with_water_depth`](Self::with_water_depth). Without these there is no water. Without
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
    /// Dry, bare ground.
    ///
    /// # Errors
    ///
    /// Fails if a height is out of range (see [`Band::range`]), or if cells are smaller than 0.1 m, which usually means that the
    /// raster is in degrees.
    pub fn new(heights: Raster) -> Result<Self, RangeError> {
        heights.check(Band::Height)?;
        let bounds = heights.bounds();
        Ok(Self { bounds, heights: Surface::sloping(heights), sea_level: None, water: None, vegetation: None })
    }

    /// Puts ground lower than `level` metres under water. There the raster holds the height of the sea bed.
    ///
    /// # Errors
    ///
    /// Fails if `level` is not in the range of heights.
    pub fn with_sea_level(self, level: f64) -> Result<Self, RangeError> {
        let (low, high) = Band::Height.range();
        RangeError::check("sea_level", level, low, high)?;
        Ok(Self { sea_level: Some(level), ..self })
    }

    /// Adds lakes and rivers from a raster of depths in metres, 0 on land. A mask of 0 and 1 makes water one metre deep.
    ///
    /// Where there is water, the height raster holds the height of the water surface, as surveys from the air measure it. The
    /// shore lies about half-way between a wet and a dry sample; wet samples that touch at a corner are connected. Beyond the
    /// raster, its border continues.
    ///
    /// # Errors
    ///
    /// Fails if a depth is out of range, or if the raster does not overlap the heights.
    pub fn with_water_depth(self, depths: Raster) -> Result<Self, RangeError> {
        self.check_place(&depths, Band::Depth)?;
        Ok(Self { water: Some(Surface::flat(surface::with_shores(depths))), ..self })
    }

    /// Adds vegetation from a raster of densities, 0 to 1. Under water there is none.
    ///
    /// # Errors
    ///
    /// Fails if a density is out of range, or if the raster does not overlap the heights.
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
            allowed: format!("a box that overlaps the box of the heights, {}", name(self.bounds)),
        })
    }

    /// The box of the height raster in plan metres, with whole cells at its border.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }
}

impl Terrain for RasterTerrain {
    fn sample(&self, p: DVec2) -> TerrainSample {
        let surface = self.heights.smooth(p);
        // Negative on land.
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
