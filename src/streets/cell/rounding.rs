//! Rounding: sharp corners of a street become curves.

use super::canvas::Canvas;
use super::rules::CellRules;
use crate::network::{STREET_FLOOR, VertexIx};
use crate::space::math::{angle_between, sin};
use crate::space::{Bounds, line_length, point_at, quantize, segment_distance, segments};
use glam::DVec2;

/// Bends of at most this angle stay as they are, in radians.
const SHARP: f64 = 0.3;
/// Least distance between a corner and the beginning of its curve, in metres; smaller curves cannot be seen.
const LEAST_REACH: f64 = 3.5;
/// Greatest share of the way to the next corner, or to the end of the street, that a curve takes.
const MOST_SHARE: f64 = 0.45;
/// Greatest distance between a corner of a curve that keeps its shape and what takes its place, in metres.
const SHAPE_KEPT: f64 = 0.45;
/// Angle between the segments of a curve, in radians.
const ARC: f64 = 0.25;

/// A curve that replaces a corner.
struct Curve {
    /// Where it begins and ends, in metres along the street.
    from: f64,
    to: f64,
    points: Vec<DVec2>,
}

/// The line through `vertices` with its corners rounded as far as the style says, in metres from the corner, other streets
/// leave room and the street stays as long as it must be.
pub fn rounded(canvas: &Canvas, rules: &CellRules, vertices: &[VertexIx], line: Vec<DVec2>) -> Vec<DVec2> {
    let most = rules.local.rounding;
    if most < LEAST_REACH {
        return line;
    }
    let mut along = vec![0.0];
    along.extend(segments(&line).scan(0.0, |sum, (a, b)| {
        *sum += a.distance(b);
        Some(*sum)
    }));
    let turn = |i: usize| angle_between(line[i] - line[i - 1], line[i + 1] - line[i]);
    let node = |i: usize| canvas.nodes[vertices[i] as usize];
    let last = line.len() - 1;
    // A curve begins and ends between these: what is pinned stays where it is.
    let stops: Vec<usize> =
        (0..=last).filter(|i| [0, last].contains(i) || node(*i).pinned || turn(*i) > SHARP).collect();
    let mut curves = Vec::new();
    for &[previous, i, next] in stops.array_windows() {
        if node(i).pinned {
            continue;
        }
        let (before, after) = (along[i] - along[previous], along[next] - along[i]);
        let keeps_shape = if node(i).shaped { 2.0 * SHAPE_KEPT / sin(turn(i) / 2.0) } else { f64::INFINITY };
        let reach = most.min(MOST_SHARE * before.min(after)).min(keeps_shape);
        if reach < LEAST_REACH {
            continue;
        }
        let (from, to) = (along[i] - reach, along[i] + reach);
        let (p, q) = (point_at(&line, from).0, point_at(&line, to).0);
        let parts = (turn(i) / ARC).ceil();
        let point = |part: usize| {
            let t = part as f64 / parts;
            quantize(p.lerp(line[i], t).lerp(line[i].lerp(q, t), t))
        };
        let points: Vec<DVec2> = (0..=parts as usize).map(point).collect();
        if has_room(canvas, rules.repair.gap, vertices, &line, &points) {
            curves.push(Curve { from, to, points });
        }
    }
    let saved = |c: &Curve| c.to - c.from - line_length(&c.points);
    let mut spare = along[last] - rules.repair.min_piece;
    curves.retain(|c| {
        let stays = saved(c) <= spare;
        spare -= if stays { saved(c) } else { 0.0 };
        stays
    });
    let mut out = Vec::with_capacity(line.len() + 4 * curves.len());
    let mut rest = curves.iter().peekable();
    for (p, along) in line.into_iter().zip(along) {
        while let Some(curve) = rest.next_if(|c| c.from < along) {
            out.extend(&curve.points);
        }
        let inside = curves.iter().any(|c| c.from <= along && along <= c.to);
        if !inside {
            out.push(p);
        }
    }
    out.dedup();
    out
}

/// Whether a curve keeps the distance `gap` from other streets and what it must from the border, or comes no nearer than the
/// line did.
fn has_room(canvas: &Canvas, gap: f64, vertices: &[VertexIx], line: &[DVec2], curve: &[DVec2]) -> bool {
    let bounds = Bounds::of(curve.iter().copied()).grown(gap + STREET_FLOOR);
    let own = |v: VertexIx| vertices.contains(&v);
    canvas.overlapping(bounds).filter(|s| s.is_wall() || !(own(s.va) && own(s.vb))).all(|s| {
        let distance = |line: &[DVec2]| {
            segments(line).map(|(a, b)| segment_distance(a, b, s.a, s.b)).fold(f64::INFINITY, f64::min)
        };
        let floor = if s.is_wall() { s.floor.max(gap) } else { gap };
        let now = distance(curve);
        now >= floor || now >= distance(line)
    })
}
