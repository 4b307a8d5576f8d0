//! Gates: where roads and main streets enter a settlement.

use crate::network::{JunctionId, StreetClass};
use glam::DVec2;

/// A place where roads enter a settlement, or where main streets of two settlements meet.
#[derive(Clone, Debug, PartialEq)]
pub struct Gate {
    /// The junction where the roads end and the main street begins.
    pub junction: JunctionId,
    /// Index of the gate's vertex in the settlement's outline.
    pub vertex: usize,
    /// Position of that vertex, local to the settlement.
    pub at: DVec2,
    /// Unit direction into the settlement, in which the road of the highest class arrives.
    pub inward: DVec2,
    /// The highest class of the roads that end here.
    pub class: StreetClass,
}
