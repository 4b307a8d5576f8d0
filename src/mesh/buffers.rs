//! Vertex buffers and the faces added to them.

use glam::{DVec3, Vec3};

/// Vertices and triangles (counter-clockwise seen from the front) with a normal and a linear RGBA colour each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshBuffers {
    /// Positions in metres.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Linear RGBA.
    pub colours: Vec<[f32; 4]>,
    /// Three per triangle.
    pub indices: Vec<u32>,
}

/// A linear colour without transparency.
pub(super) type Rgb = [f32; 3];

/// A point or direction, given as plan x, plan y and height, in Bevy's axes.
pub(super) fn to_bevy(p: DVec3) -> [f32; 3] {
    [p.x as f32, p.z as f32, -p.y as f32]
}

/// The colour between `a` (at `t` = 0) and `b` (at 1).
pub(super) fn blend(a: Rgb, b: Rgb, t: f32) -> Rgb {
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t)
}

impl MeshBuffers {
    /// Adds a vertex (plan x, plan y, height) and returns its index.
    pub(super) fn vertex(&mut self, at: DVec3, normal: DVec3, colour: Rgb, alpha: f32) -> u32 {
        let index = self.positions.len() as u32;
        self.positions.push(to_bevy(at));
        self.normals.push(to_bevy(normal));
        self.colours.push([colour[0], colour[1], colour[2], alpha]);
        index
    }

    /// Adds a triangle of earlier vertices, unless it has no area or faces away from their normals.
    pub(super) fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|i| Vec3::from(self.positions[i as usize]));
        let cross = (b - a).cross(c - a);
        if cross.length_squared() > 1e-10 && cross.dot(Vec3::from(self.normals[corners[0] as usize])) > 0.0 {
            self.indices.extend(corners);
        }
    }

    /// Adds a flat convex polygon, counter-clockwise seen from the front.
    pub(super) fn face(&mut self, points: &[DVec3], colour: Rgb) {
        // Newell's sum holds for any polygon, even if three points in a row lie on a line.
        let n = points.len();
        let normal = (0..n).map(|i| points[i].cross(points[(i + 1) % n])).sum::<DVec3>().normalize_or_zero();
        let first = self.positions.len() as u32;
        for &p in points {
            self.vertex(p, normal, colour, 1.0);
        }
        for i in 1..n.saturating_sub(1) as u32 {
            self.triangle([first, first + i, first + i + 1]);
        }
    }
}
