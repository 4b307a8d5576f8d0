//! Building.
use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::{ChunkMesh, Detail};

/// The meshes of a chunk.
pub fn build(_chunk: &Chunk, _detail: Detail, _cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
    todo!()
}
