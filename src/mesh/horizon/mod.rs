//! The land beyond the chunks, to the horizon: square tiles, each several chunks a side, with coarse ground, water and the
//! massing of towns, and roads. Reads the terrain, the outlines of the towns that a tile overlaps, and the roads in it; padding: one
//! and a half steps of the tile's ground.
//!
//! Tiles of a level have half the detail of tiles of the level below and are twice as wide. Around each tile hang skirts, so that
//! no gap shows where tiles of different levels, or a tile and a chunk, meet. Towns are rows of boxes: no street is made for them.

mod ground;
mod massing;
mod roads;
#[cfg(test)]
mod tests;
mod tile;

pub use massing::HorizonTown;
pub use tile::{HorizonTile, horizon_tiles};

use crate::layer::{Cancel, LayerError};
use crate::mesh::part::{ChunkMesh, ChunkPart};
use crate::region::RoadSection;
use crate::terrain::Terrain;
use std::sync::Arc;

/// What people made that is seen from afar in a tile.
#[derive(Clone, Debug, Default)]
pub struct HorizonFeatures<'a> {
    /// The settlements whose outlines overlap the tile, in any order.
    pub towns: Vec<HorizonTown<'a>>,
    /// The roads that enter the tile, in a fixed order; none for tiles of a level above [`HorizonTile::ROADS`].
    pub roads: Vec<Arc<RoadSection>>,
}

/// Builds the meshes of a tile, from its south-west corner. `chunk_size` is the edge of a chunk in metres.
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
    features: &HorizonFeatures<'_>,
    cancel: &Cancel,
) -> Result<ChunkMesh, LayerError> {
    let mut mesh = ChunkMesh::default();
    let land = ground::Land::new(tile, chunk_size, terrain);
    mesh[ChunkPart::Ground] = land.ground(&features.towns);
    mesh[ChunkPart::Water] = land.water();
    cancel.check()?;
    mesh[ChunkPart::Buildings] = massing::massing(tile, chunk_size, terrain, &features.towns);
    mesh[ChunkPart::Roads] = roads::roads(&land, &features.roads);
    Ok(mesh)
}
