//! The land beyond the chunks, to the horizon: square tiles, each several chunks a side, with coarse ground, water and the
//! massing of towns. Reads the terrain, and the outlines of the towns that a tile overlaps; padding: one step of the tile's ground.
//!
//! Tiles of a level have half the detail of tiles of the level below and are twice as wide. Around each tile hang skirts, so that
//! no gap shows where tiles of different levels, or a tile and a chunk, meet. Towns are rows of boxes: no street is made for them.

mod ground;
mod massing;
#[cfg(test)]
mod tests;
mod tile;

pub use massing::HorizonTown;
pub use tile::{HorizonTile, horizon_tiles};

use crate::layer::{Cancel, LayerError};
use crate::mesh::part::{ChunkMesh, ChunkPart};
use crate::terrain::Terrain;

/// Builds the meshes of a tile, from its south-west corner. `chunk_size` is the edge of a chunk in metres, and `towns` are the
/// settlements whose outlines overlap the tile, in any order.
///
/// Vertices on the border have the same bits in the meshes of neighbours of the same level, skirts aside.
///
/// # Errors
///
/// [`LayerError::Cancelled`] when `cancel` is set.
pub fn horizon(
    tile: HorizonTile,
    chunk_size: i64,
    terrain: &dyn Terrain,
    towns: &[HorizonTown<'_>],
    cancel: &Cancel,
) -> Result<ChunkMesh, LayerError> {
    let mut mesh = ChunkMesh::default();
    let land = ground::Land::new(tile, chunk_size, terrain);
    mesh[ChunkPart::Ground] = land.ground(towns);
    mesh[ChunkPart::Water] = land.water();
    cancel.check()?;
    mesh[ChunkPart::Buildings] = massing::massing(tile, chunk_size, terrain, towns);
    Ok(mesh)
}
