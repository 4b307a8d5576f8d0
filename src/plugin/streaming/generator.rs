//! The maker of chunks and tiles: the world, or a stand-in in tests.

use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::{ChunkMesh, Detail, HorizonTile};
use crate::region::Outline;
use crate::space::ChunkCoord;
use crate::world::World;
use std::sync::Arc;

/// Makes chunks and their meshes, on any thread.
pub(in crate::plugin) trait ChunkGenerator: Send + Sync + 'static {
    /// Edge of a chunk in metres.
    fn chunk_size(&self) -> i64;

    /// Makes a chunk.
    fn chunk(&self, coord: ChunkCoord, cancel: &Cancel) -> Result<Arc<Chunk>, LayerError>;

    /// The outlines of a chunk's settlements, in the same order.
    fn outlines(&self, chunk: &Chunk) -> Result<Vec<Arc<Outline>>, LayerError>;

    /// Makes the meshes of a chunk.
    fn mesh(&self, chunk: &Chunk, detail: Detail, cancel: &Cancel) -> Result<ChunkMesh, LayerError>;

    /// Makes the meshes of a tile of the horizon.
    fn horizon(&self, tile: HorizonTile, cancel: &Cancel) -> Result<ChunkMesh, LayerError>;
}

impl ChunkGenerator for World {
    fn chunk_size(&self) -> i64 {
        self.settings().chunk_size
    }

    fn chunk(&self, coord: ChunkCoord, cancel: &Cancel) -> Result<Arc<Chunk>, LayerError> {
        self.chunk(coord, cancel)
    }

    fn outlines(&self, chunk: &Chunk) -> Result<Vec<Arc<Outline>>, LayerError> {
        chunk.settlements.iter().map(|s| self.settlements().outline(s)).collect()
    }

    fn mesh(&self, chunk: &Chunk, detail: Detail, cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
        World::mesh(self, chunk.coord, detail, cancel)
    }

    fn horizon(&self, tile: HorizonTile, cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
        self.horizon(tile, cancel)
    }
}
