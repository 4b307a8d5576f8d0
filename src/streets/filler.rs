//! The contract between a main cell and what fills it.

use crate::layer::{Cancel, LayerError, Weigh};
use crate::network::{Junction, JunctionId, Street};
use crate::patch::PatchBuilding;
use crate::seam::CellPort;
use crate::space::Seed;
use crate::style::{FieldKind, LocalRules, Style};
use crate::town::{CellId, DirectionField};
use glam::DVec2;
use std::fmt::Debug;
use std::sync::Arc;

/// All that a [`CellFiller`] is told about a main cell. Positions are local to the town, in metres.
#[derive(Clone, Copy)]
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
    /// What kind of field that is: how strictly streets follow it.
    pub field_kind: FieldKind,
    /// What the style asks of local streets.
    pub rules: &'a LocalRules,
}

/// Something that the user wants in a certain place: a piece of those that a filler lays.
#[derive(Clone, Debug, PartialEq)]
pub struct PinnedPiece {
    /// Name of the piece; the filler knows what it stands for.
    pub piece: String,
    /// Where its centre lies, local to the town, in metres. Of a patch, that is the centre of its bounding circle.
    pub at: DVec2,
    /// Angle by which it is turned against its drawing, in radians, counter-clockwise.
    pub turned: f64,
    /// Whether it is mirrored at its x axis, before it is turned.
    pub mirrored: bool,
}

/// A main cell that a filler is prepared for.
pub struct CellToFill<'a> {
    /// The cell.
    pub brief: CellBrief<'a>,
    /// The style of the cell, mixed from `styles`; it names the filler.
    pub style: &'a Style,
    /// The styles that are mixed in the cell, in the order of their names, with their shares, which sum to 1.
    pub styles: &'a [(Arc<Style>, f64)],
    /// What the user wants to stand in the cell, in order.
    pub pinned: Vec<PinnedPiece>,
}

/// The main cells of a town that name the same filler.
pub struct TownToFill<'a> {
    /// The styles of the town itself. What another style asks for at least is not asked of this town, even if a part of it reaches
    /// in at the border.
    pub styles: Vec<&'a Style>,
    /// The cells.
    pub cells: Vec<CellToFill<'a>>,
}

/// What fills the main cells of a town.
#[derive(Clone, Debug, Default)]
pub struct FilledTown {
    /// What fills each cell, in the order of [`TownToFill::cells`].
    pub fillers: Vec<Arc<dyn CellFiller>>,
    /// The counts that the town does not keep.
    pub short_counts: Vec<ShortCount>,
}

/// A piece of which fewer stand in a town than a style asks for at least: its main cells have no room for more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShortCount {
    /// Name of the style.
    pub style: String,
    /// Name of the piece.
    pub piece: String,
    /// Number of main cells in which it should stand ([`PatchCount::at_least`](crate::style::PatchCount::at_least)).
    pub at_least: u32,
    /// Number of main cells of the style in which it does.
    pub stands: u32,
}

/// A filler with the rules and assets that it needs in a world, made once for the world's styles and assets.
pub trait Filler: Send + Sync {
    /// Prepares the filler for the cells of a town. It is a pure function of the town, the styles and the assets.
    fn prepare(&self, town: &TownToFill<'_>) -> Result<FilledTown, LayerError>;

    /// Whether there is a piece of this name that can be pinned.
    fn has_piece(&self, name: &str) -> bool;
}

/// Fills a main cell with local streets: a pure function of the brief and of what it was prepared with.
///
/// Streets stay inside the border; no two cross or touch without a junction; every street is connected to a port; every
/// port is met; the rules of the style hold but for [`CellStreets::exceptions`], and streets that do not meet keep 14 m in any
/// case, 12 m at dead ends. The first metres of a port's street are as near to the border as its stub.
pub trait CellFiller: Debug + Send + Sync + Weigh {
    /// Fills the cell. Fails only when it is cancelled.
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError>;
}

/// What made a local street.
///
/// The names stay what they are while the world's styles and patch sets do, and mean the same in every chunk: a piece of
/// `SemanticPatches` is called `set/patch`, after the patch set and the patch in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MadeBy {
    /// The filler, as a style's `filler` names it.
    pub filler: &'static str,
    /// What the filler made the street of.
    pub origin: StreetOrigin,
}

/// What a filler made a street of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StreetOrigin {
    /// The street grew by parameters alone.
    Growth,
    /// The street was added to mend the network.
    Repair,
    /// The greatest part of the street is from the piece of this name.
    Piece(Arc<str>),
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
    /// Pinned pieces that were left out, in order.
    pub left_out: Vec<LeftOut>,
    /// Names of the pieces that should stand here because a style counts them, and that no street could reach.
    pub missing: Vec<Arc<str>>,
    /// How often each piece was laid, by its name, whatever repair and fairing left of it. Pieces that were not are not named.
    pub laid: Vec<(Arc<str>, u32)>,
    /// Where the streets break a rule of the style.
    pub exceptions: Vec<Exception>,
    /// Buildings that come with the streets, such as those of the maps that pieces are cut out of; local to the town, in metres. They
    /// overlap no other one, but may overlap streets: they stand where the streets' surface leaves room.
    pub buildings: Vec<PatchBuilding>,
}

/// A place where local streets break a rule of their style ([`LocalRules`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exception {
    /// The rule.
    pub rule: Rule,
    /// What made it necessary.
    pub cause: Cause,
    /// Where, in metres, local to the town.
    pub at: DVec2,
}

/// A rule that every local street keeps (Teng 2017, section 3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// [`LocalRules::min_angle_deg`].
    Angle,
    /// [`LocalRules::min_length`].
    Length,
    /// The greatest number of streets of [`LocalRules::degree`].
    Degree,
    /// [`LocalRules::clearance`].
    Clearance,
}

impl Rule {
    /// The rule's word in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Length => "length",
            Self::Degree => "degree",
            Self::Clearance => "clearance",
        }
    }
}

/// What makes it necessary that a rule is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// A port: its street must begin there, and goes no farther than it can.
    Port,
    /// A pinned piece, or one that the style wants in any case.
    Pin,
    /// The drawing of a piece, whose streets keep their shape.
    Drawing,
    /// The cell, which is too narrow for the rule ([`LocalRules`]).
    Cell,
    /// Nothing: the filler has a defect.
    Defect,
}

impl Cause {
    /// The cause's word in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Port => "port",
            Self::Pin => "pin",
            Self::Drawing => "drawing",
            Self::Cell => "cell",
            Self::Defect => "defect",
        }
    }
}

/// A pinned piece that was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Index into [`CellToFill::pinned`].
    pub piece: usize,
    /// Why the piece was left out: the rest of a sentence that begins with "it".
    pub reason: &'static str,
}
