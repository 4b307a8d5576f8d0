//! A planned settlement: its main streets and main cells.

use super::field::DirectionField;
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
    /// The border with another settlement along which the street runs. The other settlement has the same street and the cell
    /// on one side of it; on that side the index here is [`MainStreet::OUTSIDE`].
    pub border: Option<Arc<Border>>,
}

impl MainStreet {
    /// Index of a cell that belongs to another settlement.
    pub const OUTSIDE: usize = usize::MAX;
}

/// A run of border edges of a main cell along one main street, or along none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellSide {
    /// Main street that the side runs along, as an index into [`Town::mains`]; `None` where the cell ends without a street:
    /// at the town's outline, at the banks of a river, and at cuts across the fringe.
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
    /// A river between its banks; main streets cross it on bridges.
    Water,
}

/// Face of the planar graph of main streets and town outline: the unit of filling.
#[derive(Clone, Debug, PartialEq)]
pub struct MainCell {
    /// Stable name.
    pub id: CellId,
    /// What the cell is for.
    pub cell_use: CellUse,
    /// Border, counter-clockwise. A main street that ends inside the cell is walked on both sides, so points may repeat.
    pub border: Vec<DVec2>,
    /// Sides, which cover the border edges in order.
    pub sides: Vec<CellSide>,
    /// Pole of inaccessibility: the chunk that contains this point owns the cell.
    pub anchor: DVec2,
}

/// A settlement planned whole. Positions are local to `origin`, in metres.
#[derive(Clone, Debug)]
pub struct Town {
    /// The settlement.
    pub settlement: Arc<Settlement>,
    /// The settlement's centre.
    pub origin: Origin,
    /// The settlement's outline.
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
