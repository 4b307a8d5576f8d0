//! Settings at the ends of their ranges give roads in seconds, or are refused.

use super::*;
use crate::layer::RangeError;
use crate::region::road::tier_settings::NUMBERS;
use crate::region::{PerSize, SettlementSettings, Settlements};
use crate::space::Seed;
use crate::terrain::{Terrain, TerrainSample};
use crate::testing::Countryside;
use std::sync::atomic::{AtomicU64, Ordering};

/// Steps of searches, each up to 4,096 nodes, that the roads of one place may take; with the defaults they take 250.
const MOST_STEPS: u64 = 12_000;
/// Samples of the terrain that they may take; with the defaults they take 300,000.
const MOST_SAMPLES: u64 = 12_000_000;

/// A ground that counts its samples.
struct Counted(Countryside, AtomicU64);

impl Terrain for Counted {
    fn sample(&self, p: DVec2) -> TerrainSample {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.sample(p)
    }
}

/// Finds the roads of one place, unless the settings are refused. Gives whether they were found.
fn is_found(name: &str, roads: &RoadSettings, settlements: &SettlementSettings) -> bool {
    let checked = roads.check().and_then(|()| settlements.check()).and_then(|()| roads.check_effort(settlements));
    if let Err(e) = checked {
        let RangeError { allowed, .. } = &e;
        assert!(!allowed.is_empty(), "{name}: {e}");
        return false;
    }
    let terrain = Arc::new(Counted(Countryside { flat: false, river: 35.0 }, AtomicU64::new(0)));
    let all = Arc::new(Settlements::new(Seed(3), settlements, terrain.clone(), 64 << 20));
    let roads = Roads::from_source(roads, terrain.clone(), all, &Edits::default(), 64 << 20);
    let cancel = Cancel::after(MOST_STEPS);
    for tier in SizeClass::ALL {
        let found = roads.routes.passing(tier, Bounds::square(DVec2::new(700.0, -300.0), 300.0), &cancel);
        assert!(found.is_ok(), "{name}: more than {MOST_STEPS} steps");
    }
    let samples = terrain.1.load(Ordering::Relaxed);
    assert!(samples < MOST_SAMPLES, "{name}: {samples} samples");
    true
}

/// Both ends of every number of a class of roads.
fn both_ends(name: &str, of: impl Fn(&mut RoadSettings) -> &mut TierSettings) {
    let mut refused = Vec::new();
    for number in NUMBERS {
        for value in [number.low, number.high] {
            let mut roads = RoadSettings::default();
            (number.set)(of(&mut roads), value);
            let name = format!("{name}.{} = {value}", number.name);
            if !is_found(&name, &roads, &SettlementSettings::default()) {
                refused.push(name);
            }
        }
    }
    // All but the greatest reach are fine as they are.
    assert!(refused.iter().all(|name| name.contains("reach = 60000")), "{refused:?}");
    assert!(name != "minor" || refused.len() == 1, "so long roads between villages take minutes");
}

#[test]
fn highways_at_both_ends_of_every_range() {
    both_ends("highway", |s| &mut s.highway);
}

#[test]
fn majors_at_both_ends_of_every_range() {
    both_ends("major", |s| &mut s.major);
}

#[test]
fn minors_at_both_ends_of_every_range() {
    both_ends("minor", |s| &mut s.minor);
}

#[test]
fn settlements_at_both_ends_of_every_range() {
    let usual = SettlementSettings::default();
    let of_each = |of: &PerSize<f64>, ends: [f64; 2]| -> Vec<PerSize<f64>> {
        let with = |value: f64| {
            let one = |city, town, village| PerSize { city, town, village };
            [one(value, of.town, of.village), one(of.city, value, of.village), one(of.city, of.town, value)]
        };
        ends.into_iter().flat_map(with).collect()
    };
    let mut all: Vec<SettlementSettings> = Vec::new();
    // A new field has to be put here.
    let SettlementSettings {
        spacing,
        radius,
        share,
        styles: _,
        steep: _,
        jitter: _,
        max_slope: _,
        max_height: _,
        fullness: _,
        clearance: _,
        gap: _,
        widest_river: _,
    } = &usual;
    all.extend(of_each(share, [0.0, 1.0]).into_iter().map(|share| SettlementSettings { share, ..usual.clone() }));
    let nearest = PerSize { city: radius.city.1 * 1.2, town: radius.town.1 * 1.2, village: radius.village.1 * 1.2 };
    for size in SizeClass::ALL {
        for value in [*nearest.of(size), 1e6] {
            let spacing = |of: SizeClass| if of == size { value } else { *spacing.of(of) };
            let [city, town, village] = SizeClass::ALL.map(spacing);
            all.push(SettlementSettings { spacing: PerSize { city, town, village }, ..usual.clone() });
        }
        for range in [(120.0, 120.0), (120.0, 2_000.0)] {
            let radius = |of: SizeClass| if of == size { range } else { *radius.of(of) };
            let [city, town, village] = SizeClass::ALL.map(radius);
            all.push(SettlementSettings { radius: PerSize { city, town, village }, ..usual.clone() });
        }
    }
    let mut with = |ends: [f64; 2], set: &dyn Fn(&mut SettlementSettings) -> &mut f64| {
        for value in ends {
            let mut s = usual.clone();
            *set(&mut s) = value;
            all.push(s);
        }
    };
    with([0.0, 0.9], &|s| &mut s.jitter);
    with([0.01, 0.5], &|s| &mut s.max_slope);
    with([0.0, 10_000.0], &|s| &mut s.max_height);
    with([0.7, 0.98], &|s| &mut s.fullness);
    with([0.5, 4.0], &|s| &mut s.clearance);
    with([0.0, 10_000.0], &|s| &mut s.gap);
    with([0.0, 200.0], &|s| &mut s.widest_river);
    let found = all.iter().filter(|s| is_found(&format!("{s:?}"), &RoadSettings::default(), s)).count();
    assert!(found + 4 >= all.len(), "{found} of {}", all.len());
}

#[test]
fn random_valid_settings_are_found_or_refused() {
    let (mut found, mut random) = (0, Seed(12).stream("settings", &[]));
    for i in 0..24 {
        let mut roads = RoadSettings::default();
        for tier in [&mut roads.highway, &mut roads.major, &mut roads.minor] {
            for number in NUMBERS.iter().filter(|_| random.chance(0.4)).collect::<Vec<_>>() {
                let value = [number.low, number.high, random.range(number.low, number.high)][random.index(3)];
                (number.set)(tier, value);
            }
        }
        let mut settlements = SettlementSettings::default();
        settlements.spacing.village = random.range(400.0, 5_000.0);
        settlements.spacing.town = random.range(1_000.0, 20_000.0);
        found += usize::from(is_found(&format!("{i}: {roads:?}"), &roads, &settlements));
    }
    assert!(found > 4, "{found}");
}
