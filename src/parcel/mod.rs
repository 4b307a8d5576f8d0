//! Layer 8: blocks, lots, footprints and parks of a main cell. Reads the cell, the streets in and around it, the surface that they
//! cover, and the drawn ground below buildings, so the padding is that of the town.

mod blocks;
mod brief;
mod convex;
mod divide;
mod footprints;
mod given;
mod land;
mod lots;
mod runs;
#[cfg(test)]
pub(crate) mod tests;

pub use brief::ParcelBrief;
pub use divide::divide;
pub use land::{Block, BlockUse, CellParcels, Footprint, Lot, STOREY_HEIGHT};
