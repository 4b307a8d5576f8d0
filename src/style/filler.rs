//! What fills the main cells, and how often single patches are used.

use super::mix::Blend;
use super::patchcity::PatchCityRules;
use crate::layer::{Choice, RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// What fills the main cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Filler {
    /// Patches chosen by their semantics, with parametric growth where none fits (Teng 2017).
    #[default]
    SemanticPatches,
    /// Parametric growth alone (Teng 2017, Fig. 3).
    Parametric,
    /// Windows of maps side by side (Bustard and de Valmency 2015): the windows in the style's patch sets that its tags allow. Streets
    /// grow where there are none.
    PatchCity(PatchCityRules),
}

impl Filler {
    /// Every filler, with its usual rules.
    pub const ALL: [Self; 3] = [Self::SemanticPatches, Self::Parametric, Self::PatchCity(PatchCityRules::USUAL)];

    /// The name of the filler, without its rules.
    pub fn name(self) -> &'static str {
        match self {
            Self::SemanticPatches => "SemanticPatches",
            Self::Parametric => "Parametric",
            Self::PatchCity(_) => "PatchCity",
        }
    }

    /// Whether both are the same filler, whatever their rules.
    pub fn is(self, other: Self) -> bool {
        self.name() == other.name()
    }

    /// The filler of `a` or `b`; the rules between both where it is the same.
    pub(super) fn mix(a: &Self, b: &Self, blend: &mut Blend) -> Self {
        match (a, b) {
            (Self::PatchCity(a), Self::PatchCity(b)) => Self::PatchCity(PatchCityRules::mix(a, b, blend)),
            _ => blend.choice(a, b),
        }
    }
}

impl Ranged for Filler {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let mut kind = Self::ALL.into_iter().find(|filler| filler.is(*self)).unwrap_or_default();
        walk.choice("kind", &mut kind)?;
        if !kind.is(*self) {
            *self = kind;
        }
        match self {
            Self::PatchCity(rules) => rules.walk(walk),
            Self::SemanticPatches | Self::Parametric => Ok(()),
        }
    }
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
