//! What shows where shapes overlap.

use super::sheet::{Sheet, height_on};
use crate::space::QUANTUM;
use crate::surface::finish::Finish;
use glam::DVec2;

/// Edge of a cell of the index, in metres.
const CELL: f64 = 8.0;

/// Distance that a point may lie outside of a triangle that still counts as holding it, in metres.
const NEAR: f64 = 0.002;

/// The same for where edges cross: crossings are rounded, and edges bent to pass through points beside them.
const NEAR_CROSSING: f64 = 0.05;

/// The triangles of shared parts, by place.
pub(super) struct Overlaps<'a> {
    sheet: &'a Sheet,
    columns: usize,
    cells: Vec<Vec<u32>>,
}

impl<'a> Overlaps<'a> {
    /// `None` if nothing is shared.
    pub fn new(sheet: &'a Sheet) -> Option<Self> {
        if !sheet.shared.contains(&true) {
            return None;
        }
        let columns = (f64::from(sheet.edge) * QUANTUM / CELL) as usize + 1;
        let mut out = Self { sheet, columns, cells: vec![Vec::new(); columns * columns] };
        for (i, triangle) in sheet.triangles.iter().enumerate().filter(|(_, t)| sheet.shared[t.part as usize]) {
            let at = triangle.corners.map(|v| sheet.plan(v));
            let low = ((at[0].min(at[1]).min(at[2]) - NEAR_CROSSING).max(DVec2::ZERO) / CELL).as_usizevec2();
            let high = ((at[0].max(at[1]).max(at[2]) + NEAR_CROSSING) / CELL).as_usizevec2();
            for y in low.y..=high.y.min(columns - 1) {
                for x in low.x..=high.x.min(columns - 1) {
                    out.cells[y * columns + x].push(i as u32);
                }
            }
        }
        Some(out)
    }

    /// What shows at a point (metres), and its height: the greatest finish of all triangles that hold the point.
    pub fn at(&self, p: DVec2) -> Option<(Finish, f64)> {
        self.within(p, NEAR)
    }

    /// The height at a point where edges cross, in metres.
    pub fn crossing_height(&self, p: DVec2) -> Option<f64> {
        self.within(p, NEAR_CROSSING).map(|(_, height)| height)
    }

    fn within(&self, p: DVec2, near: f64) -> Option<(Finish, f64)> {
        let cell = (p.max(DVec2::ZERO) / CELL).as_usizevec2();
        let (x, y) = (cell.x.min(self.columns - 1), cell.y.min(self.columns - 1));
        let mut best: Option<(Finish, f64)> = None;
        for index in &self.cells[y * self.columns + x] {
            let triangle = &self.sheet.triangles[*index as usize];
            if best.is_some_and(|(finish, _)| finish >= triangle.finish) {
                continue;
            }
            let at = triangle.corners.map(|v| self.sheet.plan(v));
            let inside = (0..3).all(|i| {
                let by = at[(i + 1) % 3] - at[i];
                by.perp_dot(p - at[i]) >= -near * by.length()
            });
            if inside {
                let plane = triangle.corners.map(|v| self.sheet.points[v as usize]);
                // Beside a thin triangle its plane may be anywhere.
                let heights = plane.map(|corner| corner.height);
                let low = heights.into_iter().fold(f64::INFINITY, f64::min);
                let high = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
                best = Some((triangle.finish, height_on(&plane, p / QUANTUM).clamp(low, high)));
            }
        }
        best
    }
}
