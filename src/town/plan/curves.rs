//! Lines of streets: smooth curves, and their points on the quantum grid.

use crate::space::math::angle_between;
use crate::space::{distance_to_segment, quantize};
use glam::DVec2;

/// Distance between the points of inflexion of a curved street, in metres.
pub(super) const STEP: f64 = 52.0;

/// Points nearer than this to the line between their neighbours are left out, in metres: the bend would not show.
const FLAT: f64 = 0.4;

/// Points of a cubic curve between two points, with a direction at each end.
pub(super) fn cubic(from: DVec2, leaving: DVec2, to: DVec2, arriving: DVec2) -> Vec<DVec2> {
    let distance = from.distance(to);
    let (p1, p2) = (from + leaving * (0.37 * distance), to - arriving * (0.37 * distance));
    let turns = angle_between(leaving, to - from) + angle_between(to - from, arriving);
    // Steps are short where the curve bends, so that no point of inflexion is a corner.
    let parts = (distance / STEP).max(turns / 0.24).round().clamp(1.0, 40.0);
    (0..=parts as usize)
        .map(|i| {
            let t = i as f64 / parts;
            let s = 1.0 - t;
            from * (s * s * s) + p1 * (3.0 * s * s * t) + p2 * (3.0 * s * t * t) + to * (t * t * t)
        })
        .collect()
}

/// The points of `path` on the quantum grid, without points whose bend would not show.
pub(super) fn simplified(path: Vec<DVec2>) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::with_capacity(path.len());
    for p in path.into_iter().map(quantize) {
        while let [.., a, b] = out[..]
            && distance_to_segment(b, a, p) < FLAT
        {
            out.pop();
        }
        if out.last() != Some(&p) {
            out.push(p);
        }
    }
    out
}
