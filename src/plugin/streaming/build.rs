//! The tasks that make chunks and tiles of the horizon, with their meshes.

use super::generator::ChunkGenerator;
use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::{ChunkMesh, Detail, HorizonTile};
use crate::plugin::appearance::{PartMesh, part_meshes};
use crate::plugin::collision::MadeCollision;
use crate::plugin::stream_settings::StreamSettings;
use crate::region::Outline;
use crate::space::ChunkCoord;
use std::sync::Arc;

/// A finished chunk that waits to be applied.
pub(super) struct FinishedChunk {
    pub chunk: Arc<Chunk>,
    pub detail: Detail,
    /// The outlines of the chunk's settlements, in the same order.
    pub outlines: Vec<Arc<Outline>>,
    /// Meshes; none if nothing could draw them.
    pub parts: Vec<PartMesh>,
    /// What things run into, if it is wanted.
    pub collision: Option<MadeCollision>,
}

/// The meshes of a finished tile, by the pieces that are shown and hidden alone: see [`pieces`].
pub(super) type FinishedTile = Vec<(HorizonTile, Vec<PartMesh>)>;

/// What tasks are made with.
#[derive(Clone)]
pub(super) struct Builder {
    pub generator: Arc<dyn ChunkGenerator>,
    pub with_meshes: bool,
    pub keep_meshes: bool,
    pub texture_coordinates: bool,
    pub collision: bool,
}

impl Builder {
    /// A builder that makes meshes only where something could draw them.
    pub fn new(generator: &Arc<dyn ChunkGenerator>, settings: &StreamSettings, with_meshes: bool) -> Self {
        let StreamSettings { keep_meshes, texture_coordinates, collision, .. } = *settings;
        Self { generator: generator.clone(), with_meshes, keep_meshes, texture_coordinates, collision }
    }

    /// Makes a chunk.
    pub fn chunk(&self, coord: ChunkCoord, detail: Detail, cancel: &Cancel) -> Result<FinishedChunk, LayerError> {
        let chunk = self.generator.chunk(coord, cancel)?;
        let outlines = self.generator.outlines(&chunk)?;
        let (mut parts, mut collision) = (Vec::new(), None);
        let solid = self.collision && detail == Detail::Full;
        if self.with_meshes || solid {
            cancel.check()?;
            let mesh = self.generator.mesh(&chunk, detail, cancel)?;
            collision = solid.then(|| MadeCollision::new(mesh.collision()));
            if self.with_meshes {
                parts = self.parts(mesh);
            }
        }
        Ok(FinishedChunk { chunk, detail, outlines, parts, collision })
    }

    /// Makes a tile of the horizon.
    pub fn tile(&self, tile: HorizonTile, cancel: &Cancel) -> Result<FinishedTile, LayerError> {
        let make = |piece| Ok((piece, self.parts(self.generator.horizon(piece, cancel)?)));
        pieces(tile).into_iter().map(make).collect()
    }

    fn parts(&self, mesh: ChunkMesh) -> Vec<PartMesh> {
        part_meshes(mesh, self.keep_meshes, self.texture_coordinates)
    }
}

/// The pieces of a tile. A tile of level 1 has one for each chunk that may take its place, any other tile is of one piece.
fn pieces(tile: HorizonTile) -> Vec<HorizonTile> {
    if tile.level == 1 { tile.children().to_vec() } else { vec![tile] }
}
