//! What fills the main cells, and how often single patches are used.

use crate::layer::{Choice, RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// What fills the main cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Filler {
    /// Patches chosen by their semantics, with parametric growth where none fits (Teng 2017).
    #[default]
    SemanticPatches,
    /// Parametric growth alone (Teng 2017, Fig. 3).
    Parametric,
}

impl Filler {
    /// Every filler.
    pub const ALL: [Self; 2] = [Self::SemanticPatches, Self::Parametric];
}

/// How often a patch is used in a settlement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatchCount {
    /// Name of the patch.
    pub patch: String,
    /// Number of main cells of this style in which it stands in any case, as far as there are cells that have room for it. What
    /// falls short is said ([`ShortCount`](crate::streets::ShortCount)).
    #[serde(default)]
    pub at_least: u32,
    /// Greatest number of times that it is used in the settlement's main cells of this style, once in a cell; no limit when not
    /// given. A cell that is mixed of several styles keeps to the counts of each.
    #[serde(default)]
    pub at_most: Option<u32>,
    /// What its weight is multiplied by: 0 to 1000.
    #[serde(default = "one")]
    pub weight: f64,
}

fn one() -> f64 {
    1.0
}

impl Choice for Filler {
    const CHOICES: &'static [Self] = &Self::ALL;
}

impl Ranged for PatchCount {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { patch: _, at_least, at_most, weight } = self;
        walk.number("weight", weight, 0.0, 1000.0)?;
        walk.number("at_least", at_least, 0.0, u32::MAX.into())?;
        let Some(at_most) = at_most else { return Ok(()) };
        walk.number("at_most", at_most, (*at_least).into(), u32::MAX.into())
    }
}
