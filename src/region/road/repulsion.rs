//! Settlements repel roads that do not serve them: a control term h around each one (Galin 2011, section 4.1).

use super::cost::kernel;
use super::padding::REPULSION;
use super::tier_settings::TierSettings;
use crate::region::settlement::Settlement;
use glam::DVec2;

/// Distance in metres from its centre within which a settlement repels roads. 0 for a way point, which roads may pass.
pub(super) fn repulsion_radius(s: &Settlement) -> f64 {
    if s.radius > 0.0 { s.radius + REPULSION } else { 0.0 }
}

/// Extra cost per metre of a road at a plan point, because of a settlement that the road does not serve.
pub(super) fn repulsion(t: &TierSettings, s: &Settlement, at: DVec2) -> f64 {
    t.settlement * kernel(at.distance(s.centre.plan()), repulsion_radius(s))
}
