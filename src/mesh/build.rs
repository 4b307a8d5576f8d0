//! Builds the meshes of a chunk.

use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::buffers::MeshBuffers;
use crate::mesh::drape::Drape;
use crate::mesh::{ChunkMesh, Detail, bridges, buildings, ground, junctions, ribbon};
use crate::surface::JunctionShape;
use crate::terrain::Terrain;

/// The meshes of a chunk. `terrain` is the one that the chunk's ground was taken from; fails only when cancelled.
///
/// Ground vertices on the chunk's border are the same, to the bit, in the meshes of its neighbours, whatever their detail.
pub fn build(chunk: &Chunk, terrain: &dyn Terrain, detail: Detail, cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
    let mut fine = Drape::new(chunk, terrain, 1);
    let full = detail == Detail::Full;
    let ground = ground::ground(chunk, &mut fine, !full);
    let water = ground::water(chunk);
    cancel.check()?;
    let mut roads = MeshBuffers::default();
    if full {
        for (at, ends) in chunk.junctions.iter().zip(junctions::ends(chunk)) {
            if let Some(shape) = JunctionShape::new(at, &ends) {
                junctions::junction(&mut fine, &mut roads, &shape);
            }
        }
    }
    let mut coarse = (!full).then(|| Drape::new(chunk, terrain, ground::COARSE as i32));
    for street in chunk.streets.iter().map(|s| &s.street).filter(|s| ribbon::is_drawn(s)) {
        let drape = coarse.as_mut().unwrap_or(&mut fine);
        if street.bridge {
            bridges::bridge(drape, &mut roads, street);
        } else if full {
            ribbon::street(drape, &mut roads, street);
        } else {
            ribbon::far_street(drape, &mut roads, street);
        }
    }
    cancel.check()?;
    let (buildings, windows) = buildings::buildings(chunk, &mut fine, full);
    Ok(ChunkMesh { ground, water, roads, buildings, windows })
}
