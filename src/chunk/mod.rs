//! Layer 10: what a chunk owns, and the ground under it. Reads everything that overlaps the chunk's square; the padding is
//! [`SURFACE_REACH`](crate::surface::SURFACE_REACH) for streets, 0 for terrain, and the largest settlement radius for towns.

mod assemble;
mod ground;
mod lanes;

pub use assemble::assemble;
#[cfg(test)]
pub(crate) use assemble::tin;
pub use ground::Ground;
pub use lanes::ChunkLanes;

use crate::network::{Junction, Street};
use crate::parcel::{Block, Footprint, Lot};
use crate::region::Settlement;
use crate::space::{ChunkCoord, Origin};
use crate::stack::{PlacedStreet, owner_of};
use crate::surface::{Deck, Pieces, SurfaceKind, SurfacePoint, Tin};
use glam::DVec2;
use std::sync::Arc;

/// What a chunk owns, and the ground under it. Positions are local to `origin`.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// Name of the chunk.
    pub coord: ChunkCoord,
    /// South-west corner of the chunk.
    pub origin: Origin,
    /// Edge of the chunk in metres.
    pub size: i64,
    /// The natural ground, on a grid over the square.
    pub ground: Ground,
    /// Ground and streets in the square, whichever chunks own the streets: what is drawn and walked on.
    pub tin: Tin,
    /// Junctions in the square, sorted by id.
    pub junctions: Vec<Junction>,
    /// Streets whose midpoint lies in the square, sorted by id. Their ends may lie in other chunks: join by id.
    pub streets: Vec<PlacedStreet>,
    /// Streets of other chunks that end at one of `junctions`, sorted by id: with them every street at a junction is known.
    pub arriving: Vec<Street>,
    /// Further streets of other chunks that have a [piece](Pieces) in the square, sorted by id.
    pub passing: Vec<Street>,
    /// Blocks of the chunk's main cells.
    pub blocks: Vec<Block>,
    /// Lots of the chunk's main cells.
    pub lots: Vec<Lot>,
    /// Buildings of the chunk's main cells.
    pub footprints: Vec<Footprint>,
    /// Settlements whose outline overlaps the square, sorted by id.
    pub settlements: Vec<Arc<Settlement>>,
    /// Decks of all bridges over the square or its rim, whichever chunks own the bridges.
    pub decks: Vec<Deck>,
    /// Number of unmet ports in the chunk's main cells; 0 unless a filler has a defect.
    pub unmet_ports: usize,
}

impl Chunk {
    /// A chunk of edge `size` metres that owns nothing.
    pub(crate) fn empty(coord: ChunkCoord, size: i64, ground: Ground) -> Self {
        Self {
            coord,
            origin: coord.origin(size),
            size,
            tin: Tin::new(&[], size, |column, row| ground.vertex(column, row).height),
            ground,
            junctions: Vec::new(),
            streets: Vec::new(),
            arriving: Vec::new(),
            passing: Vec::new(),
            blocks: Vec::new(),
            lots: Vec::new(),
            footprints: Vec::new(),
            settlements: Vec::new(),
            decks: Vec::new(),
            unmet_ports: 0,
        }
    }

    /// All streets that have a piece in the square or end in it, whichever chunks own them; each once.
    pub fn streets_here(&self) -> impl Iterator<Item = &Street> {
        self.streets.iter().map(|s| &s.street).chain(&self.arriving).chain(&self.passing)
    }

    /// The pieces of a street that belong to this chunk: their indices among `pieces`. Every piece belongs to the chunk
    /// that holds its middle, and reaches at most half the [`LONGEST_PIECE`](crate::surface::LONGEST_PIECE) out of its square.
    pub fn own_pieces(&self, pieces: &Pieces<'_>) -> impl Iterator<Item = usize> {
        let (origin, coord, size) = (self.origin, self.coord, self.size);
        let own = move |middle: DVec2| owner_of(origin, middle, size) == coord;
        pieces.middles().enumerate().filter(move |(_, middle)| own(*middle)).map(|(piece, _)| piece)
    }

    /// Height of the surface that a walker stands on at a local point, in metres: the ground or a street on it, or the deck of a
    /// bridge over it. Only decks at most `below` metres high count, so that a walker can be under a bridge. `None` outside the
    /// square.
    pub fn surface(&self, local: DVec2, below: f64) -> Option<f64> {
        let decks = self.decks.iter().filter_map(|d| d.height(local)).filter(|h| *h <= below);
        Some(decks.fold(self.tin.at(local)?.height, f64::max))
    }

    /// The ground or the street at a local point, not counting decks. `None` outside the square.
    pub fn surface_at(&self, local: DVec2) -> Option<SurfacePoint> {
        let mut point = self.tin.at(local)?;
        if point.kind == SurfaceKind::Ground && point.height < self.ground.water_level(local)? {
            point.kind = SurfaceKind::Water;
        }
        Some(point)
    }
}
