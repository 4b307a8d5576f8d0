//! Bending: a patch is bent a little where it would leave a kink at one of its ends as it is drawn.

use crate::patch::PatchShape;
use crate::space::math::{cos, sin, smoothstep};
use crate::style::FieldKind;
use glam::DVec2;

/// A smooth sideways shift along a straight line: both ends of the line stay where they are, and the headings there turn.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    from: DVec2,
    along: DVec2,
    length: f64,
    /// Change of slope at the start and at the end.
    slopes: [f64; 2],
}

impl Bend {
    /// The bend of a line from `from` to `to`.
    pub fn new(from: DVec2, to: DVec2, slopes: [f64; 2]) -> Self {
        let length = from.distance(to);
        Self { from, along: (to - from) / length, length, slopes }
    }

    /// The vector by which the bend moves the point `p`.
    pub fn shift(&self, p: DVec2) -> DVec2 {
        let x = (p - self.from).dot(self.along);
        let t = (x / self.length).clamp(0.0, 1.0);
        // The cubic with these slopes and no shift at the ends; straight on beyond them.
        let inside = self.length * t * (1.0 - t) * (self.slopes[0] * (1.0 - t) - self.slopes[1] * t);
        let beyond = self.slopes[0] * x.min(0.0) + self.slopes[1] * (x - self.length).max(0.0);
        self.along.perp() * (inside + beyond)
    }
}

/// How far patches are bent.
#[derive(Clone, Copy, Debug)]
pub struct Bending {
    /// Greatest angle by which a patch is bent at an end, in radians.
    most: f64,
    /// Greatest angle by which a street may turn where another goes on from it, in radians.
    most_turn: f64,
}

impl Bending {
    /// The bending in a cell whose streets follow a field of the given kind and turn by at most `most_turn` radians where one
    /// goes on from another.
    pub fn new(field: FieldKind, most_turn: f64) -> Self {
        let most = if field == FieldKind::Grid { 0.05 } else { 0.2 };
        Self { most, most_turn }
    }

    /// How far a patch of this shape is bent: one with a roundabout not at all.
    pub fn of(self, shape: &PatchShape) -> Self {
        if shape.round { Self { most: 0.0, ..self } } else { self }
    }

    /// Greatest angle between the heading of a patch at an end and the heading wanted there, in radians.
    pub fn reach(self) -> f64 {
        self.most + self.most_turn
    }

    /// Whether both headings are near enough to the wanted ones that a patch can be bent.
    fn may_bend(self, is: [f64; 2], wanted: [Option<f64>; 2]) -> bool {
        let most = self.reach();
        (0..2).all(|i| wanted[i].is_none_or(|w| (w - is[i]).abs() <= most))
    }

    /// How the slopes of a street change at its two ends to fit, as far as a patch may be bent, and the least cosine of the
    /// bends that are left there; `None` if they are too sharp. `is` and `wanted` are the headings of the street at both ends
    /// against the straight line between them, in radians. An end whose wanted heading is `None` may have any.
    pub fn bend(self, is: [f64; 2], wanted: [Option<f64>; 2]) -> Option<([f64; 2], f64)> {
        if !self.may_bend(is, wanted) {
            return None;
        }
        let mut slopes = [0.0; 2];
        let mut left: f64 = 0.0;
        for i in 0..2 {
            let Some(wanted) = wanted[i] else { continue };
            let off = wanted - is[i];
            // A street that sets out sidewards is not turned by a sidewards shift. Less than a degree is no more than the
            // jitter of streets, and what is straight stays so.
            let steep = is[i].abs().max(wanted.abs()) > 0.9;
            let most = if steep { 0.0 } else { self.most };
            let bent = off.clamp(-most, most) * smoothstep(0.01, 0.03, off.abs());
            left = left.max((off - bent).abs());
            if bent != 0.0 {
                let slope = |angle: f64| sin(angle) / cos(angle);
                slopes[i] = slope(is[i] + bent) - slope(is[i]);
            }
        }
        (left <= self.most_turn).then_some((slopes, 1.0 - 0.5 * left * left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_keeps_both_ends_and_turns_their_headings() {
        let (from, to) = (DVec2::new(10.0, 5.0), DVec2::new(90.0, 35.0));
        let bend = Bend::new(from, to, [0.2, -0.1]);
        let along = (to - from).normalize();
        assert!(bend.shift(from).length() < 1e-9 && bend.shift(to).length() < 1e-9);
        for (end, slope) in [(from, 0.2), (to, -0.1)] {
            for side in [-1e-4, 1e-4] {
                let p = end + along * side;
                let heading = (p + bend.shift(p) - end) / side;
                assert!((heading.dot(along) - 1.0).abs() < 1e-6 && (heading.dot(along.perp()) - slope).abs() < 1e-4);
            }
        }
    }
}
