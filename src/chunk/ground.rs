//! The natural ground under a chunk as a triangulated grid of heights.

use crate::space::Origin;
use crate::terrain::{GROUND_STEP, Terrain, TerrainSample, height_in_square};
use glam::{DVec2, I64Vec2};

/// Terrain at the vertices of a square grid. Each grid square is two triangles, split from its south-west to its
/// north-east corner. Streets cut and fill this ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Number of grid squares along an edge.
    pub cells: usize,
    /// Terrain at (column, row) in element `row * (cells + 1) + column`, counted from the south-west corner.
    pub samples: Vec<TerrainSample>,
}

impl Ground {
    /// The ground of the square of `size` metres (a multiple of [`GROUND_STEP`]) north-east of `origin`.
    pub fn new(terrain: &dyn Terrain, origin: Origin, size: i64) -> Self {
        let mut scan = terrain.scan();
        Self::of_vertices(|vertex| scan(vertex.as_dvec2() * GROUND_STEP), origin, size)
    }

    /// The same ground from the vertices of the drawn ground, given in steps from the plan's origin.
    pub(super) fn of_vertices(mut sample: impl FnMut(I64Vec2) -> TerrainSample, origin: Origin, size: i64) -> Self {
        let cells = size / GROUND_STEP as i64;
        let corner = origin.0 / GROUND_STEP as i64;
        let vertices = (0..(cells + 1) * (cells + 1)).map(|i| I64Vec2::new(i % (cells + 1), i / (cells + 1)));
        Self { cells: cells as usize, samples: vertices.map(|at| sample(corner + at)).collect() }
    }

    /// The vertex at a column and row, 0 to `cells`.
    pub fn vertex(&self, column: usize, row: usize) -> &TerrainSample {
        &self.samples[row * (self.cells + 1) + column]
    }

    /// Height of the natural ground at a local point, in metres; `None` outside the square.
    pub fn height(&self, local: DVec2) -> Option<f64> {
        self.value(local, |sample| sample.height)
    }

    /// Height of the water at a local point, in metres, below the ground where there is none; `None` outside the square.
    pub fn water_level(&self, local: DVec2) -> Option<f64> {
        self.value(local, |sample| sample.water_level)
    }

    /// A value between those at the vertices around a local point.
    pub(crate) fn value(&self, local: DVec2, of: impl Fn(&TerrainSample) -> f64) -> Option<f64> {
        let (p, edge) = (local / GROUND_STEP, DVec2::splat(self.cells as f64));
        if !(p.cmpge(DVec2::ZERO) & p.cmple(edge)).all() {
            return None;
        }
        let cell = p.floor().min(DVec2::splat(self.cells as f64 - 1.0));
        let (column, row, f) = (cell.x as usize, cell.y as usize, p - cell);
        let at = |dx, dy| of(self.vertex(column + dx, row + dy));
        Some(height_in_square([at(0, 0), at(1, 0), at(0, 1), at(1, 1)], f))
    }
}
