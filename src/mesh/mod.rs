//! Layer 9: vertex buffers of a chunk. Reads the chunk and terrain; padding 0.
//!
//! Axes are Bevy's: x east, y up, z south, in metres from the chunk's south-west corner.

mod build;

pub use build::build;

/// Level of detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Detail {
    /// Everything.
    Full,
    /// For the distance: coarse ground, streets as flat ribbons, buildings as boxes.
    Reduced,
}

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

/// The meshes of a chunk, one for each material. Any may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChunkMesh {
    /// The ground.
    pub ground: MeshBuffers,
    /// Surface of sea, lakes and rivers.
    pub water: MeshBuffers,
    /// Streets and junctions.
    pub roads: MeshBuffers,
    /// Buildings.
    pub buildings: MeshBuffers,
}
