//! The style that takes over at the fringe of a settlement.

use crate::layer::{RangeError, Ranged, Walk};
use crate::space::math::smoothstep;
use serde::{Deserialize, Serialize};

/// How another style takes over from the centre of a settlement outwards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FringeRules {
    /// Name of the style of the fringe.
    pub style: String,
    /// Where it begins, as a share of the settlement's radius: 0 to 1.
    pub begins: f64,
    /// Where nothing is left of the style of the centre, likewise: from `begins` to 2.
    pub complete: f64,
}

impl Ranged for FringeRules {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { style: _, begins, complete } = self;
        walk.number("begins", begins, 0.0, 1.0)?;
        walk.number("complete", complete, *begins, 2.0)
    }
}

impl FringeRules {
    /// Share of the fringe's style at a distance from the centre, in radii of the settlement: 0 to 1.
    pub(super) fn share(&self, radii: f64) -> f64 {
        smoothstep(self.begins, self.complete.max(self.begins + 1e-6), radii)
    }
}
