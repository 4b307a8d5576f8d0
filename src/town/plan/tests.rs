//! What holds for every planned settlement, over many made-up ones.

use crate::network::{PlanarGraph, StreetClass};
use crate::space::{point_in_polygon, segment_crossing, segments, signed_area};
use crate::town::Town;
use crate::town::sample::{Case, case};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// Every segment of a town's main streets, with the index of its street.
fn all_segments(town: &Town) -> Vec<(usize, DVec2, DVec2)> {
    let of = |(i, m): (usize, &crate::town::MainStreet)| {
        segments(&m.street.line).map(move |(a, b)| (i, a, b)).collect::<Vec<_>>()
    };
    town.mains.iter().enumerate().flat_map(of).collect()
}

fn key(p: DVec2) -> [u64; 2] {
    p.to_array().map(f64::to_bits)
}

fn check(case: &Case, town: &Town, what: &str) {
    let polygon = &case.outline.polygon;
    assert!(!town.mains.is_empty(), "{what}: no streets");
    // One component that holds all gates; no dead ends but these.
    let mut g = PlanarGraph::new();
    let mut vertex = BTreeMap::new();
    for (_, a, b) in all_segments(town) {
        assert_ne!(a, b, "{what}");
        let [a, b] = [a, b].map(|p| *vertex.entry(key(p)).or_insert_with(|| g.add_vertex(p)));
        g.add_edge(a, b, ());
    }
    assert!(g.components().iter().flatten().all(|c| *c == 0), "{what}: several components");
    let gates: BTreeSet<_> = case.gates.iter().map(|gate| key(gate.at)).collect();
    for gate in &gates {
        assert!(vertex.contains_key(gate), "{what}: a gate has no street");
    }
    for (at, v) in &vertex {
        assert!(g.degree(*v) > 1 || gates.contains(at), "{what}: a dead end at {}", g.at(*v));
        assert!(g.at(*v) == crate::space::quantize(g.at(*v)));
    }
    // No two segments meet but in a common point of both.
    let edges: Vec<_> = g.edges().map(|(e, _)| e).collect();
    for &e in &edges {
        let (a, b) = g.segment(e);
        for f in g.edges_near(crate::space::Bounds::of([a, b])) {
            let (c, d) = g.segment(f);
            if let Some(x) = segment_crossing(a, b, c, d)
                && f > e
            {
                let shared = [a, b].into_iter().find(|p| [c, d].contains(p));
                assert_eq!(Some(x.at), shared, "{what}: streets meet without a junction");
            }
        }
    }
    // Junctions are the ends of streets.
    let ids: BTreeMap<_, _> = town.junctions.iter().map(|j| (j.id, j.at)).collect();
    assert_eq!(ids.len(), town.junctions.len(), "{what}: junction ids repeat");
    let names: BTreeSet<_> = town.mains.iter().map(|m| m.street.id).collect();
    assert_eq!(names.len(), town.mains.len(), "{what}: street ids repeat");
    for m in &town.mains {
        let line = &m.street.line;
        assert_eq!((ids[&m.street.from], ids[&m.street.to]), (line[0], line[line.len() - 1]), "{what}");
        assert!(line[1..line.len() - 1].iter().all(|p| !ids.values().any(|q| q == p)), "{what}: passes a junction");
        assert!(line.iter().all(|p| gates.contains(&key(*p)) || point_in_polygon(*p, polygon)), "{what}: outside");
    }
    for gate in &case.gates {
        assert_eq!(ids.get(&gate.junction), Some(&gate.at), "{what}");
    }
    // Cells cover the outline; sides cover the border; every side of a street belongs to the cell that it says.
    let cover: f64 = town.cells.iter().map(|c| signed_area(&c.border)).sum();
    assert!((cover - signed_area(polygon)).abs() < 1e-3, "{what}: cells cover {cover} of {}", signed_area(polygon));
    let names: BTreeSet<_> = town.cells.iter().map(|c| c.id).collect();
    assert_eq!(names.len(), town.cells.len(), "{what}: cell ids repeat");
    let mut half_edges = BTreeSet::new();
    for (index, cell) in town.cells.iter().enumerate() {
        assert!(signed_area(&cell.border) > 0.0 && point_in_polygon(cell.anchor, &cell.border), "{what}: anchor");
        let mut next = 0;
        for side in &cell.sides {
            assert_eq!(side.first, next, "{what}");
            next += side.count;
            let points = |i: usize| cell.border[i % cell.border.len()];
            for i in side.first..next {
                assert!(half_edges.insert((key(points(i)), key(points(i + 1)))), "{what}: an edge of two sides");
            }
            if let Some(main) = side.main {
                let m = &town.mains[main];
                assert_eq!(if side.forward { m.left } else { m.right }, index, "{what}");
                let mut line = m.street.line.clone();
                if !side.forward {
                    line.reverse();
                }
                let run: Vec<_> = (side.first..=next).map(points).collect();
                assert_eq!(run, line, "{what}: a side is not its street");
            }
        }
        assert_eq!(next, cell.border.len(), "{what}");
    }
    for (_, a, b) in all_segments(town) {
        assert!(half_edges.contains(&(key(a), key(b))) && half_edges.contains(&(key(b), key(a))), "{what}");
    }
}

#[test]
fn every_settlement_is_planned_whole() {
    for number in (0..60).chain(1000..1200) {
        let case = case(number);
        check(&case, &case.plan(), &format!("case {number}"));
    }
}

#[test]
fn the_same_arguments_give_the_same_town_and_others_another() {
    for number in 0..8 {
        let mut case = case(number);
        let (a, b) = (case.plan(), case.plan());
        assert!(a.mains == b.mains && a.cells == b.cells && a.junctions == b.junctions);
        if case.settlement.radius > 500.0 {
            case.seed.0 += 1;
            assert_ne!(case.plan().cells, a.cells, "the seed does not matter");
        }
    }
}

#[test]
fn arterials_run_from_every_gate() {
    for number in 0..20 {
        let case = case(number);
        let town = case.plan();
        for gate in &case.gates {
            let street = town.mains.iter().find(|m| m.street.from == gate.junction || m.street.to == gate.junction);
            assert_eq!(street.unwrap().street.class, StreetClass::Arterial, "case {number}");
        }
    }
}
