//! What a terrain is: height, water and vegetation at any point.

use glam::DVec2;

/// Ground, water and vegetation at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerrainSample {
    /// Height of the ground in metres; under water, the height of the bed.
    pub height: f64,
    /// Height in metres of the water surface that this point belongs to. The point is under water if `height` is lower.
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

/// Samples a terrain point by point: see [`Terrain::scan`].
pub type Scan<'a> = Box<dyn FnMut(DVec2) -> TerrainSample + 'a>;

/// The ground of a world.
///
/// A world is the same on every machine only if its ground is. An implementation therefore keeps four rules:
///
/// - The same point gives the same bits: on any thread, in any order, in every run. Sampling changes no state that a result
///   depends on, reads no clock, and iterates over no hash map with a random state.
/// - The bits are the same on every platform. `+ - * /` and `sqrt` are; `f64::sin`, `powi` and the like are not: use
///   [`space::math`](crate::space::math).
/// - Every point of the plan has finite numbers, even far outside what a game shows. Where there is no water, the water level
///   lies below the ground.
/// - Heights are continuous, and slopes should be: roads follow creases of the ground. The water level does not jump within a
///   body of water, and no water stands above the dry ground beside it.
///
/// A sample should take less than a microsecond: the search for roads takes millions of samples.
///
/// Points are in plan metres (x east, y north).
pub trait Terrain: Send + Sync + 'static {
    /// Samples a point.
    fn sample(&self, p: DVec2) -> TerrainSample;

    /// Takes the same samples at many points near each other or along a line. This is faster if the terrain can reuse work
    /// from one point for the next.
    fn scan(&self) -> Scan<'_> {
        Box::new(|p| self.sample(p))
    }

    /// The same as [`scan`](Self::scan), except that `vegetation` may be 0 everywhere: for callers that only need heights and
    /// water.
    fn scan_ground(&self) -> Scan<'_> {
        self.scan()
    }

    /// Height of the ground in metres.
    fn height(&self, p: DVec2) -> f64 {
        self.sample(p).height
    }

    /// Gradient of the height (rise over run, pointing uphill), by central differences over `step` metres.
    fn gradient(&self, p: DVec2, step: f64) -> DVec2 {
        let h = step / 2.0;
        let along = |d: DVec2| (self.height(p + d) - self.height(p - d)) / step;
        DVec2::new(along(DVec2::X * h), along(DVec2::Y * h))
    }
}
