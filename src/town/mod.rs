//! Layer 4: a settlement's main streets and main cells, planned whole. Reads terrain, the settlement with its outline and
//! its gates; everything lies within the outline, so the padding is the settlement's radius. Streets along the borders with
//! settlements that it touches come from the outline, so the plans of both hold the same.

mod field;
mod plan;
#[cfg(test)]
pub(crate) mod sample;

pub use field::DirectionField;
pub use plan::plan;

use crate::network::{Junction, Street};
use crate::region::{Border, Gate, Outline, Settlement};
use crate::space::Origin;
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Stable name of a main cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CellId(pub u64);

/// A main street between two junctions of main streets.
#[derive(Clone, Debug, PartialEq)]
pub struct MainStreet {
    /// The whole street, not yet divided by ports.
    pub street: Street,
    /// Index of the main cell on its left, going along the line.
    pub left: usize,
    /// Index of the main cell on its right (the same as `left` for a street that runs into a cell and ends).
    pub right: usize,
    /// The border with another settlement that it is a part of. That settlement has the same street, and the cell on one
    /// side: here it is [`MainStreet::OUTSIDE`].
    pub border: Option<Arc<Border>>,
}

impl MainStreet {
    /// Stands for a cell of another settlement.
    pub const OUTSIDE: usize = usize::MAX;
}

/// A run of border edges of a main cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellSide {
    /// Main street that the side runs along, as index into [`Town::mains`]; `None` where the cell ends without a street
    /// (the town's outline, the banks of a river, and cuts across the fringe).
    pub main: Option<usize>,
    /// Whether the cell's border runs along the street's line (true) or against it.
    pub forward: bool,
    /// Index of the first border edge; edge i runs from `border[i]` to the next point.
    pub first: usize,
    /// Number of border edges.
    pub count: usize,
}

/// What a main cell is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellUse {
    /// Local streets and buildings.
    Built,
    /// An open place between main streets, such as the island of a roundabout: no street attaches to its sides.
    Open,
    /// A river between its banks; main streets lead over it on bridges.
    Water,
}

/// Face of the planar graph of main streets and town outline: the unit of filling.
#[derive(Clone, Debug, PartialEq)]
pub struct MainCell {
    /// Stable name.
    pub id: CellId,
    /// What it is for.
    pub used_as: CellUse,
    /// Border, counter-clockwise, with the cell on its left. A main street that ends inside the cell is walked on both
    /// sides, so points may repeat.
    pub border: Vec<DVec2>,
    /// Sides, which cover the border edges in order.
    pub sides: Vec<CellSide>,
    /// Pole of inaccessibility: the chunk that holds it owns the cell.
    pub anchor: DVec2,
}

/// A settlement planned whole. Positions are local to `origin`.
#[derive(Clone, Debug)]
pub struct Town {
    /// The settlement.
    pub settlement: Arc<Settlement>,
    /// The settlement's centre.
    pub origin: Origin,
    /// Its outline.
    pub outline: Arc<Outline>,
    /// Where roads enter, and where main streets cross a border; each is the end of a main street.
    pub gates: Vec<Gate>,
    /// Directions that streets follow.
    pub field: DirectionField,
    /// Junctions of main streets, gates included.
    pub junctions: Vec<Junction>,
    /// Main streets; they form one component.
    pub mains: Vec<MainStreet>,
    /// Main cells; together they cover the outline.
    pub cells: Vec<MainCell>,
}
