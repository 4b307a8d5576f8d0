//! The contract between a main cell and what fills it.

use crate::layer::{Cancel, LayerError};
use crate::network::{Junction, JunctionId, Street};
use crate::patch::PatchDatabase;
use crate::seam::CellPort;
use crate::space::Seed;
use crate::style::Style;
use crate::town::{CellId, DirectionField};
use glam::DVec2;

/// All that a [`CellFiller`] is told about a main cell. Positions are local to the town.
pub struct CellBrief<'a> {
    /// The world's seed.
    pub seed: Seed,
    /// Name of the cell, the key of its random streams.
    pub id: CellId,
    /// Border, counter-clockwise, as [`crate::town::MainCell::border`].
    pub border: &'a [DVec2],
    /// For each border edge, half the width of the main street that runs along it, `None` where there is no street.
    pub street_half_width: &'a [Option<f64>],
    /// Ports; each must be met.
    pub ports: &'a [CellPort],
    /// Preferred directions.
    pub field: &'a DirectionField,
    /// Style of the cell.
    pub style: &'a Style,
    /// Patches that the style may use.
    pub patches: &'a PatchDatabase,
    /// Weight of each of these patches in this cell, 0 for one that may not be used here.
    pub weights: &'a [f64],
    /// Patches that stand in the cell whatever grows around them. They keep to the border and to each other as streets do.
    pub pinned: &'a [PinnedPatch],
}

/// A patch with its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinnedPatch {
    /// Index into [`PatchDatabase::patches`].
    pub patch: usize,
    /// Where the centre of its bounding circle lies, local to the town, in metres.
    pub at: DVec2,
    /// Angle by which it is turned against its drawing, in radians, counter-clockwise.
    pub turned: f64,
    /// Whether it is mirrored at its x axis, before it is turned.
    pub mirrored: bool,
}

/// What made a local street.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MadeBy {
    /// A patch: index into [`PatchDatabase::patches`].
    Patch(u32),
    /// Parametric growth.
    Growth,
    /// Repair: a connection that was added to mend the network.
    Repair,
}

/// A local street.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalStreet {
    /// The street.
    pub street: Street,
    /// What made it.
    pub made_by: MadeBy,
}

/// The local streets of a main cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellStreets {
    /// Junctions inside the cell; those of the ports are not repeated.
    pub junctions: Vec<Junction>,
    /// Streets between these and the ports.
    pub streets: Vec<LocalStreet>,
    /// Ports that no street reaches. A filler that leaves one here has a defect.
    pub unmet: Vec<JunctionId>,
    /// Pinned patches that were left out, as indices into [`CellBrief::pinned`] in order: they do not keep to the border, to
    /// a port or to one before them, break the rules in themselves, or no street can reach them.
    pub unfit: Vec<usize>,
}

/// Fills a main cell with local streets: a pure function of the brief.
///
/// Streets stay inside the border; no two cross or touch without a junction; every street is connected to a port; every
/// port is met; streets that do not meet keep the style's clearance where they can, and 14 m in any case, 12 m at dead
/// ends. The first metres of a port's street are as near to the border as its stub.
pub trait CellFiller: Send + Sync {
    /// Fills one cell.
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError>;
}
