//! Settings of the default terrain.

use crate::layer::{RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// Settings of [`NoiseTerrain`](super::NoiseTerrain). Lengths and heights are in metres, shares are 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(default, deny_unknown_fields)]
pub struct TerrainSettings {
    /// Share of the plan that is sea: 0 to 0.8.
    pub sea_share: f64,
    /// Distance over which sea and land alternate: 10,000 to 1,000,000.
    pub continent_size: f64,
    /// Height of plains, and of the rivers in them, far inland: 0 to 400.
    pub inland_height: f64,
    /// Height of hills: 0 to 400.
    pub hill_height: f64,
    /// Share of the plan that is hilly: 0 to 1.
    pub hill_share: f64,
    /// Approximate height of the highest mountains above the plain: 0 to 3000.
    pub mountain_height: f64,
    /// Share of the plan where mountains rise, if rivers and sea leave room: 0 to 0.8.
    pub mountain_share: f64,
    /// Distance between main rivers: 4,000 to 200,000.
    pub river_spacing: f64,
    /// Least and greatest width of a river: 4 to 200.
    pub river_width: (f64, f64),
    /// Distance between places that may hold a lake: 3,000 to 200,000.
    pub lake_spacing: f64,
    /// Share of these places that hold a lake if the ground allows it: 0 to 1.
    pub lake_share: f64,
    /// Least and greatest radius of a lake: 50 to 2000, but at most a tenth of `lake_spacing`.
    pub lake_radius: (f64, f64),
    /// Density of the vegetation: 0 is bare ground, 0.5 woods and meadows in turn, 1 mostly woods.
    pub vegetation: f64,
}

impl Default for TerrainSettings {
    fn default() -> Self {
        Self {
            sea_share: 0.24,
            continent_size: 47_000.0,
            inland_height: 70.0,
            hill_height: 75.0,
            hill_share: 0.55,
            mountain_height: 1000.0,
            mountain_share: 0.3,
            river_spacing: 16_000.0,
            river_width: (12.0, 60.0),
            lake_spacing: 5_300.0,
            lake_share: 0.75,
            lake_radius: (120.0, 500.0),
            vegetation: 0.5,
        }
    }
}

impl TerrainSettings {
    /// Checks that every value lies in its range.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is out of range or NaN.
    pub fn check(&self) -> Result<(), RangeError> {
        self.check_ranges()
    }
}

impl Ranged for TerrainSettings {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self {
            sea_share,
            continent_size,
            inland_height,
            hill_height,
            hill_share,
            mountain_height,
            mountain_share,
            river_spacing,
            river_width,
            lake_spacing,
            lake_share,
            lake_radius,
            vegetation,
        } = self;
        walk.number("sea_share", sea_share, 0.0, 0.8)?;
        walk.number("continent_size", continent_size, 10_000.0, 1_000_000.0)?;
        walk.number("inland_height", inland_height, 0.0, 400.0)?;
        walk.number("hill_height", hill_height, 0.0, 400.0)?;
        walk.number("hill_share", hill_share, 0.0, 1.0)?;
        walk.number("mountain_height", mountain_height, 0.0, 3000.0)?;
        walk.number("mountain_share", mountain_share, 0.0, 0.8)?;
        walk.number("river_spacing", river_spacing, 4_000.0, 200_000.0)?;
        walk.pair("river_width", river_width, 4.0, (*river_spacing / 60.0).min(200.0))?;
        walk.number("lake_spacing", lake_spacing, 3_000.0, 200_000.0)?;
        walk.number("lake_share", lake_share, 0.0, 1.0)?;
        walk.pair("lake_radius", lake_radius, 50.0, (*lake_spacing / 10.0).min(2000.0))?;
        walk.number("vegetation", vegetation, 0.0, 1.0)
    }
}
