//! A small world for the tests of roads: hills, a river, lakes, and settlements on jittered lattices.

use super::super::places::Places;
use super::super::{RoadSettings, Roads, Work};
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::{Outline, Settlement, SettlementId};
use crate::space::{Bounds, Origin, Seed, math, quantize, stable_hash};
use crate::terrain::{Terrain, TerrainSample};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

/// Hills, a river every 19 km and lakes; or nothing but a plain.
pub struct Hills {
    pub flat: bool,
    /// Half the width of rivers in metres.
    pub river: f64,
}

impl Terrain for Hills {
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

type Found = BTreeMap<(usize, [i64; 2]), Option<Arc<Settlement>>>;

/// Settlements on jittered lattices.
pub struct Towns {
    pub seed: Seed,
    pub terrain: Arc<Hills>,
    found: Mutex<Found>,
}

const TIERS: [(SizeClass, f64, f64); 3] =
    [(SizeClass::City, 16_000.0, 1_300.0), (SizeClass::Town, 6_000.0, 600.0), (SizeClass::Village, 2_500.0, 260.0)];

impl Towns {
    fn in_cell(&self, tier: usize, cell: I64Vec2) -> Option<Arc<Settlement>> {
        let key = (tier, cell.to_array());
        if let Some(held) = self.found.lock().unwrap().get(&key) {
            return held.clone();
        }
        let made = self.make(tier, cell);
        self.found.lock().unwrap().insert(key, made.clone());
        made
    }

    fn make(&self, tier: usize, cell: I64Vec2) -> Option<Arc<Settlement>> {
        let (size, spacing, radius) = TIERS[tier];
        let mut s = self.seed.stream("settlements", &[tier as u64, cell.x as u64, cell.y as u64]);
        let at = (cell.as_dvec2() + DVec2::new(s.range(0.2, 0.8), s.range(0.2, 0.8))) * spacing;
        let centre = Origin::at(at);
        let radius = radius * s.range(0.7, 1.3);
        let dry = (0..16).all(|i| {
            self.terrain.sample(centre.plan() + math::direction(TAU / 16.0 * f64::from(i)) * radius).depth() == 0.0
        });
        let clear = (0..tier).all(|above| {
            self.find(above, Bounds::square(centre.plan(), 8_000.0))
                .iter()
                .all(|o| o.centre.plan().distance(centre.plan()) > o.radius + radius + 350.0)
        });
        let id = SettlementId(stable_hash(&[tier as u64, cell.x as u64, cell.y as u64]));
        let (style, name) = (String::new(), format!("{size:?} {cell}"));
        (dry && clear && s.chance(0.9)).then(|| Arc::new(Settlement { id, centre, radius, size, style, name }))
    }

    fn find(&self, tier: usize, bounds: Bounds) -> Vec<Arc<Settlement>> {
        let spacing = TIERS[tier].1;
        let (min, max) = ((bounds.min / spacing).floor().as_i64vec2(), (bounds.max / spacing).floor().as_i64vec2());
        let mut out = Vec::new();
        for y in min.y..=max.y {
            for x in min.x..=max.x {
                out.extend(self.in_cell(tier, I64Vec2::new(x, y)).filter(|s| bounds.contains(s.centre.plan())));
            }
        }
        out.sort_by_key(|s| s.id);
        out
    }
}

impl Places for Towns {
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Ok(self.find(TIERS.iter().position(|t| t.0 == size).unwrap(), bounds))
    }

    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut all = self.of_tier(bounds.grown(2_000.0), SizeClass::Village)?;
        all.retain(|s| Bounds::square(s.centre.plan(), 2.0 * s.radius).overlaps(bounds));
        Ok(all)
    }

    fn outline(&self, s: &Settlement) -> Result<Arc<Outline>, LayerError> {
        let count = (s.radius * TAU / 65.0) as usize;
        let mut stream = self.seed.stream("outline", &[s.id.0]);
        let (p, q) = (stream.range(0.0, TAU), stream.range(0.0, TAU));
        let polygon = (0..count)
            .map(|i| {
                let a = TAU * i as f64 / count as f64;
                let r = 0.82 + 0.1 * math::sin(2.0 * a + p) + 0.07 * math::sin(5.0 * a + q);
                quantize(math::direction(a) * r * s.radius)
            })
            .collect();
        Ok(Arc::new(Outline { origin: s.centre, polygon, shared: Vec::new(), river: None }))
    }
}

/// Roads of a test world.
pub fn roads(seed: u64, flat: bool, settings: &RoadSettings) -> Roads {
    roads_over(seed, Hills { flat, river: 35.0 }, settings)
}

/// Roads of a test world over a ground.
pub fn roads_over(seed: u64, ground: Hills, settings: &RoadSettings) -> Roads {
    let terrain = Arc::new(ground);
    let places = Arc::new(Towns { seed: Seed(seed), terrain: terrain.clone(), found: Mutex::default() });
    Roads { work: Work::new(settings, terrain, places, 256 << 20) }
}
