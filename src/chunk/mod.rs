//! Layer 10: what a chunk owns, and the ground under it. Reads everything that overlaps the chunk's square; the padding is 0
//! for roads and terrain, and the largest settlement radius for towns.

mod assemble;
mod ground;

pub use assemble::assemble;
pub use ground::Ground;

use crate::network::{Junction, Street};
use crate::parcel::{Block, Footprint, Lot};
use crate::region::Settlement;
use crate::space::{ChunkCoord, Origin};
use crate::stack::PlacedStreet;
use crate::surface::Deck;
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
    /// The ground, on a grid over the square.
    pub ground: Ground,
    /// Junctions in the square, sorted by id.
    pub junctions: Vec<Junction>,
    /// Streets whose midpoint lies in the square, sorted by id. Their ends may lie in other chunks: join by id.
    pub streets: Vec<PlacedStreet>,
    /// Streets of other chunks that end at one of `junctions`, sorted by id: with them every street at a junction is known.
    pub arriving: Vec<Street>,
    /// Blocks of the chunk's main cells.
    pub blocks: Vec<Block>,
    /// Lots of the chunk's main cells.
    pub lots: Vec<Lot>,
    /// Buildings of the chunk's main cells.
    pub footprints: Vec<Footprint>,
    /// Settlements whose outline overlaps the square, sorted by id.
    pub settlements: Vec<Arc<Settlement>>,
    /// Decks of all bridges over the square, whichever chunks own the bridges.
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
            ground,
            junctions: Vec::new(),
            streets: Vec::new(),
            arriving: Vec::new(),
            blocks: Vec::new(),
            lots: Vec::new(),
            footprints: Vec::new(),
            settlements: Vec::new(),
            decks: Vec::new(),
            unmet_ports: 0,
        }
    }

    /// Height of the surface that a walker stands on at a local point, in metres: the drawn ground, or the deck of a bridge over
    /// it. Only decks at most `below` metres high count, so that a walker can be under a bridge. `None` outside the square.
    pub fn surface(&self, local: DVec2, below: f64) -> Option<f64> {
        let decks = self.decks.iter().filter_map(|d| d.height(local)).filter(|h| *h <= below);
        Some(decks.fold(self.ground.height(local)?, f64::max))
    }
}
