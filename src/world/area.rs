//! Everything in a box, whoever owns it.

use crate::chunk::PlacedStreet;
use crate::network::{Junction, Network};
use crate::parcel::{Block, Footprint, Lot};
use crate::region::Settlement;
use crate::space::{Bounds, ChunkCoord, Origin};
use std::sync::Arc;

/// A thing and the chunk that owns it.
#[derive(Clone, Debug, PartialEq)]
pub struct Owned<T> {
    /// The chunk.
    pub chunk: ChunkCoord,
    /// The thing.
    pub it: T,
}

/// Everything that overlaps a box. Positions are local to `origin`.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// The whole-metre point below the middle of the box.
    pub origin: Origin,
    /// The box that was asked for, in plan metres.
    pub bounds: Bounds,
    /// Streets and roads that overlap the box, whole; sorted by id.
    pub streets: Vec<Owned<PlacedStreet>>,
    /// Junctions at the ends of these, wherever they lie; sorted by id.
    pub junctions: Vec<Owned<Junction>>,
    /// Blocks of the main cells that overlap the box.
    pub blocks: Vec<Owned<Block>>,
    /// Lots of these.
    pub lots: Vec<Owned<Lot>>,
    /// Buildings of these.
    pub footprints: Vec<Owned<Footprint>>,
    /// Settlements whose outline overlaps the box, sorted by id.
    pub settlements: Vec<Arc<Settlement>>,
    /// Number of unmet ports in the main cells that overlap the box.
    pub unmet_ports: usize,
}

impl Area {
    /// Streets and junctions alone.
    pub fn network(&self) -> Network {
        Network {
            junctions: self.junctions.iter().map(|j| j.it).collect(),
            streets: self.streets.iter().map(|s| s.it.street.clone()).collect(),
        }
    }
}
