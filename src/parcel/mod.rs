//! Layer 7: blocks, lots, footprints and parks of a main cell. Reads the cell and its streets; nothing outside the cell, so
//! the padding is that of the town.

mod blocks;
mod convex;
mod divide;
mod footprints;
mod lots;
#[cfg(test)]
pub(crate) mod tests;

pub use divide::divide;

use crate::network::{Street, StreetId};
use crate::space::Seed;
use crate::style::ParcelRules;
use crate::town::CellId;
use glam::DVec2;

/// All that is told about a main cell to divide it. Positions are local to the town.
pub struct ParcelBrief<'a> {
    /// The world's seed.
    pub seed: Seed,
    /// Name of the cell, the key of its random streams.
    pub id: CellId,
    /// Border, counter-clockwise; a main street that ends inside is walked on both sides.
    pub border: &'a [DVec2],
    /// Streets along the border and inside the cell.
    pub streets: &'a [&'a Street],
    /// Rules of the cell's style.
    pub rules: &'a ParcelRules,
    /// How central the cell is: 1 at the settlement's centre, 0 at its outline.
    pub centrality: f64,
}

/// What a block is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockUse {
    /// Lots with buildings.
    Built,
    /// A park, or land without room for a lot.
    Park,
}

/// Land between streets: its border is the outer edge of the pavements around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Stable name.
    pub id: u64,
    /// Counter-clockwise.
    pub polygon: Vec<DVec2>,
    /// Its use.
    pub used_as: BlockUse,
}

/// A parcel of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Lot {
    /// Stable name.
    pub id: u64,
    /// The block it is part of.
    pub block: u64,
    /// Counter-clockwise; its first edge is the frontage.
    pub polygon: Vec<DVec2>,
    /// The street that the frontage lies on.
    pub street: StreetId,
}

/// The ground plan of a building.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    /// Stable name.
    pub id: u64,
    /// The lot it stands on.
    pub lot: u64,
    /// Counter-clockwise.
    pub polygon: Vec<DVec2>,
    /// Number of storeys, at least 1.
    pub storeys: u32,
}

/// Blocks, lots and buildings of a main cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellParcels {
    /// Blocks.
    pub blocks: Vec<Block>,
    /// Lots with a frontage.
    pub lots: Vec<Lot>,
    /// Buildings, at most one a lot.
    pub footprints: Vec<Footprint>,
}
