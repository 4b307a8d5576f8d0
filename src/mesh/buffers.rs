//! Vertex buffers and the faces added to them.

use crate::texture::Texture;
use glam::{DVec3, Vec3};

/// Vertices, each with a normal and a linear RGBA colour, and triangles, counter-clockwise seen from the front. A vertex takes
/// 24 bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshBuffers {
    /// Positions in metres, in Bevy's axes, from the chunk's south-west corner.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals, 127 for 1. The fourth number is 0: it fills the place.
    pub normals: Vec<[i8; 4]>,
    /// Colours, linear RGBA, 65535 for 1. The alpha of a part that is not transparent names its [texture](Texture::alpha).
    pub colours: Vec<[u16; 4]>,
    /// Indices of vertices, three per triangle.
    pub indices: Vec<u32>,
}

/// A linear colour without transparency.
pub(super) type Rgb = [f32; 3];

/// What a face is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coat {
    pub colour: Rgb,
    pub texture: Texture,
}

impl Coat {
    pub const fn new(texture: Texture, colour: Rgb) -> Self {
        Self { colour, texture }
    }

    /// The same with a colour between its own (at `t` = 0) and another one (at 1).
    pub fn tinted(self, colour: Rgb, t: f32) -> Self {
        Self { colour: blend(self.colour, colour, t), ..self }
    }
}

/// A point or direction, given as plan x, plan y and height, in Bevy's axes.
pub(super) fn to_bevy(p: DVec3) -> [f32; 3] {
    [p.x as f32, p.z as f32, -p.y as f32]
}

/// The colour between `a` (at `t` = 0) and `b` (at 1).
pub(super) fn blend(a: Rgb, b: Rgb, t: f32) -> Rgb {
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t)
}

impl MeshBuffers {
    /// Texture coordinates for each vertex, in metres, so that a texture repeats at its true size.
    ///
    /// On floors, roofs and the ground, u runs to the east and v to the south from the chunk's south-west corner. Chunks are
    /// whole metres wide, so a texture that is one metre wide, or a divisor of the chunk's edge, goes on over their borders.
    /// On walls, u runs along the wall, to the right of someone who looks at it, and v downwards from height 0.
    pub fn texture_coordinates(&self) -> Vec<[f32; 2]> {
        let mut out: Vec<[f32; 2]> = self.positions.iter().map(|[x, _, z]| [*x, *z]).collect();
        for triangle in self.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| Vec3::from(self.positions[triangle[i] as usize]));
            let normal = (b - a).cross(c - a).normalize_or_zero();
            // To the right of someone who looks against the normal.
            if let Some(right) = Vec3::Y.cross(normal).try_normalize().filter(|_| normal.y.abs() < 0.7) {
                for i in triangle {
                    let p = Vec3::from(self.positions[*i as usize]);
                    out[*i as usize] = [p.dot(right), -p.y];
                }
            }
        }
        out
    }

    /// The normal of a vertex.
    pub fn normal(&self, vertex: u32) -> Vec3 {
        let [x, y, z, _] = self.normals[vertex as usize].map(|n| f32::from(n) / 127.0);
        Vec3::new(x, y, z)
    }

    /// Makes room for vertices and triangles.
    pub(super) fn reserve(&mut self, vertices: usize, triangles: usize) {
        self.positions.reserve_exact(vertices);
        self.normals.reserve_exact(vertices);
        self.colours.reserve_exact(vertices);
        self.indices.reserve_exact(3 * triangles);
    }

    /// Gives back room that is not used.
    pub(super) fn shrink(&mut self) {
        self.positions.shrink_to_fit();
        self.normals.shrink_to_fit();
        self.colours.shrink_to_fit();
        self.indices.shrink_to_fit();
    }

    /// Adds a vertex (plan x, plan y, height) and returns its index.
    pub(super) fn vertex(&mut self, at: DVec3, normal: DVec3, coat: Coat) -> u32 {
        self.coloured(at, normal, coat.colour, coat.texture.alpha())
    }

    /// The same with any alpha.
    pub(super) fn coloured(&mut self, at: DVec3, normal: DVec3, colour: Rgb, alpha: f32) -> u32 {
        let index = self.positions.len() as u32;
        self.positions.push(to_bevy(at));
        // Rounded by hand: without instructions that not every processor has, `round` is a call.
        let [x, y, z] = to_bevy(normal).map(|n| (n * 127.0 + 0.5f32.copysign(n)) as i8);
        self.normals.push([x, y, z, 0]);
        self.colours.push([colour[0], colour[1], colour[2], alpha].map(|c| (c * 65535.0 + 0.5) as u16));
        index
    }

    /// Adds a triangle of earlier vertices, unless it has no area or faces away from the normal of its first vertex.
    pub(super) fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|i| Vec3::from(self.positions[i as usize]));
        let cross = (b - a).cross(c - a);
        if cross.length_squared() > 1e-10 && cross.dot(self.normal(corners[0])) > 0.0 {
            self.indices.extend(corners);
        }
    }

    /// Adds a flat convex polygon, counter-clockwise seen from the front.
    pub(super) fn face(&mut self, points: &[DVec3], coat: Coat) {
        // Newell's sum holds for any polygon, even if three points in a row lie on a line.
        let n = points.len();
        let normal = (0..n).map(|i| points[i].cross(points[(i + 1) % n])).sum::<DVec3>().normalize_or_zero();
        let first = self.positions.len() as u32;
        for &p in points {
            self.vertex(p, normal, coat);
        }
        for i in 1..n.saturating_sub(1) as u32 {
            self.triangle([first, first + i, first + i + 1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn textures_keep_their_size_and_are_not_mirrored() {
        let mut mesh = MeshBuffers::default();
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        // A floor, a wall that faces south and one that faces south-west, each seen from its front.
        let faces = [
            [at(2.0, 3.0, 5.0), at(6.0, 3.0, 5.0), at(6.0, 5.0, 5.0), at(2.0, 5.0, 5.0)],
            [at(0.0, 0.0, 0.0), at(7.0, 0.0, 0.0), at(7.0, 0.0, 3.0), at(0.0, 0.0, 3.0)],
            [at(0.0, 4.0, 0.0), at(3.0, 0.0, 0.0), at(3.0, 0.0, 2.0), at(0.0, 4.0, 2.0)],
        ];
        for face in &faces {
            mesh.face(face, Coat::new(Texture::Stone, [1.0; 3]));
        }
        let places = mesh.texture_coordinates();
        for (face, points) in places.chunks(4).zip(&faces) {
            let [right, up] = [1, 3].map(|i| {
                let by = Vec2::from(face[i]) - Vec2::from(face[0]);
                assert!((f64::from(by.length()) - points[i].distance(points[0])).abs() < 1e-5);
                by
            });
            // v runs down an image, so a face that is not mirrored goes around clockwise.
            assert!(right.x > 0.0 && right.perp_dot(up) < 0.0, "{face:?}");
        }
    }
}
