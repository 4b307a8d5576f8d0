//! What holds for every planned settlement, over many made-up ones.

use crate::network::{PlanarGraph, StreetClass};
use crate::space::math::angle_between;
use crate::space::{Bounds, point_in_polygon, pole, quantize, segment_crossing, segments, signed_area};
use crate::testing::{SettlementCase, any_settlement};
use crate::town::{CellUse, MainCell, MainStreet, Town};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// All segments of a town's main streets, with the indices of their streets.
fn all_segments(town: &Town) -> Vec<(usize, DVec2, DVec2)> {
    let numbered =
        |(i, m): (usize, &MainStreet)| segments(&m.street.line).map(move |(a, b)| (i, a, b)).collect::<Vec<_>>();
    town.mains.iter().enumerate().flat_map(numbered).collect()
}

fn key(p: DVec2) -> [u64; 2] {
    p.to_array().map(f64::to_bits)
}

fn check(case: &SettlementCase, town: &Town, what: &str) {
    let polygon = &case.outline.polygon;
    assert!(!town.mains.is_empty(), "{what}: no streets");
    // One component that holds all gates, which are the only dead ends.
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
        assert!(g.at(*v) == quantize(g.at(*v)));
    }
    // Two segments meet at a common end only.
    let edges: Vec<_> = g.edges().map(|(e, _)| e).collect();
    for &e in &edges {
        let (a, b) = g.segment(e);
        for f in g.edges_near(Bounds::of([a, b])) {
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
    // Cells cover the outline; sides cover the border; every side of a street belongs to the cell that the street names.
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
        let case = any_settlement(number);
        check(&case, &case.plan(), &format!("case {number}"));
    }
}

#[test]
fn the_same_arguments_give_the_same_town_and_others_another() {
    for number in 0..8 {
        let mut case = any_settlement(number);
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
        let case = any_settlement(number);
        let town = case.plan();
        for gate in &case.gates {
            let street = town.mains.iter().find(|m| m.street.from == gate.junction || m.street.to == gate.junction);
            assert_eq!(street.unwrap().street.class, StreetClass::Arterial, "case {number}");
        }
    }
}

#[test]
fn main_cells_have_the_size_and_width_that_streets_need() {
    let (mut built, mut slim, mut large) = (0, 0, 0);
    for number in 0..120 {
        let case = any_settlement(number);
        let town = case.plan();
        let length = case.style.main.length.min(0.55 * case.settlement.radius).max(60.0);
        for cell in town.cells.iter().filter(|c| c.cell_use == CellUse::Built) {
            let (area, width) = (signed_area(&cell.border), pole(&cell.border, 2.0).1);
            let fringe = cell.sides.iter().any(|s| s.main.is_none());
            let what = format!("case {number}, cell at {:.0}: {area:.0} m2, {width:.0} m", cell.anchor);
            // Inner cells have the size that the style asks for.
            assert!(fringe || width >= 12.0, "{what}: slim");
            assert!(fringe || area <= 2.6 * length * length || length < 100.0, "{what}: large for {length:.0} m");
            built += 1;
            slim += usize::from(width < 20.0);
            large += usize::from(area > 3.0 * length.max(170.0) * length.max(170.0));
        }
    }
    assert!(slim * 40 < built, "{slim} of {built} cells are slim");
    assert!(large * 60 < built, "{large} of {built} cells are large");
}

/// Directions, away from a corner of a cell, of the main streets that meet it there but do not run along the cell.
fn streets_from(town: &Town, cell: &MainCell, corner: DVec2) -> Vec<DVec2> {
    let along_cell = |i: usize| cell.sides.iter().any(|s| s.main == Some(i));
    let others = town.mains.iter().enumerate().filter(|(i, _)| !along_cell(*i));
    others
        .filter_map(|(_, m)| {
            let line = &m.street.line;
            let leaving = |a: DVec2, b: DVec2| (a == corner).then_some(b - a);
            leaving(line[0], line[1]).or(leaving(line[line.len() - 1], line[line.len() - 2]))
        })
        .collect()
}

#[test]
fn roundabouts_and_squares_lie_open_among_main_streets() {
    let (mut spaces, mut streets) = (0, 0);
    for number in (0..120).step_by(2) {
        let mut case = any_settlement(number);
        let what = format!("case {number}");
        let town = case.plan();
        for cell in town.cells.iter().filter(|c| c.cell_use == CellUse::Open) {
            spaces += 1;
            assert!(cell.sides.iter().all(|s| s.main.is_some()) && cell.sides.len() >= 3, "{what}");
            let (area, width) = (signed_area(&cell.border), pole(&cell.border, 1.0).1);
            assert!(area > 600.0 && area < 12_000.0 && width > 14.0, "{what}: {area:.0} m2, {width:.0} m wide");
            for side in &cell.sides {
                // No two junctions around the space are near each other, and the streets that lead to it meet it squarely.
                let corner = cell.border[side.first];
                let next = cell.border[(side.first + side.count) % cell.border.len()];
                assert!(corner.distance(next) > 12.0, "{what}: junctions {:.1} m apart", corner.distance(next));
                let outward = (corner - cell.anchor).normalize_or_zero();
                for leaving in streets_from(&town, cell, corner) {
                    streets += 1;
                    assert!(angle_between(leaving, outward) < 0.9, "{what}: a street leaves towards {leaving}");
                }
            }
        }
        (case.style.main.roundabouts, case.style.main.squares) = (0.0, 0.0);
        assert!(
            case.plan().cells.iter().all(|c| c.cell_use == CellUse::Built),
            "{what}: a space that no rule asks for"
        );
    }
    assert!(spaces > 20 && streets >= 3 * spaces, "{spaces} open spaces, {streets} streets that lead there");
}

#[test]
fn junctions_keep_to_the_degree_range() {
    let (mut junctions, mut full) = (0, 0);
    for number in 0..120 {
        let case = any_settlement(number);
        let town = case.plan();
        for junction in &town.junctions {
            let ends = town.mains.iter().flat_map(|m| [m.street.from, m.street.to]);
            let degree = ends.filter(|id| *id == junction.id).count();
            junctions += 1;
            full += usize::from(degree > case.style.main.degree.1 as usize);
        }
    }
    // Gates that have no other way than straight to the centre may exceed the range.
    assert!(full * 200 < junctions, "{full} of {junctions} junctions have too many streets");
}
