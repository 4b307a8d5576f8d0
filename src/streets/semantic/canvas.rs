//! What a cell is drawn on: the growing graph of local streets, the walls around it, and what is near a place.

use super::free::FreeGrid;
use super::proposal::{Join, Proposal};
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use crate::space::{Bounds, closest_on_segment, quantize, segment_crossing};
use crate::streets::{CellBrief, MadeBy};
use glam::DVec2;

/// Least distance between a street's pavement and that of a border street, in metres.
pub(super) const WALL_MARGIN: f64 = 4.0;

/// Least distance from an open side of the cell.
const OPEN_SIDE: f64 = 14.0;

/// Least cross product, in square metres, of what is surely beside a line; rounding errors are far smaller.
const BESIDE: f64 = 1e-6;

/// Stands for "no edge" and "no vertex" in a [`Seg`].
pub(super) const NONE: u32 = u32::MAX;

/// What is known of a vertex beside its position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    /// Index into the brief's ports, for the vertex at a port.
    pub port: Option<usize>,
    /// Whether the network may go on here. False for the ends of cul-de-sacs.
    pub open: bool,
    /// Number of streets that growth aims at here.
    pub target: usize,
    /// Whether it belongs to a pinned patch, of which nothing may be removed.
    pub pinned: bool,
}

/// A border edge of the cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    a: DVec2,
    b: DVec2,
    floor: f64,
}

/// An obstacle: a street segment or a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seg {
    /// First end.
    pub a: DVec2,
    /// Second end.
    pub b: DVec2,
    /// South-west corner of its box.
    pub low: DVec2,
    /// North-east corner of its box.
    pub high: DVec2,
    /// Edge of the graph, [`NONE`] for a wall.
    pub edge: EdgeIx,
    /// Vertex at `a`, [`NONE`] for a wall.
    pub va: VertexIx,
    /// Vertex at `b`, [`NONE`] for a wall.
    pub vb: VertexIx,
    /// Least distance from a wall that nothing may fall below; 0 for streets.
    pub floor: f64,
}

impl Seg {
    /// Whether this is a border edge.
    pub fn is_wall(&self) -> bool {
        self.edge == NONE
    }

    /// Whether it surely lies to one side of the line through `from` along `step`, by so much that no rounding matters.
    pub fn is_beside(&self, from: DVec2, step: DVec2) -> bool {
        let (a, b) = (step.perp_dot(self.a - from), step.perp_dot(self.b - from));
        a.min(b) > BESIDE || a.max(b) < -BESIDE
    }

    /// Whether its box and the box from `low` to `high` are apart.
    pub fn is_apart(&self, low: DVec2, high: DVec2) -> bool {
        low.x > self.high.x || self.low.x > high.x || low.y > self.high.y || self.low.y > high.y
    }

    /// Whether `v` is one of its ends.
    pub fn ends_at(&self, v: VertexIx) -> bool {
        self.va == v || self.vb == v
    }
}

/// The obstacles around a place, copied together so that many proposals can be held against them.
#[derive(Default)]
pub(super) struct Near {
    /// The obstacles.
    pub segs: Vec<Seg>,
    /// The dead ends among their ends.
    pub tips: Vec<Tip>,
}

/// A dead end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tip {
    /// The vertex.
    pub v: VertexIx,
    /// Where it lies.
    pub at: DVec2,
    /// Unit direction in which its street would go on.
    pub lead: DVec2,
    /// Whether the network may go on here.
    pub open: bool,
}

impl Near {
    /// First obstacle that the segment `from`-`to` meets: its index, and parameter and position on the segment. What
    /// ends at the vertex `leaving` is left out, and the walls that `from` lies on then.
    pub fn ray(&self, from: DVec2, to: DVec2, leaving: VertexIx) -> Option<(usize, f64, DVec2)> {
        let (mut low, mut high) = (from.min(to), from.max(to));
        let step = to - from;
        let mut best: Option<(usize, f64, DVec2)> = None;
        for (i, s) in self.segs.iter().enumerate() {
            if s.is_apart(low, high) || s.is_beside(from, step) {
                continue;
            }
            // At a port, the main street is left as well.
            if leaving != NONE
                && (s.ends_at(leaving) || (s.is_wall() && nearest(from, s.a, s.b).distance_squared(from) < 1e-4))
            {
                continue;
            }
            if let Some(x) = segment_crossing(from, to, s.a, s.b)
                && best.is_none_or(|b| x.t < b.1)
            {
                best = Some((i, x.t, x.at));
                // What lies beyond, by more than rounding, is not met first.
                (low, high) = (from.min(x.at) - BESIDE, from.max(x.at) + BESIDE);
            }
        }
        best
    }
}

/// The growing graph of a cell.
pub(super) struct Canvas {
    /// Local streets.
    pub graph: PlanarGraph<MadeBy>,
    /// What is known of each vertex.
    pub nodes: Vec<Node>,
    /// Free room around every point.
    pub free: FreeGrid,
    walls: Vec<Wall>,
}

impl Canvas {
    /// The canvas of a cell, with a vertex at each port, in their order, and no street yet. `cap` is the greatest
    /// distance that will be asked of [`Canvas::free`].
    pub fn new(brief: &CellBrief<'_>, cap: f64) -> Self {
        let n = brief.border.len();
        let walls: Vec<Wall> = (0..n)
            .map(|i| {
                let half = brief.street_half_width.get(i).copied().flatten();
                let floor = half.map_or(OPEN_SIDE, |h| h + StreetClass::Local.half_width() + WALL_MARGIN);
                Wall { a: brief.border[i], b: brief.border[(i + 1) % n], floor }
            })
            .filter(|w| w.a != w.b)
            .collect();
        let mut free = FreeGrid::new(brief.border, cap);
        walls.iter().for_each(|w| free.stamp(w.a, w.b));
        let mut canvas = Self { graph: PlanarGraph::without_index(), nodes: Vec::new(), free, walls };
        for (i, port) in brief.ports.iter().enumerate() {
            canvas.add_vertex(port.at, Node { port: Some(i), target: 1, ..Node::default() });
        }
        canvas
    }

    /// Adds a vertex.
    pub fn add_vertex(&mut self, at: DVec2, node: Node) -> VertexIx {
        self.nodes.push(node);
        self.graph.add_vertex(at)
    }

    /// Adds the stub of a port. The coarse grid learns of it when the streets at the ports are laid.
    pub fn add_stub(&mut self, port: VertexIx, end: VertexIx) {
        self.graph.add_edge(port, end, MadeBy::Growth);
    }

    /// Adds an edge.
    pub fn add_edge(&mut self, a: VertexIx, b: VertexIx, made_by: MadeBy) {
        self.graph.add_edge(a, b, made_by);
        self.free.stamp(self.graph.at(a), self.graph.at(b));
    }

    /// Puts a vertex at `p` on an edge, or on the part of it that is still there.
    pub fn split_edge(&mut self, edge: EdgeIx, p: DVec2) -> Option<VertexIx> {
        let p = quantize(p);
        let edge = if self.graph.is_live(edge) { edge } else { self.graph.nearest_edge(p, 0.5, |_| false)?.0 };
        let ends = self.graph.edge(edge);
        let pinned = [ends.a, ends.b].into_iter().all(|v| self.nodes[v as usize].pinned);
        let v = self.graph.split_edge(edge, p);
        while self.nodes.len() < self.graph.vertex_count() {
            self.nodes.push(Node { open: true, pinned, ..Node::default() });
        }
        Some(v)
    }

    /// Whether streets end or divide at `v`, or a main street passes: not a mere point of inflexion.
    pub fn is_end(&self, v: VertexIx) -> bool {
        self.graph.degree(v) != 2 || self.nodes[v as usize].port.is_some()
    }

    /// Whether `v` is a dead end, intended or not.
    pub fn is_dead_end(&self, v: VertexIx) -> bool {
        self.graph.degree(v) == 1 && self.nodes[v as usize].port.is_none()
    }

    /// Follows the street from `v` along `edge` to where it ends: that vertex, and the length. `visit` sees each edge.
    pub fn follow(&self, v: VertexIx, edge: EdgeIx, mut visit: impl FnMut(EdgeIx)) -> (VertexIx, f64) {
        let (mut at, mut edge, mut length) = (v, edge, 0.0);
        loop {
            visit(edge);
            let next = self.graph.edge(edge).other(at);
            length += self.graph.at(at).distance(self.graph.at(next));
            at = next;
            if at == v || self.is_end(at) {
                return (at, length);
            }
            match self.graph.edges_at(at).iter().copied().find(|e| *e != edge) {
                Some(e) => edge = e,
                None => return (at, length),
            }
        }
    }

    /// Collects what lies within `reach` of the segment or point `of` into `near`.
    pub fn gather(&self, of: Bounds, reach: f64, near: &mut Near) {
        near.segs.clear();
        near.tips.clear();
        let bounds = of.grown(reach);
        for w in &self.walls {
            let (low, high) = (w.a.min(w.b), w.a.max(w.b));
            if bounds.overlaps(Bounds::new(low, high)) {
                near.segs.push(Seg { a: w.a, b: w.b, low, high, edge: NONE, va: NONE, vb: NONE, floor: w.floor });
            }
        }
        for (edge, e) in self.graph.edges() {
            let (a, b) = (self.graph.at(e.a), self.graph.at(e.b));
            let (low, high) = (a.min(b), a.max(b));
            if bounds.overlaps(Bounds::new(low, high)) {
                near.segs.push(Seg { a, b, low, high, edge, va: e.a, vb: e.b, floor: 0.0 });
                for (v, at, from) in [(e.a, a, b), (e.b, b, a)] {
                    if self.is_dead_end(v) {
                        let open = self.nodes[v as usize].open;
                        near.tips.push(Tip { v, at, lead: (at - from).normalize_or_zero(), open });
                    }
                }
            }
        }
    }

    /// The border edges.
    pub fn wall_lines(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        self.walls.iter().map(|w| (w.a, w.b))
    }

    /// Removes the street that ends at the dead end `v`, back to where it began; that vertex and the length removed.
    pub fn remove_dead_end(&mut self, v: VertexIx) -> Option<VertexIx> {
        let first = *self.graph.edges_at(v).first()?;
        let mut edges = Vec::new();
        let (end, _) = self.follow(v, first, |e| edges.push(e));
        for e in edges {
            self.graph.remove_edge(e);
        }
        Some(end)
    }

    /// Builds a proposal that was checked; the vertices of its points.
    pub fn build(&mut self, p: &Proposal, made_by: MadeBy, vertices: &mut Vec<VertexIx>) {
        vertices.clear();
        for (at, join) in p.points.iter().zip(&p.joins) {
            let v = match *join {
                Join::At(v) => Some(v),
                Join::On(e) => self.split_edge(e, *at),
                Join::Free(_) => None,
            };
            let open = !matches!(join, Join::Free(false));
            let v = v.unwrap_or_else(|| self.add_vertex(*at, Node { open, ..Node::default() }));
            vertices.push(v);
        }
        for (a, b) in &p.edges {
            self.add_edge(vertices[*a], vertices[*b], made_by);
        }
    }

    /// Direction from `v` along its only or first edge, reversed: the way straight on.
    pub fn onward(&self, v: VertexIx) -> Option<DVec2> {
        let w = self.graph.neighbours(v).next()?;
        Some((self.graph.at(v) - self.graph.at(w)).normalize_or_zero())
    }
}

/// Nearest point of segment `a`-`b` to `p`.
pub(super) fn nearest(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    closest_on_segment(p, a, b).1
}
