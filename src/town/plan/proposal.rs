//! The test that every proposed main street must pass.

use super::rules::Limits;
use super::sketch::{End, Sketch};
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use crate::space::math::{angle_between, sin};
use crate::space::{distance_to_segment, line_length, point_in_polygon, segments};
use glam::DVec2;

/// Length of the pieces for which the distance to other streets is measured, in metres.
const PIECE: f64 = 24.0;
/// Least distance between two points of a street, in metres.
const SHORTEST: f64 = 8.0;
/// Angle between a border and a street that meets it, in radians, where the limits do not ask for more.
const BORDER_ANGLE: f64 = 0.75;
/// Angle between the outline and a road that enters at a gate, in radians.
const GATE_ANGLE: f64 = 0.2;
/// Distance that streets keep from the gates of other streets, in metres.
const GATE_ROOM: f64 = 45.0;

/// A street that could be added to a sketch.
#[derive(Clone, Copy)]
pub(super) struct Proposal<'a> {
    pub path: &'a [DVec2],
    /// What the first point of the path attaches to.
    pub start: End,
    /// What the last point of the path attaches to.
    pub end: End,
}

impl<'a> Proposal<'a> {
    pub fn new(path: &'a [DVec2], start: End, end: End) -> Self {
        Self { path, start, end }
    }

    /// Whether the street keeps to the limits: constraints 2 to 4 of Teng 2017, section 3.3, and the reasons for which
    /// connecting and clipping discard a street. The street must also keep a distance from every other street that grows with
    /// the distance from its own ends, so that no street runs beside another.
    pub fn fits(&self, sketch: &Sketch, limits: &Limits) -> bool {
        let (path, n) = (self.path, self.path.len());
        let turns = || path.windows(3).map(|w| angle_between(w[1] - w[0], w[2] - w[1]));
        let same_edge = matches!((self.start, self.end), (End::Edge(e, _), End::Edge(f, _)) if e == f);
        !same_edge
            && line_length(path) >= limits.min_length
            && segments(path).all(|(a, b)| a.distance(b) >= SHORTEST)
            && turns().all(|t| t <= limits.max_turn)
            && end_fits(sketch, self.start, path[1] - path[0], limits)
            && end_fits(sketch, self.end, path[n - 2] - path[n - 1], limits)
            && self.crosses_nothing(sketch)
            && self.keeps_clear(sketch, limits)
            && (!limits.checks_ground || sketch.site.ground_fits(path))
    }

    /// Whether the street meets other streets and the outline only at its ends. Exact.
    pub fn crosses_nothing(&self, sketch: &Sketch) -> bool {
        let (path, site) = (self.path, &sketch.site);
        let last = path.len() - 2;
        let touches = |end: End, e: EdgeIx| match end {
            End::Vertex(v) => sketch.graph.edges_at(v).contains(&e),
            End::Edge(f, _) => e == f,
            _ => false,
        };
        let starts_inside = match self.start {
            End::Gate(_) => point_in_polygon(path[0].lerp(path[1], 0.01), site.outline),
            _ => true,
        };
        starts_inside
            && segments(path).enumerate().all(|(i, (a, b))| {
                let own = |e| (i == 0 && touches(self.start, e)) || (i == last && touches(self.end, e));
                let at_gate = |e: EdgeIx| match self.start {
                    End::Gate(gate) if i == 0 => site.ends_at_gate(e, gate),
                    _ => false,
                };
                sketch.graph.first_hit(a, b, own).is_none()
                    && site.ring.first_hit(a, b, at_gate).is_none()
                    && !site.is_blocked(a, b)
            })
    }

    /// Whether the street keeps its distance from other streets, the outline and gates.
    fn keeps_clear(&self, sketch: &Sketch, limits: &Limits) -> bool {
        let (path, site) = (self.path, &sketch.site);
        let (first, last) = (path[0], path[path.len() - 1]);
        // Streets that part at the least angle, and bend towards each other a little, keep this share of the distance.
        let share = 0.75 * sin(limits.min_angle);
        let distance = |end: End, at: DVec2, a: DVec2, b: DVec2| match end {
            End::Free => f64::INFINITY,
            _ => at.distance(a).min(at.distance(b)),
        };
        let at_gate = matches!(self.start, End::Gate(_));
        segments(path).all(|(from, to)| {
            // Far enough from the ends, the whole segment has to keep the full distance and need not be divided.
            let near =
                distance(self.start, first, from, to).min(distance(self.end, last, from, to)) - from.distance(to) / 2.0;
            let whole = share * near >= limits.gap && (!at_gate || 0.3 * near >= limits.margin);
            let pieces = if whole { 1.0 } else { (from.distance(to) / PIECE).ceil().max(1.0) };
            (0..pieces as usize).all(|i| {
                let (a, b) = (from.lerp(to, i as f64 / pieces), from.lerp(to, (i + 1) as f64 / pieces));
                let near_start = distance(self.start, first, a, b);
                let near = near_start.min(distance(self.end, last, a, b));
                let gap = limits.gap.min(share * near);
                let margin = if at_gate { limits.margin.min(0.3 * near_start) } else { limits.margin };
                let gate_room = GATE_ROOM.min(limits.gap).min(0.5 * near);
                let mut gates = site.gates.iter().enumerate();
                sketch.graph.clearance(a, b, gap, |_| false) >= gap
                    && site.ring.clearance(a, b, margin, |_| false) >= margin
                    && gates
                        .all(|(g, gate)| self.start == End::Gate(g) || distance_to_segment(gate.at, a, b) >= gate_room)
            })
        })
    }
}

/// Whether a street may be attached to an end that it leaves in the direction `leaving`.
fn end_fits(sketch: &Sketch, end: End, leaving: DVec2, limits: &Limits) -> bool {
    let g = &sketch.graph;
    match end {
        End::Free => true,
        End::Gate(i) => {
            let gate = &sketch.site.gates[i];
            // Along a border the outline is a street.
            let least = if gate.class.is_main() { limits.min_angle.min(BORDER_ANGLE) } else { GATE_ANGLE };
            let at = sketch.site.outline[gate.vertex];
            sketch.site.beside_gate(i).iter().all(|p| angle_between(*p - at, leaving) > least)
        }
        End::Vertex(v) => {
            g.degree(v) < sketch.rules.degree.1
                && !sketch.is_gate(v)
                && g.smallest_angle(v, leaving) >= limits.min_angle
                && (g.degree(v) != 2
                    || g.edges_at(v).iter().all(|e| is_long_enough(g, *e, v, g.at(v), limits.min_part)))
        }
        End::Edge(e, p) => {
            let edge = g.edge(e);
            [edge.a, edge.b].iter().all(|v| {
                g.at(*v).distance(p) >= SHORTEST
                    && angle_between(g.at(*v) - p, leaving) >= limits.min_angle
                    && is_long_enough(g, e, edge.other(*v), p, limits.min_part)
            })
        }
    }
}

/// Whether the street of `edge` runs on from `p`, away from the vertex `from`, for at least `length` metres before its
/// next junction.
fn is_long_enough(g: &PlanarGraph<StreetClass>, edge: EdgeIx, from: VertexIx, p: DVec2, length: f64) -> bool {
    let (mut e, mut v, mut at, mut run) = (edge, from, p, 0.0);
    loop {
        v = g.edge(e).other(v);
        run += at.distance(g.at(v));
        at = g.at(v);
        if run >= length {
            return true;
        }
        match g.edges_at(v) {
            [a, b] => e = if *a == e { *b } else { *a },
            _ => return false,
        }
    }
}
