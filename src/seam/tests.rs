//! What holds for the seams of every settlement. Distances are measured by brute force, not as the ports were found.

use super::propose::opposite;
use super::side::StreetSide;
use super::*;
use crate::analysis::measure;
use crate::space::{
    distance_to_line, left_normal, line_length, point_at, point_in_polygon, pole, polygon_distance, segment_crossing,
    segment_distance, segments, signed_area,
};
use crate::style::FieldKind;
use crate::testing::{SettlementCase, any_settlement, settlement};
use crate::town::{CellUse, Town};
use glam::DVec2;
use std::collections::BTreeSet;

/// Distance of `a`-`b` from the sides of a cell other than its `forward` side along `main`.
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

/// Checks the seams of a town; returns the number of its built cells with fewer than two ports, and of all its cells.
fn check(case: &SettlementCase, what: &str) -> (usize, usize) {
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
            assert!(distance_to_line(port.at, &main.street.line) < 1e-3, "{what}: off its street");
            last = port.along;
        }
    }
    let (mut met, mut poor) = (0, 0);
    for index in 0..town.cells.len() {
        let ports = cell_ports(&town, &seams, index);
        let cell = &town.cells[index];
        met += ports.len();
        poor += usize::from(ports.len() < 2 && cell.cell_use == CellUse::Built);
        assert!(ports.is_empty() || cell.cell_use == CellUse::Built, "{what}: a port in an open place");
        let approach = |p: &CellPort| (p.at + p.inward * 0.01, p.at + p.inward * APPROACH_LENGTH);
        for (i, port) in ports.iter().enumerate() {
            let (a, b) = approach(port);
            assert!((port.inward.length() - 1.0).abs() < 1e-9);
            for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
                assert!(point_in_polygon(a.lerp(b, t), &cell.border), "{what}: an approach leaves its cell");
            }
            assert!(
                polygon_distance(a.lerp(b, 0.5), b, &cell.border) > 8.0,
                "{what}: an approach runs into the border"
            );
            let (main, forward) = seams
                .iter()
                .enumerate()
                .find_map(|(m, s)| {
                    let p = s.ports.iter().find(|p| p.junction == port.junction)?;
                    let left = left_normal(point_at(&town.mains[m].street.line, p.along).1);
                    Some((m, left.dot(port.inward) > 0.0))
                })
                .unwrap();
            let distance = other_sides(&town, index, main, forward, a, b);
            assert!(distance >= APPROACH_CLEARANCE, "{what}: an approach is {distance} m from another side");
            for other in &ports[i + 1..] {
                let (c, d) = approach(other);
                assert!(segment_distance(a, b, c, d) >= APPROACH_CLEARANCE, "{what}: approaches are near each other");
            }
        }
    }
    let ports = seams.iter().flat_map(|s| &s.ports);
    let arms: usize = ports.map(|p| usize::from(p.left.is_some()) + usize::from(p.right.is_some())).sum();
    assert_eq!(met, arms, "{what}: every port belongs to the cells that it opens to");
    network(case, &town, &seams, what);
    (poor, town.cells.len())
}

fn network(case: &SettlementCase, town: &Town, seams: &[Seam], what: &str) {
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
        let (few, all) = check(&any_settlement(number), &format!("case {number}"));
        (poor, cells) = (poor + few, cells + all);
    }
    assert!(poor * 5 < cells, "{poor} of {cells} cells have fewer than two ports");
}

/// How many ports of towns on a grid have another port opposite across their cell, and how many could have: the line along the
/// field meets another side squarely and away from its ends. Ports are proposed as on a field of `kind`.
fn facing(kind: FieldKind) -> (usize, usize) {
    let (mut facing, mut all) = (0, 0);
    for number in 0..60 {
        let case = settlement(number, FieldKind::Grid, 700.0, 5);
        let town = case.plan();
        let mut style = case.style.clone();
        style.main.field = kind;
        let seams = seams(case.seed, &town, &vec![&style; town.cells.len()], &[]);
        for (main, seam) in seams.iter().enumerate() {
            for (port, side) in seam.ports.iter().flat_map(|p| StreetSide::BOTH.map(|side| (p, side))) {
                let cell = &town.cells[side.cell(&town.mains[main])];
                if let Some(point) = opposite(&town, cell, main, side, port.along)
                    && (60.0..town.mains[point.main].street.length() - 60.0).contains(&point.along)
                {
                    all += 1;
                    facing += usize::from(seams[point.main].ports.iter().any(|p| (p.along - point.along).abs() < 15.0));
                }
            }
        }
    }
    (facing, all)
}

#[test]
fn ports_of_grids_face_each_other_across_their_cells() {
    let (facing, all) = facing(FieldKind::Grid);
    let (by_chance, tries) = self::facing(FieldKind::Contours);
    assert!(facing * 10 > all * 7, "{facing} of {all} ports face another; {by_chance} of {tries} do by chance");
}

#[test]
fn cells_with_room_have_ports_and_open_spaces_have_none() {
    let (mut roomy, mut poor) = (0, 0);
    let (mut area_of_all, mut without_access) = (0.0, 0.0);
    for number in 0..120 {
        let case = any_settlement(number);
        let town = case.plan();
        let seams = seams(case.seed, &town, &vec![&case.style; town.cells.len()], &[]);
        for (index, cell) in town.cells.iter().enumerate() {
            let ports = cell_ports(&town, &seams, index).len();
            if cell.cell_use != CellUse::Built {
                assert_eq!(ports, 0, "case {number}");
                continue;
            }
            let (area, width) = (signed_area(&cell.border), pole(&cell.border, 2.0).1);
            let street: f64 = cell.sides.iter().filter_map(|s| s.main).map(|m| town.mains[m].street.length()).sum();
            if width >= 40.0 && street >= 220.0 {
                assert!(ports > 0, "case {number}, cell at {:.0}: no port along {street:.0} m", cell.anchor);
                roomy += 1;
                poor += usize::from(ports < 2);
            }
            area_of_all += area;
            without_access += if ports == 0 { area } else { 0.0 };
        }
    }
    assert!(poor * 40 < roomy, "{poor} of {roomy} cells with room have one port");
    assert!(without_access < 0.006 * area_of_all, "{:.4} of the land has no port", without_access / area_of_all);
}
