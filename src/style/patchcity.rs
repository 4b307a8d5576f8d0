//! Rules of the filler `PatchCity`.

use super::mix::Blend;
use crate::layer::{RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// How the filler `PatchCity` lays the windows in a style's patch sets side by side (Bustard and de Valmency 2015).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PatchCityRules {
    /// Whether windows stand turned by quarter turns, too: four times as many tiles.
    pub quarter_turns: bool,
    /// Distance in metres up to which a street that the border of a main cell cuts off is led to a port: 0 to 200.
    pub port_reach: f64,
    /// About how large the parts of a town are, in metres, in which one map prevails where the patch sets hold windows of several:
    /// 50 to 10000.
    pub blend: f64,
}

impl PatchCityRules {
    /// The usual rules: quarter turns, ports up to 45 m away, and maps that prevail in parts of 500 m.
    pub const USUAL: Self = Self { quarter_turns: true, port_reach: 45.0, blend: 500.0 };

    /// The rules between `a` and `b`.
    pub(super) fn mix(a: &Self, b: &Self, blend: &mut Blend) -> Self {
        Self {
            quarter_turns: blend.choice(&a.quarter_turns, &b.quarter_turns),
            port_reach: blend.number(a.port_reach, b.port_reach),
            blend: blend.number(a.blend, b.blend),
        }
    }
}

impl Default for PatchCityRules {
    fn default() -> Self {
        Self::USUAL
    }
}

impl Ranged for PatchCityRules {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { quarter_turns: _, port_reach, blend } = self;
        walk.number("port_reach", port_reach, 0.0, 200.0)?;
        walk.number("blend", blend, 50.0, 10_000.0)
    }
}
