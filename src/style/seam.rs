//! Rules of seams.

use super::mix::Blend;
use crate::layer::{RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// How local streets attach to main streets. Lengths in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SeamRules {
    /// Distance between attachment points of one side.
    pub spacing: f64,
    /// Greatest deviation of a point from even spacing, as a share of the spacing.
    pub jitter: f64,
    /// Least distance between two attachment points, and to the ends of the main street.
    pub min_spacing: f64,
    /// Distance along the street, as a share of the spacing (0 to 0.5), up to which points of the two sides become one crossing:
    /// with little of it most are T-junctions.
    pub crossing: f64,
    /// Number of attachment points (0 to 2) that every main cell gets at least, where there is room.
    pub least: u32,
}

impl Default for SeamRules {
    fn default() -> Self {
        Self { spacing: 95.0, jitter: 0.2, min_spacing: 36.0, crossing: 0.4, least: 2 }
    }
}

impl Ranged for SeamRules {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { spacing, jitter, min_spacing, crossing, least } = self;
        walk.number("spacing", spacing, 30.0, 1000.0)?;
        walk.number("jitter", jitter, 0.0, 0.45)?;
        walk.number("min_spacing", min_spacing, 30.0, *spacing)?;
        walk.number("crossing", crossing, 0.0, 0.5)?;
        walk.number("least", least, 0.0, 2.0)
    }
}

impl SeamRules {
    /// The rules between `a` and `b`.
    pub(super) fn mix(a: &Self, b: &Self, blend: &mut Blend) -> Self {
        Self {
            spacing: blend.number(a.spacing, b.spacing),
            jitter: blend.number(a.jitter, b.jitter),
            min_spacing: blend.number(a.min_spacing, b.min_spacing),
            crossing: blend.number(a.crossing, b.crossing),
            least: blend.counts((a.least, a.least), (b.least, b.least)).0,
        }
    }
}
