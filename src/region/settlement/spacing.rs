//! How near each other settlements may stand.

use super::model::Settlement;
use super::settings::SettlementSettings;
use crate::space::Origin;

/// Distance in metres that an outline keeps from the power line between two settlements that share no border.
pub(in crate::region) const SETBACK: f64 = 40.0;
/// Gap in metres between two circles below which the settlements shape each other's outlines.
pub(in crate::region) const NEIGHBOUR_GAP: f64 = 3.0 * SETBACK;
/// Core of a settlement, which the power line to a neighbour may not cut: as a share of the radius, and at least in metres.
const CORE: (f64, f64) = (0.5, 110.0);

/// Distance in metres from the centre of a circle to the line that separates it from another circle in their power diagram.
/// The centres are `apart` metres from each other; the radii are `own` and `other`.
pub(in crate::region) fn power_line(apart: f64, own: f64, other: f64) -> f64 {
    (apart * apart + own * own - other * other) / (2.0 * apart)
}

/// Whether `a` and a settlement of `radius` at `centre` are too near each other: nearer than the settings allow, or so near
/// that the power line cuts the core of one of them.
pub(in crate::region) fn conflict(settings: &SettlementSettings, a: &Settlement, centre: Origin, radius: f64) -> bool {
    let apart = a.centre.offset_to(centre).length();
    let cut = |own: f64, other: f64| power_line(apart, own, other) - SETBACK < core(own);
    apart < settings.clearance * (a.radius + radius) + settings.gap || cut(a.radius, radius) || cut(radius, a.radius)
}

/// Distance in metres from which two settlements of radii `a` and `b` never conflict.
pub(in crate::region) fn conflict_distance(settings: &SettlementSettings, a: f64, b: f64) -> f64 {
    // `power_line(d, own, other) >= k` holds for every d >= 2 k + other.
    let room = |own: f64, other: f64| 2.0 * (core(own) + SETBACK) + other;
    (settings.clearance * (a + b) + settings.gap).max(room(a, b)).max(room(b, a))
}

/// Radius in metres of the core of a settlement.
fn core(radius: f64) -> f64 {
    (radius * CORE.0).max(CORE.1)
}
