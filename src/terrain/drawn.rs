//! The ground as it is drawn: triangles over a grid.

use crate::terrain::{Scan, Terrain};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;

/// Distance between the vertices of the drawn ground, in metres. They lie at the multiples of it.
pub const GROUND_STEP: f64 = 8.0;

/// Heights of the drawn ground at plan points. Remembers the vertices that it has sampled.
///
/// Each square of the grid is two triangles, split from its south-west to its north-east corner.
pub struct DrawnGround<'a> {
    scan: Scan<'a>,
    vertices: BTreeMap<(i64, i64), f64>,
}

impl<'a> DrawnGround<'a> {
    /// The drawn ground of a terrain.
    pub fn new(terrain: &'a dyn Terrain) -> Self {
        Self { scan: terrain.scan_ground(), vertices: BTreeMap::new() }
    }

    /// Height at a plan point, in metres.
    pub fn height(&mut self, p: DVec2) -> f64 {
        let cell = (p / GROUND_STEP).floor();
        let corners = [I64Vec2::ZERO, I64Vec2::X, I64Vec2::Y, I64Vec2::ONE].map(|d| {
            let at = cell.as_i64vec2() + d;
            let scan = &mut self.scan;
            *self.vertices.entry((at.x, at.y)).or_insert_with(|| scan(at.as_dvec2() * GROUND_STEP).height)
        });
        height_in_square(corners, p / GROUND_STEP - cell)
    }
}

/// Height in a square of the grid at `f` (0 to 1 each way) from its corners SW, SE, NW, NE.
pub(crate) fn height_in_square([sw, se, nw, ne]: [f64; 4], f: DVec2) -> f64 {
    if f.x >= f.y { sw + (se - sw) * f.x + (ne - se) * f.y } else { sw + (nw - sw) * f.y + (ne - nw) * f.x }
}
