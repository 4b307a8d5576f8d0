//! The two sides of a main street.

use crate::space::left_normal;
use crate::town::{CellSide, MainStreet};
use glam::DVec2;

/// A side of a main street.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum StreetSide {
    /// Left of the street's line.
    Left,
    /// Right of the street's line.
    Right,
}

impl StreetSide {
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// The side of its main street that a side of a cell lies on.
    pub fn of(side: &CellSide) -> Self {
        if side.forward { Self::Left } else { Self::Right }
    }

    /// The unit direction away from a street that leads in `direction`, on this side of it.
    pub fn inward(self, direction: DVec2) -> DVec2 {
        match self {
            Self::Left => left_normal(direction),
            Self::Right => -left_normal(direction),
        }
    }

    /// Index of the cell on this side of a main street.
    pub fn cell(self, street: &MainStreet) -> usize {
        match self {
            Self::Left => street.left,
            Self::Right => street.right,
        }
    }
}
