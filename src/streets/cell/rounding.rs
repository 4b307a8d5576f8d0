//! Rounding: sharp corners of a street become curves.

use super::canvas::Canvas;
use crate::network::{STREET_FLOOR, VertexIx};
use crate::space::math::angle_between;
use crate::space::{Bounds, point_at, quantize, segment_distance, segments};
use glam::DVec2;

/// Bends of at most this angle stay as they are, in radians.
const SHARP: f64 = 0.3;
/// Least distance between a corner and the beginning of its curve, in metres; smaller curves cannot be seen.
const LEAST_REACH: f64 = 4.0;
/// Greatest share of the way to the next corner, or to the end of the street, that a curve takes.
const MOST_SHARE: f64 = 0.45;
/// Angle between the segments of a curve, in radians.
const ARC: f64 = 0.25;

/// A curve that replaces a corner.
struct Curve {
    /// Where it begins and ends, in metres along the street.
    from: f64,
    to: f64,
    points: Vec<DVec2>,
}

/// The line through `vertices` with its corners rounded as far as `most`, in metres from the corner, and other streets
/// leave room.
pub fn rounded(canvas: &Canvas, most: f64, vertices: &[VertexIx], line: Vec<DVec2>) -> Vec<DVec2> {
    if most < LEAST_REACH {
        return line;
    }
    let mut along = vec![0.0];
    along.extend(segments(&line).scan(0.0, |sum, (a, b)| {
        *sum += a.distance(b);
        Some(*sum)
    }));
    let turn = |i: usize| angle_between(line[i] - line[i - 1], line[i + 1] - line[i]);
    let pinned = |i: usize| canvas.nodes[vertices[i] as usize].pinned;
    let last = line.len() - 1;
    // A curve begins and ends between these: what is pinned stays where it is.
    let stops: Vec<usize> = (0..=last).filter(|i| [0, last].contains(i) || pinned(*i) || turn(*i) > SHARP).collect();
    let mut curves = Vec::new();
    for &[previous, i, next] in stops.array_windows() {
        if pinned(i) {
            continue;
        }
        let (before, after) = (along[i] - along[previous], along[next] - along[i]);
        let reach = most.min(MOST_SHARE * before.min(after));
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
        if has_room(canvas, vertices, &line, &points) {
            curves.push(Curve { from, to, points });
        }
    }
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

/// Whether a curve keeps the least distance from other streets and from the border, or comes no nearer than the line did.
fn has_room(canvas: &Canvas, vertices: &[VertexIx], line: &[DVec2], curve: &[DVec2]) -> bool {
    let bounds = Bounds::of(curve.iter().copied()).grown(2.0 * STREET_FLOOR);
    let own = |v: VertexIx| vertices.contains(&v);
    canvas.overlapping(bounds).filter(|s| s.is_wall() || !(own(s.va) && own(s.vb))).all(|s| {
        let distance = |line: &[DVec2]| {
            segments(line).map(|(a, b)| segment_distance(a, b, s.a, s.b)).fold(f64::INFINITY, f64::min)
        };
        let floor = if s.is_wall() { s.floor } else { STREET_FLOOR };
        let now = distance(curve);
        now >= floor || now >= distance(line)
    })
}
