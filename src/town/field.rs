//! Direction fields that streets follow.
use glam::DVec2;

/// Directions that streets follow.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionField {
    /// placeholder
    pub angle: f64,
}

impl DirectionField {
    /// Angle in radians, in -pi/4..=pi/4 modulo a quarter turn, of the cross of preferred directions at `p` (local to the town).
    pub fn angle(&self, _p: DVec2) -> f64 {
        self.angle
    }
}
