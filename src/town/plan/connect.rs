//! Curved streets that connect gates and dead ends to the network.

use super::curves::{cubic, simplified};
use super::proposal::Proposal;
use super::rules::Limits;
use super::sketch::{End, Sketch};
use crate::layer::{Cancel, LayerError};
use crate::network::VertexIx;
use crate::space::math::{angle_between, rotate};
use crate::space::{Bounds, closest_on_segment, left_normal, quantize};
use glam::DVec2;

/// Length of the straight piece with which a street leaves its gate, in metres: there it keeps the road's heading.
const STRAIGHT: f64 = 26.0;

/// Number of curves that are tried from one point.
const MOST_TRIES: usize = 160;

/// A curve to a point of the network.
struct Candidate {
    score: f64,
    end: End,
    from: DVec2,
    leaving: DVec2,
    at: DVec2,
    arriving: DVec2,
}

impl Candidate {
    fn points(&self) -> Vec<DVec2> {
        cubic(self.from, self.leaving, self.at, self.arriving)
    }
}

/// Connects every gate that has no street yet to the network, gates of the widest roads first. Always succeeds while the
/// network holds the centre or runs around it.
pub(super) fn connect_gates(sketch: &mut Sketch, cancel: &Cancel) -> Result<(), LayerError> {
    let mut order: Vec<usize> = (0..sketch.site.gates.len()).filter(|g| sketch.gate_vertices[*g].is_none()).collect();
    order.sort_by_key(|g| (sketch.site.gates[*g].class, sketch.site.gates[*g].vertex));
    for gate in order {
        cancel.check()?;
        if !connect_by_curve(sketch, gate) {
            connect_straight(sketch, gate);
        }
    }
    Ok(())
}

/// Connects a gate by a curve, with demands that fall step by step; returns whether a curve was found.
fn connect_by_curve(sketch: &mut Sketch, gate: usize) -> bool {
    let full = sketch.rules.limits();
    let (at, inward) = (sketch.site.gates[gate].at, sketch.site.gates[gate].inward);
    let easier = |gap: f64, min_angle: f64, max_turn: f64| Limits {
        gap: full.gap.min(gap),
        min_angle: full.min_angle.min(min_angle),
        min_length: full.min_length.min(gap),
        min_part: full.min_part.min(1.5 * gap),
        margin: full.margin.min(gap),
        max_turn,
        ..full
    };
    let steps = [
        (Limits { max_turn: 0.42, min_length: 60.0, gap: 0.85 * full.gap, ..full }, 0.0),
        (easier(50.0, 0.9, 0.45), 0.0),
        (easier(36.0, 0.75, 0.5), 0.35),
        (Limits { checks_ground: false, ..easier(36.0, 0.75, 0.6) }, 0.5),
        (Limits { checks_ground: false, ..easier(22.0, 0.6, 0.7) }, 0.9),
    ];
    // The distance to the network decides how far to look.
    let near = sketch.graph.nearest_edge(at, 1e6, |_| false).map_or(0.0, |(_, d)| d);
    for (limits, swing) in steps {
        let reach = near + sketch.rules.length + 60.0;
        let swings: &[f64] = if swing == 0.0 { &[0.0] } else { &[0.0, -swing, swing] };
        let mut all: Vec<Candidate> = swings
            .iter()
            .flat_map(|s| {
                let heading = rotate(inward, *s);
                candidates(sketch, at + heading * STRAIGHT.min(0.3 * near), heading, reach, &limits)
            })
            .collect();
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        for c in all.into_iter().take(MOST_TRIES) {
            let mut path = vec![at];
            path.extend(c.points());
            let path = simplified(path);
            if path.len() > 1 && Proposal::new(&path, End::Gate(gate), c.end).fits(sketch, &limits) {
                sketch.add(&path, End::Gate(gate), c.end);
                return true;
            }
        }
    }
    false
}

/// Connects a gate by the straight line to the centre, up to the first street on the way. The outline is star-shaped, so the
/// line stays inside.
fn connect_straight(sketch: &mut Sketch, gate: usize) {
    let at = sketch.site.gates[gate].at;
    let hit = sketch.graph.first_hit(at, DVec2::ZERO, |_| false);
    let mut ends = Vec::new();
    if let Some(hit) = hit {
        // Ending at a junction beside the meeting point avoids a piece of street of a few metres.
        let edge = sketch.graph.edge(hit.edge);
        let near = |v: &VertexIx| sketch.graph.at(*v).distance(hit.at) < 15.0 && !sketch.is_gate(*v);
        ends.extend([edge.a, edge.b].into_iter().filter(near).map(End::Vertex));
        ends.push(End::Edge(hit.edge, hit.at));
    } else {
        ends.extend(sketch.graph.vertices().next().map(End::Vertex));
    }
    let position = |end: End| match end {
        End::Vertex(v) => sketch.graph.at(v),
        End::Edge(_, p) => quantize(p),
        _ => at,
    };
    let last = ends.len().saturating_sub(1);
    let fits = |i: usize| {
        i == last || {
            let path = [at, position(ends[i])];
            Proposal::new(&path, End::Gate(gate), ends[i]).crosses_nothing(sketch)
        }
    };
    if let Some(end) = (0..ends.len()).find(|i| fits(*i)).map(|i| ends[i]) {
        let mut path = vec![at];
        if let Some(river) = &sketch.site.river {
            path.extend(river.bank_crossings(at, position(end)));
        }
        path.push(position(end));
        path.dedup();
        sketch.add(&path, End::Gate(gate), end);
    }
}

/// Connects dead ends to nearby streets and junctions, each by the best curve that keeps to the rules.
pub(super) fn connect_dead_ends(sketch: &mut Sketch, cancel: &Cancel) -> Result<(), LayerError> {
    let mut dead_ends = sketch.dead_ends();
    dead_ends.sort_by(|a, b| {
        let distance = |v: &VertexIx| sketch.graph.at(*v).length();
        distance(a).total_cmp(&distance(b)).then(a.cmp(b))
    });
    let full = sketch.rules.limits();
    let limits = Limits { margin: 0.75 * full.margin, max_turn: 0.55, gap: 0.9 * full.gap, ..full };
    for v in dead_ends {
        cancel.check()?;
        let g = &sketch.graph;
        let [e] = *g.edges_at(v) else { continue };
        let at = g.at(v);
        let heading = (at - g.at(g.edge(e).other(v))).normalize_or_zero();
        let mut all = candidates(sketch, at, heading, 1.7 * sketch.rules.length, &limits);
        // A street with a corner is better than none, and a street with a bend is better than one with a corner.
        for c in candidates(sketch, at, DVec2::ZERO, 1.7 * sketch.rules.length, &limits) {
            let corner = angle_between(heading, c.leaving);
            if corner < 1.6 {
                all.push(Candidate { score: c.score + 150.0 * corner, ..c });
            }
        }
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        for c in all.into_iter().take(MOST_TRIES) {
            let path = simplified(c.points());
            if path.len() > 1 && Proposal::new(&path, End::Vertex(v), c.end).fits(sketch, &limits) {
                sketch.add(&path, End::Vertex(v), c.end);
                break;
            }
        }
    }
    Ok(())
}

/// Curves from `from` to streets and junctions within reach. They leave with `heading`, or straight for their target if
/// `heading` is zero.
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
            // A dead end gains most by a street. A junction is better than a point of inflexion, which would become a junction.
            let extra = match degree {
                1 => -0.5 * sketch.rules.length,
                2 => 90.0,
                _ => 0.0,
            };
            let beeline = (p - from).normalize_or_zero();
            let mut corner = f64::INFINITY;
            for w in g.neighbours(v) {
                let on = (g.at(w) - p).normalize_or_zero();
                // A street that leads on to the centre is better than one that leads around it.
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
