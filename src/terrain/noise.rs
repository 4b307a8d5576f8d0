//! The default terrain.

use super::field::{Corners, Fractal, Fresh, Octaves, Places, Remembered};
use super::lake::Lakes;
use super::river::Rivers;
use super::{Scan, Terrain, TerrainSample, TerrainSettings};
use crate::space::{Seed, math};
use glam::DVec2;

/// Places in a wide field that are sorted to find the level below which a share of them lies.
const QUANTILE_SAMPLES: usize = 4096;
/// Greatest strength of the small bays and capes that are laid over the coast.
const COAST_DETAIL: f64 = 0.1;
/// Value of the continent field, above that of the coast, from which the ground is free of the sea.
const INLAND: f64 = 0.17;
/// Height of flood plains above the water, in metres.
const FLOOD_PLAIN: f64 = 1.6;

/// Endless land of plains, hills, ridged mountains, sea, rivers and lakes.
///
/// Heights stand on a water table: a level that is 0 on the coast and rises gently inland. Sea and rivers lie at that
/// level, all dry ground above it, so no water stands higher than the land beside it. Lakes have levels of their own.
#[derive(Debug)]
pub struct NoiseTerrain {
    ground: Ground,
    lakes: Lakes,
    /// Octaves of all.
    octaves: usize,
}

/// Everything but the lakes.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    settings: TerrainSettings,
    continent: Continent,
    rivers: Rivers,
    plain: Fractal<2>,
    detail: Fractal<4>,
    hill: Fractal<4>,
    hill_mask: Mask,
    mountain: Fractal<6>,
    mountain_bend: Octaves<2>,
    mountain_mask: Mask,
    wood: Fractal<4>,
}

/// Ground at a point, before lakes.
pub(super) struct Shape {
    /// Height in metres.
    pub height: f64,
    /// Water table in metres.
    pub table: f64,
    /// How far from sea and rivers: 0 at their edge, 1 well away.
    pub dry: f64,
    /// How mountainous, 0 to 1.
    pub mountain: f64,
}

/// A field that is 0 outside of a share of the plan and rises smoothly to 1 within.
#[derive(Clone, Debug)]
struct Mask {
    field: Fractal<2>,
    low: f64,
    high: f64,
}

impl Mask {
    fn new(seed: Seed, key: u64, wavelength: f64, share: f64, width: f64, places: &mut Places) -> Self {
        let field = Fractal::new(seed, key, wavelength, 0.4, places);
        let low = quantile(seed, key, wavelength, 1.0 - share, |p| field.at(p, &mut Fresh::new()));
        Self { field, low, high: low + width }
    }

    fn at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        math::smoothstep(self.low, self.high, self.field.at(p, corners))
    }
}

/// The value that a `share` of a field lies below, found at places many wavelengths apart; beyond all values for 0 and 1.
fn quantile(seed: Seed, key: u64, wavelength: f64, share: f64, field: impl Fn(DVec2) -> f64) -> f64 {
    let mut stream = seed.stream("terrain", &[key, 1]);
    let mut place = || stream.signed() * wavelength * 500.0;
    let mut values: Vec<f64> = (0..QUANTILE_SAMPLES).map(|_| field(DVec2::new(place(), place()))).collect();
    values.sort_by(f64::total_cmp);
    match (share * QUANTILE_SAMPLES as f64) as usize {
        0 => values[0] - 10.0,
        QUANTILE_SAMPLES.. => values[QUANTILE_SAMPLES - 1] + 10.0,
        i => values[i],
    }
}

/// Where land and sea are.
#[derive(Clone, Debug)]
struct Continent {
    bend: Octaves<2>,
    bend_by: f64,
    field: Fractal<3>,
    coast: Fractal<5>,
    sea: f64,
}

impl Continent {
    fn new(seed: Seed, size: f64, sea_share: f64, places: &mut Places) -> Self {
        let mut it = Self {
            bend: Octaves::new(seed, [(1, size * 0.53), (2, size * 0.53)], places),
            bend_by: size * 0.16,
            field: Fractal::new(seed, 3, size, 0.42, places),
            coast: Fractal::new(seed, 4, 5_300.0, 0.5, places),
            sea: 0.0,
        };
        it.sea = quantile(seed, 3, size, sea_share, |p| it.wide(p, &mut Fresh::new()));
        it
    }

    fn wide(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        let bend = DVec2::from(self.bend.at(p, corners));
        self.field.at(p + bend * self.bend_by, corners) - self.sea
    }

    /// Wide field, and the same with the coast's detail: above 0 on land, below in the sea.
    fn at(&self, p: DVec2, corners: &mut impl Corners) -> (f64, f64) {
        let wide = self.wide(p, corners);
        let x = wide / INLAND;
        if x.abs() >= 1.0 {
            return (wide, wide);
        }
        let fade = (1.0 - x * x) * (1.0 - x * x);
        (wide, wide + COAST_DETAIL * fade * self.coast.at(p, corners).clamp(-1.0, 1.0))
    }
}

/// `x` where it is well above 0, and smoothly to 0 below: valley floors without a crease.
fn positive(x: f64) -> f64 {
    (x + (x * x + 0.03).sqrt()) / 2.0
}

/// The smaller of two heights, rounded off over `k` metres.
fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k / 4.0
}

impl Ground {
    fn new(seed: Seed, s: &TerrainSettings, places: &mut Places) -> Self {
        Self {
            settings: s.clone(),
            continent: Continent::new(seed, s.continent_size, s.sea_share, places),
            rivers: Rivers::new(seed, s.river_spacing, s.river_width, places),
            plain: Fractal::new(seed, 20, 2_300.0, 0.4, places),
            detail: Fractal::new(seed, 21, 330.0, 0.3, places),
            hill: Fractal::new(seed, 22, 2_900.0, 0.42, places),
            hill_mask: Mask::new(seed, 23, 15_700.0, s.hill_share, 0.25, places),
            mountain: Fractal::new(seed, 24, 7_900.0, 0.44, places),
            mountain_bend: Octaves::new(seed, [(25, 3_100.0), (26, 3_100.0)], places),
            mountain_mask: Mask::new(seed, 27, 39_000.0, s.mountain_share, 0.35, places),
            wood: Fractal::new(seed, 28, 2_900.0, 0.65, places),
        }
    }

    pub fn at(&self, p: DVec2, corners: &mut impl Corners) -> Shape {
        let s = &self.settings;
        let (wide, coast) = self.continent.at(p, corners);
        let table = s.inland_height * math::smoothstep(INLAND, 0.95, wide);
        let river = self.rivers.at(p, corners);

        // Roughness grows away from rivers; mountains stand on watersheds.
        let mut relief = 9.0 * positive(0.55 + self.plain.at(p, corners)) * river.valley;
        let hilly = if coast > 0.0 { self.hill_mask.at(p, corners) * coast / (coast + 0.05) } else { 0.0 };
        if hilly > 0.0 {
            relief += s.hill_height * hilly * river.valley * positive(0.45 + 0.9 * self.hill.at(p, corners));
        }
        let mut mountain = 0.0;
        // Neither stands on the beach.
        let inland = math::smoothstep(0.0, INLAND, coast);
        let room = inland * math::smoothstep(0.12, 0.6, river.watershed) * river.valley;
        if room > 0.0 {
            mountain = self.mountain_mask.at(p, corners) * room;
            if mountain > 0.0 {
                let bend = DVec2::from(self.mountain_bend.at(p, corners)) * 500.0;
                relief += s.mountain_height * mountain * (0.15 + self.mountain.ridged_at(p + bend, corners));
            }
        }
        let rough = 0.5 * positive(0.8 + self.detail.at(p, corners)) * (1.0 + (3.0 * mountain + hilly) * river.valley);
        let land = if coast > 0.0 {
            let shore = coast / (coast + 0.035) * (1.0 + 0.035);
            shore * (FLOOD_PLAIN + rough + relief) + 40.0 * coast.min(0.05)
        } else {
            420.0 * coast / (1.0 - 3.0 * coast)
        };
        let height = table + smooth_min(land, river.profile, 0.5);
        let dry = river.dry * inland;
        Shape { height, table, dry, mountain }
    }

    fn vegetation(&self, p: DVec2, shape: &Shape, height: f64, corners: &mut impl Corners) -> f64 {
        let above = height - shape.table;
        let shore = math::smoothstep(0.5, 4.0, above);
        let tree_line = 1.0 - math::smoothstep(420.0, 620.0, above);
        let density = 0.5 + self.wood.at(p, corners) + 1.4 * (self.settings.vegetation - 0.5) + 0.25 * shape.mountain;
        math::smoothstep(0.0, 1.0, density) * shore * tree_line
    }
}

impl NoiseTerrain {
    /// The terrain of a seed. `settings` are taken as checked.
    pub fn new(seed: Seed, settings: &TerrainSettings) -> Self {
        let places = &mut Places::default();
        let (ground, lakes) = (Ground::new(seed, settings, places), Lakes::new(seed, settings, places));
        Self { ground, lakes, octaves: places.taken() }
    }

    fn sample_with(&self, p: DVec2, wooded: bool, corners: &mut impl Corners) -> TerrainSample {
        let shape = self.ground.at(p, corners);
        let (height, water_level) = self.lakes.lay(p, &shape, corners, |q| self.ground.at(q, &mut Fresh::new()));
        let bare = !wooded || height < water_level;
        let vegetation = if bare { 0.0 } else { self.ground.vegetation(p, &shape, height, corners) };
        TerrainSample { height, water_level, vegetation }
    }
}

impl Terrain for NoiseTerrain {
    fn sample(&self, p: DVec2) -> TerrainSample {
        self.sample_with(p, true, &mut Fresh::new())
    }

    fn scan(&self) -> Scan<'_> {
        let mut corners = Remembered::new(self.octaves);
        Box::new(move |p| self.sample_with(p, true, &mut corners))
    }

    fn scan_ground(&self) -> Scan<'_> {
        let mut corners = Remembered::new(self.octaves);
        Box::new(move |p| self.sample_with(p, false, &mut corners))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terrain(seed: u64) -> NoiseTerrain {
        NoiseTerrain::new(Seed(seed), &TerrainSettings::default())
    }

    fn places(seed: u64, extent: f64, count: usize) -> Vec<DVec2> {
        let mut s = Seed(seed).stream("test", &[]);
        (0..count).map(|_| DVec2::new(s.signed(), s.signed()) * extent).collect()
    }

    #[test]
    fn a_scan_gives_the_very_samples() {
        let t = terrain(17);
        let mut scan = t.scan();
        for start in places(17, 1e7, 40) {
            for i in 0..60 {
                let p = start + DVec2::new(f64::from(i % 8), f64::from(i / 8)) * 37.0;
                assert_eq!(scan(p), t.sample(p));
            }
        }
    }

    #[test]
    fn most_land_is_fit_for_towns_and_mountains_are_mountains() {
        for seed in [11, 12, 13] {
            let t = terrain(seed);
            let samples: Vec<_> = places(seed, 4e5, 6000).into_iter().map(|p| (p, t.sample(p))).collect();
            let land: Vec<_> = samples.iter().filter(|(_, s)| s.depth() == 0.0).collect();
            let share = land.len() as f64 / samples.len() as f64;
            assert!((0.62..0.84).contains(&share), "land {share}");
            let gentle = land.iter().filter(|(p, _)| t.gradient(*p, 64.0).length() < 0.08).count();
            assert!(gentle * 10 > land.len() * 6, "gentle {gentle} of {}", land.len());
            let highest = samples.iter().map(|(_, s)| s.height).fold(0.0, f64::max);
            assert!((600.0..1250.0).contains(&highest), "highest {highest}");
            assert!(samples.iter().all(|(_, s)| (0.0..=1.0).contains(&s.vegetation)));
            let wooded = land.iter().map(|(_, s)| s.vegetation).sum::<f64>() / land.len() as f64;
            assert!((0.3..0.7).contains(&wooded), "vegetation {wooded}");
        }
    }

    #[test]
    fn the_ground_is_as_smooth_far_out_as_at_the_origin_and_not_the_same() {
        let t = terrain(5);
        let mut profiles: Vec<Vec<f64>> = vec![];
        for origin in [0.0, 5e8, -5e8, 1e11] {
            let at = |i: i32| DVec2::new(origin + f64::from(i), -origin + 7e3);
            let heights: Vec<f64> = (0..6000).map(|i| t.height(at(i))).collect();
            for w in heights.windows(3) {
                assert!((w[1] - w[0]).abs() < 2.0, "step at {origin}: {w:?}");
                assert!((w[0] - 2.0 * w[1] + w[2]).abs() < 0.5, "kink at {origin}: {w:?}");
            }
            assert!(heights.windows(2).filter(|w| w[0] == w[1]).count() < 60, "plateaus at {origin}");
            profiles.push(heights);
        }
        for (i, a) in profiles.iter().enumerate() {
            for b in &profiles[i + 1..] {
                let apart = a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum::<f64>() / a.len() as f64;
                assert!(apart > 1.0);
            }
        }
    }

    #[test]
    fn no_water_stands_above_the_dry_ground_beside_it() {
        let (mut shores, t) = (0, terrain(21));
        for (i, p) in places(21, 2e5, 150).into_iter().enumerate() {
            let step = math::direction(i as f64) * 1.5;
            let mut last = t.sample(p);
            for k in 1..1200 {
                let here = t.sample(p + step * f64::from(k));
                let (wet, dry) = if last.depth() > 0.0 { (last, here) } else { (here, last) };
                if wet.depth() > 0.0 && dry.depth() == 0.0 {
                    shores += 1;
                    assert!(dry.height > wet.water_level - 0.05, "{p} {k}: {wet:?} {dry:?}");
                } else if wet.depth() > 0.0 {
                    assert!((wet.water_level - dry.water_level).abs() < 0.05, "{p} {k}: a step in the water");
                }
                last = here;
            }
        }
        assert!(shores > 20, "{shores}");
    }

    #[test]
    fn rivers_carry_water_all_along_between_banks() {
        for seed in [31, 32, 33, 34] {
            let t = terrain(seed);
            let (mut on_land, mut steepest) = (0, 0.0f64);
            for start in places(seed, 2e5, 12) {
                let Some(mut p) = t.ground.rivers.course_near(start) else { continue };
                let mut last = t.sample(p).water_level;
                for _ in 0..100 {
                    let s = t.sample(p);
                    assert!(s.depth() > 0.3, "dry at {p}: {s:?}");
                    steepest = steepest.max((s.water_level - last).abs() / 40.0);
                    last = s.water_level;
                    let across = t.ground.rivers.direction(p).perp();
                    let sides = [-1.0, 1.0].map(|side| {
                        // The other bank within 80 m, unless this is the sea or a river's mouth.
                        (1..=80).map(|d| t.sample(p + across * side * f64::from(d))).find(|s| s.depth() == 0.0)
                    });
                    if let [Some(left), Some(right)] = sides {
                        on_land += 1;
                        for bank in [left, right] {
                            assert!(
                                bank.height >= bank.water_level && bank.height > s.water_level - 0.5,
                                "{bank:?} {s:?}"
                            );
                        }
                    }
                    let Some(next) = t.ground.rivers.course_near(p + t.ground.rivers.direction(p) * 40.0) else {
                        break;
                    };
                    p = next;
                }
            }
            assert!(on_land > 300, "{on_land}");
            assert!(steepest < 0.02, "a fall of {steepest}");
        }
    }

    #[test]
    fn lakes_have_one_level_below_their_rim() {
        let t = terrain(41);
        let mut found = 0;
        for cell in (-6..6).flat_map(|x| (-6..6).map(move |y| [x, y])) {
            let Some((centre, radius, level)) = t.lakes.lake(cell, |q| t.ground.at(q, &mut Fresh::new())) else {
                continue;
            };
            found += 1;
            let middle = t.sample(centre);
            assert_eq!(middle.water_level, level);
            assert!(middle.depth() > 0.5, "{middle:?}");
            // On every way out of it the level holds up to ground that is above it.
            for i in 0..40 {
                let way = math::direction(f64::from(i) * 0.157);
                let mut along = (1..400).map(|k| t.sample(centre + way * radius * (f64::from(k) * 0.01)));
                let shore = along.find(|s| s.depth() == 0.0).unwrap();
                assert!(shore.height >= level && shore.water_level == level, "{shore:?} {level}");
            }
        }
        assert!(found > 10, "{found}");
    }

    #[test]
    fn settings_out_of_range_are_refused() {
        assert!(TerrainSettings::default().check().is_ok());
        let bad = |change: fn(&mut TerrainSettings)| {
            let mut s = TerrainSettings::default();
            change(&mut s);
            s.check().unwrap_err().field
        };
        assert_eq!(bad(|s| s.sea_share = f64::NAN), "sea_share");
        assert_eq!(bad(|s| s.mountain_height = 1e9), "mountain_height");
        assert_eq!(bad(|s| s.river_width = (40.0, 20.0)), "river_width");
        assert_eq!(bad(|s| s.lake_radius = (100.0, 2000.0)), "lake_radius");
        assert_eq!(bad(|s| s.lake_spacing = 0.0), "lake_spacing");
    }

    #[test]
    fn extreme_settings_stay_finite() {
        let most = TerrainSettings {
            sea_share: 0.0,
            hill_share: 1.0,
            mountain_share: 0.8,
            mountain_height: 3000.0,
            lake_share: 1.0,
            vegetation: 1.0,
            ..TerrainSettings::default()
        };
        let least = TerrainSettings {
            hill_share: 0.0,
            mountain_share: 0.0,
            lake_share: 0.0,
            inland_height: 0.0,
            vegetation: 0.0,
            ..TerrainSettings::default()
        };
        for (settings, highest) in [(most, 6000.0), (least, 60.0)] {
            assert_eq!(settings.check(), Ok(()));
            let t = NoiseTerrain::new(Seed(1), &settings);
            for p in places(1, 1e6, 3000) {
                let s = t.sample(p);
                assert!(s.height > -1000.0 && s.height < highest && s.water_level.is_finite(), "{s:?}");
            }
        }
    }
}
