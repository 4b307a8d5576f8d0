//! Layer 9: vertex buffers of a chunk. Reads the chunk, and terrain under its streets where they leave its square and one
//! ground vertex around it; padding: the length of the longest street.
//!
//! Axes are Bevy's: x east, y up, z south, in metres from the chunk's south-west corner.

mod bridges;
mod buffers;
mod build;
mod buildings;
mod drape;
mod ground;
mod junctions;
mod ribbon;
mod roofs;
#[cfg(test)]
mod tests;
mod windows;

pub use buffers::MeshBuffers;
pub use build::build;

/// Level of detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Detail {
    /// Everything.
    Full,
    /// For the distance: coarse ground (whole along its border, so that it meets the ground of any other detail without a
    /// crack), streets as flat ribbons, buildings as boxes.
    Reduced,
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
    /// Buildings: each a closed solid.
    pub buildings: MeshBuffers,
    /// Panes of windows and doors, just before the walls.
    pub windows: MeshBuffers,
}
