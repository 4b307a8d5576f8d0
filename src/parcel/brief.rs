//! The input for dividing a main cell.

use crate::network::Street;
use crate::patch::PatchBuilding;
use crate::space::{Origin, Seed};
use crate::style::ParcelRules;
use crate::terrain::GroundTiles;
use crate::town::CellId;
use glam::DVec2;

/// A main cell to divide, with its streets and the rules of its style. Positions are local to the town, in metres.
pub struct ParcelBrief<'a> {
    /// The world's seed.
    pub seed: Seed,
    /// Name of the cell, which is the key of its random streams.
    pub id: CellId,
    /// Border, counter-clockwise. It runs along both sides of a main street that ends inside the cell.
    pub border: &'a [DVec2],
    /// Streets along the border and inside the cell.
    pub streets: &'a [&'a Street],
    /// Buildings that come with the streets, which stand where they collide with no street.
    pub buildings: &'a [PatchBuilding],
    /// Rules of the cell's style.
    pub rules: &'a ParcelRules,
    /// Position of the cell, from 0 at the settlement's outline to 1 at its centre.
    pub centrality: f64,
    /// The ground, which buildings stand on.
    pub ground: &'a GroundTiles,
    /// Plan point that positions are local to.
    pub origin: Origin,
}
