//! Layer 1: the ground. Makes height, water and vegetation at any point of the plan; reads the seed only; padding 0.
//!
//! [`NoiseTerrain`] is the default, without end. [`RasterTerrain`] is a piece of ground from files: ESRI ASCII grids, and with
//! the feature `cli` PNG pictures. A game brings ground of its own by the trait [`Terrain`]:
//!
//! ```
//! use bevy_sprawl::{space::Seed, terrain::{Terrain, TerrainSample}, world::{TerrainSource, World, WorldSource}};
//! use glam::DVec2;
//!
//! /// A plain with a sea in the south and a smooth rise to 60 m in the north.
//! struct Coast;
//!
//! impl Terrain for Coast {
//!     fn sample(&self, p: DVec2) -> TerrainSample {
//!         let t = p.y / 5000.0;
//!         let height = 30.0 + 30.0 * t / (1.0 + t * t).sqrt();
//!         TerrainSample { height, water_level: 2.0, vegetation: 0.3 }
//!     }
//! }
//!
//! let world = World::new(WorldSource { terrain: TerrainSource::own(Coast), ..WorldSource::new(Seed(7)) })?;
//! assert!(world.height_at(DVec2::new(0.0, 20_000.0)) > world.height_at(DVec2::ZERO));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod field;
mod lake;
mod noise;
#[cfg(feature = "noise")]
mod noise_fn;
mod raster;
mod river;
mod settings;

pub use self::noise::NoiseTerrain;
#[cfg(feature = "noise")]
pub use self::noise_fn::{NoiseFnSettings, NoiseFnTerrain};
#[cfg(feature = "cli")]
pub use self::raster::PngPlace;
pub use self::raster::{Band, Holes, MOST_CELLS, Raster, RasterTerrain};
pub use self::settings::TerrainSettings;

use glam::DVec2;

/// Ground, water and vegetation at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerrainSample {
    /// Height of the ground (of the bed, under water), in metres.
    pub height: f64,
    /// Height of the water surface that this point belongs to, in metres; it is under water when `height` is below.
    pub water_level: f64,
    /// Vegetation density, 0 (bare) to 1 (dense wood).
    pub vegetation: f64,
}

impl TerrainSample {
    /// Depth of the water in metres, 0 on land.
    pub fn depth(&self) -> f64 {
        (self.water_level - self.height).max(0.0)
    }
}

/// Samples a terrain point after point: [`Terrain::scan`].
pub type Scan<'a> = Box<dyn FnMut(DVec2) -> TerrainSample + 'a>;

/// The ground of a world.
///
/// The world above it is the same on every machine only if the ground is, so an implementation keeps four rules:
///
/// - The same point gives the same bits: on any thread, in any order, in every run. No state that sampling changes, no
///   clock, no iteration over hash maps with a random state.
/// - The same bits on every platform: `+ - * /` and `sqrt` are, `f64::sin`, `powi` and their like are not; use
///   [`space::math`](crate::space::math).
/// - Every point of the plan has finite numbers, far outside of what a game shows too. Where there is no water, the
///   water level lies below the ground.
/// - Heights are continuous, and so should slopes be: roads follow creases of the ground. Water levels do not jump along
///   a piece of water, and no water stands above the dry ground beside it.
///
/// Sampling should take less than a microsecond: the search for roads samples millions of points.
///
/// Points are in plan metres (x east, y north).
pub trait Terrain: Send + Sync + 'static {
    /// Everything at a point.
    fn sample(&self, p: DVec2) -> TerrainSample;

    /// The same samples, for many points near each other or along a line: faster where the terrain has something to
    /// remember from one to the next.
    fn scan(&self) -> Scan<'_> {
        Box::new(|p| self.sample(p))
    }

    /// The same for those who ask for heights and water only: `vegetation` may be 0 everywhere.
    fn scan_ground(&self) -> Scan<'_> {
        self.scan()
    }

    /// Height of the ground in metres.
    fn height(&self, p: DVec2) -> f64 {
        self.sample(p).height
    }

    /// Gradient of the height (rise over run, pointing uphill) by central differences over `step` metres.
    fn gradient(&self, p: DVec2, step: f64) -> DVec2 {
        let h = step / 2.0;
        let along = |d: DVec2| (self.height(p + d) - self.height(p - d)) / step;
        DVec2::new(along(DVec2::X * h), along(DVec2::Y * h))
    }
}
