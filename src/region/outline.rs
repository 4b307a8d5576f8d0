//! Outlines of settlements.
use crate::space::{Bounds, Origin};
use glam::DVec2;

/// The outline of a settlement: a polygon, star-shaped about the centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Origin the polygon is local to: the settlement's centre.
    pub origin: Origin,
    /// Counter-clockwise, on the quantum grid, neighbours 40 to 90 m apart, star-shaped about (0, 0).
    pub polygon: Vec<DVec2>,
}

impl Outline {
    /// Box around the outline, in plan metres.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.polygon.iter().copied()).moved(self.origin.plan())
    }
}
