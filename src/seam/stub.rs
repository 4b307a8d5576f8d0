//! Whether a port has room for its stub: the guarantee of [`CellPort`](crate::seam::CellPort), checked against the
//! cell's border.

use super::survey::Mark;
use crate::seam::{STUB_CLEARANCE, STUB_LENGTH};
use crate::space::math::angle_between;
use crate::space::{Bounds, distance_to_segment, left_normal, quantize, segment_distance, segments};
use crate::style::Style;
use crate::town::{CellSide, CellUse, MainCell, MainStreet, Town};
use glam::DVec2;

/// Distance of a stub from the cell's other sides. With it, stubs that start on different sides keep
/// [`STUB_CLEARANCE`] of each other whatever the other sides propose, so a street need not know the ports of others.
const ROOM: f64 = STUB_LENGTH + STUB_CLEARANCE + 2.0;
/// Distance of ports from points of inflexion, in metres.
const STRAIGHT: f64 = 8.0;
/// Bend of a side, in radians, up to which its parts count as one run that stubs stand beside.
const BEND: f64 = 0.6;

/// A side of a main street.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Hand {
    /// Left of the street's line.
    Left,
    /// Right of it.
    Right,
}

impl Hand {
    /// The side of its main street that a side of a cell is.
    pub fn of(side: &CellSide) -> Self {
        if side.forward { Self::Left } else { Self::Right }
    }

    /// Index of the cell on this side of a main street.
    pub fn cell(self, street: &MainStreet) -> usize {
        match self {
            Self::Left => street.left,
            Self::Right => street.right,
        }
    }
}

/// A place on a main street where a port could be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    /// Metres along the street.
    pub along: f64,
    /// The place, on the quantum grid.
    pub at: DVec2,
    /// Unit direction of the street there.
    pub direction: DVec2,
    /// Index of the segment of the street's line.
    segment: usize,
}

impl Spot {
    /// The spot near `along` metres on a street's line that keeps off points of inflexion; `None` where these are close
    /// together.
    pub fn near(line: &[DVec2], along: f64) -> Option<Self> {
        let mut start = 0.0;
        for (segment, (a, b)) in segments(line).enumerate() {
            let length = a.distance(b);
            if along <= start + length || segment + 2 == line.len() {
                if length < 2.0 * STRAIGHT {
                    return None;
                }
                let t = (along - start).clamp(STRAIGHT, length - STRAIGHT);
                let direction = (b - a) / length;
                return Some(Self { along: start + t, at: quantize(a + direction * t), direction, segment });
            }
            start += length;
        }
        None
    }

    /// Direction of a stub to one hand.
    pub fn inward(&self, hand: Hand) -> DVec2 {
        match hand {
            Hand::Left => left_normal(self.direction),
            Hand::Right => -left_normal(self.direction),
        }
    }

    /// Whether the stubs of two spots of one street and hand are far enough apart.
    pub fn apart(&self, other: &Self, hand: Hand) -> bool {
        let end = |s: &Self| s.at + s.inward(hand) * STUB_LENGTH;
        segment_distance(self.at, end(self), other.at, end(other)) >= STUB_CLEARANCE + 2.0
    }
}

/// One side of a main street: the town that its cell belongs to, and what that town's style proposes.
#[derive(Clone, Copy)]
pub(super) struct Kerb<'a> {
    pub town: &'a Town,
    pub style: &'a Style,
    /// The marks of its cell.
    pub marks: &'a [Mark],
    /// Index of the street among the town's.
    pub main: usize,
    pub hand: Hand,
    /// What to add to a place of the seam to make it local to the town.
    pub shift: DVec2,
}

/// Whether a stub from `spot` has the room that is promised.
pub(super) fn has_room(kerb: &Kerb, spot: &Spot) -> bool {
    let (main, hand) = (kerb.main, kerb.hand);
    let street = &kerb.town.mains[main];
    let open_to = |c: &&MainCell| c.used_as == CellUse::Built;
    let Some(cell) = kerb.town.cells.get(hand.cell(street)).filter(open_to) else { return false };
    let (from, inward) = (spot.at + kerb.shift, spot.inward(hand));
    let tip = from + inward * STUB_LENGTH;
    let reach = Bounds::of([from, tip]).grown(ROOM);
    let n = cell.border.len();
    cell.sides.iter().all(|side| {
        let same = side.main == Some(main) && Hand::of(side) == hand;
        (0..side.count).all(|i| {
            let (a, b) = (cell.border[side.first + i], cell.border[(side.first + i + 1) % n]);
            if !reach.overlaps(Bounds::of([a, b])) {
                return true;
            }
            let segment = if side.forward { i } else { side.count - 1 - i };
            if !same {
                // Where there is no street nothing comes towards the stub.
                let room = if side.main.is_some() { ROOM } else { STUB_CLEARANCE + 2.0 };
                return segment_distance(from, tip, a, b) >= room;
            }
            if !one_run(&street.street.line, segment, spot) {
                return segment_distance(from.lerp(tip, 0.5), tip, a, b) >= STUB_CLEARANCE + 1.0;
            }
            // A run that bends towards the stub must not come near its end.
            segment == spot.segment || distance_to_segment(tip, a, b) >= STUB_CLEARANCE + 1.0
        })
    })
}

/// Whether a street's line bends little between a segment and the spot's.
fn one_run(line: &[DVec2], segment: usize, spot: &Spot) -> bool {
    let (low, high) = (segment.min(spot.segment), segment.max(spot.segment));
    (low..=high).all(|k| angle_between(line[k + 1] - line[k], spot.direction) <= BEND)
}
