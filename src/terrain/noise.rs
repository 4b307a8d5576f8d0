//! The default terrain.

use super::contract::{Scan, Terrain, TerrainSample};
use super::field::{CachedCorners, Corners, FreshCorners, Slots};
use super::ground::Ground;
use super::lake::Lakes;
use super::settings::TerrainSettings;
use crate::space::Seed;
use glam::DVec2;

/// Endless land of plains, hills, ridged mountains, sea, rivers and lakes.
///
/// All heights are relative to a water table, a level that is 0 on the coast and rises gently inland. Sea and rivers lie at this
/// level and all dry ground lies above it, so no water stands higher than the land beside it. Lakes have levels of their own.
#[derive(Debug)]
pub struct NoiseTerrain {
    ground: Ground,
    lakes: Lakes,
    /// Number of octaves in all fields.
    octaves: usize,
}

impl NoiseTerrain {
    /// The terrain of a seed. `settings` must have been checked.
    pub fn new(seed: Seed, settings: &TerrainSettings) -> Self {
        let slots = &mut Slots::default();
        let (ground, lakes) = (Ground::new(seed, settings, slots), Lakes::new(seed, settings, slots));
        Self { ground, lakes, octaves: slots.taken() }
    }

    fn sample_with(&self, p: DVec2, wooded: bool, corners: &mut impl Corners) -> TerrainSample {
        let shape = self.ground.at(p, corners);
        let (height, water_level) =
            self.lakes.apply(p, &shape, corners, |q| self.ground.at(q, &mut FreshCorners::new()));
        let bare = !wooded || height < water_level;
        let vegetation = if bare { 0.0 } else { self.ground.vegetation(p, &shape, height, corners) };
        TerrainSample { height, water_level, vegetation }
    }
}

impl Terrain for NoiseTerrain {
    fn sample(&self, p: DVec2) -> TerrainSample {
        self.sample_with(p, true, &mut FreshCorners::new())
    }

    fn scan(&self) -> Scan<'_> {
        let mut corners = CachedCorners::new(self.octaves);
        Box::new(move |p| self.sample_with(p, true, &mut corners))
    }

    fn scan_ground(&self) -> Scan<'_> {
        let mut corners = CachedCorners::new(self.octaves);
        Box::new(move |p| self.sample_with(p, false, &mut corners))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::math;

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
            let Some((centre, radius, level)) = t.lakes.lake(cell, |q| t.ground.at(q, &mut FreshCorners::new())) else {
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
        assert_eq!(bad(|s| s.river_width = (40.0, 20.0)), "river_width[1]");
        assert_eq!(bad(|s| s.lake_radius = (100.0, 2000.0)), "lake_radius[1]");
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
