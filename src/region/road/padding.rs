//! How far the search for the road of a pair reads beyond the two settlements.

use super::tier_settings::TierSettings;

/// How far beyond an outline ties and closed edges reach, in steps of the lattice: the padding of a site.
pub(super) const SITE_STEPS: f64 = 6.0;
/// Ties, and all edges that would meet them, come within this many steps of the settlement's circle.
pub(super) const TIE_REACH: f64 = 2.3;
/// Distance in metres from its circle within which a settlement repels roads that do not serve it.
pub(super) const REPULSION: f64 = 500.0;

/// How far around the box of both centres the search for the road of a pair reads settlements and roads, in metres. `length` is
/// the pair's beeline, `corridor` the width of its corridor.
///
/// The search reads the box of the ellipse that holds its coarse path, with room for centres that are moved to a node up to
/// five cells away, and the settlements beside its corridor.
pub(super) fn pair_padding(t: &TierSettings, step: i64, length: f64, corridor: f64) -> f64 {
    let cells = (8 * step * t.coarse_step) as f64;
    let beside = REPULSION.max(SITE_STEPS * step as f64);
    t.detour * (0.515 * length + cells) + cells + corridor + beside
}
