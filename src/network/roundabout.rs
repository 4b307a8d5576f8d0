//! Roundabouts: small round faces of the street network.

use crate::network::traffic::Side;
use crate::space::{centroid, math::angle_between};
use glam::DVec2;

/// Greatest mean radius of a roundabout's ring, in metres.
const ROUNDABOUT_RADIUS: f64 = 40.0;

/// Least number of points of a ring.
const LEAST_POINTS: usize = 6;

/// Greatest angle between neighbouring points of a ring as seen from its middle, in degrees.
const WIDEST_STEP: f64 = 65.0;

/// Whether a closed line is the ring of a roundabout: small, round to an eighth of its radius, and with points all around.
pub fn is_round(ring: &[DVec2]) -> bool {
    let n = ring.len();
    if n < LEAST_POINTS {
        return false;
    }
    let centre = centroid(ring);
    let radius = ring.iter().map(|p| p.distance(centre)).sum::<f64>() / n as f64;
    let round = ring.iter().all(|p| (p.distance(centre) - radius).abs() <= radius / 8.0);
    let step = |i: usize| angle_between(ring[i] - centre, ring[(i + 1) % n] - centre);
    radius <= ROUNDABOUT_RADIUS && round && (0..n).all(|i| step(i) <= WIDEST_STEP.to_radians())
}

/// The side of a street on which the island of its roundabout lies, from the runs in which the ring, counter-clockwise, passes the
/// street's edges: whether each edge is passed in the direction of the street, or `None` for an edge that is not of the ring.
pub fn island_side(runs: impl IntoIterator<Item = Option<bool>>) -> Option<Side> {
    let mut runs = runs.into_iter();
    let first = runs.next()??;
    runs.all(|run| run == Some(first)).then_some(if first { Side::Left } else { Side::Right })
}
