//! What holds for borders and for the outlines that share them, on the default terrain.

use super::*;
use crate::region::{Outline, PerSize, SettlementSettings, Settlements, SharedBorder};
use crate::space::{Bounds, distance_to_line, orient, segment_crossing, signed_area};
use crate::terrain::{NoiseTerrain, TerrainSettings};

/// Settings under which most settlements touch.
fn crowded() -> SettlementSettings {
    let s = SettlementSettings {
        spacing: PerSize { city: 1_700.0, town: 1_000.0, village: 600.0 },
        radius: PerSize { city: (900.0, 1300.0), town: (400.0, 650.0), village: (150.0, 340.0) },
        share: PerSize { city: 0.7, town: 1.0, village: 1.0 },
        jitter: 0.5,
        max_slope: 0.15,
        fullness: 0.96,
        clearance: 0.5,
        gap: 0.0,
        ..SettlementSettings::default()
    };
    assert_eq!(s.check(), Ok(()));
    s
}

fn settlements(seed: u64) -> (Settlements, NoiseTerrain) {
    let terrain = || NoiseTerrain::new(Seed(seed), &TerrainSettings::default());
    (Settlements::new(Seed(seed), &crowded(), Arc::new(terrain()), 16 << 20), terrain())
}

/// Places to look at: seed, and where.
fn places() -> impl Iterator<Item = (u64, DVec2)> {
    (0..9).map(|i| (4_200 + i, DVec2::new(7e6 * i as f64, -3e4 * i as f64)))
}

#[test]
fn both_sides_and_any_order_find_the_same_border() {
    let mut found = 0;
    for (seed, at) in places() {
        let (there, back) = (settlements(seed).0, settlements(seed).0);
        let all = there.centred_in(Bounds::square(at, 5_000.0)).unwrap();
        for a in &all {
            for b in all.iter().filter(|b| b.id > a.id) {
                let border = there.border(a, b).unwrap();
                assert_eq!(border, there.border(b, a).unwrap());
                found += usize::from(border.is_some());
            }
        }
        for a in all.iter().rev() {
            assert_eq!(back.outline(a).unwrap(), there.outline(a).unwrap());
        }
    }
    assert!(found > 60, "{found} borders");
}

#[test]
fn borders_have_gates_and_streets_within_their_ends() {
    for (seed, at) in places() {
        let (s, _) = settlements(seed);
        for a in s.centred_in(Bounds::square(at, 5_000.0)).unwrap() {
            for shared in &s.outline(&a).unwrap().shared {
                let border = &shared.border;
                let last = border.line.len() - 1;
                assert!(border.line.iter().all(|p| *p == quantize(*p)));
                assert!(!border.gates.is_empty() && border.gates.is_sorted());
                assert!(border.gates.iter().all(|g| *g > 0 && *g < last));
                let streets = border.streets();
                assert_eq!(streets.len(), border.gates.len() - 1);
                for (k, street) in streets.iter().enumerate() {
                    assert_eq!((street.from, street.to), (border.junction(k), border.junction(k + 1)));
                    assert!(street.length() > 100.0);
                }
                for gate in s.outline(&a).unwrap().border_gates() {
                    assert!((gate.inward.length() - 1.0).abs() < 1e-9 && gate.inward.dot(-gate.at) > 0.0);
                }
            }
        }
    }
}

/// Whether two outlines share no ground: their edges meet in common vertices only, and no vertex lies inside.
fn apart(a: &Outline, b: &Outline) -> bool {
    let shift = b.origin.offset_to(a.origin);
    let there: Vec<DVec2> = b.polygon.iter().map(|p| *p + shift).collect();
    let edges = |polygon: &[DVec2]| -> Vec<(DVec2, DVec2)> {
        (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()])).collect()
    };
    let (ours, theirs) = (edges(&a.polygon), edges(&there));
    let meet_well = ours.iter().all(|(p, q)| {
        theirs.iter().all(|(c, d)| {
            segment_crossing(*p, *q, *c, *d).is_none_or(|x| [p, q].contains(&&x.at) && [c, d].contains(&&x.at))
        })
    });
    let inside = |p: &DVec2, of: &Outline, shift: DVec2| {
        let p = *p + shift;
        let mut ring = of.polygon.clone();
        ring.push(ring[0]);
        of.contains(of.origin.to_plan(p)) && distance_to_line(p, &ring) > 0.01
    };
    meet_well && !a.polygon.iter().any(|p| inside(p, b, -shift)) && !there.iter().any(|p| inside(p, a, DVec2::ZERO))
}

#[test]
fn outlines_share_vertices_and_no_ground() {
    let (mut shares, mut odd, mut edges) = (0, 0, 0);
    for (seed, at) in places() {
        let (s, terrain) = settlements(seed);
        let all = s.centred_in(Bounds::square(at, 5_000.0)).unwrap();
        for a in &all {
            let outline = s.outline(a).unwrap();
            let (polygon, n) = (&outline.polygon, outline.polygon.len());
            let tag = format!("seed {seed}: {} at {:?}", a.name, a.centre);
            assert!(signed_area(polygon) > 0.0, "{tag}");
            for i in 0..n {
                let (p, q) = (polygon[i], polygon[(i + 1) % n]);
                assert!(orient(DVec2::ZERO, p, q) > 0.0, "{tag}: not a star at vertex {i}: {p} {q}");
                assert!(p == quantize(p) && p.length() <= a.radius, "{tag}");
                assert_eq!(terrain.sample(outline.origin.to_plan(p)).depth(), 0.0, "{tag}: in water");
                odd += usize::from(!(40.0..=90.0).contains(&p.distance(q)));
                edges += 1;
                assert!((15.0..140.0).contains(&p.distance(q)), "{tag}: an edge of {} m", p.distance(q));
            }
            assert!(s.touching(a).unwrap().len() == outline.shared.len());
            for SharedBorder { border, .. } in &outline.shared {
                let shared = outline.shared.iter().find(|s| s.border == *border).unwrap();
                let shift = border.origin.offset_to(outline.origin);
                for (i, p) in border.line.iter().enumerate() {
                    assert_eq!(polygon[shared.vertex(i)], *p + shift, "{tag}: vertex {i} of a border");
                }
                shares += 1;
            }
            for b in all.iter().filter(|b| b.id > a.id) {
                if a.centre.offset_to(b.centre).length() < a.radius + b.radius + 100.0 {
                    assert!(apart(&outline, &s.outline(b).unwrap()), "{tag} overlaps {} at {:?}", b.name, b.centre);
                }
            }
        }
    }
    assert!(shares > 150 && odd * 50 < edges, "{shares} shares; {odd} of {edges} edges");
}

#[test]
fn gates_are_spread_over_the_inner_vertices() {
    for vertices in 4..60 {
        for edge in [50.0, 60.0, 70.0] {
            let gates = place_gates(vertices, edge);
            assert!(gates.iter().all(|g| (1..vertices - 1).contains(g)), "{gates:?} of {vertices}");
            assert!(gates.windows(2).all(|w| (w[1] - w[0]) as f64 * edge > 115.0), "{gates:?} of {vertices}");
            assert!(gates.len() == 1 || (gates[0], gates[gates.len() - 1]) == (1, vertices - 2));
        }
    }
}

#[test]
fn the_longest_run_is_found() {
    let open = [false, true, true, false, true, true, true];
    assert_eq!(longest_run(3, |k| open[(k + 3) as usize]), Some((1, 3)));
    assert_eq!(longest_run(3, |_| true), Some((-3, 3)));
    assert_eq!(longest_run(3, |_| false), None);
}
