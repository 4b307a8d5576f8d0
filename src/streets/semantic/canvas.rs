//! What a cell is drawn on: the growing graph of local streets, the walls around it, and what is near a place.

use super::free::FreeGrid;
use super::proposal::{Join, Proposal};
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use crate::space::{Bounds, closest_on_segment, quantize, segment_crossing};
use crate::streets::{CellBrief, MadeBy};
use glam::{DVec2, Vec4};

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

/// The box of a segment, or a little more, so that one instruction or two tell whether it overlaps another: the south-west
/// corner and the north-east one with its signs changed, in single precision, from the canvas's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull(Vec4);

impl Hull {
    /// Overlaps nothing.
    const NOWHERE: Self = Self(Vec4::INFINITY);

    fn new(a: DVec2, b: DVec2, origin: DVec2) -> Self {
        let (low, high) = (a.min(b) - origin - HULL_MARGIN, a.max(b) - origin + HULL_MARGIN);
        Self(Vec4::new(low.x as f32, low.y as f32, -high.x as f32, -high.y as f32))
    }

    /// False only where the boxes are surely apart.
    pub fn overlaps(self, reach: Reach) -> bool {
        self.0.cmple(reach.0).all()
    }
}

/// A box to hold against [`Hull`]s: its north-east corner, and the south-west one with its signs changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach(Vec4);

/// How much a hull is larger than the box, in metres; far more than single precision loses within a cell.
const HULL_MARGIN: f64 = 0.02;

/// A border edge of the cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    a: DVec2,
    b: DVec2,
    hull: Hull,
    floor: f64,
}

/// An obstacle: a street segment or a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seg {
    /// First end.
    pub a: DVec2,
    /// Second end.
    pub b: DVec2,
    /// Its box.
    pub hull: Hull,
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
    /// Origin of the hulls.
    pub origin: DVec2,
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
    /// The box from `low` to `high`, to hold against the hulls of the obstacles.
    pub fn reach(&self, low: DVec2, high: DVec2) -> Reach {
        let (low, high) = ((low - self.origin).as_vec2(), (high - self.origin).as_vec2());
        Reach(Vec4::new(high.x, high.y, -low.x, -low.y))
    }

    /// First obstacle that the segment `from`-`to` meets: its index, and parameter and position on the segment. What
    /// ends at the vertex `leaving` is left out, and the walls that `from` lies on then.
    pub fn ray(&self, from: DVec2, to: DVec2, leaving: VertexIx) -> Option<(usize, f64, DVec2)> {
        let mut reach = self.reach(from.min(to), from.max(to));
        let step = to - from;
        let mut best: Option<(usize, f64, DVec2)> = None;
        for (i, s) in self.segs.iter().enumerate() {
            if !s.hull.overlaps(reach) || s.is_beside(from, step) {
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
                reach = self.reach(from.min(x.at), from.max(x.at));
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
    /// Boxes of the edges, by index; those of removed edges stay, and the youngest may be missing.
    hulls: Vec<Hull>,
    origin: DVec2,
}

impl Canvas {
    /// The canvas of a cell, with a vertex at each port, in their order, and no street yet. `cap` is the greatest
    /// distance that will be asked of [`Canvas::free`].
    pub fn new(brief: &CellBrief<'_>, cap: f64) -> Self {
        let n = brief.border.len();
        let origin = brief.border.first().copied().unwrap_or_default();
        let walls: Vec<Wall> = (0..n)
            .map(|i| {
                let half = brief.street_half_width.get(i).copied().flatten();
                let floor = half.map_or(OPEN_SIDE, |h| h + StreetClass::Local.half_width() + WALL_MARGIN);
                let (a, b) = (brief.border[i], brief.border[(i + 1) % n]);
                Wall { a, b, hull: Hull::new(a, b, origin), floor }
            })
            .filter(|w| w.a != w.b)
            .collect();
        let mut free = FreeGrid::new(brief.border, cap);
        walls.iter().for_each(|w| free.stamp(w.a, w.b));
        let graph = PlanarGraph::without_index();
        let mut canvas = Self { graph, nodes: Vec::new(), free, walls, hulls: Vec::new(), origin };
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
    pub fn gather(&mut self, of: Bounds, reach: f64, near: &mut Near) {
        near.segs.clear();
        near.tips.clear();
        near.origin = self.origin;
        for edge in self.hulls.len()..self.graph.edge_count() {
            let edge = edge as EdgeIx;
            let ends = self.graph.is_live(edge).then(|| self.graph.segment(edge));
            self.hulls.push(ends.map_or(Hull::NOWHERE, |(a, b)| Hull::new(a, b, self.origin)));
        }
        let bounds = of.grown(reach);
        let reach = near.reach(bounds.min, bounds.max);
        let inside = |a: DVec2, b: DVec2| bounds.overlaps(Bounds::new(a.min(b), a.max(b)));
        for w in self.walls.iter().filter(|w| w.hull.overlaps(reach)) {
            if inside(w.a, w.b) {
                let (a, b, hull, floor) = (w.a, w.b, w.hull, w.floor);
                near.segs.push(Seg { a, b, hull, edge: NONE, va: NONE, vb: NONE, floor });
            }
        }
        for (edge, &hull) in self.hulls.iter().enumerate().filter(|(_, hull)| hull.overlaps(reach)) {
            let edge = edge as EdgeIx;
            if !self.graph.is_live(edge) {
                continue;
            }
            let e = self.graph.edge(edge);
            let (a, b) = (self.graph.at(e.a), self.graph.at(e.b));
            if inside(a, b) {
                near.segs.push(Seg { a, b, hull, edge, va: e.a, vb: e.b, floor: 0.0 });
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
