//! What holds for the seams of every settlement. Distances are measured by brute force, on other ways than the ones
//! that make the ports.

use super::stub::Hand;
use super::*;
use crate::analysis::measure;
use crate::space::{line_length, point_in_polygon, polygon_distance, segment_crossing, segment_distance, segments};
use crate::style::FieldKind;
use crate::town::sample::{Case, case, case_of};
use crate::town::{CellUse, Town};
use std::collections::BTreeSet;

/// Distance of `a`-`b` from the sides of a cell that do not run along `main`, or that are the other side of it.
fn other_sides(town: &Town, cell: usize, main: usize, forward: bool, a: DVec2, b: DVec2) -> f64 {
    let cell = &town.cells[cell];
    let mut least = f64::INFINITY;
    for side in cell.sides.iter().filter(|s| s.main != Some(main) || s.forward != forward) {
        for i in side.first..side.first + side.count {
            least = least.min(segment_distance(a, b, cell.border[i], cell.border[(i + 1) % cell.border.len()]));
        }
    }
    least
}

/// Checks the seams of a town; its cells with fewer than two ports, and all its cells.
fn check(case: &Case, what: &str) -> (usize, usize) {
    let town = case.plan();
    let styles = vec![&case.style; town.cells.len()];
    let seams = seams(case.seed, &town, &styles, &[]);
    assert_eq!(seams, super::seams(case.seed, &town, &styles, &[]), "{what}: not the same again");
    assert_eq!(seams.len(), town.mains.len());
    let rules = &case.style.seam;
    for (main, seam) in town.mains.iter().zip(&seams) {
        let length = main.street.length();
        let mut last = 0.0;
        for port in &seam.ports {
            assert!(port.left.is_some() || port.right.is_some());
            assert!(port.along >= last + rules.min_spacing.min(30.0) && port.along <= length - 30.0, "{what}: spacing");
            assert!(crate::space::distance_to_line(port.at, &main.street.line) < 1e-3, "{what}: off its street");
            last = port.along;
        }
    }
    let (mut met, mut poor) = (0, 0);
    for index in 0..town.cells.len() {
        let ports = cell_ports(&town, &seams, index);
        let cell = &town.cells[index];
        met += ports.len();
        poor += usize::from(ports.len() < 2 && cell.used_as == CellUse::Built);
        assert!(ports.is_empty() || cell.used_as == CellUse::Built, "{what}: a port in an open place");
        let stub = |p: &CellPort| (p.at + p.inward * 0.01, p.at + p.inward * STUB_LENGTH);
        for (i, port) in ports.iter().enumerate() {
            let (a, b) = stub(port);
            assert!((port.inward.length() - 1.0).abs() < 1e-9);
            for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
                assert!(point_in_polygon(a.lerp(b, t), &cell.border), "{what}: a stub leaves its cell");
            }
            assert!(polygon_distance(a.lerp(b, 0.5), b, &cell.border) > 8.0, "{what}: a stub runs into the border");
            let (main, forward) = seams
                .iter()
                .enumerate()
                .find_map(|(m, s)| {
                    let p = s.ports.iter().find(|p| p.junction == port.junction)?;
                    let left = crate::space::left_normal(crate::space::point_at(&town.mains[m].street.line, p.along).1);
                    Some((m, left.dot(port.inward) > 0.0))
                })
                .unwrap();
            let distance = other_sides(&town, index, main, forward, a, b);
            assert!(distance >= STUB_CLEARANCE, "{what}: a stub is {distance} m from another side");
            for other in &ports[i + 1..] {
                let (c, d) = stub(other);
                assert!(segment_distance(a, b, c, d) >= STUB_CLEARANCE, "{what}: stubs are near each other");
            }
        }
    }
    let wanted = seams.iter().flat_map(|s| &s.ports);
    let arms: usize = wanted.map(|p| usize::from(p.left.is_some()) + usize::from(p.right.is_some())).sum();
    assert_eq!(met, arms, "{what}: every port belongs to the cells that it opens to");
    network(case, &town, &seams, what);
    (poor, town.cells.len())
}

fn network(case: &Case, town: &Town, seams: &[Seam], what: &str) {
    let network = main_network(town, seams);
    let ids: BTreeSet<_> = network.junctions.iter().map(|j| j.id).collect();
    let names: BTreeSet<_> = network.streets.iter().map(|s| s.id).collect();
    assert_eq!((ids.len(), names.len()), (network.junctions.len(), network.streets.len()), "{what}: ids repeat");
    let at = |id| network.junctions.iter().find(|j| j.id == id).map(|j| j.at);
    for s in &network.streets {
        assert_eq!((at(s.from), at(s.to)), (s.line.first().copied(), s.line.last().copied()), "{what}");
        assert!(segments(&s.line).all(|(a, b)| a.distance(b) > 1.0), "{what}: a piece of {:?}", s.line);
    }
    let whole: f64 = town.mains.iter().map(|m| m.street.length()).sum();
    let parts: f64 = network.streets.iter().map(|s| line_length(&s.line)).sum();
    assert!((whole - parts).abs() < 0.01 * network.junctions.len() as f64, "{what}: {whole} m became {parts} m");
    let m = measure(&network);
    assert_eq!(m.components, 1, "{what}");
    assert!(m.dead_ends <= case.gates.len(), "{what}");
    for (i, s) in network.streets.iter().enumerate() {
        for t in &network.streets[i + 1..] {
            if !s.bounds().overlaps(t.bounds()) {
                continue;
            }
            for (a, b) in segments(&s.line) {
                for (c, d) in segments(&t.line) {
                    if let Some(x) = segment_crossing(a, b, c, d) {
                        let ends = [s.line[0], s.line[s.line.len() - 1]];
                        assert!(ends.contains(&x.at), "{what}: streets meet without a junction");
                    }
                }
            }
        }
    }
}

#[test]
fn every_port_has_the_room_that_is_promised() {
    let (mut poor, mut cells) = (0, 0);
    for number in (0..40).chain(1000..1200) {
        let (few, of) = check(&case(number), &format!("case {number}"));
        (poor, cells) = (poor + few, cells + of);
    }
    assert!(poor * 5 < cells, "{poor} of {cells} cells have fewer than two ports");
}

/// Ports of the cells of towns on a grid whose line along the field meets another side squarely, away from its ends, and how
/// many of these have a port there, with the ports of `kind`.
fn facing(kind: FieldKind) -> (usize, usize) {
    let (mut facing, mut all) = (0, 0);
    for number in 0..60 {
        let case = case_of(number, FieldKind::Grid, 700.0, 5);
        let town = case.plan();
        let mut style = case.style.clone();
        style.main.field = kind;
        let seams = seams(case.seed, &town, &vec![&style; town.cells.len()], &[]);
        for (main, seam) in seams.iter().enumerate() {
            for (port, hand) in seam.ports.iter().flat_map(|p| [(p, Hand::Left), (p, Hand::Right)]) {
                let cell = &town.cells[hand.cell(&town.mains[main])];
                if let Some(mark) = survey::opposite(&town, cell, main, hand, port.along)
                    && (60.0..town.mains[mark.main].street.length() - 60.0).contains(&mark.along)
                {
                    all += 1;
                    facing += usize::from(seams[mark.main].ports.iter().any(|p| (p.along - mark.along).abs() < 15.0));
                }
            }
        }
    }
    (facing, all)
}

#[test]
fn ports_of_grids_face_each_other_across_their_cells() {
    let (facing, all) = facing(FieldKind::Grid);
    let (by_chance, of) = self::facing(FieldKind::Contours);
    assert!(
        facing * 10 > all * 7,
        "{facing} of {all} ports face another; {by_chance} of {of} do where nobody surveyed"
    );
}
