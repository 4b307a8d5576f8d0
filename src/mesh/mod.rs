//! Layer 11: vertex buffers of a chunk. Reads the chunk, the outlines of its streets from `surface`, the terrain under streets
//! that leave its square, and one ground vertex around the square; padding: half a piece of a street and half a street's width.
//!
//! Axes are Bevy's: x east, y up, z south, in metres from the chunk's south-west corner.

mod bridges;
mod buffers;
mod build;
mod buildings;
mod detail;
mod drape;
mod ground;
mod junctions;
mod part;
mod ribbon;
mod roofs;
#[cfg(test)]
mod tests;
mod windows;

pub use buffers::MeshBuffers;
pub use build::build;
pub use detail::Detail;
pub use part::{ChunkMesh, ChunkPart, PartMaterial};
