//! Tests of settlements and their outlines, on the default terrain.

use super::*;
use crate::region::PerSize;
use crate::space::{orient, polygon_distance, signed_area};
use crate::terrain::{NoiseTerrain, TerrainSettings};

const MIB: usize = 1 << 20;

fn settlements(seed: u64, settings: &SettlementSettings) -> Settlements {
    let terrain = NoiseTerrain::new(Seed(seed), &TerrainSettings::default());
    Settlements::new(Seed(seed), settings, Arc::new(terrain), 16 * MIB)
}

/// As many settlements as the settings allow, up to where their outlines meet.
fn dense() -> SettlementSettings {
    let s = SettlementSettings {
        spacing: PerSize { city: 4_000.0, town: 1_700.0, village: 950.0 },
        radius: PerSize { city: (900.0, 1500.0), town: (300.0, 600.0), village: (120.0, 300.0) },
        jitter: 0.9,
        max_slope: 0.2,
        clearance: 0.8,
        gap: 0.0,
        ..SettlementSettings::default()
    };
    assert_eq!(s.check(), Ok(()));
    s
}

const FAR: [DVec2; 3] = [DVec2::new(12_345.0, -6_789.0), DVec2::new(5e8, 3e5), DVec2::new(-5e8, -7e8)];

#[test]
fn any_order_and_any_box_give_the_same() {
    for (i, origin) in FAR.into_iter().enumerate() {
        let seed = 50 + i as u64;
        let whole = settlements(seed, &SettlementSettings::default());
        let bounds = Bounds::square(origin, 10_500.0);
        let all = whole.centred_in(bounds).unwrap();
        assert!(all.len() > 4 && all.is_sorted_by_key(|s| s.id), "{}", all.len());

        // Tile by tile, last tile first, outlines before the rest, and with almost no memory.
        let terrain = NoiseTerrain::new(Seed(seed), &TerrainSettings::default());
        let tiled = Settlements::new(Seed(seed), &SettlementSettings::default(), Arc::new(terrain), 20_000);
        let mut found = vec![];
        for tile in (0..49).rev() {
            let corner = bounds.min + DVec2::new(f64::from(tile % 7), f64::from(tile / 7)) * 1_500.0;
            let tile = Bounds::new(corner, corner + 1_500.0);
            for s in tiled.centred_in(tile).unwrap() {
                assert_eq!(tiled.outline(&s).unwrap(), whole.outline(&s).unwrap());
                found.push(s);
            }
        }
        found.sort_by_key(|s| s.id);
        found.dedup_by_key(|s| s.id);
        assert_eq!(all, found);
    }
}

#[test]
fn settlements_keep_their_distance() {
    for (seed, settings) in [(61, SettlementSettings::default()), (62, SettlementSettings::default()), (63, dense())] {
        let s = settlements(seed, &settings);
        for origin in FAR {
            let all = s.centred_in(Bounds::square(origin, 8_000.0)).unwrap();
            for (i, a) in all.iter().enumerate() {
                for b in &all[i + 1..] {
                    assert_ne!(a.id, b.id);
                    let apart = a.centre.offset_to(b.centre).length();
                    let least = settings.clearance * (a.radius + b.radius) + settings.gap;
                    assert!(apart >= least, "{} {} {apart}", a.name, b.name);
                }
            }
        }
    }
}

#[test]
fn most_cells_hold_a_settlement() {
    // A few cells of each tier at places far apart, so that no single coast decides.
    let mut counts = [0; 3];
    let settings = SettlementSettings::default();
    for seed in 0..10 {
        let s = settlements(700 + seed, &settings);
        for i in 0..4 {
            let place = DVec2::new(seed as f64 * 3e6, f64::from(i) * 1e6);
            for size in SizeClass::ALL {
                let bounds = Bounds::square(place, settings.spacing.of(size) * 2.0);
                counts[size as usize] += s.centred_in_of(bounds, size).unwrap().len();
            }
        }
    }
    // Of 160 cells of each tier, some in the sea or on mountains.
    assert!(counts[2] > 90 && counts[1] > 85 && counts[0] > 75, "{counts:?}");
}

/// Everything that the contract of an outline promises.
fn check_outline(s: &Settlements, settlement: &Settlement) {
    let outline = s.outline(settlement).unwrap();
    let (polygon, n) = (&outline.polygon, outline.polygon.len());
    assert_eq!(outline.origin, settlement.centre);
    assert!(n >= 9, "{n} vertices");
    assert!(signed_area(polygon) > 0.0);
    let tag = format!("{} {:?} r {}", settlement.name, settlement.centre, settlement.radius);
    for i in 0..n {
        let (a, b) = (polygon[i], polygon[(i + 1) % n]);
        // Star-shaped, and so simple: every edge turns left about the centre, once around in all.
        assert!(orient(DVec2::ZERO, a, b) > 0.0, "{tag}: vertex {i}");
        let d = a.distance(b);
        let ends: Vec<usize> = outline.river.iter().flat_map(|river| river.ends.concat()).collect();
        match [i, (i + 1) % n].map(|v| ends.contains(&v)) {
            [false, false] => assert!((40.0..=90.0).contains(&d), "{tag}: edge {i} of {n}: {d} m"),
            [true, true] => assert!((40.0..=300.0).contains(&d), "{tag}: {d} m across a river"),
            _ => assert!((15.0..=108.0).contains(&d), "{tag}: {d} m beside a river"),
        }
        assert!(a.length() <= settlement.radius && a.length() > 60.0, "{tag}: {}", a.length());
        assert_eq!(crate::space::quantize(a), a);
        assert_eq!(s.lattices.terrain().sample(outline.origin.to_plan(a)).depth(), 0.0, "{tag}: vertex {i} in water");
    }
    let turns: f64 = (0..n).map(|i| crate::space::math::turn(polygon[i], polygon[(i + 1) % n])).sum();
    assert!((turns - std::f64::consts::TAU).abs() < 1e-6);
    assert!(outline.contains(settlement.centre.plan()));
    assert!(outline.clearance(settlement.centre.plan()) > 50.0);
    assert!(outline.clearance(settlement.centre.plan() + settlement.radius + 10.0) < 0.0);
}

fn check_all(seed: u64, settings: &SettlementSettings, origin: DVec2, size: f64) -> usize {
    let s = settlements(seed, settings);
    let all = s.centred_in(Bounds::square(origin, size)).unwrap();
    for a in &all {
        check_outline(&s, a);
        let outline = s.outline(a).unwrap();
        for b in all.iter().filter(|b| b.id > a.id) {
            let offset = a.centre.offset_to(b.centre);
            if offset.length() > a.radius + b.radius + 100.0 {
                continue;
            }
            if s.border(a, b).unwrap().is_some() {
                continue;
            }
            let other = s.outline(b).unwrap();
            let moved: Vec<DVec2> = outline.polygon.iter().map(|p| *p + offset).collect();
            for i in 0..moved.len() {
                let gap = polygon_distance(moved[i], moved[(i + 1) % moved.len()], &other.polygon);
                assert!(gap > 10.0, "{} and {}: {gap} m", a.name, b.name);
            }
            assert!(!other.contains(outline.origin.to_plan(outline.polygon[0])));
        }
    }
    all.len()
}

#[test]
fn outlines_keep_their_promises() {
    let count: usize = (0..3)
        .map(|i| check_all(800 + i, &SettlementSettings::default(), FAR[i as usize % 3] + i as f64 * 1e5, 11_000.0))
        .sum();
    assert!(count > 15, "{count}");
}

#[test]
fn outlines_of_a_dense_world_do_not_meet() {
    let count: usize =
        (0..3).map(|i| check_all(900 + i, &dense(), FAR[i as usize % 3] - i as f64 * 1e5, 4_500.0)).sum();
    assert!(count > 20, "{count}");
}

#[test]
fn a_point_finds_its_settlement() {
    let s = settlements(77, &SettlementSettings::default());
    let all = s.centred_in(Bounds::square(DVec2::splat(-2e4), 8_000.0)).unwrap();
    for a in &all {
        let centre = a.centre.plan();
        assert_eq!(s.at(centre).unwrap().as_ref(), Some(a));
        let outline = s.outline(a).unwrap();
        let corner = outline.polygon[0];
        assert_eq!(s.at(centre + corner * 0.95).unwrap().as_ref(), Some(a));
        assert_ne!(s.at(centre + corner * 1.05).unwrap().as_ref(), Some(a));
        assert!(s.overlapping(Bounds::square(centre + a.radius * 0.6, 50.0)).unwrap().contains(a));
        assert!(a.radius <= s.largest_radius() && a.id.0 != 0);
    }
    assert!(!all.is_empty());
}

#[test]
fn settings_out_of_range_are_refused() {
    assert_eq!(SettlementSettings::default().check(), Ok(()));
    let bad = |change: fn(&mut SettlementSettings)| {
        let mut s = SettlementSettings::default();
        change(&mut s);
        s.check().unwrap_err().field
    };
    assert_eq!(bad(|s| s.spacing.city = 10.0), "spacing.city");
    assert_eq!(bad(|s| s.spacing.town = f64::NAN), "spacing.town");
    assert_eq!(bad(|s| s.radius.village = (300.0, 140.0)), "radius.village[1]");
    assert_eq!(bad(|s| s.share.city = -0.1), "share.city");
    assert_eq!(bad(|s| s.styles.village.clear()), "styles.village");
    assert_eq!(bad(|s| s.styles.city[0].1 = f64::INFINITY), "styles.city[0]");
    assert_eq!(bad(|s| s.clearance = 0.0), "clearance");
    assert_eq!(bad(|s| s.jitter = 1.0), "jitter");
    let text = "(spacing: (city: 10, town: 6000, village: 2500))";
    let read: SettlementSettings = crate::layer::from_ron("s.ron", text).unwrap();
    let error = read.check().unwrap_err().in_file("s.ron", text).to_string();
    assert!(error.starts_with("s.ron:1:12: spacing.city is 10; allowed is 2040 to"), "{error}");
}
