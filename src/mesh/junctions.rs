//! Junctions: the surface where streets meet, and the ends of the streets up to where the chunks that own them draw on.

use crate::chunk::Chunk;
use crate::mesh::buffers::MeshBuffers;
use crate::mesh::drape::Drape;
use crate::mesh::ribbon::{carriageway_colour, corner, ribbon};
use crate::network::Street;
use crate::surface::{JunctionShape, ROAD_LIFT};

/// The streets at each of the chunk's junctions, each with whether it begins there.
pub(super) fn ends(chunk: &Chunk) -> Vec<Vec<(&Street, bool)>> {
    let mut ends: Vec<Vec<(&Street, bool)>> = vec![Vec::new(); chunk.junctions.len()];
    for street in chunk.streets.iter().map(|s| &s.street).chain(&chunk.arriving) {
        for (id, begins) in [(street.from, true), (street.to, false)] {
            if let Ok(at) = chunk.junctions.binary_search_by_key(&id, |j| j.id) {
                ends[at].push((street, begins));
            }
        }
    }
    ends
}

/// Adds a junction and the ends of its streets.
pub(super) fn junction(drape: &mut Drape<'_>, out: &mut MeshBuffers, shape: &JunctionShape<'_>) {
    for arm in &shape.arms {
        ribbon(drape, out, &arm.line, arm.street.class);
        corner(drape, out, &arm.corner);
    }
    let Some(widest) = shape.arms.iter().map(|arm| arm.street.class).min() else { return };
    let ring = &shape.carriageway;
    for i in 0..ring.len() {
        let triangle = [shape.at, ring[i], ring[(i + 1) % ring.len()]];
        drape.lay_triangle(out, triangle, ROAD_LIFT, carriageway_colour(widest));
    }
}
