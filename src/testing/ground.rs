//! Grounds.

use crate::terrain::{Terrain, TerrainSample};
use glam::DVec2;

/// A dry, bare plain at a height of 10 m.
pub(crate) struct Flat;

impl Terrain for Flat {
    fn sample(&self, _: DVec2) -> TerrainSample {
        TerrainSample { height: 10.0, water_level: 0.0, vegetation: 0.0 }
    }
}

/// Ground that a function of the plan point describes.
pub(crate) struct Ground<F>(pub F);

impl<F: Fn(DVec2) -> TerrainSample + Send + Sync + 'static> Terrain for Ground<F> {
    fn sample(&self, p: DVec2) -> TerrainSample {
        self.0(p)
    }
}
