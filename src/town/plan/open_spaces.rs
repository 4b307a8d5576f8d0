//! Open spaces in the place of big junctions: roundabouts and squares, with main streets around them.

use super::sketch::Sketch;
use crate::network::{EdgeIx, StreetClass, VertexIx};
use crate::space::math::{angle_of, cos, direction, sin};
use crate::space::{Seed, quantize, quantum_key};
use crate::style::MainRules;
use glam::DVec2;
use std::cmp::Reverse;
use std::f64::consts::TAU;

/// Least and greatest radius of a roundabout, to the middle of its street, in metres.
const ROUND: (f64, f64) = (18.0, 28.0);
/// Least and greatest distance from the middle of a square to its sides, in metres.
const SQUARE: (f64, f64) = (26.0, 40.0);
/// Least distance between two open spaces, in metres.
const SPACING: f64 = 260.0;
/// Distance that an open space keeps from streets that do not lead to it, in metres.
const STREET_GAP: f64 = 30.0;
/// Distance that an open space keeps from the outline, in metres.
const OUTLINE_GAP: f64 = 45.0;
/// Least length that an open space leaves of the last segment of a street that leads to it, in metres.
const REST: f64 = 16.0;
/// Least angle between two streets that lead to an open space, in radians.
const LEAST_ANGLE: f64 = 0.78;
/// A square gets a side without a street where streets leave a wider angle than this, in radians.
const OPEN_ANGLE: f64 = 2.0;
/// Length that is cut off a square's corners, in metres.
const CORNER: f64 = 9.0;
/// Angle between the points of a roundabout, in radians.
const ARC: f64 = 0.45;

/// A street that leads to an open space.
struct Arm {
    edge: EdgeIx,
    /// The edge's other vertex.
    to: VertexIx,
    class: StreetClass,
    angle: f64,
    length: f64,
}

/// The street around an open space, counter-clockwise: its points, each with the arm that ends there.
type Loop = Vec<(DVec2, Option<usize>)>;

/// Replaces some of the big junctions by open spaces. A junction is big if three arterials meet there, or four streets of which
/// two are arterials, or five streets.
pub(super) fn replace_junctions(sketch: &mut Sketch, rules: &MainRules, seed: Seed, settlement: u64) {
    if rules.roundabouts + rules.squares <= 0.0 {
        return;
    }
    let g = &sketch.graph;
    let arterials = |v: VertexIx| g.edges_at(v).iter().filter(|e| g.edge(**e).data == StreetClass::Arterial).count();
    let big = |v: &VertexIx| arterials(*v) >= 3 || (arterials(*v) == 2 && g.degree(*v) >= 4) || g.degree(*v) >= 5;
    let mut junctions: Vec<VertexIx> = g.vertices().filter(|v| big(v) && !sketch.is_gate(*v)).collect();
    junctions.sort_by(|a, b| {
        let rank = |v: VertexIx| Reverse((arterials(v), g.degree(v)));
        rank(*a).cmp(&rank(*b)).then(g.at(*a).length().total_cmp(&g.at(*b).length())).then(a.cmp(b))
    });
    for v in junctions {
        let at = sketch.graph.at(v);
        let [x, y] = quantum_key(at);
        let mut stream = seed.stream("town/place", &[settlement, x, y]);
        let (draw, size) = (stream.unit(), stream.unit());
        if draw >= rules.roundabouts + rules.squares || sketch.open_spaces.iter().any(|p| p.distance(at) < SPACING) {
            continue;
        }
        let round = draw < rules.roundabouts;
        let (low, high) = if round { ROUND } else { SQUARE };
        // Where the drawn size has no room, smaller sizes are tried.
        for size in [size, size / 2.0, 0.0] {
            if replace(sketch, v, round, low + (high - low) * size) {
                break;
            }
        }
    }
}

/// Replaces a junction by an open space; returns whether there is room for it.
fn replace(sketch: &mut Sketch, v: VertexIx, round: bool, radius: f64) -> bool {
    let g = &sketch.graph;
    let at = g.at(v);
    let arm = |e: &EdgeIx| {
        let to = g.edge(*e).other(v);
        let line = g.at(to) - at;
        Arm { edge: *e, to, class: g.edge(*e).data, angle: angle_of(line), length: line.length() }
    };
    let mut arms: Vec<Arm> = g.edges_at(v).iter().map(arm).collect();
    arms.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.edge.cmp(&b.edge)));
    let gap = |i: usize| {
        let next = arms[(i + 1) % arms.len()].angle - arms[i].angle;
        if next <= 0.0 { next + TAU } else { next }
    };
    let close = (0..arms.len()).any(|i| gap(i) < LEAST_ANGLE);
    if close || arms.iter().any(|a| a.length < radius + REST) {
        return false;
    }
    let gaps: Vec<f64> = (0..arms.len()).map(gap).collect();
    let around = if round { ring(at, radius, &arms, &gaps) } else { square(at, radius, &arms, &gaps) };
    let n = around.len();
    let own = |e: EdgeIx| arms.iter().any(|a| a.edge == e);
    let clear = (0..n).all(|i| {
        let (a, b) = (around[i].0, around[(i + 1) % n].0);
        // Junctions are wider than points of inflexion.
        let least = if around[i].1.is_some() && around[(i + 1) % n].1.is_some() { 13.0 } else { 6.0 };
        a.distance(b) >= least
            && !sketch.site.is_blocked(a, b)
            && g.clearance(a, b, STREET_GAP, own) >= STREET_GAP
            && sketch.site.ring.clearance(a, b, OUTLINE_GAP, |_| false) >= OUTLINE_GAP
    });
    let mut closed: Vec<DVec2> = around.iter().map(|(p, _)| *p).collect();
    closed.push(closed[0]);
    if !clear || !sketch.site.ground_fits(&closed) {
        return false;
    }
    let class = arms.iter().map(|a| a.class).min().unwrap_or(StreetClass::Main);
    let vertices: Vec<VertexIx> = around.iter().map(|(p, _)| sketch.graph.add_vertex(*p)).collect();
    for i in 0..n {
        sketch.graph.add_edge(vertices[i], vertices[(i + 1) % n], class);
    }
    for (vertex, (_, arm)) in vertices.iter().zip(&around) {
        if let Some(arm) = arm.map(|i| &arms[i]) {
            sketch.graph.remove_edge(arm.edge);
            sketch.graph.add_edge(*vertex, arm.to, arm.class);
        }
    }
    sketch.open_spaces.push(at);
    true
}

/// A circle that every arm meets at a right angle.
fn ring(at: DVec2, radius: f64, arms: &[Arm], gaps: &[f64]) -> Loop {
    let mut out = Vec::new();
    for (i, (arm, gap)) in arms.iter().zip(gaps).enumerate() {
        let parts = (gap / ARC).floor().max(1.0);
        for k in 0..parts as usize {
            let p = at + direction(arm.angle + gap * k as f64 / parts) * radius;
            out.push((quantize(p), (k == 0).then_some(i)));
        }
    }
    out
}

/// A polygon with a side square to every arm.
fn square(at: DVec2, radius: f64, arms: &[Arm], gaps: &[f64]) -> Loop {
    let mut sides: Vec<(f64, f64, Option<usize>)> = Vec::new();
    for (i, (arm, gap)) in arms.iter().zip(gaps).enumerate() {
        let parts = (gap / OPEN_ANGLE).ceil().max(1.0);
        for k in 0..parts as usize {
            sides.push((arm.angle + gap * k as f64 / parts, gap / parts, (k == 0).then_some(i)));
        }
    }
    let mut out = Vec::new();
    for (angle, gap, arm) in sides {
        let (way, next) = (direction(angle), direction(angle + gap));
        if arm.is_some() {
            out.push((quantize(at + way * radius), arm));
        }
        let corner = at + direction(angle + gap / 2.0) * (radius / cos(gap / 2.0));
        let half = radius * sin(gap / 2.0) / cos(gap / 2.0);
        if half < 2.0 * CORNER {
            out.push((quantize(corner), None));
        } else {
            out.push((quantize(corner - way.perp() * CORNER), None));
            out.push((quantize(corner + next.perp() * CORNER), None));
        }
    }
    out
}
