//! Whether a port has room for its approach: the guarantee of [`CellPort`](crate::seam::CellPort), checked against the border
//! of the cell.

use super::edge::SeamSide;
use super::point::StreetPoint;
use super::port::{APPROACH_CLEARANCE, APPROACH_LENGTH};
use super::side::StreetSide;
use crate::space::math::angle_between;
use crate::space::{Bounds, distance_to_segment, segment_distance};
use crate::town::{CellUse, MainCell};
use glam::DVec2;

/// Distance of an approach from the cell's other sides, in metres. It keeps approaches from different sides
/// [`APPROACH_CLEARANCE`] apart wherever they start, so a street need not know the ports of other streets.
const ROOM: f64 = APPROACH_LENGTH + APPROACH_CLEARANCE + 2.0;
/// Bend of a side, in radians, up to which its parts count as one run.
const BEND: f64 = 0.6;

/// Whether an approach from `point` has the room that [`CellPort`](crate::seam::CellPort) promises.
pub(super) fn has_room(seam: &SeamSide, point: &StreetPoint) -> bool {
    let (main, hand) = (seam.main, seam.side);
    let street = &seam.town.mains[main];
    let is_built = |c: &&MainCell| c.cell_use == CellUse::Built;
    let Some(cell) = seam.town.cells.get(hand.cell(street)).filter(is_built) else { return false };
    let (from, inward) = (point.at + seam.shift, point.inward(hand));
    let tip = from + inward * APPROACH_LENGTH;
    let reach = Bounds::of([from, tip]).grown(ROOM);
    let n = cell.border.len();
    cell.sides.iter().all(|side| {
        let own = side.main == Some(main) && StreetSide::of(side) == hand;
        (0..side.count).all(|i| {
            let (a, b) = (cell.border[side.first + i], cell.border[(side.first + i + 1) % n]);
            if !reach.overlaps(Bounds::of([a, b])) {
                return true;
            }
            let segment = if side.forward { i } else { side.count - 1 - i };
            if !own {
                // No approach comes from a side without a street.
                let room = if side.main.is_some() { ROOM } else { APPROACH_CLEARANCE + 2.0 };
                return segment_distance(from, tip, a, b) >= room;
            }
            if !is_one_run(&street.street.line, segment, point) {
                return segment_distance(from.lerp(tip, 0.5), tip, a, b) >= APPROACH_CLEARANCE + 1.0;
            }
            // A run that bends towards the approach must not come near its end.
            segment == point.segment || distance_to_segment(tip, a, b) >= APPROACH_CLEARANCE + 1.0
        })
    })
}

/// Whether a street's line bends little between a segment and a point.
fn is_one_run(line: &[DVec2], segment: usize, point: &StreetPoint) -> bool {
    let (low, high) = (segment.min(point.segment), segment.max(point.segment));
    (low..=high).all(|k| angle_between(line[k + 1] - line[k], point.direction) <= BEND)
}
