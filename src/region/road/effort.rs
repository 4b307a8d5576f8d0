//! How much work roads are. A reach that takes in hundreds of settlements, or a search over millions of nodes, would take
//! minutes for a square of 2 km, so such settings are refused.

use super::partners::MOST_BETWEEN;
use super::settings::RoadSettings;
use super::tier_settings::TierSettings;
use crate::layer::RangeError;
use crate::network::SizeClass;
use crate::region::settlement::SettlementSettings;
use crate::space::math;
use std::f64::consts::PI;

/// Greatest number of cells of the lattices of settlements that are looked at for the roads of one place.
const MOST_CELLS: f64 = 5_000.0;
/// Greatest number of nodes in the ellipse of one search on the coarse lattice.
const MOST_NODES: f64 = 200_000.0;
/// Greatest number of nodes in the ellipses of all searches for the roads of one place.
const MOST_WORK: f64 = 10_000_000.0;
/// Least reach of a class in metres.
const LEAST_REACH: f64 = 500.0;
/// A pair is not tried if so many settlements are within its length of one end.
const MOST_PARTNERS: f64 = MOST_BETWEEN as f64 / 0.39;

/// An estimate of the work for the roads of one class at one place.
struct Effort {
    cells: f64,
    nodes: f64,
    work: f64,
}

/// Settlements with which one shares a pair that beelines do not rule out, on open ground: the disc that rules a pair out has
/// a radius of `height` lengths.
fn partners(gamma: f64) -> f64 {
    let height2 = 0.757 * math::pow(2.0, -2.0 / gamma) - 0.25;
    if height2 > 0.0 { (1.0 / height2).min(MOST_PARTNERS) } else { MOST_PARTNERS }
}

impl Effort {
    /// The work for roads of a tier if its reach were `reach`.
    fn new(roads: &RoadSettings, settlements: &SettlementSettings, tier: SizeClass, reach: f64) -> Self {
        let t = TierSettings { reach, ..roads.tier(tier).clone() };
        let cell = (roads.step * t.coarse_step) as f64;
        let sum_over = |of: &dyn Fn(f64, f64) -> f64| {
            let sizes = SizeClass::ALL.into_iter().filter(|size| *size >= tier);
            sizes.map(|size| of(*settlements.spacing.of(size), *settlements.share.of(size))).sum::<f64>()
        };
        let side = 2.0 * t.listing_padding(roads.step);
        let across = side + 2.0 * reach;
        let cells = sum_over(&|spacing, _| (across * across / (spacing * spacing)).max(1.0));
        let density = sum_over(&|spacing, share| share / (spacing * spacing));
        let within = PI * reach * reach * density;
        let partners = partners(t.gamma).min(within);
        let ellipse = |length2: f64| PI / 4.0 * t.detour * (t.detour * t.detour - 1.0).sqrt() * length2 / (cell * cell);
        // The mean square of the length of a pair that is tried.
        let length2 = if density > 0.0 { (partners / (PI * density)).min(reach * reach) } else { 0.0 };
        let work = side * side * density * partners / 2.0 * ellipse(length2);
        Self { cells, nodes: ellipse(reach * reach), work }
    }

    fn is_bearable(&self) -> bool {
        self.cells <= MOST_CELLS && self.nodes <= MOST_NODES && self.work <= MOST_WORK
    }
}

impl RoadSettings {
    /// Checks that no class reaches so far among such settlements that its roads take minutes to find. All values lie in
    /// their ranges.
    pub(crate) fn check_effort(&self, settlements: &SettlementSettings) -> Result<(), RangeError> {
        for (name, tier) in [("highway", SizeClass::City), ("major", SizeClass::Town), ("minor", SizeClass::Village)] {
            let reach = self.tier(tier).reach;
            let bearable = |reach: f64| Effort::new(self, settlements, tier, reach).is_bearable();
            if bearable(reach) {
                continue;
            }
            if !bearable(LEAST_REACH) {
                let allowed = "a wider spacing of settlements, a greater gamma or coarse step, or a smaller detour; roads would take \
                               minutes to find whatever the reach";
                return Err(RangeError {
                    field: format!("{name}.reach"),
                    value: reach.to_string(),
                    allowed: allowed.into(),
                });
            }
            let (mut low, mut high) = (LEAST_REACH, reach);
            while high - low > 1.0 {
                let middle = (low + high) / 2.0;
                if bearable(middle) { low = middle } else { high = middle }
            }
            let allowed = format!(
                "{LEAST_REACH} to {:.0} with such settlements, gamma, detour and lattice; roads would take minutes to find",
                low.floor()
            );
            return Err(RangeError { field: format!("{name}.reach"), value: reach.to_string(), allowed });
        }
        Ok(())
    }
}
