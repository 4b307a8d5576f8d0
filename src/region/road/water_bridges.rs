//! Small bridges: where a road that runs on the ground crosses water.

use super::inputs::Inputs;
use super::route::Route;
use crate::space::{Measured, Origin};
use glam::DVec2;

/// Distance between samples of water along a line, in steps of the lattice: 8 m of 128 m.
const SAMPLE_STEPS: f64 = 1.0 / 16.0;
/// How far a bridge extends onto land at each end, in metres, so that its ends lie above the water.
const ABUTMENT: f64 = 8.0;
/// Land between two bridges that is shorter, in metres, is bridged, too.
pub(super) const SHORT_LAND: f64 = 24.0;
/// A bridge that ends nearer to a junction, in metres, extends to it.
pub(super) const SHORT_END: f64 = 20.0;

/// The parts of a line in turn over land and over water: from and to, in metres along the line, and whether the part is a
/// bridge.
pub(super) fn land_and_water(inputs: &Inputs, origin: Origin, line: &[DVec2]) -> Vec<((f64, f64), bool)> {
    let line = Measured::new(line);
    let length = line.length();
    let count = (length / (SAMPLE_STEPS * inputs.step() as f64)).ceil().max(1.0) as usize;
    let step = length / count as f64;
    let mut wet: Vec<(f64, f64)> = Vec::new();
    for i in 0..=count {
        let p = line.point_at(i as f64 * step);
        if inputs.terrain.sample(origin.to_plan(p)).depth() <= 0.0 {
            continue;
        }
        let (from, to) = ((i as f64 - 1.0) * step - ABUTMENT, (i as f64 + 1.0) * step + ABUTMENT);
        match wet.last_mut() {
            Some(last) if from - last.1 < SHORT_LAND => last.1 = to,
            _ => wet.push((from, to)),
        }
    }
    let mut out = Vec::new();
    let mut at = 0.0;
    for (from, to) in wet {
        let from = if from < SHORT_END { 0.0 } else { from };
        let to = if to > length - SHORT_END { length } else { to };
        if from > at {
            out.push(((at, from), false));
        }
        out.push(((from, to), true));
        at = to;
    }
    if at < length {
        out.push(((at, length), false));
    }
    out
}

/// Number of small bridges along a route, without the bridges that its search chose.
pub(super) fn count(inputs: &Inputs, route: &Route) -> usize {
    let line = route.line(inputs.step());
    // Relative to an origin of its own, so that the same route gives the same result anywhere.
    let origin = Origin::at(line.first().copied().unwrap_or_default());
    let local: Vec<DVec2> = line.iter().map(|p| origin.to_local(*p)).collect();
    // The points of the line are a gate, the nodes, and a gate.
    let mut first = 0;
    let mut count = 0;
    let ends = route.spans.iter().map(|s| (s.first + 1, s.last + 1)).chain([(local.len() - 1, 0)]);
    for (last, next) in ends {
        if last > first {
            count += land_and_water(inputs, origin, &local[first..=last]).iter().filter(|p| p.1).count();
        }
        first = next;
    }
    count
}
