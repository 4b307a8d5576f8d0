//! Repairs of the grown network: streets divide faces that are too large, streets around faces that are too small are removed,
//! and corners become round.

use super::curves::{STEP, cubic, simplified};
use super::proposal::Proposal;
use super::sketch::{End, Sketch};
use crate::layer::{Cancel, LayerError};
use crate::network::{EdgeIx, Face, StreetClass, VertexIx};
use crate::space::math::{angle_between, cos};
use crate::space::{left_normal, pole, quantize, segments, signed_area};
use crate::town::DirectionField;
use glam::DVec2;
use std::f64::consts::PI;

/// Least area of a main cell, in square metres, and as a share of a cell of regular growth.
const MIN_AREA: (f64, f64) = (2500.0, 0.12);
/// Least radius of the largest circle in a main cell, in metres, and as a share of the length of a street.
const MIN_INRADIUS: (f64, f64) = (15.0, 0.1);
/// Cells larger than this many cells of regular growth are divided.
const LARGE: f64 = 1.9;
/// Points of inflexion that turn by more than this are rounded, in radians.
const SHARP: f64 = 0.45;
/// Greatest distance from a corner at which its rounding begins, in metres.
const CORNER: f64 = 45.0;
/// Distance that a rounded corner keeps from streets that it does not join, in metres.
const CORNER_ROOM: f64 = 18.0;

/// A point of a face's border from which a street could cross the face.
struct Start {
    end: End,
    at: DVec2,
    /// Index of the half-edge of the walk that the point lies on or begins.
    index: usize,
    /// Best direction into the face.
    inward: DVec2,
}

/// Divides inner faces that are much larger than the style's cells by streets across them.
pub(super) fn divide_large_faces(
    sketch: &mut Sketch,
    field: &DirectionField,
    cancel: &Cancel,
) -> Result<(), LayerError> {
    let most = LARGE * sketch.rules.length * sketch.rules.length;
    for _ in 0..4 {
        let large: Vec<Face> = sketch.graph.faces().into_iter().filter(|f| f.area() > most).collect();
        let mut changed = false;
        for face in large {
            cancel.check()?;
            // A street across one face may end on the border of the next, which then has to be walked anew.
            let fresh = face.walk.iter().all(|h| sketch.graph.is_live(h.edge));
            changed |= !fresh || divide(sketch, field, &face);
        }
        if !changed {
            break;
        }
    }
    Ok(())
}

fn divide(sketch: &mut Sketch, field: &DirectionField, face: &Face) -> bool {
    let (g, n) = (&sketch.graph, face.walk.len());
    let limits = sketch.rules.limits();
    let mut starts = Vec::new();
    for i in 0..n {
        let v = face.vertices[i];
        let (at, next, last) = (face.polygon[i], face.polygon[(i + 1) % n], face.polygon[(i + n - 1) % n]);
        if g.degree(v) < sketch.rules.degree.1 && !sketch.is_gate(v) {
            let (out, back) = ((next - at).normalize_or_zero(), (last - at).normalize_or_zero());
            // Inward is between the two neighbours, on the left of the walk.
            let middle = out + back;
            let inward = if middle.length() < 0.2 {
                left_normal(out)
            } else if out.perp_dot(back) > 0.0 {
                middle.normalize()
            } else {
                -middle.normalize()
            };
            starts.push(Start { end: End::Vertex(v), at, index: i, inward });
        }
        let steps = (at.distance(next) / STEP).floor() as usize;
        for k in 1..=steps {
            let p = at.lerp(next, k as f64 / (steps + 1) as f64);
            let inward = left_normal(next - at).normalize_or_zero();
            starts.push(Start { end: End::Edge(face.walk[i].edge, p), at: p, index: i, inward });
        }
    }
    let area = face.area();
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, a) in starts.iter().enumerate() {
        for (j, b) in starts.iter().enumerate().skip(i + 1) {
            let line = b.at - a.at;
            let distance = line.length();
            if distance < limits.min_length || distance > 2.2 * sketch.rules.length || a.index == b.index {
                continue;
            }
            let beeline = line / distance;
            let (t0, t1) = (angle_between(a.inward, beeline), angle_between(b.inward, -beeline));
            if t0 > 0.8 || t1 > 0.8 {
                continue;
            }
            let mut part = vec![a.at];
            part.extend_from_slice(&face.polygon[a.index + 1..=b.index]);
            part.push(b.at);
            let share = signed_area(&part) / area;
            let balance = share.min(1.0 - share);
            if balance < 0.22 {
                continue;
            }
            let middle = a.at.lerp(b.at, 0.5);
            let off = angle_between(field.along(middle, beeline), beeline);
            let vertices = [a, b].iter().filter(|p| matches!(p.end, End::Vertex(_))).count() as f64;
            let score =
                distance * (1.0 + 0.4 * (1.0 - cos(4.0 * off))) / balance.sqrt() + 80.0 * (t0 + t1) - 40.0 * vertices;
            pairs.push((score, i, j));
        }
    }
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    for (_, i, j) in pairs.into_iter().take(60) {
        let (a, b) = (&starts[i], &starts[j]);
        let beeline = (b.at - a.at).normalize_or_zero();
        // The street meets the streets at its ends more squarely than the straight line would.
        let blend = |inward: DVec2, line: DVec2| (line * 2.0 + inward).normalize_or_zero();
        let path = simplified(cubic(a.at, blend(a.inward, beeline), b.at, -blend(b.inward, -beeline)));
        if path.len() > 1 && Proposal::new(&path, a.end, b.end).fits(sketch, &limits) {
            sketch.add(&path, a.end, b.end);
            return true;
        }
    }
    false
}

/// Removes the streets inside a face that hang on one junction of its border.
pub(super) fn drop_pockets(sketch: &mut Sketch, cancel: &Cancel) -> Result<(), LayerError> {
    // Each round removes streets, so this ends. The bound only limits the time.
    for _ in 0..64 {
        cancel.check()?;
        let pocket = sketch.graph.faces().iter().filter(|f| f.area() > 0.0).find_map(|face| {
            let mut visits: Vec<(VertexIx, usize)> = face.vertices.iter().copied().zip(0..).collect();
            visits.sort_unstable();
            let (p, q) = visits.windows(2).find(|w| w[0].0 == w[1].0).map(|w| (w[0].1, w[1].1))?;
            // The walk goes around the pocket the other way.
            let inside = signed_area(&face.polygon[p..q]) <= 0.0;
            let next = if inside { p + 1 } else { (q + 1) % face.walk.len() };
            Some((face.vertices[p], face.vertices[next]))
        });
        let Some((knot, first)) = pocket else { break };
        let mut stack = vec![first];
        while let Some(v) = stack.pop() {
            for e in sketch.graph.edges_at(v).to_vec() {
                let other = sketch.graph.edge(e).other(v);
                sketch.graph.remove_edge(e);
                if other != knot {
                    stack.push(other);
                }
            }
        }
        sketch.prune();
    }
    Ok(())
}

/// Rounds sharp points of inflexion.
pub(super) fn round_corners(sketch: &mut Sketch) {
    for v in sketch.graph.vertices() {
        let g = &sketch.graph;
        let [e, f] = *g.edges_at(v) else { continue };
        if sketch.is_on_bank(v) {
            continue;
        }
        let (a, b, at) = (g.edge(e).other(v), g.edge(f).other(v), g.at(v));
        let (to_a, to_b) = (g.at(a) - at, g.at(b) - at);
        let turn = PI - angle_between(to_a, to_b);
        if turn < SHARP || to_a.length().min(to_b.length()) < 24.0 {
            continue;
        }
        let reach = (0.45 * to_a.length().min(to_b.length())).min(CORNER);
        let (p, q) = (at + to_a.normalize_or_zero() * reach, at + to_b.normalize_or_zero() * reach);
        let parts = (turn / 0.3).ceil();
        let mut path = vec![g.at(a)];
        path.extend((0..=parts as usize).map(|i| {
            let t = i as f64 / parts;
            quantize(p.lerp(at, t).lerp(at.lerp(q, t), t))
        }));
        path.push(g.at(b));
        // The curve stays within the corner: only what lies there could be in its way.
        let near = |x: EdgeIx| [a, b, v].iter().any(|w| g.edges_at(*w).contains(&x));
        if segments(&path[1..path.len() - 1]).any(|(c, d)| g.clearance(c, d, CORNER_ROOM, near) < CORNER_ROOM) {
            continue;
        }
        for e in [e, f] {
            sketch.graph.remove_edge(e);
        }
        sketch.add(&path, End::Vertex(a), End::Vertex(b));
    }
}

/// Removes streets other than arterials around faces that are too small or too narrow to be filled.
pub(super) fn drop_slivers(sketch: &mut Sketch, cancel: &Cancel) -> Result<(), LayerError> {
    let length = sketch.rules.length;
    let least_area = MIN_AREA.0.max(MIN_AREA.1 * length * length);
    let least_radius = MIN_INRADIUS.0.max(MIN_INRADIUS.1 * length);
    // Each removal joins two faces, so this ends. The bound only limits the time.
    for _ in 0..64 {
        cancel.check()?;
        let faces = sketch.graph.faces();
        let sliver = |f: &Face| {
            if sketch.site.river.as_ref().is_some_and(|river| river.is_water(&sketch.graph, f)) {
                return false;
            }
            let area = f.area();
            let around: f64 = f.walk.iter().map(|h| sketch.graph.edge_length(h.edge)).sum();
            // No region has an inradius below its area over its perimeter.
            area > 0.0
                && (area < least_area || (area < least_radius * around && pole(&f.polygon, 2.0).1 < least_radius))
        };
        let victim = faces.iter().filter(|f| sliver(f)).find_map(|f| longest_street(sketch, f));
        let Some(street) = victim else { break };
        let before = sketch.graph.clone();
        for e in street {
            sketch.graph.remove_edge(e);
        }
        sketch.prune();
        if sketch.is_empty() {
            // A small ring is better than no street.
            sketch.graph = before;
            break;
        }
    }
    Ok(())
}

/// The longest street of a face, except arterials, quays, bridges and streets that lead to gates.
fn longest_street(sketch: &Sketch, face: &Face) -> Option<Vec<EdgeIx>> {
    let g = &sketch.graph;
    let ends = |v| g.degree(v) != 2;
    let around: Vec<EdgeIx> = face.walk.iter().map(|h| h.edge).collect();
    let mut best: Option<(f64, Vec<EdgeIx>)> = None;
    for chain in g.chains(ends) {
        let edges: Vec<EdgeIx> = chain.iter().map(|(e, _)| *e).collect();
        let to_gate = || g.chain_vertices(&chain).into_iter().any(|v| sketch.is_gate(v));
        let waterside = |e: &EdgeIx| sketch.site.river.as_ref().is_some_and(|river| river.has_street(g, *e));
        if !around.contains(&edges[0])
            || edges.iter().any(waterside)
            || edges.iter().any(|e| g.edge(*e).data == StreetClass::Arterial)
            || to_gate()
        {
            continue;
        }
        let length: f64 = edges.iter().map(|e| g.edge_length(*e)).sum();
        if best.as_ref().is_none_or(|(l, _)| length > *l) {
            best = Some((length, edges));
        }
    }
    best.map(|(_, edges)| edges)
}
