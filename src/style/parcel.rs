//! Rules of lots and buildings.

use super::mix::Blend;
use crate::layer::{RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// How blocks become lots and buildings. Lengths in metres, areas in square metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ParcelRules {
    /// Least and greatest frontage of a lot.
    pub lot_width: (f64, f64),
    /// Greatest depth of a lot.
    pub lot_depth: f64,
    /// Least area of a lot that is built on.
    pub min_area: f64,
    /// Distance from the frontage to the building.
    pub setback_front: f64,
    /// Distance from the lot's other sides to the building.
    pub setback_side: f64,
    /// Greatest depth of a building.
    pub building_depth: f64,
    /// Share of the houses in closed rows that have a wing along one side of the yard behind them.
    pub wings: f64,
    /// Least and greatest number of storeys; the centre has the most.
    pub storeys: (u32, u32),
    /// Share of lots that stay empty.
    pub vacant: f64,
    /// Share of blocks that become parks.
    pub parks: f64,
}

impl Default for ParcelRules {
    fn default() -> Self {
        Self {
            lot_width: (14.0, 24.0),
            lot_depth: 34.0,
            min_area: 120.0,
            setback_front: 3.0,
            setback_side: 1.5,
            building_depth: 14.0,
            wings: 0.0,
            storeys: (1, 4),
            vacant: 0.05,
            parks: 0.04,
        }
    }
}

impl Ranged for ParcelRules {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self {
            lot_width,
            lot_depth,
            min_area,
            setback_front,
            setback_side,
            building_depth,
            wings,
            storeys,
            vacant,
            parks,
        } = self;
        walk.pair("lot_width", lot_width, 4.0, 500.0)?;
        walk.number("lot_depth", lot_depth, 8.0, 500.0)?;
        walk.number("min_area", min_area, 20.0, 100_000.0)?;
        walk.number("setback_front", setback_front, 0.0, 100.0)?;
        walk.number("setback_side", setback_side, 0.0, 100.0)?;
        walk.number("building_depth", building_depth, 4.0, 200.0)?;
        walk.number("wings", wings, 0.0, 1.0)?;
        walk.pair("storeys", storeys, 1.0, 100.0)?;
        walk.number("vacant", vacant, 0.0, 1.0)?;
        walk.number("parks", parks, 0.0, 1.0)
    }
}

impl ParcelRules {
    /// The rules between `a` and `b`.
    pub(super) fn mix(a: &Self, b: &Self, blend: &mut Blend) -> Self {
        Self {
            lot_width: blend.pair(a.lot_width, b.lot_width),
            lot_depth: blend.number(a.lot_depth, b.lot_depth),
            min_area: blend.number(a.min_area, b.min_area),
            setback_front: blend.number(a.setback_front, b.setback_front),
            setback_side: blend.number(a.setback_side, b.setback_side),
            building_depth: blend.number(a.building_depth, b.building_depth),
            wings: blend.number(a.wings, b.wings),
            storeys: blend.counts(a.storeys, b.storeys),
            vacant: blend.number(a.vacant, b.vacant),
            parks: blend.number(a.parks, b.parks),
        }
    }
}
