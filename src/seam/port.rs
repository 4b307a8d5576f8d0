//! Ports: where streets of main cells attach to main streets.

use crate::network::{JunctionId, StreetClass};
use glam::DVec2;

/// Length of the straight approach that every port has room for, in metres.
pub const APPROACH_LENGTH: f64 = 20.0;

/// Least distance of an approach from other approaches, and from the cell's border except the side where it starts, in metres.
pub const APPROACH_CLEARANCE: f64 = 14.0;

/// An attachment point on a main street.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// The junction at the port.
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
    /// Position of the junction, local to the town, in metres.
    pub at: DVec2,
    /// Unit direction into the cell, square to the main street. The approach, a segment of [`APPROACH_LENGTH`] from `at` in this
    /// direction, lies in the cell and keeps [`APPROACH_CLEARANCE`] from all other approaches and from the cell's other sides.
    pub inward: DVec2,
    /// Class of the street that attaches.
    pub class: StreetClass,
}
