//! The default terrain.
use super::{Terrain, TerrainSample};
use crate::layer::RangeError;
use crate::space::Seed;
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Settings of [`NoiseTerrain`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TerrainSettings {
    /// Height scale.
    pub relief: f64,
}

impl Default for TerrainSettings {
    fn default() -> Self {
        Self { relief: 1.0 }
    }
}

impl TerrainSettings {
    /// Checks ranges.
    pub fn check(&self) -> Result<(), RangeError> {
        RangeError::check("relief", self.relief, 0.0, 10.0)
    }
}

/// Noise terrain.
pub struct NoiseTerrain;

impl NoiseTerrain {
    /// New.
    pub fn new(_seed: Seed, _settings: &TerrainSettings) -> Self {
        Self
    }
}

impl Terrain for NoiseTerrain {
    fn sample(&self, _p: DVec2) -> TerrainSample {
        TerrainSample { height: 10.0, water_level: 0.0, vegetation: 0.0 }
    }
}
