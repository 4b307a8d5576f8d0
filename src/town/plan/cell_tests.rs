//! What holds for main cells, roundabouts and squares, over many made-up settlements.

use super::pole::pole;
use crate::seam::{cell_ports, seams};
use crate::space::math::angle_between;
use crate::space::signed_area;
use crate::town::sample::{Case, case};
use crate::town::{CellUse, MainCell, Town};
use glam::DVec2;

/// Every cell with its ports.
fn cells(case: &Case, town: &Town) -> Vec<(MainCell, usize)> {
    let styles = vec![&case.style; town.cells.len()];
    let seams = seams(case.seed, town, &styles, &[]);
    town.cells.iter().enumerate().map(|(i, cell)| (cell.clone(), cell_ports(town, &seams, i).len())).collect()
}

#[test]
fn main_cells_have_the_size_width_and_access_that_streets_need() {
    let (mut built, mut roomy, mut poor, mut slim, mut wide) = (0, 0, 0, 0, 0);
    let (mut area_of_all, mut without_access) = (0.0, 0.0);
    for number in 0..120 {
        let case = case(number);
        let town = case.plan();
        let length = case.style.main.length.min(0.55 * case.settlement.radius).max(60.0);
        for (cell, ports) in cells(&case, &town).into_iter().filter(|(c, _)| c.used_as == CellUse::Built) {
            let (area, width) = (signed_area(&cell.border), pole(&cell.border, 2.0).1);
            let street: f64 = cell.sides.iter().filter_map(|s| s.main).map(|m| town.mains[m].street.length()).sum();
            let fringe = cell.sides.iter().any(|s| s.main.is_none());
            let what = format!("case {number}, cell at {:.0}: {area:.0} m2, {width:.0} m, {ports} ports", cell.anchor);
            // Inner cells are those that the style asks for.
            assert!(fringe || width >= 12.0, "{what}: slim");
            assert!(fringe || area <= 2.6 * length * length || length < 100.0, "{what}: wide for {length:.0} m");
            built += 1;
            slim += usize::from(width < 20.0);
            wide += usize::from(area > 3.0 * length.max(170.0) * length.max(170.0));
            if width >= 40.0 && street >= 220.0 {
                assert!(ports > 0, "{what}: no access along {street:.0} m of streets");
                roomy += 1;
                poor += usize::from(ports < 2);
            }
            area_of_all += area;
            without_access += if ports == 0 { area } else { 0.0 };
        }
    }
    assert!(slim * 40 < built, "{slim} of {built} cells are slim");
    assert!(wide * 60 < built, "{wide} of {built} cells are wide");
    assert!(poor * 40 < roomy, "{poor} of {roomy} cells with room have one port");
    assert!(without_access < 0.006 * area_of_all, "{:.4} of the land has no port", without_access / area_of_all);
}

#[test]
fn roundabouts_and_squares_lie_open_among_main_streets() {
    let (mut places, mut roads) = (0, 0);
    for number in (0..120).step_by(2) {
        let mut case = case(number);
        let what = format!("case {number}");
        let town = case.plan();
        for (cell, ports) in cells(&case, &town).into_iter().filter(|(c, _)| c.used_as == CellUse::Open) {
            places += 1;
            assert_eq!(ports, 0, "{what}");
            assert!(cell.sides.iter().all(|s| s.main.is_some()) && cell.sides.len() >= 3, "{what}");
            let (area, width) = (signed_area(&cell.border), pole(&cell.border, 1.0).1);
            assert!(area > 600.0 && area < 12_000.0 && width > 14.0, "{what}: {area:.0} m2, {width:.0} m wide");
            for side in &cell.sides {
                // What leads to the place meets it square, and no two junctions around it are near each other.
                let corner = cell.border[side.first];
                let next = cell.border[(side.first + side.count) % cell.border.len()];
                assert!(corner.distance(next) > 12.0, "{what}: junctions {:.1} m apart", corner.distance(next));
                let outward = (corner - cell.anchor).normalize_or_zero();
                let leads = town.mains.iter().filter_map(|m| {
                    let line = &m.street.line;
                    let own = cell.sides.iter().any(|s| s.main.is_some_and(|i| town.mains[i].street.id == m.street.id));
                    let away = |a: DVec2, b: DVec2| (a == corner).then_some(b - a);
                    let ends = away(line[0], line[1]).or(away(line[line.len() - 1], line[line.len() - 2]));
                    ends.filter(|_| !own)
                });
                for way in leads {
                    roads += 1;
                    assert!(angle_between(way, outward) < 0.9, "{what}: a street leaves at {way}");
                }
            }
        }
        (case.style.main.roundabouts, case.style.main.squares) = (0.0, 0.0);
        assert!(case.plan().cells.iter().all(|c| c.used_as == CellUse::Built), "{what}: places that nobody wants");
    }
    assert!(places > 20 && roads >= 3 * places, "{places} places, {roads} streets that lead there");
}

#[test]
fn junctions_keep_to_the_degree_range() {
    let (mut junctions, mut full) = (0, 0);
    for number in 0..120 {
        let case = case(number);
        let town = case.plan();
        for junction in &town.junctions {
            let ends = town.mains.iter().flat_map(|m| [m.street.from, m.street.to]);
            let degree = ends.filter(|id| *id == junction.id).count();
            junctions += 1;
            full += usize::from(degree > case.style.main.degree.1 as usize);
        }
    }
    // Only where several gates have no other way than straight to the centre are more.
    assert!(full * 200 < junctions, "{full} of {junctions} junctions have too many streets");
}
