//! How main cells are begun.

use super::mix::Blend;
use crate::layer::{RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// How the filler `SemanticPatches` begins a main cell (Teng 2017, section 3.2), as shares from 0 to 1. What a share asks for is
/// built where the cell has room for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StartRules {
    /// Share of the attachment points of main streets that begin with an initial patch. At the others a street grows. Opposite
    /// a closed pattern along a main street an initial patch is tried in any case (Teng 2017, Fig. 5.3).
    pub initial_patches: f64,
    /// Share of the cells that begin with a pattern along a main street.
    pub patterns_along: f64,
    /// Share of the cells that begin with a pattern from one main street to another.
    pub patterns_between: f64,
    /// Share of the street ends from which a pattern is tried while the cell fills.
    pub patterns_onwards: f64,
}

impl Default for StartRules {
    fn default() -> Self {
        Self { initial_patches: 0.34, patterns_along: 0.4, patterns_between: 0.3, patterns_onwards: 0.06 }
    }
}

impl Ranged for StartRules {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { initial_patches, patterns_along, patterns_between, patterns_onwards } = self;
        walk.number("initial_patches", initial_patches, 0.0, 1.0)?;
        walk.number("patterns_along", patterns_along, 0.0, 1.0)?;
        walk.number("patterns_between", patterns_between, 0.0, 1.0)?;
        walk.number("patterns_onwards", patterns_onwards, 0.0, 1.0)
    }
}

impl StartRules {
    /// The rules between `a` and `b`.
    pub(super) fn mix(a: &Self, b: &Self, blend: &mut Blend) -> Self {
        Self {
            initial_patches: blend.number(a.initial_patches, b.initial_patches),
            patterns_along: blend.number(a.patterns_along, b.patterns_along),
            patterns_between: blend.number(a.patterns_between, b.patterns_between),
            patterns_onwards: blend.number(a.patterns_onwards, b.patterns_onwards),
        }
    }
}
