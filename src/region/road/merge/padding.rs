//! Distances that the steps of merging share, and how far each step reads around its tile.

use crate::region::road::settings::RoadSettings;

/// Length in steps of the stretch, in each direction from a vertex, over which a route is watched.
pub(super) const WATCHED_STEPS: f64 = 3.0;
/// How much nearer to each other smoothing usually brings two roads than they are on the lattice, in metres.
const NEARER: f64 = 11.0;
/// Greatest length of an edge of the lattice, in steps.
pub(super) const EDGE_STEPS: f64 = 2.237;
/// Vertices this near to a connector, in metres, lie on it.
pub(super) const ON_LINE: f64 = 10.0;
/// Distance in steps that connectors keep from outlines.
pub(super) const OUTLINE_STEPS: f64 = 0.3;
/// Greatest length in steps of a minor leg whose attachment moves.
const LEG_STEPS: f64 = 2.35;

/// Greatest length of a connector in metres: the merge distance at half a right angle.
pub(in crate::region::road) fn longest_connector(settings: &RoadSettings) -> f64 {
    1.4 * settings.merge
}

/// Greatest length in metres of a minor leg whose attachment moves.
pub(in crate::region::road) fn longest_leg(settings: &RoadSettings) -> f64 {
    LEG_STEPS * settings.step as f64
}

/// Distance in metres within which a route runs beside another. Smoothing may bring roads a little nearer.
pub(super) fn beside(settings: &RoadSettings) -> f64 {
    settings.merge + NEARER
}

/// Greatest length of a rung in metres: vertices of a road that runs beside lie up to half an edge farther along.
pub(super) fn longest_rung(settings: &RoadSettings) -> f64 {
    let half = EDGE_STEPS * settings.step as f64 / 2.0;
    (beside(settings) * beside(settings) + half * half).sqrt()
}

/// Greatest distance in metres along a road between two attachments that become one crossing.
pub(super) fn longest_stagger(settings: &RoadSettings) -> f64 {
    0.7 * settings.merge
}

/// Padding of the merged graph in metres: a connector into the tile, a connector that crosses it, and what decides about that
/// connector: whether its ways are dropped, and what runs beside what where it could end.
pub(super) fn merged_padding(settings: &RoadSettings) -> f64 {
    let step = settings.step as f64;
    let (edge, connector) = (EDGE_STEPS * step, longest_connector(settings));
    let beside = WATCHED_STEPS * step + beside(settings);
    let dropped = edge + longest_rung(settings) + beside;
    2.0 * connector + dropped.max(connector + beside)
}

/// Padding of the realigned graph in metres: a leg into the tile, the partner of its attachment, and either what attaches beyond
/// that or the partner's leg and what might cross its new course.
pub(super) fn realigned_padding(settings: &RoadSettings) -> f64 {
    let edge = EDGE_STEPS * settings.step as f64;
    let (leg, stagger) = (longest_leg(settings).max(edge), longest_stagger(settings));
    2.0 * leg + stagger + (longest_connector(settings) / 2.0).max(stagger) + ON_LINE
}

/// How far in metres around its tile the realigned graph depends on the graph before merging.
pub(in crate::region::road) fn padding(settings: &RoadSettings) -> f64 {
    merged_padding(settings) + realigned_padding(settings)
}

/// Distance in metres within which every vertex lies that could merge with, or be attached to, a vertex of a tile: the longer
/// of an edge and a connector, a leg, and a rung.
pub(super) fn plain_padding(settings: &RoadSettings) -> f64 {
    longest_leg(settings)
        + (EDGE_STEPS * settings.step as f64).max(longest_connector(settings))
        + longest_rung(settings)
}
