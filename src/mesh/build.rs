//! Building the meshes of a chunk.

use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::detail::Detail;
use crate::mesh::footing::Footing;
use crate::mesh::part::{ChunkMesh, ChunkPart};
use crate::mesh::{bridges, buildings, ground, streets};
use crate::surface::{Pieces, has_surface};
use crate::terrain::Terrain;

/// Builds the meshes of a chunk. `terrain` is the terrain that the chunk's ground was sampled from.
///
/// Vertices of ground and streets on the chunk's border have the same bits in the meshes of its neighbours, whatever their detail.
///
/// # Errors
///
/// [`LayerError::Cancelled`] when `cancel` is set.
pub fn build(chunk: &Chunk, terrain: &dyn Terrain, detail: Detail, cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
    let full = detail == Detail::Full;
    let mut footing = Footing::new(chunk, terrain);
    let mut mesh = ChunkMesh::default();
    mesh[ChunkPart::Ground] = ground::ground(chunk, terrain, full);
    mesh[ChunkPart::Water] = ground::water(chunk);
    cancel.check()?;
    mesh[ChunkPart::Roads] = streets::streets(chunk, full);
    let roads = &mut mesh[ChunkPart::Roads];
    for street in chunk.streets_here().filter(|s| s.bridge && has_surface(s)) {
        let pieces = Pieces::new(street);
        let own: Vec<usize> = chunk.own_pieces(&pieces).collect();
        if let Some(deck) = chunk.decks.iter().find(|d| d.street == street.id) {
            bridges::bridge(&mut footing, roads, deck, street, &pieces, &own);
        }
    }
    cancel.check()?;
    let (solids, panes) = buildings::buildings(chunk, &mut footing, full);
    mesh[ChunkPart::Buildings] = solids;
    mesh[ChunkPart::Windows] = panes;
    Ok(mesh)
}
