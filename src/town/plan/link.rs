//! Curved streets that tie something to the network: gates, and streets that would otherwise end in nothing.

use super::grow::STEP;
use super::sketch::{End, Limits, Sketch, tidy};
use super::water::fords;
use crate::layer::{Cancel, LayerError};
use crate::network::VertexIx;
use crate::space::math::{angle_between, rotate};
use crate::space::{Bounds, closest_on_segment, left_normal, quantize};
use glam::DVec2;

/// Straight piece with which a street leaves its gate, in metres: the road's heading goes on into the town.
const LEAD: f64 = 26.0;

/// Number of curves that are tried from one place.
const MOST_TRIES: usize = 160;

/// A curve to a place on the network.
struct Candidate {
    score: f64,
    end: End,
    from: DVec2,
    leaving: DVec2,
    at: DVec2,
    arriving: DVec2,
}

/// Ties every gate to the network, the widest roads first. Always succeeds while the network holds the centre or runs
/// around it. Gates that have a street already are left alone.
pub(super) fn tie_gates(sketch: &mut Sketch, cancel: &Cancel) -> Result<(), LayerError> {
    let mut order: Vec<usize> = (0..sketch.gates.len()).filter(|g| sketch.gate_vertices[*g].is_none()).collect();
    order.sort_by_key(|g| (sketch.gates[*g].class, sketch.gates[*g].vertex));
    for gate in order {
        cancel.check()?;
        if !tie(sketch, gate) {
            tie_by_ray(sketch, gate);
        }
    }
    Ok(())
}

/// Ties a gate by a curve, with demands that fall step by step.
fn tie(sketch: &mut Sketch, gate: usize) -> bool {
    let full = sketch.limits();
    let (at, inward) = (sketch.gates[gate].at, sketch.gates[gate].inward);
    let easier = |gap: f64, angle: f64, turn: f64| Limits {
        gap: full.gap.min(gap),
        angle: full.angle.min(angle),
        min_length: full.min_length.min(gap),
        split: full.split.min(1.5 * gap),
        margin: full.margin.min(gap),
        turn,
        ..full
    };
    let steps = [
        (Limits { turn: 0.42, min_length: 60.0, gap: 0.85 * full.gap, ..full }, 0.0),
        (easier(50.0, 0.9, 0.45), 0.0),
        (easier(36.0, 0.75, 0.5), 0.35),
        (Limits { ground: false, ..easier(36.0, 0.75, 0.6) }, 0.5),
        (Limits { ground: false, ..easier(22.0, 0.6, 0.7) }, 0.9),
    ];
    // How far away the network is decides how far to look.
    let near = sketch.graph.nearest_edge(at, 1e6, |_| false).map_or(0.0, |(_, d)| d);
    for (limits, swing) in steps {
        let reach = near + sketch.rules.length + 60.0;
        let swings: &[f64] = if swing == 0.0 { &[0.0] } else { &[0.0, -swing, swing] };
        let mut all: Vec<Candidate> = swings
            .iter()
            .flat_map(|s| {
                let heading = rotate(inward, *s);
                candidates(sketch, at + heading * LEAD.min(0.3 * near), heading, reach, &limits)
            })
            .collect();
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        for c in all.into_iter().take(MOST_TRIES) {
            let mut path = vec![at];
            path.extend(curve(&c));
            let path = tidy(path);
            if path.len() > 1 && sketch.fits(&path, End::Gate(gate), c.end, &limits) {
                sketch.add(&path, End::Gate(gate), c.end);
                return true;
            }
        }
    }
    false
}

/// Ties a gate by the straight line to the centre, up to the first street that it meets: the outline is star-shaped, so
/// the line stays inside.
fn tie_by_ray(sketch: &mut Sketch, gate: usize) {
    let at = sketch.gates[gate].at;
    let hit = sketch.graph.first_hit(at, DVec2::ZERO, |_| false);
    let mut ends = Vec::new();
    if let Some(hit) = hit {
        // A junction beside the meeting point spares a piece of street of a few metres.
        let edge = sketch.graph.edge(hit.edge);
        let near = |v: &VertexIx| sketch.graph.at(*v).distance(hit.at) < 15.0 && !sketch.is_gate(*v);
        ends.extend([edge.a, edge.b].into_iter().filter(near).map(End::Vertex));
        ends.push(End::Edge(hit.edge, hit.at));
    } else {
        ends.extend(sketch.graph.vertices().next().map(End::Vertex));
    }
    let place = |end: End| match end {
        End::Vertex(v) => sketch.graph.at(v),
        End::Edge(_, p) => quantize(p),
        _ => at,
    };
    let last = ends.len().saturating_sub(1);
    let fits = |i: usize| i == last || sketch.crosses_nothing(&[at, place(ends[i])], End::Gate(gate), ends[i]);
    if let Some(end) = (0..ends.len()).find(|i| fits(*i)).map(|i| ends[i]) {
        let mut path = vec![at];
        if let Some(river) = &sketch.river {
            path.extend(fords(river.way, at, place(end)));
        }
        path.push(place(end));
        path.dedup();
        sketch.add(&path, End::Gate(gate), end);
    }
}

/// Connects streets that end in nothing to what is near, each by the best curve that keeps to the rules.
pub(super) fn link_tips(sketch: &mut Sketch, cancel: &Cancel) -> Result<(), LayerError> {
    let mut tips = sketch.tips();
    tips.sort_by(|a, b| {
        let distance = |v: &VertexIx| sketch.graph.at(*v).length();
        distance(a).total_cmp(&distance(b)).then(a.cmp(b))
    });
    let full = sketch.limits();
    let limits = Limits { margin: 0.75 * full.margin, turn: 0.55, gap: 0.9 * full.gap, ..full };
    for v in tips {
        cancel.check()?;
        let g = &sketch.graph;
        let [e] = *g.edges_at(v) else { continue };
        let at = g.at(v);
        let heading = (at - g.at(g.edge(e).other(v))).normalize_or_zero();
        let mut all = candidates(sketch, at, heading, 1.7 * sketch.rules.length, &limits);
        // A corner is better than no street, but a bend is better than a corner.
        for c in candidates(sketch, at, DVec2::ZERO, 1.7 * sketch.rules.length, &limits) {
            let corner = angle_between(heading, c.leaving);
            if corner < 1.6 {
                all.push(Candidate { score: c.score + 150.0 * corner, ..c });
            }
        }
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        for c in all.into_iter().take(MOST_TRIES) {
            let path = tidy(curve(&c));
            if path.len() > 1 && sketch.fits(&path, End::Vertex(v), c.end, &limits) {
                sketch.add(&path, End::Vertex(v), c.end);
                break;
            }
        }
    }
    Ok(())
}

/// Curves from `from`, leaving with `heading` (straight for the target when zero), to what lies within reach.
fn candidates(sketch: &Sketch, from: DVec2, heading: DVec2, reach: f64, limits: &Limits) -> Vec<Candidate> {
    let g = &sketch.graph;
    let mut out = Vec::new();
    let mut offer = |end: End, at: DVec2, arriving: DVec2, extra: f64| {
        let line = at - from;
        let distance = line.length();
        let beeline = line / distance;
        let leaving = if heading == DVec2::ZERO { beeline } else { heading };
        let (t0, t1) = (angle_between(leaving, beeline), angle_between(beeline, arriving));
        if distance < reach && distance > 0.5 * limits.min_length && t0 < 1.3 && t1 < 1.2 {
            let score = distance + 130.0 * (t0 + t1) + extra;
            out.push(Candidate { score, end, from, leaving, at, arriving });
        }
    };
    let mut seen = vec![false; g.vertex_count()];
    for e in g.edges_near(Bounds::of([from]).grown(reach)) {
        let edge = g.edge(e);
        for v in [edge.a, edge.b] {
            if seen[v as usize] || g.at(v) == from || sketch.is_gate(v) {
                continue;
            }
            seen[v as usize] = true;
            let (p, degree) = (g.at(v), g.degree(v));
            // A loose end is glad of company; a junction where the street runs on is better than one where it stops.
            let extra = match degree {
                1 => -0.5 * sketch.rules.length,
                2 => 90.0,
                _ => 0.0,
            };
            let beeline = (p - from).normalize_or_zero();
            let mut corner = f64::INFINITY;
            for w in g.neighbours(v) {
                let on = (g.at(w) - p).normalize_or_zero();
                // What leads on to the centre is better than what leads around it.
                let detour = angle_between(on, -p);
                corner = corner.min(angle_between(on, beeline));
                offer(End::Vertex(v), p, on, extra + 35.0 * detour);
            }
            let stop = if degree == 1 { 250.0 * corner } else { 80.0 };
            offer(End::Vertex(v), p, beeline, extra + stop);
        }
        let (a, b) = (g.at(edge.a), g.at(edge.b));
        let normal = left_normal(b - a).normalize_or_zero();
        let towards = if normal.dot(a - from) < 0.0 { -normal } else { normal };
        let (foot, _) = closest_on_segment(from, a, b);
        for t in [foot, 0.25, 0.75] {
            if t > 0.05 && t < 0.95 {
                let p = quantize(a.lerp(b, t));
                offer(End::Edge(e, p), p, towards, 120.0);
                offer(End::Edge(e, p), p, (p - from).normalize_or_zero(), 135.0);
            }
        }
    }
    out
}

/// Points of the cubic curve of a candidate.
fn curve(c: &Candidate) -> Vec<DVec2> {
    smooth(c.from, c.leaving, c.at, c.arriving)
}

/// Points of a cubic curve between two places with directions at both ends.
pub(super) fn smooth(from: DVec2, leaving: DVec2, to: DVec2, arriving: DVec2) -> Vec<DVec2> {
    let distance = from.distance(to);
    let (p1, p2) = (from + leaving * (0.37 * distance), to - arriving * (0.37 * distance));
    let turns = angle_between(leaving, to - from) + angle_between(to - from, arriving);
    // Short steps where it bends, so that no point of inflexion is a corner.
    let parts = (distance / STEP).max(turns / 0.24).round().clamp(1.0, 40.0);
    (0..=parts as usize)
        .map(|i| {
            let t = i as f64 / parts;
            let s = 1.0 - t;
            from * (s * s * s) + p1 * (3.0 * s * s * t) + p2 * (3.0 * s * t * t) + to * (t * t * t)
        })
        .collect()
}
