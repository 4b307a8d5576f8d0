//! Terrain from the functions of the crate `noise`.

use super::{Terrain, TerrainSample};
use crate::layer::{RangeError, Ranged, Walk};
use glam::DVec2;
use noise::NoiseFn;

/// How [`NoiseFnTerrain`] turns the values of a function into ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseFnSettings {
    /// Metres of the plan for one unit of the function's coordinates: 1 to 1,000,000.
    pub metres_per_unit: f64,
    /// Height in metres where the function is 0: -10,000 to 10,000.
    pub base_height: f64,
    /// Height in metres that the ground rises where the function grows by 1: 0 to 10,000.
    pub height_scale: f64,
    /// Height of the sea in metres: -20,000 to 20,000. Lower ground is under water.
    pub sea_level: f64,
    /// Density of vegetation on dry ground: 0 (bare) to 1 (dense wood).
    pub vegetation: f64,
}

impl Default for NoiseFnSettings {
    fn default() -> Self {
        Self { metres_per_unit: 4000.0, base_height: 40.0, height_scale: 80.0, sea_level: 0.0, vegetation: 0.3 }
    }
}

impl NoiseFnSettings {
    /// Checks that every value lies in its range; NaN lies in none.
    ///
    /// # Errors
    /// The first field that is outside its range.
    pub fn check(&self) -> Result<(), RangeError> {
        self.check_ranges()
    }
}

impl Ranged for NoiseFnSettings {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { metres_per_unit, base_height, height_scale, sea_level, vegetation } = self;
        walk.number("metres_per_unit", metres_per_unit, 1.0, 1_000_000.0)?;
        walk.number("base_height", base_height, -10_000.0, 10_000.0)?;
        walk.number("height_scale", height_scale, 0.0, 10_000.0)?;
        walk.number("sea_level", sea_level, -20_000.0, 20_000.0)?;
        walk.number("vegetation", vegetation, 0.0, 1.0)
    }
}

/// Ground whose height is any two-dimensional function of the crate `noise`, with a sea at one level.
///
/// The ground is the same on every platform only where the function is, and as smooth as the function is.
/// A value that is not finite counts as 0.
///
/// ```
/// use bevy_sprawl::space::Seed;
/// use bevy_sprawl::terrain::{NoiseFnSettings, NoiseFnTerrain};
/// use bevy_sprawl::world::{TerrainSource, World, WorldSource};
/// use noise::{Fbm, MultiFractal, Perlin};
///
/// let hills = Fbm::<Perlin>::new(7).set_octaves(4);
/// let ground = NoiseFnTerrain::new(hills, NoiseFnSettings { height_scale: 120.0, ..Default::default() })?;
/// let world = World::new(WorldSource { terrain: TerrainSource::own(ground), ..WorldSource::new(Seed(7)) })?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct NoiseFnTerrain<N> {
    function: N,
    settings: NoiseFnSettings,
}

impl<N: NoiseFn<f64, 2>> NoiseFnTerrain<N> {
    /// Ground from a function.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(function: N, settings: NoiseFnSettings) -> Result<Self, RangeError> {
        settings.check()?;
        Ok(Self { function, settings })
    }
}

impl<N: NoiseFn<f64, 2> + Send + Sync + 'static> Terrain for NoiseFnTerrain<N> {
    fn sample(&self, p: DVec2) -> TerrainSample {
        let NoiseFnSettings { metres_per_unit, base_height, height_scale, sea_level, vegetation } = self.settings;
        let value = self.function.get((p / metres_per_unit).to_array());
        let height = base_height + height_scale * if value.is_finite() { value } else { 0.0 };
        TerrainSample { height, water_level: sea_level, vegetation: if height < sea_level { 0.0 } else { vegetation } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use noise::{Constant, Perlin};

    #[test]
    fn heights_follow_the_function() {
        let settings = NoiseFnSettings { base_height: 10.0, height_scale: 20.0, ..Default::default() };
        let ground = |value| NoiseFnTerrain::new(Constant::new(value), settings).unwrap().sample(DVec2::ZERO);
        assert_eq!((ground(0.5).height, ground(0.5).depth()), (20.0, 0.0));
        assert_eq!((ground(-1.0).height, ground(-1.0).depth(), ground(-1.0).vegetation), (-10.0, 10.0, 0.0));
        assert_eq!(ground(f64::NAN).height, 10.0);
    }

    #[test]
    fn one_unit_is_as_many_metres_as_asked() {
        let perlin = Perlin::new(3);
        let settings =
            NoiseFnSettings { metres_per_unit: 500.0, base_height: 0.0, height_scale: 1.0, ..Default::default() };
        let ground = NoiseFnTerrain::new(perlin, settings).unwrap();
        assert_eq!(ground.height(DVec2::new(150.0, -400.0)), perlin.get([0.3, -0.8]));
    }

    #[test]
    fn settings_outside_their_range_are_refused() {
        let settings = NoiseFnSettings { metres_per_unit: f64::NAN, ..Default::default() };
        assert!(NoiseFnTerrain::new(Constant::new(0.0), settings).is_err());
    }
}
