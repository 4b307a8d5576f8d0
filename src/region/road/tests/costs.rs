//! Costs of geodesics against a search of everything.

use super::super::cost::bends;
use super::super::distance::open_field;
use super::super::field::{Corridor, Field};
use super::super::lattice::{DIRECTIONS, node_near, stencil_distance};
use super::*;
use crate::layer::Reach;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Dijkstra's search over all nodes and headings of a field, from one node to another.
fn brute_force(field: &mut Field, from: I64Vec2, to: I64Vec2) -> f64 {
    let turns = bends(field.class(), field.step());
    let (from, to) = (field.corridor().slot(from).unwrap(), field.corridor().slot(to).unwrap());
    let mut costs = vec![f64::INFINITY; field.corridor().nodes.len() * DIRECTIONS];
    let mut open = BinaryHeap::new();
    open.push(Reverse((0u64, from, DIRECTIONS)));
    while let Some(Reverse((bits, slot, heading))) = open.pop() {
        let here = f64::from_bits(bits);
        if slot == to {
            return here;
        }
        if heading < DIRECTIONS && here > costs[slot * DIRECTIONS + heading] {
            continue;
        }
        let any: Vec<(usize, f32)> = (0..DIRECTIONS).map(|h| (h, 0.0)).collect();
        for (along, bend) in if heading < DIRECTIONS { &turns[heading] } else { &any } {
            let Some((next, edge)) = field.lower_bound(slot, *along).unwrap() else { continue };
            let mut reached = vec![(next, f64::from(edge + field.surcharge(slot, *along).unwrap()))];
            for span in field.spans(slot, *along).unwrap().to_vec() {
                let after = field.lower_bound(span.last, *along).unwrap().map_or(f32::INFINITY, |e| e.1);
                let (more, _) = field.span_surcharge(slot, *along, span.edges).unwrap();
                reached.push((span.to, f64::from(edge + span.cost + after + more)));
            }
            for (next, more) in reached {
                let (cost, state) = (here + f64::from(*bend) + more, next * DIRECTIONS + along);
                if cost < costs[state] {
                    costs[state] = cost;
                    open.push(Reverse((cost.to_bits(), next, *along)));
                }
            }
        }
    }
    f64::INFINITY
}

#[test]
fn distances_are_within_a_percent_of_a_search_of_everything() {
    let roads = roads(21, false, &RoadSettings::default());
    let (inputs, distances) = (&*roads.searches.inputs, &roads.searches.distances);
    let step = inputs.step();
    let everything = Reach::new("test", Bounds::square(DVec2::ZERO, 1e6), 0.0);
    let mut compared = 0;
    for (tier, size) in [(SizeClass::Town, 14_000.0), (SizeClass::Village, 9_000.0)] {
        let bounds = Bounds::square(DVec2::new(7_000.0, -4_000.0), size);
        let all = inputs.settlements.centred_in(bounds, tier).unwrap();
        let t = inputs.tier(tier);
        for (i, a) in all.iter().enumerate() {
            for b in all[i + 1..].iter().filter(|b| tier_of(a, b) == tier && beeline(a, b) <= t.reach).step_by(3) {
                let wet = |s: &Settlement| {
                    inputs.terrain.sample(node_at(node_near(s.centre.plan(), step), step)).depth() > 0.0
                };
                if wet(a) || wet(b) {
                    continue;
                }
                let found = distances.distance(tier, a, b, &Cancel::new()).unwrap();
                let corner = bounds.grown(4_000.0);
                let corridor = Corridor::around(&[corner.min, corner.max], corner.size().length(), step, None);
                let mut field = open_field(inputs, tier, [a, b], corridor, &everything).unwrap();
                let (from, to) = (node_near(a.centre.plan(), step), node_near(b.centre.plan(), step));
                let line = stencil_distance(to - from) * step as f64;
                let best = brute_force(&mut field, from, to) * beeline(a, b) / line;
                if found.is_infinite() {
                    // Not without a detour that the class refuses.
                    assert!(best > 0.9 * t.detour * beeline(a, b), "{best}");
                    continue;
                }
                assert!((1.0 - 1e-4..1.01).contains(&(found / best)), "{tier:?} {found} {best}");
                compared += 1;
            }
        }
    }
    assert!(compared > 10, "{compared}");
}
