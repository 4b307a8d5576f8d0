//! Worlds for the tests of roads, and checks that several of them make: a small world of hills, a river, lakes and settlements on
//! jittered lattices, and random worlds on the default terrain.

use super::super::source::SettlementSource;
use super::super::{RoadSection, RoadSettings, Roads};
use crate::edits::Edits;
use crate::layer::{Cancel, LayerError};
use crate::network::{JunctionId, SizeClass};
use crate::region::{Outline, Settlement, SettlementId, SettlementSettings, Settlements};
use crate::space::{Bounds, Origin, Seed, math, quantize, segment_crossing, segments, stable_hash};
use crate::terrain::{NoiseTerrain, Terrain, TerrainSettings};
use crate::testing::Countryside;
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

type Cells = BTreeMap<(usize, [i64; 2]), Option<Arc<Settlement>>>;

/// Settlements on jittered lattices.
pub struct Towns {
    pub seed: Seed,
    pub terrain: Arc<dyn Terrain>,
    cells: Mutex<Cells>,
}

const TIERS: [(SizeClass, f64, f64); 3] =
    [(SizeClass::City, 16_000.0, 1_300.0), (SizeClass::Town, 6_000.0, 600.0), (SizeClass::Village, 2_500.0, 260.0)];

impl Towns {
    fn in_cell(&self, tier: usize, cell: I64Vec2) -> Option<Arc<Settlement>> {
        let key = (tier, cell.to_array());
        if let Some(held) = self.cells.lock().unwrap().get(&key) {
            return held.clone();
        }
        let made = self.make(tier, cell);
        self.cells.lock().unwrap().insert(key, made.clone());
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

impl SettlementSource for Towns {
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Ok(self.find(TIERS.iter().position(|t| t.0 == size).unwrap(), bounds))
    }

    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut all = self.centred_in(bounds.grown(2_000.0), SizeClass::Village)?;
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
    roads_over(seed, Countryside { flat, river: 35.0 }, settings)
}

/// Roads of a test world over a ground.
pub fn roads_over(seed: u64, ground: impl Terrain + 'static, settings: &RoadSettings) -> Roads {
    let terrain: Arc<dyn Terrain> = Arc::new(ground);
    let towns = Arc::new(Towns { seed: Seed(seed), terrain: terrain.clone(), cells: Mutex::default() });
    Roads::from_source(settings, terrain, towns, &Edits::default(), 256 << 20)
}

/// A merge distance.
pub fn with_merge(merge: f64) -> RoadSettings {
    RoadSettings { merge, ..RoadSettings::default() }
}

/// The default merge distance.
pub const MERGE: f64 = 275.0;

/// Roads of a world as it is by default.
pub fn world(seed: u64, merge: f64) -> Roads {
    let terrain = Arc::new(NoiseTerrain::new(Seed(seed), &TerrainSettings::default()));
    let settlements = Settlements::new(Seed(seed), &SettlementSettings::default(), terrain.clone(), 32 << 20);
    Roads::new(&with_merge(merge), terrain, Arc::new(settlements), 256 << 20)
}

/// A random world, and a random place in it.
pub fn random_place(i: u64) -> (u64, DVec2) {
    let mut stream = Seed(2026).stream("merging", &[i]);
    let seed = stream.range(0.0, 1e9) as u64;
    (seed, DVec2::new(stream.range(-4e5, 4e5), stream.range(-4e5, 4e5)).round())
}

/// Sections of road that enter a box.
pub fn all(roads: &Roads, bounds: Bounds) -> Vec<Arc<RoadSection>> {
    roads.overlapping(bounds, &Cancel::new()).unwrap()
}

/// Segments of sections around a common origin: section, index in its line, ends.
pub fn local_segments(sections: &[Arc<RoadSection>], origin: Origin) -> Vec<(usize, usize, DVec2, DVec2)> {
    let mut out = Vec::new();
    for (i, r) in sections.iter().enumerate() {
        let shift = r.origin.offset_to(origin);
        out.extend(segments(&r.street.line).enumerate().map(|(k, (a, b))| (i, k, a + shift, b + shift)));
    }
    out.sort_by(|a, b| a.2.x.min(a.3.x).total_cmp(&b.2.x.min(b.3.x)));
    out
}

/// Panics unless sections meet at shared junctions only.
pub fn assert_planar(sections: &[Arc<RoadSection>], origin: Origin) {
    let mut at: BTreeMap<JunctionId, DVec2> = BTreeMap::new();
    for r in sections {
        let (line, shift) = (&r.street.line, r.origin.offset_to(origin));
        assert!(line.iter().all(|p| quantize(*p) == *p));
        assert!(r.street.length() > 1.0, "{r:?}");
        for (id, p) in [(r.street.from, line[0]), (r.street.to, line[line.len() - 1])] {
            assert_eq!(*at.entry(id).or_insert(p + shift), p + shift);
        }
    }
    let segments = local_segments(sections, origin);
    for (n, (i, k, a, b)) in segments.iter().enumerate() {
        assert_ne!(a, b);
        for (j, l, c, d) in &segments[n + 1..] {
            if c.x.min(d.x) > a.x.max(b.x) {
                break;
            }
            if i == j && k.abs_diff(*l) <= 1 {
                continue;
            }
            let Some(x) = segment_crossing(*a, *b, *c, *d) else { continue };
            let (r, s) = (&sections[*i].street, &sections[*j].street);
            if r.level != s.level {
                continue;
            }
            let shared = [r.from, r.to].iter().any(|id| (*id == s.from || *id == s.to) && at[id] == x.at);
            assert!(shared, "{r:?} and {s:?} meet at {}", origin.to_plan(x.at));
        }
    }
}

/// Panics unless the roads around `centre` are the same alone, from a larger window, and from quarters with caches that
/// forget most of it in between.
pub fn assert_same_whatever_was_asked(fresh: impl Fn() -> Roads, centre: DVec2, size: f64) {
    let window = Bounds::square(centre, size);
    let alone = all(&fresh(), window);
    assert!(!alone.is_empty());
    let larger = fresh();
    let mut inside = all(&larger, Bounds::square(centre + 900.0, size + 3_500.0));
    inside.retain(|r| r.enters(window));
    assert_eq!(alone, inside);
    assert_eq!(alone, all(&larger, window));
    let inputs = &larger.searches.inputs;
    let (terrain, settlements) = (inputs.terrain.clone(), inputs.settlements.clone());
    let tiny = Roads::from_source(&inputs.settings, terrain, settlements, &Edits::default(), 6_000_000);
    let mut quarters: Vec<Arc<RoadSection>> = Vec::new();
    for (x, y) in [(0.25, 0.25), (0.25, -0.25), (-0.25, 0.25), (-0.25, -0.25)] {
        let quarter = Bounds::square(centre + DVec2::new(x, y) * size, size / 2.0);
        quarters.extend(all(&tiny, quarter));
    }
    quarters.sort_by_key(|r| r.street.id);
    quarters.dedup_by_key(|r| r.street.id);
    assert_eq!(alone, quarters);
}
