//! Layer 5: seams. Along each main street the two cells beside it propose attachment points from their styles, each in line
//! with those on its other sides where the style is one of surveyors; matched, they become ports that both cells start from.
//! Reads town and styles; the result is a function of the street, its two cells, their styles and the town's field alone, so
//! the padding is that of the town. Along a border the two cells are of two towns, and the seam reads both plans.

mod cut;
mod matching;
mod stub;
mod survey;
#[cfg(test)]
mod tests;

pub use cut::{cell_ports, main_network, shared_streets};
pub use matching::{Across, seams};

use crate::network::{JunctionId, StreetClass};
use glam::DVec2;

/// Length of the straight stub that every port is sure to have room for, in metres.
pub const STUB_LENGTH: f64 = 20.0;

/// Least distance of a stub from any other stub and from any part of the cell's border but the side it starts on.
pub const STUB_CLEARANCE: f64 = 14.0;

/// An attachment point on a main street.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// The junction it makes.
    pub junction: JunctionId,
    /// Metres along the main street.
    pub along: f64,
    /// Position, local to the town, on the quantum grid.
    pub at: DVec2,
    /// Class of the street that attaches from the left, if one does.
    pub left: Option<StreetClass>,
    /// Class of the street that attaches from the right, if one does.
    pub right: Option<StreetClass>,
}

/// A main street with its ports.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Seam {
    /// Ports in order along the street.
    pub ports: Vec<Port>,
}

/// A port as one of its cells sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellPort {
    /// The junction on the main street.
    pub junction: JunctionId,
    /// Its position, local to the town.
    pub at: DVec2,
    /// Unit direction into the cell, square to the main street. The segment of [`STUB_LENGTH`] from `at` along it lies in
    /// the cell, [`STUB_CLEARANCE`] from the stubs of all other ports and from the cell's other sides.
    pub inward: DVec2,
    /// Class of the street that attaches.
    pub class: StreetClass,
}
