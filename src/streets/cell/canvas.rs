//! The canvas of a cell: the growing graph of local streets and the walls around it, with the indices that find obstacles
//! by place.

use super::bands::Bands;
use super::free_grid::FreeGrid;
use super::obstacle::{Hull, LooseEnd, NONE, Neighbourhood, Obstacle, Ray, Window};
use super::proposal::{Join, Proposal};
use super::squares::Squares;
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use crate::seam::{APPROACH_LENGTH, CellPort};
use crate::space::{Bounds, quantize};
use crate::streets::filler::CellBrief;
use glam::{DVec2, Vec2};

/// Least distance between a street's pavement and that of a border street, in metres.
pub const WALL_MARGIN: f64 = 4.0;

/// Number of edges for which memory is reserved; most cells have fewer.
const USUAL: usize = 512;

/// Least distance of streets from a side of the cell without a main street, in metres.
const OPEN_SIDE: f64 = 14.0;

/// What a filler made an edge with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Maker {
    /// Parametric growth.
    Growth,
    /// Repair.
    Repair,
    /// A street that connects a pinned piece, as near to others as streets may be at all: without it the piece would float.
    Link,
    /// A piece that the filler laid, by a number of its own.
    Piece(u32),
}

/// What an edge is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    /// What it was made with.
    pub by: Maker,
    /// Number of the proposal that it was built with; all edges of a piece that was laid have the same.
    pub build: u32,
}

/// What a filler knows of a vertex besides its position.
#[derive(Clone, Copy, Debug, Default)]
pub struct Node {
    /// Index into the ports of the brief, if the vertex is a port.
    pub port: Option<usize>,
    /// Whether the network may go on here. False for the ends of cul-de-sacs.
    pub open: bool,
    /// Number of streets that growth aims at here.
    pub wanted_degree: usize,
    /// Whether the vertex belongs to a pinned piece, from which nothing may be removed.
    pub pinned: bool,
    /// Whether the vertex lies on a curve of a piece, which keeps its shape.
    pub shaped: bool,
}

impl Node {
    /// Whether the vertex stays where it is, whatever fairing and rounding would like.
    pub fn is_fixed(&self) -> bool {
        self.pinned || self.shaped
    }
}

/// The place where an edge was divided.
#[derive(Clone, Copy)]
struct Division {
    at: DVec2,
    /// Vector from the first end of the edge to the last.
    along: DVec2,
    /// The first part of the edge; the other part is the next edge.
    first: EdgeIx,
}

/// The growing graph of a cell.
pub struct Canvas {
    /// Local streets.
    pub graph: PlanarGraph<Made>,
    /// What is known of each vertex, by index.
    pub nodes: Vec<Node>,
    /// Free room around every point.
    pub free: FreeGrid,
    /// The walls, and after them every edge that was ever built, by index.
    obstacles: Vec<Obstacle>,
    /// Index of the obstacles that overlap a box.
    bands: Bands,
    /// Index of the obstacles along a ray.
    squares: Squares,
    /// Number of walls.
    walls: usize,
    /// Length of the diagonal of its bounding box, in metres.
    size: f64,
    /// For each edge, where it was divided.
    divisions: Vec<Option<Division>>,
    /// Whether the coarse grid knows the streets at the ports.
    knows_stubs: bool,
    /// Number of proposals that were built, stubs included.
    builds: u32,
    origin: DVec2,
}

impl Canvas {
    /// The canvas of a cell without streets. The first vertices are the ports, in their order. `asked` is the greatest
    /// distance in metres that [`Canvas::free`] will be asked about.
    pub fn new(brief: &CellBrief<'_>, asked: f64) -> Self {
        let n = brief.border.len();
        let origin = brief.border.first().copied().unwrap_or_default();
        let obstacles: Vec<Obstacle> = (0..n)
            .map(|i| {
                let half = brief.street_half_width.get(i).copied().flatten();
                let floor = half.map_or(OPEN_SIDE, |h| h + StreetClass::Local.half_width() + WALL_MARGIN);
                let (a, b) = (brief.border[i], brief.border[(i + 1) % n]);
                Obstacle { a, b, hull: Hull::new(a, b, origin), edge: NONE, va: NONE, vb: NONE, floor }
            })
            .filter(|w| w.a != w.b)
            .collect();
        let mut free = FreeGrid::new(brief.border, asked);
        obstacles.iter().enumerate().for_each(|(i, w)| free.stamp(i, w.a, w.b));
        let bounds = Bounds::of(brief.border.iter().copied());
        let mut canvas = Self {
            graph: PlanarGraph::without_index(),
            nodes: Vec::with_capacity(USUAL),
            free,
            walls: obstacles.len(),
            size: bounds.size().length(),
            obstacles: Vec::with_capacity(USUAL),
            bands: Bands::new(bounds),
            squares: Squares::new(bounds),
            divisions: Vec::with_capacity(USUAL),
            knows_stubs: false,
            builds: 0,
            origin,
        };
        obstacles.into_iter().enumerate().for_each(|(i, w)| canvas.put(i, w));
        canvas.graph.reserve(USUAL, USUAL);
        for (i, port) in brief.ports.iter().enumerate() {
            canvas.add_vertex(port.at, Node { port: Some(i), wanted_degree: 1, ..Node::default() });
        }
        canvas
    }

    /// Length of the diagonal of the cell's bounding box, in metres.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Adds a vertex.
    pub fn add_vertex(&mut self, at: DVec2, node: Node) -> VertexIx {
        self.nodes.push(node);
        self.graph.add_vertex(at)
    }

    /// Adds the stub of a port. The coarse grid learns of stubs in [`stamp_stubs`](Self::stamp_stubs).
    pub fn add_stub(&mut self, port: VertexIx, end: VertexIx) {
        self.builds += 1;
        self.graph.add_edge(port, end, Made { by: Maker::Growth, build: self.builds });
        self.index_edges();
    }

    /// Adds the edges that are not obstacles yet to the obstacles.
    fn index_edges(&mut self) {
        for edge in self.obstacles.len() - self.walls..self.graph.edge_count() {
            // Every edge is indexed before it can be removed.
            self.put(self.obstacles.len(), self.obstacle_of(edge as EdgeIx));
            self.divisions.push(None);
        }
    }

    /// Stores an obstacle under its number, in place of an older one.
    fn put(&mut self, number: usize, s: Obstacle) {
        self.squares.put(number as u32, s.a, s.b);
        self.bands.put(number, Bounds::of([s.a, s.b]));
        match self.obstacles.get_mut(number) {
            Some(place) => *place = s,
            None => self.obstacles.push(s),
        }
    }

    /// An edge as an obstacle.
    fn obstacle_of(&self, edge: EdgeIx) -> Obstacle {
        let e = self.graph.edge(edge);
        let (a, b) = (self.graph.at(e.a), self.graph.at(e.b));
        Obstacle { a, b, hull: Hull::new(a, b, self.origin), edge, va: e.a, vb: e.b, floor: 0.0 }
    }

    /// Adds an edge.
    fn add_edge(&mut self, a: VertexIx, b: VertexIx, made: Made) {
        self.add_last_edge(a, b, made);
        self.free.stamp(self.obstacles.len() - 1, self.graph.at(a), self.graph.at(b));
    }

    /// Adds an edge when the coarse grid is no longer needed.
    pub fn add_last_edge(&mut self, a: VertexIx, b: VertexIx, made: Made) {
        self.graph.add_edge(a, b, made);
        self.index_edges();
    }

    /// Moves a vertex when the coarse grid is no longer needed.
    pub fn move_vertex(&mut self, v: VertexIx, to: DVec2) {
        self.graph.move_vertex(v, to);
        for i in 0..self.graph.degree(v) {
            let edge = self.graph.edges_at(v)[i];
            self.put(self.walls + edge as usize, self.obstacle_of(edge));
        }
    }

    /// Divides an edge at `p` and returns the new vertex. If the edge was divided before, its nearest part is divided.
    pub fn split_edge(&mut self, edge: EdgeIx, p: DVec2) -> Option<VertexIx> {
        let p = quantize(p);
        let edge = if self.graph.is_live(edge) { edge } else { self.graph.nearest_edge(p, 0.5, |_| false)?.0 };
        let ends = self.graph.edge(edge).clone();
        let both = |is: fn(&Node) -> bool| [ends.a, ends.b].into_iter().all(|v| is(&self.nodes[v as usize]));
        let (pinned, shaped) = (both(|n| n.pinned), both(|n| n.shaped));
        let along = self.graph.at(ends.b) - self.graph.at(ends.a);
        let first = self.graph.edge_count() as EdgeIx;
        let v = self.graph.split_edge(edge, p);
        if !self.graph.is_live(edge) {
            self.divisions[edge as usize] = Some(Division { at: p, along, first });
        }
        self.index_edges();
        while self.nodes.len() < self.graph.vertex_count() {
            self.nodes.push(Node { open: true, pinned, shaped, ..Node::default() });
        }
        Some(v)
    }

    /// Whether a street ends at `v`: every vertex but a point of inflexion.
    pub fn is_end(&self, v: VertexIx) -> bool {
        self.graph.degree(v) != 2 || self.nodes[v as usize].port.is_some()
    }

    /// Whether `v` is a dead end, intended or not.
    pub fn is_dead_end(&self, v: VertexIx) -> bool {
        self.graph.degree(v) == 1 && self.nodes[v as usize].port.is_none()
    }

    /// Follows the street from `v` along `edge` to its end; returns the vertex there and the length in metres. `visit` is
    /// called with each edge.
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

    /// Whether there is surely no obstacle within `distance` of `p`; false if the coarse grid cannot tell.
    pub fn is_clear(&self, p: DVec2, distance: f64) -> bool {
        self.knows_stubs && self.free.at(p) > FreeGrid::most(distance)
    }

    /// Adds the stubs at the ports to the coarse grid.
    pub fn stamp_stubs(&mut self, ports: &[CellPort]) {
        for (i, port) in ports.iter().enumerate() {
            let edge = self.graph.edges_at(i as VertexIx).first().copied().unwrap_or_default();
            self.free.stamp(self.walls + edge as usize, port.at, port.at + port.inward * APPROACH_LENGTH);
        }
        self.knows_stubs = true;
    }

    /// The obstacle nearest to a place [counted in squares](FreeGrid::in_squares), to the precision of the coarse grid;
    /// `None` if that obstacle was removed.
    pub fn nearest(&self, square: Vec2) -> Option<&Obstacle> {
        let mut number = self.free.nearest_at_square(square)?;
        while let Some(&Some(d)) = self.divisions.get(number.wrapping_sub(self.walls)) {
            let first = (self.free.place(square) - d.at).dot(d.along) < 0.0;
            number = self.walls + d.first as usize + usize::from(!first);
        }
        self.obstacle(number)
    }

    /// The wall or edge of this number among the obstacles; `None` for an edge that was removed.
    fn obstacle(&self, number: usize) -> Option<&Obstacle> {
        let s = &self.obstacles[number];
        self.is_there(s).then_some(s)
    }

    fn is_there(&self, s: &Obstacle) -> bool {
        s.is_wall() || self.graph.is_live(s.edge)
    }

    /// Collects the obstacles within `reach` metres of the box `of`, and the dead ends among them, into `near`.
    pub fn gather(&self, of: Bounds, reach: f64, near: &mut Neighbourhood) {
        self.gather_obstacles(of.grown(reach), near);
        near.loose_ends.clear();
        for s in near.obstacles.iter().filter(|s| !s.is_wall()) {
            self.add_loose_ends(s, &mut near.loose_ends);
        }
    }

    /// Collects the obstacles that overlap a box into `near`; the dead ends in `near` stay as they are.
    pub fn gather_obstacles(&self, bounds: Bounds, near: &mut Neighbourhood) {
        near.origin = self.origin;
        near.within = near.reach(bounds.min, bounds.max);
        near.obstacles.clear();
        self.overlapping(bounds).for_each(|s| near.obstacles.push(*s));
    }

    /// The walls that overlap a box.
    pub fn overlapping_walls(&self, bounds: Bounds) -> impl Iterator<Item = &Obstacle> {
        let reach = Window::new(bounds.min, bounds.max, self.origin);
        self.obstacles[..self.walls].iter().filter(move |s| s.hull.overlaps(reach))
    }

    /// The obstacles that overlap a box.
    pub fn overlapping(&self, bounds: Bounds) -> impl Iterator<Item = &Obstacle> {
        let reach = Window::new(bounds.min, bounds.max, self.origin);
        let may_overlap = self.bands.within(bounds).map(|number| &self.obstacles[number]);
        may_overlap.filter(move |s| s.hull.overlaps(reach) && self.is_there(s))
    }

    /// Collects the dead ends within `reach` metres of the box `of` into `near`, and no obstacles.
    pub fn gather_loose_ends(&self, of: Bounds, reach: f64, near: &mut Neighbourhood) {
        let bounds = of.grown(reach);
        near.obstacles.clear();
        near.loose_ends.clear();
        near.origin = self.origin;
        near.within = near.reach(bounds.min, bounds.max);
        for v in self.graph.vertices().filter(|v| self.is_dead_end(*v)) {
            let edge = self.graph.edges_at(v)[0];
            if self.obstacles[self.walls + edge as usize].hull.overlaps(near.within) {
                let from = self.graph.at(self.graph.edge(edge).other(v));
                near.loose_ends.push(self.tip(v, from));
            }
        }
    }

    fn add_loose_ends(&self, s: &Obstacle, loose_ends: &mut Vec<LooseEnd>) {
        for (v, from) in [(s.va, s.b), (s.vb, s.a)] {
            if self.is_dead_end(v) {
                loose_ends.push(self.tip(v, from));
            }
        }
    }

    /// The dead end `v` of a street that comes from `from`.
    fn tip(&self, v: VertexIx, from: DVec2) -> LooseEnd {
        let at = self.graph.at(v);
        LooseEnd { v, at, onward: (at - from).normalize_or_zero(), open: self.nodes[v as usize].open }
    }

    /// The first obstacle within the window that the segment `from`-`to` meets, with the parameter and the position of the
    /// meeting point on the segment. Streets that end at the vertex `leaving` are ignored, and so are the walls at it.
    pub fn ray(&self, from: DVec2, to: DVec2, leaving: VertexIx, within: Window) -> Option<(Obstacle, f64, DVec2)> {
        let mut ray = Ray::new(from, to, leaving, self.origin);
        self.squares.along(from, to, |number, end| {
            let s = &self.obstacles[number as usize];
            if s.hull.overlaps(ray.reach)
                && s.hull.overlaps(within)
                && self.is_there(s)
                && let Some(at) = ray.try_on(number, s)
            {
                *end = at;
            }
        });
        ray.met()
    }

    /// The border edges.
    pub fn wall_lines(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        self.obstacles[..self.walls].iter().map(|w| (w.a, w.b))
    }

    /// Removes the street that ends at the dead end `v`; returns the vertex where the street began.
    pub fn remove_dead_end(&mut self, v: VertexIx) -> Option<VertexIx> {
        let first = *self.graph.edges_at(v).first()?;
        let mut edges = Vec::new();
        let (end, _) = self.follow(v, first, |e| edges.push(e));
        for e in edges {
            self.graph.remove_edge(e);
        }
        Some(end)
    }

    /// Builds a proposal that passed the check; `vertices` receives the vertex of each of its points.
    pub fn build(&mut self, p: &Proposal, made_by: Maker, vertices: &mut Vec<VertexIx>) {
        vertices.clear();
        self.builds += 1;
        for ((at, join), shaped) in p.points.iter().zip(&p.joins).zip(&p.shaped) {
            let v = match *join {
                Join::At(v) => Some(v),
                Join::On(e) => self.split_edge(e, *at),
                Join::Free(_) => None,
            };
            let open = !matches!(join, Join::Free(false));
            let v = v.unwrap_or_else(|| self.add_vertex(*at, Node { open, ..Node::default() }));
            self.nodes[v as usize].shaped |= *shaped;
            vertices.push(v);
        }
        for (a, b) in &p.edges {
            self.add_edge(vertices[*a], vertices[*b], Made { by: made_by, build: self.builds });
        }
    }

    /// Unit direction in which the first street at `v` would go straight on.
    pub fn onward(&self, v: VertexIx) -> Option<DVec2> {
        let w = self.graph.neighbours(v).next()?;
        Some((self.graph.at(v) - self.graph.at(w)).normalize_or_zero())
    }

    /// What made the greatest part of a street, by length.
    pub fn maker(&self, chain: &[(EdgeIx, bool)]) -> Maker {
        let g = &self.graph;
        if let [(e, _)] = chain {
            return g.edge(*e).data.by;
        }
        let mut shares: Vec<(Maker, f64)> = Vec::new();
        for (e, _) in chain {
            let (a, b) = g.segment(*e);
            let (made_by, length) = (g.edge(*e).data.by, a.distance(b));
            match shares.iter_mut().find(|s| s.0 == made_by) {
                Some(s) => s.1 += length,
                None => shares.push((made_by, length)),
            }
        }
        let best = shares.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
        best.map_or(Maker::Growth, |b| b.0)
    }

    /// What a street is of, if all of it was built at once; else what made the greatest part of it, as a build of its own.
    pub fn made(&mut self, chain: &[(EdgeIx, bool)]) -> Made {
        let mut made = chain.iter().map(|(e, _)| self.graph.edge(*e).data);
        match made.next() {
            Some(first) if made.all(|m| m == first) => first,
            _ => {
                self.builds += 1;
                Made { by: self.maker(chain), build: self.builds }
            }
        }
    }
}
