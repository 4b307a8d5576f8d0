//! Builds the meshes of a chunk.

use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::buffers::MeshBuffers;
use crate::mesh::drape::Surface;
use crate::mesh::{ChunkMesh, Detail, buildings, ground, junctions, ribbon};
use crate::terrain::Terrain;

/// The meshes of a chunk. `terrain` is the one that the chunk's ground was taken from; fails only when cancelled.
///
/// Ground vertices on the chunk's border are the same, to the bit, in the meshes of its neighbours, whatever their detail.
pub fn build(chunk: &Chunk, terrain: &dyn Terrain, detail: Detail, cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
    let mut fine = Surface::new(chunk, terrain, 1);
    let full = detail == Detail::Full;
    let ground = ground::ground(chunk, &mut fine, !full);
    let water = ground::water(chunk);
    cancel.check()?;
    let mut roads = MeshBuffers::default();
    if full {
        for (i, ends) in junctions::ends(chunk).iter().enumerate() {
            junctions::junction(&mut fine, &mut roads, &chunk.junctions[i], ends);
        }
        chunk.streets.iter().for_each(|s| ribbon::street(&mut fine, &mut roads, &s.street));
    } else {
        let mut coarse = Surface::new(chunk, terrain, ground::COARSE as i32);
        chunk.streets.iter().for_each(|s| ribbon::far_street(&mut coarse, &mut roads, &s.street));
    }
    cancel.check()?;
    let (buildings, windows) = buildings::buildings(chunk, &mut fine, full);
    Ok(ChunkMesh { ground, water, roads, buildings, windows })
}
