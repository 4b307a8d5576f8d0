//! How far from a settlement the outlines of others change when that settlement appears, disappears or moves.

use super::settings::SettlementSettings;
use super::spacing::{NEIGHBOUR_GAP, conflict_distance};

impl SettlementSettings {
    /// Distance in metres from a settlement that appears, disappears or moves, beyond which no outline changes. `largest` is
    /// the largest radius of any settlement. Settlements that conflict with the changed one give way, their neighbours get
    /// other outlines, and so do the settlements that share a border with these neighbours.
    pub(crate) fn change_reach(&self, largest: f64) -> f64 {
        conflict_distance(self, largest, largest) + 2.0 * (2.0 * largest + NEIGHBOUR_GAP) + largest
    }
}
