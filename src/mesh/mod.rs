//! Layer 11: vertex buffers of a chunk. Reads the chunk, and the natural ground around its square; padding: half a piece of a
//! bridge, half a street's width, and buildings that stand out of the square.
//!
//! Axes are Bevy's: x east, y up, z south, in metres from the chunk's south-west corner.

mod bridges;
mod buffers;
mod build;
mod buildings;
mod coarse;
mod collision;
mod detail;
mod footing;
mod ground;
mod horizon;
mod part;
mod roofs;
mod streets;
#[cfg(test)]
mod tests;
mod windows;

pub use buffers::MeshBuffers;
pub use build::build;
pub use collision::CollisionMesh;
pub use detail::Detail;
pub use horizon::{HorizonFeatures, HorizonTile, HorizonTown, horizon, horizon_tiles};
pub use part::{ChunkMesh, ChunkPart, PartMaterial};
