//! The network of main streets while it grows, and the test that every proposed street must pass.

use super::water::River;
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use crate::region::Gate;
use crate::space::math::{angle_between, sin};
use crate::space::{Origin, distance_to_segment, line_length, point_in_polygon, quantize, segments};
use crate::style::MainRules;
use crate::terrain::Terrain;
use glam::DVec2;

/// Steepest grade of a main street (rise over run).
const MAX_GRADE: f64 = 0.16;
/// Distance between the points at which a proposed street looks at the ground, in metres.
const GROUND_STEP: f64 = 25.0;
/// Length of the pieces whose distance to other streets is looked at, in metres.
const PIECE: f64 = 24.0;
/// Least distance between two points of a street, in metres.
const SHORTEST: f64 = 8.0;
/// Angle between a border and a street that meets it, in radians, where nothing asks for more.
const BORDER_ANGLE: f64 = 0.75;
/// Distance that streets keep from gates of others, in metres.
const GATE_ROOM: f64 = 45.0;

/// The style's rules, fitted to the size of the settlement. Metres and radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    pub length: f64,
    pub deviation: f64,
    pub min_length: f64,
    pub degree: (usize, usize),
    pub angle: f64,
    pub angle_deviation: f64,
    pub snap: f64,
    /// Least distance between streets away from their common junction.
    pub gap: f64,
    /// Least distance to the outline, but at gates.
    pub margin: f64,
}

impl Rules {
    /// Rules of a settlement whose outline has the area of a circle of `radius`.
    pub fn new(rules: &MainRules, radius: f64) -> Self {
        let length = rules.length.min(0.55 * radius).max(60.0);
        let scale = length / rules.length;
        let min_length = rules.min_length.min(0.7 * length);
        Self {
            length,
            deviation: rules.deviation * scale,
            min_length,
            degree: (rules.degree.0 as usize, rules.degree.1 as usize),
            angle: rules.min_angle_deg.to_radians(),
            angle_deviation: rules.angle_deviation_deg.to_radians(),
            snap: rules.snap_radius * scale,
            gap: (0.36 * length).clamp(50.0, 100.0),
            margin: (0.3 * length).clamp(60.0, 120.0),
        }
    }
}

/// Where a proposed street begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// At a vertex of the network.
    Vertex(VertexIx),
    /// On an edge of the network, at this point.
    Edge(EdgeIx, DVec2),
    /// At a gate that has no street yet.
    Gate(usize),
    /// At a place where nothing is.
    Free,
}

/// What a proposed street must keep to. Metres and radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub gap: f64,
    pub angle: f64,
    pub min_length: f64,
    /// Least length of the parts of a street that is split.
    pub split: f64,
    pub margin: f64,
    /// Greatest turn at a point of inflexion.
    pub turn: f64,
    /// Whether it must keep off water and steep ground.
    pub ground: bool,
}

/// The network of main streets while it grows. Edges carry their class.
pub(super) struct Sketch<'a> {
    pub graph: PlanarGraph<StreetClass>,
    /// The outline: vertex and edge i are those of the polygon.
    pub ring: PlanarGraph<()>,
    pub outline: &'a [DVec2],
    pub gates: &'a [Gate],
    /// Vertex in `graph` of each gate that has a street.
    pub gate_vertices: Vec<Option<VertexIx>>,
    pub rules: Rules,
    /// Middles of roundabouts and squares.
    pub places: Vec<DVec2>,
    /// The river that runs through, if one does.
    pub river: Option<River<'a>>,
    origin: Origin,
    terrain: &'a dyn Terrain,
}

impl<'a> Sketch<'a> {
    pub fn new(
        outline: &'a [DVec2],
        gates: &'a [Gate],
        rules: Rules,
        origin: Origin,
        terrain: &'a dyn Terrain,
    ) -> Self {
        let mut ring = PlanarGraph::new();
        for p in outline {
            ring.add_vertex(*p);
        }
        let n = outline.len() as VertexIx;
        for i in 0..n {
            ring.add_edge(i, (i + 1) % n, ());
        }
        Self {
            graph: PlanarGraph::new(),
            ring,
            outline,
            gates,
            gate_vertices: vec![None; gates.len()],
            rules,
            places: Vec::new(),
            river: None,
            origin,
            terrain,
        }
    }

    /// Forgets all streets.
    pub fn clear(&mut self) {
        self.graph = PlanarGraph::new();
        self.gate_vertices = vec![None; self.gates.len()];
    }

    /// The limits that the style's rules set.
    pub fn limits(&self) -> Limits {
        let r = &self.rules;
        Limits {
            gap: r.gap,
            angle: r.angle,
            min_length: r.min_length,
            split: r.min_length,
            margin: r.margin,
            turn: 0.5,
            ground: true,
        }
    }

    /// Whether a vertex lies on the bank line of a river.
    pub fn on_bank(&self, v: VertexIx) -> bool {
        self.river.as_ref().is_some_and(|river| river.way.bank_at(self.graph.at(v)).is_some())
    }

    pub fn is_gate(&self, v: VertexIx) -> bool {
        self.gate_vertices.contains(&Some(v))
    }

    /// Vertices of degree 1 that are no gates.
    pub fn tips(&self) -> Vec<VertexIx> {
        self.graph.vertices().filter(|v| self.graph.degree(*v) == 1 && !self.is_gate(*v)).collect()
    }

    /// Adds a street along `path`, whose ends lie where `start` and `end` say; its two end vertices.
    pub fn add(&mut self, path: &[DVec2], start: End, end: End) -> (VertexIx, VertexIx) {
        let mut resolve = |graph: &mut PlanarGraph<_>, end: End, p: DVec2| match end {
            End::Vertex(v) => v,
            End::Edge(e, p) => graph.split_edge(e, p),
            End::Free => graph.add_vertex(p),
            End::Gate(i) => {
                let v = graph.add_vertex(p);
                self.gate_vertices[i] = Some(v);
                v
            }
        };
        let first = resolve(&mut self.graph, start, path[0]);
        let last = resolve(&mut self.graph, end, path[path.len() - 1]);
        let mut before = first;
        for p in &path[1..path.len() - 1] {
            let v = self.graph.add_vertex(*p);
            self.graph.add_edge(before, v, StreetClass::Main);
            before = v;
        }
        self.graph.add_edge(before, last, StreetClass::Main);
        (first, last)
    }

    /// Whether a street along `path` keeps to the limits: Teng 2017, section 3.3, constraints 2 to 4 and the reasons for
    /// which connecting and clipping discard a street, and besides a distance to every other street that grows with
    /// the distance from the ends, so that no street runs beside another.
    pub fn fits(&self, path: &[DVec2], start: End, end: End, limits: &Limits) -> bool {
        let n = path.len();
        let turns = || path.windows(3).map(|w| angle_between(w[1] - w[0], w[2] - w[1]));
        let same = matches!((start, end), (End::Edge(e, _), End::Edge(f, _)) if e == f);
        !same
            && line_length(path) >= limits.min_length
            && segments(path).all(|(a, b)| a.distance(b) >= SHORTEST)
            && turns().all(|t| t <= limits.turn)
            && self.end_fits(start, path[1] - path[0], limits)
            && self.end_fits(end, path[n - 2] - path[n - 1], limits)
            && self.crosses_nothing(path, start, end)
            && self.keeps_clear(path, start, end, limits)
            && (!limits.ground || self.ground_fits(path))
    }

    /// Whether a street that leaves an end in a direction may be attached there.
    fn end_fits(&self, end: End, leaving: DVec2, limits: &Limits) -> bool {
        let g = &self.graph;
        match end {
            End::Free => true,
            End::Gate(i) => {
                let (n, v) = (self.outline.len(), self.gates[i].vertex);
                let at = self.outline[v];
                // Along a border the outline is a street.
                let least = if self.gates[i].class.is_main() { limits.angle.min(BORDER_ANGLE) } else { 0.2 };
                [self.outline[(v + 1) % n], self.outline[(v + n - 1) % n]]
                    .iter()
                    .all(|p| angle_between(*p - at, leaving) > least)
            }
            End::Vertex(v) => {
                g.degree(v) < self.rules.degree.1
                    && !self.is_gate(v)
                    && g.smallest_angle(v, leaving) >= limits.angle
                    && (g.degree(v) != 2
                        || g.edges_at(v).iter().all(|e| self.run_reaches(*e, v, g.at(v), limits.split)))
            }
            End::Edge(e, p) => {
                let edge = g.edge(e);
                [edge.a, edge.b].iter().all(|v| {
                    g.at(*v).distance(p) >= SHORTEST
                        && angle_between(g.at(*v) - p, leaving) >= limits.angle
                        && self.run_reaches(e, edge.other(*v), p, limits.split)
                })
            }
        }
    }

    /// Whether it is at least `length` metres from `p` along the street that `edge` belongs to, away from `from`, to the
    /// next junction.
    fn run_reaches(&self, edge: EdgeIx, from: VertexIx, p: DVec2, length: f64) -> bool {
        let (mut e, mut v, mut at, mut run) = (edge, from, p, 0.0);
        loop {
            v = self.graph.edge(e).other(v);
            run += at.distance(self.graph.at(v));
            at = self.graph.at(v);
            if run >= length {
                return true;
            }
            match self.graph.edges_at(v) {
                [a, b] => e = if *a == e { *b } else { *a },
                _ => return false,
            }
        }
    }

    /// Whether the path meets the network and the outline at its ends only. Exact.
    pub fn crosses_nothing(&self, path: &[DVec2], start: End, end: End) -> bool {
        let last = path.len() - 2;
        let touches = |x: End, e: EdgeIx| match x {
            End::Vertex(v) => self.graph.edges_at(v).contains(&e),
            End::Edge(f, _) => e == f,
            _ => false,
        };
        let starts_inside = match start {
            End::Gate(_) => point_in_polygon(path[0].lerp(path[1], 0.01), self.outline),
            _ => true,
        };
        starts_inside
            && segments(path).enumerate().all(|(i, (a, b))| {
                let skip = |e| (i == 0 && touches(start, e)) || (i == last && touches(end, e));
                let at_gate = |e: EdgeIx| match start {
                    End::Gate(g) if i == 0 => {
                        let (n, v) = (self.outline.len(), self.gates[g].vertex);
                        e as usize == v || e as usize == (v + n - 1) % n
                    }
                    _ => false,
                };
                self.graph.first_hit(a, b, skip).is_none()
                    && self.ring.first_hit(a, b, at_gate).is_none()
                    && self.river.as_ref().is_none_or(|river| !river.meets(a, b))
            })
    }

    fn keeps_clear(&self, path: &[DVec2], start: End, end: End, limits: &Limits) -> bool {
        let (first, last) = (path[0], path[path.len() - 1]);
        // Streets that part at the least angle, and bend towards each other a little, keep this share of the distance.
        let share = 0.75 * sin(limits.angle);
        let room = |end: End, at: DVec2, a: DVec2, b: DVec2| match end {
            End::Free => f64::INFINITY,
            _ => at.distance(a).min(at.distance(b)),
        };
        let at_gate = matches!(start, End::Gate(_));
        segments(path).all(|(from, to)| {
            // Away from the ends the whole segment has to keep the whole distance.
            let near = room(start, first, from, to).min(room(end, last, from, to)) - from.distance(to) / 2.0;
            let whole = share * near >= limits.gap && (!at_gate || 0.3 * near >= limits.margin);
            let pieces = if whole { 1.0 } else { (from.distance(to) / PIECE).ceil().max(1.0) };
            (0..pieces as usize).all(|i| {
                let (a, b) = (from.lerp(to, i as f64 / pieces), from.lerp(to, (i + 1) as f64 / pieces));
                let near_start = room(start, first, a, b);
                let near = near_start.min(room(end, last, a, b));
                let gap = limits.gap.min(share * near);
                let margin = if at_gate { limits.margin.min(0.3 * near_start) } else { limits.margin };
                let gate_room = GATE_ROOM.min(limits.gap).min(0.5 * near);
                self.graph.clearance(a, b, gap, |_| false) >= gap
                    && self.ring.clearance(a, b, margin, |_| false) >= margin
                    && self
                        .gates
                        .iter()
                        .enumerate()
                        .all(|(g, gate)| start == End::Gate(g) || distance_to_segment(gate.at, a, b) >= gate_room)
            })
        })
    }

    /// Whether the ground along the path is dry and not too steep.
    pub fn ground_fits(&self, path: &[DVec2]) -> bool {
        let mut before: Option<(DVec2, f64)> = None;
        segments(path).all(|(a, b)| {
            let steps = (a.distance(b) / GROUND_STEP).ceil().max(1.0);
            (0..=steps as usize).all(|i| {
                let p = a.lerp(b, i as f64 / steps);
                let sample = self.terrain.sample(self.origin.to_plan(p));
                let grade = before.map_or(0.0, |(q, height)| {
                    let run = q.distance(p);
                    if run > 0.0 { (sample.height - height).abs() / run } else { 0.0 }
                });
                before = Some((p, sample.height));
                sample.depth() == 0.0 && grade <= MAX_GRADE
            })
        })
    }

    /// Removes streets that end in nothing, until none is left.
    pub fn prune(&mut self) {
        let mut tips = self.tips();
        while let Some(mut v) = tips.pop() {
            while let [e] = *self.graph.edges_at(v)
                && !self.is_gate(v)
            {
                let other = self.graph.edge(e).other(v);
                self.graph.remove_edge(e);
                v = other;
            }
        }
    }
}

/// Points of `path` on the quantum grid, without those that bend it by less than can be seen.
pub(super) fn tidy(path: Vec<DVec2>) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::with_capacity(path.len());
    for p in path.into_iter().map(quantize) {
        while let [.., a, b] = out[..]
            && distance_to_segment(b, a, p) < 0.4
        {
            out.pop();
        }
        if out.last() != Some(&p) {
            out.push(p);
        }
    }
    out
}
