//! The lanes of a chunk.

use crate::chunk::Chunk;
use crate::network::{JunctionId, Side};
use crate::surface::{JunctionTurns, Lane, ends_by_junction, lanes_of, turns_at};

/// Where traffic drives in a chunk. Lanes of neighbouring chunks join by id. Positions are local to the chunk's origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChunkLanes {
    /// Lanes of the streets that the chunk owns, by street.
    pub lanes: Vec<Lane>,
    /// Turns through the junctions that the chunk owns, by junction. Their lanes may belong to streets of other chunks.
    pub junctions: Vec<JunctionTurns>,
}

impl Chunk {
    /// The lanes of the chunk's streets and the turns through its junctions, where traffic drives on the side `driving`.
    pub fn lanes(&self, driving: Side) -> ChunkLanes {
        let lanes = self.streets.iter().flat_map(|s| lanes_of(&s.street, driving)).collect();
        let ends = ends_by_junction(self.streets.iter().map(|s| &s.street).chain(&self.arriving));
        let turns = |id: JunctionId| turns_at(id, ends.get(&id).map_or(&[], Vec::as_slice), driving);
        ChunkLanes { lanes, junctions: self.junctions.iter().map(|j| turns(j.id)).collect() }
    }
}
