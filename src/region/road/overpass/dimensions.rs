//! Sizes of overpasses and ramps, and how far the decisions about them read.

use crate::region::road::merge::{longest_connector, longest_leg};
use crate::region::road::settings::RoadSettings;

/// Height in metres of a carriageway above the carriageway of the highway below.
pub(crate) const OVERPASS_CLEARANCE: f64 = 6.4;
/// Length in metres of the bridge on either side of the crossing.
pub(in crate::region::road) const HALF_LENGTH: f64 = 130.0;
/// Length in metres beyond the end of a bridge or beyond a ramp on which the road has no junction.
pub(super) const RUN_OUT: f64 = 45.0;
/// Distance in metres of bridges and ramps from other roads, and of the crossing from the highway's next vertex.
pub(super) const CLEAR: f64 = 40.0;
/// Distance in metres from a crossing without a ramp, within which nothing may have been merged: roads that were dropped lay within
/// the merge distance of the better roads that join their ends, and are a few hundred metres long.
pub(super) const UNMERGED: f64 = 480.0;
/// Least distance in metres along the highway from the crossing to a two-way ramp, and the distance up to which vertices are
/// tried.
pub(super) const RAMP_AT: (f64, f64) = (90.0, 200.0);
/// Greatest distance in metres along a road from a crossing to the end of a ramp.
pub(super) const FARTHEST_RAMP: f64 = 330.0;
/// Greatest distance in metres of the end of a ramp from where it was wanted: a coarse lattice names few places.
pub(super) const OFF: f64 = 20.0;
/// Least distance in metres along a road from the end of a ramp to a vertex.
pub(super) const OFF_VERTEX: f64 = 12.0;
/// Distance in metres from a crossing within which its ramps lie.
pub(super) const RAMPS_WITHIN: f64 = FARTHEST_RAMP + OFF + OFF_VERTEX;
/// Greatest distance in metres between the ends of a ramp.
pub(super) const LONGEST_RAMP: f64 = 450.0;
/// How much nearer, in metres, a bridge or ramp lies to its own crossing than to any other.
pub(super) const NEARER: f64 = 40.0;
/// Least angle in radians between a ramp and a road.
pub(super) const RAMP_ANGLE: f64 = 0.5;

/// Shape of an overpass: its height above the straight line between its ends, as a share of the height at the crossing. `t` runs
/// from -1 at one end over 0 at the crossing to 1 at the other end.
pub(crate) fn overpass_profile(t: f64) -> f64 {
    let s = 1.0 - (t * t).min(1.0);
    s * s
}

/// Greatest slope of [`overpass_profile`].
pub(super) const STEEPEST: f64 = 1.54;

/// Length in metres of the longest way before crossings are separated, except bridges and tunnels.
pub(super) fn longest_before(settings: &RoadSettings) -> f64 {
    longest_connector(settings).max(longest_leg(settings))
}

/// Length in metres of the longest way in the graph, and of the longest ramp.
pub(in crate::region::road) fn longest_way(settings: &RoadSettings) -> f64 {
    longest_before(settings).max(LONGEST_RAMP)
}

/// Distance in metres from a tile within which crossings lie that change ways into the tile: such a way holds the end of a ramp.
pub(super) fn changed_within(settings: &RoadSettings) -> f64 {
    RAMPS_WITHIN + longest_before(settings)
}

/// Padding of the graph in metres: a crossing that changes ways into the tile, and other crossings whose bridges and ramps might
/// come near its own, with their ways.
pub(in crate::region::road) fn padding(settings: &RoadSettings) -> f64 {
    let along = RAMPS_WITHIN + RUN_OUT + longest_before(settings) + CLEAR;
    let others = 2.0 * RAMPS_WITHIN + NEARER + longest_before(settings);
    changed_within(settings) + along.max(others).max(UNMERGED)
}
