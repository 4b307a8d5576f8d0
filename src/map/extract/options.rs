//! What patches are extracted, and why a part of a map makes none.

use crate::patch::DrawingErrorKind;

/// How a map is divided into patches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PatchKind {
    /// Square windows, for the filler `PatchCity`.
    #[default]
    Windows,
    /// Connected pieces of local streets, for the filler `SemanticPatches`.
    Pieces,
}

/// What patches are extracted, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtractOptions {
    /// How maps are divided.
    pub kind: PatchKind,
    /// Edge of a window, or greatest width of a piece, in metres: 40 to 1000.
    pub size: f64,
    /// Distance between the middles of windows, or of the junctions around which pieces are cut, in metres: 2 or more.
    pub interval: f64,
    /// How far beyond a window its streets are drawn, in metres: 0 to `size`.
    pub margin: f64,
    /// Angle in degrees, counter-clockwise from east, that the x axis of windows has in the map. `None` takes the direction
    /// that most streets have, so that the streets of a grid run along the edges of windows.
    pub turn_deg: Option<f64>,
    /// Least length of streets in a patch, in metres.
    pub least_streets: f64,
    /// Whether patches of the same shape are all kept.
    pub keep_duplicates: bool,
    /// Greatest number of patches, of all maps together; the most varied are kept. `None` keeps all.
    pub most: Option<usize>,
}

impl Default for ExtractOptions {
    fn default() -> Self {
        Self {
            kind: PatchKind::Windows,
            size: 200.0,
            interval: 50.0,
            margin: 20.0,
            turn_deg: None,
            least_streets: 150.0,
            keep_duplicates: false,
            most: None,
        }
    }
}

/// An option of [`ExtractOptions`] that is out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{option}` is {value}; allowed is {low} to {high}")]
pub struct ExtractError {
    /// The option.
    pub option: &'static str,
    /// Its value.
    pub value: f64,
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
}

/// Why a part of a map makes no patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoPatch {
    /// The streets in it are too short ([`ExtractOptions::least_streets`]).
    FewStreets,
    /// Streets cross or touch without a junction, even after the map was tidied.
    Touching,
    /// Two streets leave a junction at too small an angle.
    SharpAngle,
    /// Its streets have too many points.
    TooLarge,
    /// Nothing leads on from it.
    Closed,
    /// Its streets are too short or too near each other for any cell.
    Crowded,
    /// A patch of the same shape is there.
    Duplicate,
    /// More varied patches were kept ([`ExtractOptions::most`]).
    LessVaried,
}

impl NoPatch {
    /// The reason as a key of JSON reports.
    pub fn key(self) -> &'static str {
        match self {
            Self::FewStreets => "few_streets",
            Self::Touching => "touching",
            Self::SharpAngle => "sharp_angle",
            Self::TooLarge => "too_large",
            Self::Closed => "closed",
            Self::Crowded => "crowded",
            Self::Duplicate => "duplicate",
            Self::LessVaried => "less_varied",
        }
    }

    pub(super) fn of(kind: DrawingErrorKind) -> Self {
        match kind {
            DrawingErrorKind::SharpAngle => Self::SharpAngle,
            DrawingErrorKind::TooManyVertices => Self::TooLarge,
            DrawingErrorKind::Touching | DrawingErrorKind::Other => Self::Touching,
        }
    }
}

impl std::fmt::Display for NoPatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::FewStreets => "with too few streets",
            Self::Touching => "with streets that touch",
            Self::SharpAngle => "with a sharp angle",
            Self::TooLarge => "with too many points",
            Self::Closed => "from which nothing leads on",
            Self::Crowded => "too crowded",
            Self::Duplicate => "of the same shape",
            Self::LessVaried => "less varied",
        })
    }
}
