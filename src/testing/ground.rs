//! Grounds.

use crate::space::math;
use crate::terrain::{Terrain, TerrainSample};
use glam::DVec2;
use std::f64::consts::TAU;

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

/// Hills with a river every 19 km and lakes, or nothing but a plain.
pub(crate) struct Countryside {
    pub flat: bool,
    /// Half the width of rivers in metres.
    pub river: f64,
}

impl Terrain for Countryside {
    fn sample(&self, p: DVec2) -> TerrainSample {
        if self.flat {
            return TerrainSample { height: 10.0, water_level: 0.0, vegetation: 0.0 };
        }
        let wave = |d: DVec2, length: f64, phase: f64| math::sin(p.dot(d) * TAU / length + phase);
        let mut height = 60.0
            + 22.0 * wave(DVec2::new(0.8, 0.6), 5_300.0, 0.3)
            + 18.0 * wave(DVec2::new(-0.3, 0.95), 3_700.0, 1.0)
            + 5.0 * wave(DVec2::new(0.6, -0.8), 1_100.0, 2.0);
        let mut water_level = -50.0;
        let lake = wave(DVec2::X, 8_100.0, 0.5) * wave(DVec2::Y, 9_700.0, 2.1);
        if lake > 0.93 {
            (height, water_level) = (20.0 - (lake - 0.93) * 300.0, 20.0);
        }
        let river = p.x - 2_500.0 * math::sin(p.y / 6_000.0);
        let off = (river - 19_000.0 * (river / 19_000.0).round()).abs();
        if off < self.river {
            (height, water_level) = (12.0, 15.0);
        }
        TerrainSample { height, water_level, vegetation: 0.5 + 0.5 * wave(DVec2::Y, 2_900.0, 0.0) }
    }
}
