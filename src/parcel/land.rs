//! Blocks, lots and footprints.

use crate::network::StreetId;
use glam::DVec2;

/// Height of a storey, in metres.
pub const STOREY_HEIGHT: f64 = 3.0;

/// What a block is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockUse {
    /// Divided into lots.
    Built,
    /// A park, or land without room for a lot.
    Park,
}

/// Land between streets. Its border is the outer edge of the pavements around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Stable name.
    pub id: u64,
    /// Border, counter-clockwise, in local metres.
    pub polygon: Vec<DVec2>,
    /// What the block is used for.
    pub land_use: BlockUse,
}

/// A parcel of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Lot {
    /// Stable name.
    pub id: u64,
    /// The block that the lot is a part of.
    pub block: u64,
    /// Border, counter-clockwise, in local metres. The first edge is the frontage.
    pub polygon: Vec<DVec2>,
    /// The street that the frontage lies on.
    pub street: StreetId,
}

/// The outline of a building on the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    /// Stable name.
    pub id: u64,
    /// The lot that the building stands on.
    pub lot: u64,
    /// Outline, counter-clockwise, in local metres.
    pub polygon: Vec<DVec2>,
    /// Number of storeys, at least 1.
    pub storeys: u32,
    /// Height of the ground floor, in metres.
    pub base: f64,
    /// Height of the walls above the ground floor, in metres. A pitched roof rises above them.
    pub height: f64,
}

/// Blocks, lots and buildings of a main cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellParcels {
    /// Blocks.
    pub blocks: Vec<Block>,
    /// Lots with a frontage.
    pub lots: Vec<Lot>,
    /// Buildings, at most one for each lot.
    pub footprints: Vec<Footprint>,
}

fn moved(polygon: &[DVec2], offset: DVec2) -> Vec<DVec2> {
    polygon.iter().map(|p| *p + offset).collect()
}

impl Block {
    /// The same block with every point moved by `offset`.
    pub fn moved(&self, offset: DVec2) -> Self {
        Self { polygon: moved(&self.polygon, offset), ..self.clone() }
    }
}

impl Lot {
    /// The same lot with every point moved by `offset`.
    pub fn moved(&self, offset: DVec2) -> Self {
        Self { polygon: moved(&self.polygon, offset), ..self.clone() }
    }
}

impl Footprint {
    /// The same footprint with every point moved by `offset`.
    pub fn moved(&self, offset: DVec2) -> Self {
        Self { polygon: moved(&self.polygon, offset), ..self.clone() }
    }
}
