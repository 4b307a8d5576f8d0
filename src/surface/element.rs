//! Triangulated parts of the street surface.

use crate::space::{cross, ears};
use crate::surface::finish::Finish;
use glam::{DVec2, DVec3};

/// A triangulated part of the surface: a stretch of a street or a junction. Positions are local, on the quantum grid in plan, and
/// heights are the heights of the carriageway: what lies above a kerb is drawn higher by the kerb.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Element {
    /// Plan position and height of each vertex, in metres.
    pub points: Vec<DVec3>,
    /// Triangles, counter-clockwise, with what they are made of.
    pub triangles: Vec<([u32; 3], Finish)>,
    /// Vertices at which pavements come down to the carriageway: dropped kerbs.
    pub dropped: Vec<u32>,
    /// Number of triangles before each part: parts are judged as a whole where shapes overlap.
    pub parts: Vec<usize>,
}

impl Element {
    pub(super) fn point(&mut self, at: DVec2, height: f64) -> u32 {
        self.points.push(at.extend(height));
        self.points.len() as u32 - 1
    }

    /// Begins a part.
    pub(super) fn begin(&mut self) {
        self.parts.push(self.triangles.len());
    }

    /// Plan position of a vertex.
    pub fn plan(&self, vertex: u32) -> DVec2 {
        self.points[vertex as usize].truncate()
    }

    /// Twice the signed area of a triangle in plan.
    fn turn(&self, [a, b, c]: [u32; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|v| self.plan(v));
        cross(b - a, c - a)
    }

    /// Whether every triangle runs counter-clockwise.
    pub(super) fn is_sound(&self) -> bool {
        self.triangles.iter().all(|(t, _)| self.turn(*t) > 0.0)
    }

    pub(super) fn triangle(&mut self, corners: [u32; 3], finish: Finish) {
        self.triangles.push((corners, finish));
    }

    /// Triangulates a polygon given by its vertices, counter-clockwise.
    pub(super) fn polygon(&mut self, ring: &[u32], finish: Finish) {
        let plan: Vec<DVec2> = ring.iter().map(|v| self.plan(*v)).collect();
        for t in ears(&plan) {
            self.triangle(t.map(|i| ring[i]), finish);
        }
    }

    /// Fills the strip between two chains of vertices that run the same way, `right` to the right of `left`, zigzag.
    pub(super) fn zip(&mut self, right: &[u32], left: &[u32], finish: Finish) {
        let (mut i, mut j) = (0, 0);
        while i + 1 < right.len() || j + 1 < left.len() {
            let (a, b) = (self.plan(right[i]), self.plan(left[j]));
            let on_right = match (right.get(i + 1), left.get(j + 1)) {
                (Some(p), Some(q)) => self.plan(*p).distance_squared(b) < self.plan(*q).distance_squared(a),
                (next, _) => next.is_some(),
            };
            let third = if on_right { right[i + 1] } else { left[j + 1] };
            if third != right[i] && third != left[j] && right[i] != left[j] {
                self.triangle([right[i], third, left[j]], finish);
            }
            if on_right { i += 1 } else { j += 1 }
        }
    }
}
