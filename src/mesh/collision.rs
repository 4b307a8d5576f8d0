//! What things stand on and run into.

use crate::mesh::part::{ChunkMesh, ChunkPart};
use std::collections::BTreeMap;

/// The triangles that things in a chunk stand on and run into: ground, streets with kerbs, bridges, and buildings. For the colliders
/// of physics engines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CollisionMesh {
    /// Positions in metres, in Bevy's axes, from the chunk's south-west corner. No two are the same.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl ChunkPart {
    /// Whether things run into the part. Windows are drawn on walls, and things sink into water.
    pub fn is_solid(self) -> bool {
        matches!(self, Self::Ground | Self::Roads | Self::Buildings)
    }
}

impl ChunkMesh {
    /// The solid parts as one. In [full detail](crate::mesh::Detail::Full) the triangles have no gap inside the chunk, nor towards the
    /// chunks beside it.
    pub fn collision(&self) -> CollisionMesh {
        let mut out = CollisionMesh::default();
        let mut known: BTreeMap<[u32; 3], u32> = BTreeMap::new();
        for (_, buffers) in self.parts().filter(|(part, _)| part.is_solid()) {
            let vertex = |position: &[f32; 3]| {
                *known.entry(position.map(f32::to_bits)).or_insert_with(|| {
                    out.vertices.push(*position);
                    out.vertices.len() as u32 - 1
                })
            };
            let names: Vec<u32> = buffers.positions.iter().map(vertex).collect();
            let corners = buffers.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|v| names[v as usize]));
            out.triangles.extend(corners.filter(|[a, b, c]| a != b && b != c && c != a));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshBuffers;

    fn triangle(at: f32, corner: [f32; 3]) -> MeshBuffers {
        MeshBuffers {
            positions: vec![[at, 0.0, 0.0], [at + 1.0, 0.0, 0.0], corner],
            indices: vec![0, 1, 2],
            ..MeshBuffers::default()
        }
    }

    #[test]
    fn solid_parts_share_vertices_and_others_are_left_out() {
        let mut mesh = ChunkMesh::default();
        mesh[ChunkPart::Ground] = triangle(0.0, [0.0, 0.0, -1.0]);
        mesh[ChunkPart::Roads] = triangle(1.0, [0.0, 0.0, -1.0]);
        mesh[ChunkPart::Water] = triangle(5.0, [5.0, 0.0, -1.0]);
        let made = mesh.collision();
        assert_eq!(made.vertices, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [2.0, 0.0, 0.0]]);
        assert_eq!(made.triangles, [[0, 1, 2], [1, 3, 2]]);
    }
}
