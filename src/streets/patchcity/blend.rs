//! Several maps, blended over a town: each has a smooth random field, and tiles of a map cost the less, the higher its field is against
//! those of the others.

use crate::space::{Seed, math::smoothstep};
use glam::DVec2;

/// Cost of a tile of a map whose field is lower by 1 than the highest: more than that of streets which fit badly.
const COST: f32 = 6000.0;

/// Where which map prevails.
#[derive(Clone, Copy, Debug)]
pub struct Blend {
    /// The world's seed.
    pub seed: Seed,
    /// Name of the town.
    pub town: u64,
    /// About how large the parts are in which one map prevails, in metres.
    pub size: f64,
}

impl Blend {
    /// Cost of tiles of each map at a place; nothing where there is one map alone. `maps` are names of the maps.
    pub fn costs(&self, maps: &[u64], at: DVec2) -> Vec<f32> {
        if maps.len() < 2 {
            return Vec::new();
        }
        let heights: Vec<f64> = maps.iter().map(|map| self.height(*map, at / self.size)).collect();
        let highest = heights.iter().copied().fold(0.0, f64::max);
        heights.into_iter().map(|height| COST * (highest - height) as f32).collect()
    }

    /// The field of a map, 0 to 1: random values at whole numbers, smooth between them.
    fn height(&self, map: u64, at: DVec2) -> f64 {
        let corner = at.floor().as_i64vec2();
        let share = at - at.floor();
        let value = |x: i64, y: i64| {
            let key = [self.town, map, (corner.x + x) as u64, (corner.y + y) as u64];
            self.seed.stream("blend", &key).unit()
        };
        let (x, y) = (smoothstep(0.0, 1.0, share.x), smoothstep(0.0, 1.0, share.y));
        let row = |y: i64| value(0, y) + (value(1, y) - value(0, y)) * x;
        row(0) + (row(1) - row(0)) * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_smooth_and_each_map_prevails_somewhere() {
        let blend = Blend { seed: Seed(4), town: 9, size: 300.0 };
        let maps = [11, 12, 13];
        let mut prevails = [0; 3];
        let mut before: Option<Vec<f32>> = None;
        for i in 0..4000 {
            let costs = blend.costs(&maps, DVec2::new(f64::from(i) * 5.0, f64::from(i) * 1.5));
            let first = costs.iter().position(|cost| *cost == 0.0).expect("one is the highest");
            prevails[first] += 1;
            let step = before.iter().flatten().zip(&costs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(step < COST * 0.2, "{step}");
            before = Some(costs);
        }
        assert!(prevails.iter().all(|count| *count > 500), "{prevails:?}");
        let elsewhere = Blend { town: 10, ..blend };
        assert_ne!(blend.costs(&maps, DVec2::ONE), elsewhere.costs(&maps, DVec2::ONE));
        assert!(blend.costs(&maps[..1], DVec2::ONE).is_empty(), "there is nothing to choose");
    }
}
