//! Placements: where a patch lies on the plan.

use super::bend::Bend;
use crate::patch::STRETCH;
use glam::DVec2;

/// Where a patch lies on the plan: mirrored or not, scaled, turned, moved, and then bent a little.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Index into the patches of the database.
    pub patch: usize,
    /// The vertex of the patch at which it is attached.
    pub start: usize,
    x_axis: DVec2,
    y_axis: DVec2,
    offset: DVec2,
    bend: Option<Bend>,
}

impl Placement {
    /// The placement that puts `start`, which lies at `start_at` in the patch, at `at`, and turns and scales the patch
    /// vector `from` into `to`.
    pub fn new(
        (patch, start, start_at): (usize, usize, DVec2),
        from: DVec2,
        mirrored: bool,
        at: DVec2,
        to: DVec2,
    ) -> Self {
        // A mirrored patch is turned over its x axis before it is turned.
        let from = if mirrored { DVec2::new(from.x, -from.y) } else { from };
        let x_axis = DVec2::new(from.dot(to), from.perp_dot(to)) / from.length_squared();
        let y_axis = if mirrored { -x_axis.perp() } else { x_axis.perp() };
        let offset = at - x_axis * start_at.x - y_axis * start_at.y;
        Self { patch, start, x_axis, y_axis, offset, bend: None }
    }

    /// The placement that puts `start`, at `start_at` in the patch, at `at`, turns and scales the patch vector `from` into
    /// `to`, and scales what lies square to `from` by `across`; negative mirrors the patch at that vector.
    pub fn drawn_out(
        (patch, start, start_at): (usize, usize, DVec2),
        from: DVec2,
        at: DVec2,
        to: DVec2,
        across: f64,
    ) -> Self {
        let along = from / from.length_squared();
        let (u, v) = (to, to.normalize_or_zero().perp() * (across / from.length()));
        let (x_axis, y_axis) = (u * along.x - v * from.y, u * along.y + v * from.x);
        Self { patch, start, x_axis, y_axis, offset: at - x_axis * start_at.x - y_axis * start_at.y, bend: None }
    }

    /// This placement, bent so that the street between `from` and `to` changes its slopes there by `slopes`.
    pub fn bent(self, from: DVec2, to: DVec2, slopes: [f64; 2]) -> Self {
        let bend = if slopes == [0.0; 2] { None } else { Some(Bend::new(from, to, slopes)) };
        Self { bend, ..self }
    }

    /// Greatest factor by which the placement changes distances, bends aside.
    pub fn scale(&self) -> f64 {
        self.x_axis.length().max(self.y_axis.length())
    }

    /// Whether the placement leaves the shape of the patch and hardly changes its size, so that what its drawing keeps still holds.
    pub fn is_as_drawn(&self) -> bool {
        !self.is_bent() && self.scale() > 1.0 - STRETCH - 1e-9
    }

    /// Whether the placement changes the shape of the patch.
    pub fn is_bent(&self) -> bool {
        self.bend.is_some()
            || self.x_axis.dot(self.y_axis).abs() + (self.x_axis.length() - self.y_axis.length()).abs() > 1e-6
    }

    /// The position on the plan of a point of the patch.
    pub fn map(&self, p: DVec2) -> DVec2 {
        let p = self.offset + self.x_axis * p.x + self.y_axis * p.y;
        self.bend.map_or(p, |b| p + b.shift(p))
    }
}
