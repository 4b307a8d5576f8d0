//! The way of a vehicle from one lane to another.

use crate::space::{math, quantize};
use glam::DVec2;

/// Distance between the points of a curve, in metres, and least number of its parts.
const STEP: (f64, f64) = (1.5, 2.0);

/// Points of a curve that leaves `from` in the unit direction `out` and arrives at `to` in the unit direction `on`: a cubic with
/// handles as long as those of the arc of a circle that turns by as much. Relative to `from`, on the quantum grid, ends included.
pub(super) fn curve(from: DVec2, out: DVec2, to: DVec2, on: DVec2) -> Vec<DVec2> {
    let chord = from.distance(to);
    let quarter = math::angle_between(out, on) / 4.0;
    // Two thirds of tan(x) / sin(2 x), which is 1 / (2 cos(x)^2).
    let handle = chord / (3.0 * math::cos(quarter) * math::cos(quarter));
    let (b, c, d) = (out * handle, to - from - on * handle, to - from);
    let parts = ((chord + handle) / 2.0 / STEP.0).ceil().max(STEP.1) as usize;
    let at = |k: usize| {
        let t = k as f64 / parts as f64;
        let s = 1.0 - t;
        b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t)
    };
    let mut points: Vec<DVec2> = (0..parts).map(|k| from + quantize(at(k))).collect();
    points.push(to);
    points.dedup();
    points
}
