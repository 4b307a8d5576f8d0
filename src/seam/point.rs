//! Points of a main street where ports could be.

use super::port::{APPROACH_CLEARANCE, APPROACH_LENGTH};
use super::side::StreetSide;
use crate::space::{quantize, segment_distance, segments};
use glam::DVec2;

/// Distance of ports from points of inflexion, in metres.
const STRAIGHT: f64 = 8.0;

/// A point of a main street where a port could be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StreetPoint {
    /// Metres along the street.
    pub along: f64,
    /// Position, on the quantum grid.
    pub at: DVec2,
    /// Unit direction of the street there.
    pub direction: DVec2,
    /// Index of the segment of the street's line.
    pub segment: usize,
}

impl StreetPoint {
    /// The point near `along` metres on a street's line that keeps off points of inflexion; `None` where the segment there is
    /// too short.
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

    /// Unit direction of an approach on one side, away from the street.
    pub fn inward(&self, side: StreetSide) -> DVec2 {
        side.inward(self.direction)
    }

    /// Whether the approaches of two points of one street are far enough apart on one side.
    pub fn is_clear_of(&self, other: &Self, side: StreetSide) -> bool {
        let end = |p: &Self| p.at + p.inward(side) * APPROACH_LENGTH;
        segment_distance(self.at, end(self), other.at, end(other)) >= APPROACH_CLEARANCE + 2.0
    }
}
