//! Layer 1: the ground. Makes height, water and vegetation at any point of the plan; reads the seed only; padding 0.

mod field;
mod lake;
mod noise;
mod river;
mod settings;

pub use self::noise::NoiseTerrain;
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

/// The ground of a world. A pure function of the point: the same point gives the same bits, from any thread.
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
