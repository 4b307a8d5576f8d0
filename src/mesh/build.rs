//! Building the meshes of a chunk.

use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::detail::Detail;
use crate::mesh::drape::Drape;
use crate::mesh::part::{ChunkMesh, ChunkPart};
use crate::mesh::{bridges, buildings, ground, junctions, ribbon};
use crate::surface::{JunctionShape, Pieces};
use crate::terrain::Terrain;

/// Builds the meshes of a chunk. `terrain` is the terrain that the chunk's ground was sampled from.
///
/// Ground vertices on the chunk's border have the same bits in the meshes of its neighbours, whatever their detail.
///
/// # Errors
///
/// [`LayerError::Cancelled`] when `cancel` is set.
pub fn build(chunk: &Chunk, terrain: &dyn Terrain, detail: Detail, cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
    let mut fine = Drape::new(chunk, terrain, 1);
    let full = detail == Detail::Full;
    let mut mesh = ChunkMesh::default();
    mesh[ChunkPart::Ground] = ground::ground(chunk, &mut fine, !full);
    mesh[ChunkPart::Water] = ground::water(chunk);
    cancel.check()?;
    let roads = &mut mesh[ChunkPart::Roads];
    if full {
        for (at, ends) in chunk.junctions.iter().zip(junctions::ends(chunk)) {
            if let Some(shape) = JunctionShape::new(at, &ends) {
                junctions::junction(&mut fine, roads, &shape);
            }
        }
    }
    let mut coarse = (!full).then(|| Drape::new(chunk, terrain, ground::COARSE as i32));
    for street in chunk.streets_here().filter(|s| ribbon::is_drawn(s)) {
        let drape = coarse.as_mut().unwrap_or(&mut fine);
        let pieces = Pieces::new(street);
        let own: Vec<usize> = chunk.own_pieces(&pieces).collect();
        if own.is_empty() {
            continue;
        }
        if street.bridge {
            bridges::bridge(drape, roads, street, &pieces, &own);
        } else if full {
            ribbon::street(drape, roads, street, &pieces, &own);
        } else {
            ribbon::far_street(drape, roads, street, &pieces, &own);
        }
    }
    cancel.check()?;
    let (solids, panes) = buildings::buildings(chunk, &mut fine, full);
    mesh[ChunkPart::Buildings] = solids;
    mesh[ChunkPart::Windows] = panes;
    Ok(mesh)
}
