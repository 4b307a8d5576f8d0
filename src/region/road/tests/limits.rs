//! Settings at the ends of their ranges give roads in seconds, or are refused.

use super::*;
use crate::layer::{RangeError, Ranged};
use crate::region::{SettlementSettings, Settlements};
use crate::space::Seed;
use crate::terrain::{Terrain, TerrainSample};
use crate::testing::Countryside;
use std::collections::BTreeMap;
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
fn both_ends(class: &str) {
    let mut refused = Vec::new();
    let usual = RoadSettings::default();
    let of_class = |path: &str| path.strip_prefix(class).is_some_and(|rest| rest.starts_with('.'));
    let numbers: Vec<_> = usual.ends().into_iter().filter(|(path, _)| of_class(path)).collect();
    assert!(numbers.len() > 20, "{numbers:?}");
    for (path, ends) in numbers {
        for value in ends {
            let mut roads = usual.clone();
            roads.set(&BTreeMap::from([(path.clone(), value)])).expect("it is in range");
            let name = format!("{path} = {value}");
            if !is_found(&name, &roads, &SettlementSettings::default()) {
                refused.push(name);
            }
        }
    }
    // All but the greatest reach are fine as they are.
    assert!(refused.iter().all(|name| name.contains("reach = 60000")), "{refused:?}");
    assert!(class != "minor" || refused.len() == 1, "so long roads between villages take minutes");
}

#[test]
fn highways_at_both_ends_of_every_range() {
    both_ends("highway");
}

#[test]
fn majors_at_both_ends_of_every_range() {
    both_ends("major");
}

#[test]
fn minors_at_both_ends_of_every_range() {
    both_ends("minor");
}

#[test]
fn settlements_at_both_ends_of_every_range() {
    let usual = SettlementSettings::default();
    let (mut found, mut all) = (0, 0);
    for (path, ends) in usual.ends() {
        for value in ends {
            let mut settlements = usual.clone();
            // Some ends are refused beside the usual values of other numbers.
            if settlements.set(&BTreeMap::from([(path.clone(), value)])).is_ok() {
                all += 1;
                found += usize::from(is_found(&format!("{path} = {value}"), &RoadSettings::default(), &settlements));
            }
        }
    }
    assert!(all > 45 && found + 4 >= all, "{found} of {all}");
}

#[test]
fn random_valid_settings_are_found_or_refused() {
    let (mut found, mut random) = (0, Seed(12).stream("settings", &[]));
    for i in 0..24 {
        let (mut roads, mut settlements) = (RoadSettings::default(), SettlementSettings::default());
        roads.draw(0.4, &mut random).expect("no range is empty");
        if settlements.draw(0.2, &mut random).is_err() {
            // No style has a weight.
            continue;
        }
        found += usize::from(is_found(&format!("{i}: {roads:?} {settlements:?}"), &roads, &settlements));
    }
    assert!(found > 4, "{found}");
}
