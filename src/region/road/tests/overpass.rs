//! Crossings of highways on two levels.

use super::*;
use crate::region::road::overpass::HALF_LENGTH;
use crate::space::{DisjointSets, distance_to_line, line_length};

/// Roads of which all classes cross highways by one rule.
pub fn all_cross_by(roads: &Roads, rule: Crossing) -> Roads {
    let inputs = &roads.searches.inputs;
    let mut s = inputs.settings.clone();
    for tier in [&mut s.highway, &mut s.major, &mut s.minor] {
        tier.highway_crossings = rule;
    }
    Roads::from_source(&s, inputs.terrain.clone(), inputs.settlements.clone(), &Edits::default(), 256 << 20)
}

/// Roads of a random world in which all classes cross highways by one rule, or by the default ones.
fn world(i: u64, rule: Option<Crossing>) -> (Roads, DVec2) {
    let (seed, centre) = random_place(i);
    let roads = super::world(seed, MERGE);
    (if let Some(rule) = rule { all_cross_by(&roads, rule) } else { roads }, centre)
}

/// Bridges over highways among sections, with the highway below.
pub fn overpasses(sections: &[Arc<RoadSection>]) -> Vec<(&Arc<RoadSection>, &Arc<RoadSection>, DVec2)> {
    let mut out = Vec::new();
    for r in sections.iter().filter(|r| r.street.level == 1) {
        for s in sections.iter().filter(|s| s.street.level == 0 && s.street.class == StreetClass::Highway) {
            let shift = s.origin.offset_to(r.origin);
            for (a, b) in segments(&r.street.line) {
                for (c, d) in segments(&s.street.line) {
                    let met = segment_crossing(a, b, c + shift, d + shift);
                    // Where both have a vertex, four segments meet.
                    let met = met.filter(|x| {
                        !out.iter().any(|(q, _, at): &(&Arc<RoadSection>, _, DVec2)| *q == r && *at == x.at)
                    });
                    out.extend(met.map(|x| (r, s, x.at)));
                }
            }
        }
    }
    out
}

#[test]
fn roads_pass_over_highways_on_bridges() {
    let (mut passed, mut ramps) = (0, 0);
    for i in 300..305 {
        let (roads, centre) = world(i, None);
        let sections = all(&roads, Bounds::square(centre, 14_000.0));
        assert_planar(&sections, Origin::at(centre));
        let found = overpasses(&sections);
        let mut bridges: Vec<StreetId> = found.iter().map(|f| f.0.street.id).collect();
        bridges.dedup();
        assert_eq!(bridges.len(), found.len(), "a bridge crosses one highway once");
        for (r, _, at) in &found {
            let line = &r.street.line;
            let along = line_length(&line[..]) - 2.0 * HALF_LENGTH;
            assert!(r.street.bridge && (-1.0..300.0).contains(&along), "{along}");
            assert!([line[0], line[line.len() - 1]].iter().all(|end| end.distance(*at) > 80.0));
            // No lesser road but its own touches it.
            for other in
                sections.iter().filter(|o| o.street.class != StreetClass::Highway && o.street.id != r.street.id)
            {
                let shift = other.origin.offset_to(r.origin);
                let apart = other.street.line.iter().map(|p| distance_to_line(*p + shift, line));
                let ends = [r.street.from, r.street.to];
                let joined = ends.contains(&other.street.from) || ends.contains(&other.street.to);
                let least = apart.fold(f64::INFINITY, f64::min);
                assert!(joined || least > 15.0, "{least} from {other:?} at {}", r.origin.to_plan(*at));
            }
        }
        passed += found.len();
        let (with_ramps, _) = world(i, Some(Crossing::Interchange));
        let more = all(&with_ramps, Bounds::square(centre, 14_000.0));
        assert_planar(&more, Origin::at(centre));
        ramps += overpasses(&more).len();
    }
    assert!(passed > 10 && ramps > 5, "{passed} {ramps}");
}

/// For each settlement of a box the first one that roads among sections lead to from it.
fn joined(roads: &Roads, sections: &[Arc<RoadSection>], bounds: Bounds) -> Vec<(SettlementId, SettlementId)> {
    let mut sets = DisjointSets::new();
    for r in sections {
        sets.union(r.street.from.0, r.street.to.0);
    }
    let mut gates: Vec<(SettlementId, u64, bool)> = Vec::new();
    for s in roads.searches.inputs.settlements.centred_in(bounds.grown(8_000.0), SizeClass::Village).unwrap() {
        let own = roads.gates(&s, &Cancel::new()).unwrap();
        for g in own.windows(2) {
            sets.union(g[0].junction.0, g[1].junction.0);
        }
        gates.extend(own.first().map(|g| (s.id, g.junction.0, bounds.contains(s.centre.plan()))));
    }
    gates.retain(|g| g.2);
    gates.sort();
    let roots: Vec<u64> = gates.iter().map(|g| sets.find(g.1)).collect();
    let first = |r: u64| gates[roots.iter().position(|x| *x == r).unwrap()].0;
    gates.iter().zip(&roots).map(|(g, r)| (g.0, first(*r))).collect()
}

#[test]
fn crossings_on_two_levels_part_nothing() {
    let mut settlements = 0;
    for i in 310..313 {
        let of = |rule| {
            let (roads, centre) = world(i, Some(rule));
            let bounds = Bounds::square(centre, 9_000.0);
            joined(&roads, &all(&roads, bounds.grown(8_000.0)), bounds)
        };
        let joined = of(Crossing::Junction);
        settlements += joined.len();
        assert_eq!(joined, of(Crossing::Bridge));
        assert_eq!(joined, of(Crossing::Interchange));
    }
    assert!(settlements > 20, "{settlements}");
}

#[test]
fn the_same_at_crossings_whatever_was_asked_before() {
    let mut places = 0;
    for i in 300..305 {
        let (roads, centre) = world(i, None);
        let sections = all(&roads, Bounds::square(centre, 14_000.0));
        let Some((bridge, _, at)) = overpasses(&sections).first().copied() else { continue };
        assert_same_whatever_was_asked(|| world(i, None).0, bridge.origin.to_plan(at), 1_000.0);
        places += 1;
    }
    assert!(places > 1, "{places}");
}
