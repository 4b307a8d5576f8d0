//! The parts of a chunk's meshes: the one list that the generator, the digest, the exporters and the plugin go through.
//!
//! A new part is a variant of [`ChunkPart`], its entry in [`ChunkPart::ALL`], its row in [`ChunkPart::material`], and the code
//! in `build` that fills its buffers.

use crate::mesh::buffers::MeshBuffers;
use std::ops::{Index, IndexMut};

/// A part of a chunk's meshes: one vertex buffer with one material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[cfg_attr(feature = "bevy", reflect(Debug, PartialEq, Hash, Clone))]
pub enum ChunkPart {
    /// The ground.
    Ground,
    /// Surface of sea, lakes and rivers.
    Water,
    /// Streets and junctions.
    Roads,
    /// Buildings: each a closed solid.
    Buildings,
    /// Panes of windows and doors, just before the walls.
    Windows,
}

/// How the surface of a part takes light. Its colour, linear RGBA, comes from the vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartMaterial {
    /// Name of the part in files, in lower case.
    pub name: &'static str,
    /// Perceptual roughness, 0 (mirror) to 1 (matt).
    pub roughness: f32,
    /// Reflectance at normal incidence, 0 to 1, as in Bevy's `StandardMaterial`.
    pub reflectance: f32,
    /// Whether the alpha of the colours is their opacity.
    pub transparent: bool,
    /// Whether the alpha of the colours names a [texture](crate::texture::Texture::alpha).
    pub textured: bool,
}

impl ChunkPart {
    /// Every part, in the order in which files and hashes hold them.
    pub const ALL: [Self; 5] = [Self::Ground, Self::Water, Self::Roads, Self::Buildings, Self::Windows];

    /// The material of the part.
    pub fn material(self) -> PartMaterial {
        let (name, roughness, reflectance) = match self {
            Self::Ground => ("ground", 1.0, 0.1),
            Self::Water => ("water", 0.12, 0.5),
            Self::Roads => ("roads", 0.9, 0.2),
            Self::Buildings => ("buildings", 0.85, 0.3),
            Self::Windows => ("windows", 0.15, 0.6),
        };
        let textured = matches!(self, Self::Ground | Self::Roads | Self::Buildings);
        PartMaterial { name, roughness, reflectance, transparent: self == Self::Water, textured }
    }
}

/// The meshes of a chunk, by part. Any of them may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChunkMesh {
    buffers: [MeshBuffers; ChunkPart::ALL.len()],
}

impl ChunkMesh {
    /// The parts with their buffers, in the order of [`ChunkPart::ALL`].
    pub fn parts(&self) -> impl Iterator<Item = (ChunkPart, &MeshBuffers)> {
        ChunkPart::ALL.into_iter().zip(&self.buffers)
    }

    /// The same as [`parts`](Self::parts), by value.
    pub fn into_parts(self) -> impl Iterator<Item = (ChunkPart, MeshBuffers)> {
        ChunkPart::ALL.into_iter().zip(self.buffers)
    }
}

impl Index<ChunkPart> for ChunkMesh {
    type Output = MeshBuffers;

    fn index(&self, part: ChunkPart) -> &MeshBuffers {
        &self.buffers[part as usize]
    }
}

impl IndexMut<ChunkPart> for ChunkMesh {
    fn index_mut(&mut self, part: ChunkPart) -> &mut MeshBuffers {
        &mut self.buffers[part as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_has_its_own_buffers_and_name() {
        let mut mesh = ChunkMesh::default();
        for (i, part) in ChunkPart::ALL.into_iter().enumerate() {
            mesh[part].indices.push(i as u32);
        }
        for (i, (part, buffers)) in mesh.parts().enumerate() {
            assert_eq!((&mesh[part].indices, &buffers.indices), (&vec![i as u32], &vec![i as u32]));
            let named = ChunkPart::ALL.iter().filter(|p| p.material().name == part.material().name);
            assert_eq!(named.count(), 1);
        }
    }
}
