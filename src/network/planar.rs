//! A planar straight-line graph that grows edge by edge, with an R-tree over its edges.
//!
//! Vertices of degree 2 are points of inflexion, the others are junctions or ends, as in Teng 2017, section 2. The graph itself
//! accepts any edge: callers ask [`PlanarGraph::first_hit`] and [`PlanarGraph::clearance`] first, and split the edge that a
//! new one meets.

use crate::space::{Bounds, distance_to_segment, math::angle_between, quantize, segment_crossing, segment_distance};
use glam::DVec2;
use rstar::{AABB, RTree, RTreeObject};

/// Index of a vertex, which stays valid while the graph grows.
pub type VertexIx = u32;
/// Index of an edge; a removed or split edge's index is never used again.
pub type EdgeIx = u32;

/// An edge between two vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge<E> {
    /// First vertex.
    pub a: VertexIx,
    /// Second vertex.
    pub b: VertexIx,
    /// What the edge carries; copied to both parts when the edge is split.
    pub data: E,
}

impl<E> Edge<E> {
    /// The end that is not `v`.
    pub fn other(&self, v: VertexIx) -> VertexIx {
        if self.a == v { self.b } else { self.a }
    }
}

/// Where a proposed segment first meets the graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The edge that is met.
    pub edge: EdgeIx,
    /// Parameter along the proposed segment, 0..=1.
    pub t: f64,
    /// The meeting point.
    pub at: DVec2,
}

/// An edge in the R-tree, with the positions of its ends.
#[derive(Clone, Debug, PartialEq)]
struct Indexed {
    edge: EdgeIx,
    a: DVec2,
    b: DVec2,
}

impl RTreeObject for Indexed {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.a.to_array(), self.b.to_array())
    }
}

/// The edges at a vertex, oldest first: up to [`FEW`] in place, more in a list.
#[derive(Clone, Debug)]
enum Incident {
    Few(u32, [EdgeIx; FEW]),
    Many(Vec<EdgeIx>),
}

/// Number of edges that fit in place; few vertices have more.
const FEW: usize = 4;

impl Incident {
    fn edges(&self) -> &[EdgeIx] {
        match self {
            Self::Few(count, edges) => &edges[..*count as usize],
            Self::Many(edges) => edges,
        }
    }

    fn push(&mut self, edge: EdgeIx) {
        match self {
            Self::Few(count, edges) if (*count as usize) < FEW => {
                edges[*count as usize] = edge;
                *count += 1;
            }
            Self::Few(_, edges) => *self = Self::Many(edges.iter().copied().chain([edge]).collect()),
            Self::Many(edges) => edges.push(edge),
        }
    }

    fn remove(&mut self, edge: EdgeIx) {
        match self {
            Self::Few(count, edges) => {
                let at = edges[..*count as usize].iter().position(|e| *e == edge);
                if let Some(at) = at {
                    edges.copy_within(at + 1.., at);
                    *count -= 1;
                }
            }
            Self::Many(edges) => edges.retain(|e| *e != edge),
        }
    }
}

/// A planar graph of straight edges that carry `E`.
#[derive(Clone, Debug)]
pub struct PlanarGraph<E> {
    positions: Vec<DVec2>,
    incident: Vec<Incident>,
    edges: Vec<Option<Edge<E>>>,
    /// `None` in a graph without an index.
    index: Option<RTree<Indexed>>,
}

impl<E> Default for PlanarGraph<E> {
    fn default() -> Self {
        Self { positions: Vec::new(), incident: Vec::new(), edges: Vec::new(), index: Some(RTree::new()) }
    }
}

impl<E: Clone> PlanarGraph<E> {
    /// A graph without vertices.
    pub fn new() -> Self {
        Self::default()
    }

    /// A graph without vertices whose searches look at every edge and give the same answers. It is faster than an index for up
    /// to a few hundred edges, and where only the topology is asked for.
    pub fn without_index() -> Self {
        Self { index: None, ..Self::default() }
    }

    /// Reserves memory for this many more vertices and edges.
    pub fn reserve(&mut self, vertices: usize, edges: usize) {
        self.positions.reserve(vertices);
        self.incident.reserve(vertices);
        self.edges.reserve(edges);
    }

    /// Adds a vertex at `p`, rounded to the quantum grid.
    pub fn add_vertex(&mut self, p: DVec2) -> VertexIx {
        self.positions.push(quantize(p));
        self.incident.push(Incident::Few(0, [0; FEW]));
        (self.positions.len() - 1) as VertexIx
    }

    /// Adds an edge. `a` and `b` must differ.
    pub fn add_edge(&mut self, a: VertexIx, b: VertexIx, data: E) -> EdgeIx {
        debug_assert_ne!(a, b, "an edge needs two ends");
        let edge = self.edges.len() as EdgeIx;
        self.edges.push(Some(Edge { a, b, data }));
        self.incident[a as usize].push(edge);
        self.incident[b as usize].push(edge);
        let indexed = Indexed { edge, a: self.at(a), b: self.at(b) };
        if let Some(index) = &mut self.index {
            index.insert(indexed);
        }
        edge
    }

    /// Removes an edge; its ends stay.
    pub fn remove_edge(&mut self, edge: EdgeIx) -> Option<Edge<E>> {
        let removed = self.edges.get_mut(edge as usize)?.take()?;
        let indexed = Indexed { edge, a: self.at(removed.a), b: self.at(removed.b) };
        if let Some(index) = &mut self.index {
            index.remove(&indexed);
        }
        for v in [removed.a, removed.b] {
            self.incident[v as usize].remove(edge);
        }
        Some(removed)
    }

    /// Moves a vertex to `p`, rounded to the quantum grid, and the ends of its edges with it.
    pub fn move_vertex(&mut self, v: VertexIx, p: DVec2) {
        let indexed = |graph: &Self, edge: EdgeIx| {
            let (a, b) = graph.segment(edge);
            Indexed { edge, a, b }
        };
        let edges = if self.index.is_some() { self.edges_at(v).to_vec() } else { Vec::new() };
        let before: Vec<Indexed> = edges.iter().map(|e| indexed(self, *e)).collect();
        self.positions[v as usize] = quantize(p);
        let after: Vec<Indexed> = edges.iter().map(|e| indexed(self, *e)).collect();
        if let Some(index) = &mut self.index {
            for (old, new) in before.iter().zip(after) {
                index.remove(old);
                index.insert(new);
            }
        }
    }

    /// Puts a vertex at `p` on an edge and returns it; if `p` rounds to an end of the edge, returns that end.
    pub fn split_edge(&mut self, edge: EdgeIx, p: DVec2) -> VertexIx {
        let Edge { a, b, .. } = *self.edge(edge);
        let p = quantize(p);
        if let Some(end) = [a, b].into_iter().find(|v| self.at(*v) == p) {
            return end;
        }
        let middle = self.add_vertex(p);
        if let Some(Edge { data, .. }) = self.remove_edge(edge) {
            self.add_edge(a, middle, data.clone());
            self.add_edge(middle, b, data);
        }
        middle
    }

    /// Number of vertices ever added.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of edges ever added; their indices are less than this.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// All vertices, those without edges included.
    pub fn vertices(&self) -> impl Iterator<Item = VertexIx> + use<E> {
        0..self.positions.len() as VertexIx
    }

    /// Position of a vertex.
    pub fn at(&self, v: VertexIx) -> DVec2 {
        self.positions[v as usize]
    }

    /// A live edge.
    ///
    /// # Panics
    ///
    /// If the edge was removed or split.
    pub fn edge(&self, edge: EdgeIx) -> &Edge<E> {
        self.edges[edge as usize].as_ref().expect("edge was removed")
    }

    /// Whether an edge is still there (neither removed nor split).
    pub fn is_live(&self, edge: EdgeIx) -> bool {
        self.edges.get(edge as usize).is_some_and(Option::is_some)
    }

    /// What an edge carries, for changes; `None` if the edge is not live.
    pub fn data_mut(&mut self, edge: EdgeIx) -> Option<&mut E> {
        self.edges.get_mut(edge as usize)?.as_mut().map(|e| &mut e.data)
    }

    /// Live edges with their indices, oldest first.
    pub fn edges(&self) -> impl Iterator<Item = (EdgeIx, &Edge<E>)> {
        self.edges.iter().enumerate().filter_map(|(i, e)| Some((i as EdgeIx, e.as_ref()?)))
    }

    /// End positions of an edge.
    pub fn segment(&self, edge: EdgeIx) -> (DVec2, DVec2) {
        let e = self.edge(edge);
        (self.at(e.a), self.at(e.b))
    }

    /// Length of an edge in metres.
    pub fn edge_length(&self, edge: EdgeIx) -> f64 {
        let (a, b) = self.segment(edge);
        a.distance(b)
    }

    /// Edges at a vertex, oldest first.
    pub fn edges_at(&self, v: VertexIx) -> &[EdgeIx] {
        self.incident[v as usize].edges()
    }

    /// Number of edges at a vertex.
    pub fn degree(&self, v: VertexIx) -> usize {
        self.edges_at(v).len()
    }

    /// Vertices joined to `v` by an edge.
    pub fn neighbours(&self, v: VertexIx) -> impl Iterator<Item = VertexIx> + '_ {
        self.edges_at(v).iter().map(move |e| self.edge(*e).other(v))
    }

    /// The edge between two vertices, if any.
    pub fn edge_between(&self, a: VertexIx, b: VertexIx) -> Option<EdgeIx> {
        self.edges_at(a).iter().copied().find(|e| self.edge(*e).other(a) == b)
    }

    /// Edges whose box overlaps `bounds`, oldest first, so that the shape of the tree has no influence.
    pub fn edges_near(&self, bounds: Bounds) -> Vec<EdgeIx> {
        let Some(index) = &self.index else {
            let near = |e: &Edge<E>| {
                let (a, b) = (self.at(e.a), self.at(e.b));
                bounds.overlaps(Bounds::new(a.min(b), a.max(b)))
            };
            return self.edges().filter(|(_, e)| near(e)).map(|(i, _)| i).collect();
        };
        let envelope = AABB::from_corners(bounds.min.to_array(), bounds.max.to_array());
        let mut found: Vec<_> = index.locate_in_envelope_intersecting(envelope).map(|i| i.edge).collect();
        found.sort_unstable();
        found
    }

    /// The first edge that the segment from `a` to `b` meets, except edges for which `skip` holds.
    pub fn first_hit(&self, a: DVec2, b: DVec2, skip: impl Fn(EdgeIx) -> bool) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for edge in self.edges_near(Bounds::of([a, b])) {
            if skip(edge) {
                continue;
            }
            let (c, d) = self.segment(edge);
            if let Some(x) = segment_crossing(a, b, c, d)
                && best.is_none_or(|h| x.t < h.t)
            {
                best = Some(Hit { edge, t: x.t, at: x.at });
            }
        }
        best
    }

    /// Distance in metres from the segment `a`-`b` to the nearest edge within `reach` metres, except edges for which `skip`
    /// holds; `reach` if there is none.
    pub fn clearance(&self, a: DVec2, b: DVec2, reach: f64, skip: impl Fn(EdgeIx) -> bool) -> f64 {
        let near = self.edges_near(Bounds::of([a, b]).grown(reach));
        near.into_iter().filter(|e| !skip(*e)).fold(reach, |best, e| {
            let (c, d) = self.segment(e);
            best.min(segment_distance(a, b, c, d))
        })
    }

    /// The edge nearest to `p` within `reach` metres and its distance, except edges for which `skip` holds.
    pub fn nearest_edge(&self, p: DVec2, reach: f64, skip: impl Fn(EdgeIx) -> bool) -> Option<(EdgeIx, f64)> {
        let mut best = None;
        let mut best_d = reach;
        for e in self.edges_near(Bounds::of([p]).grown(reach)) {
            let (a, b) = self.segment(e);
            let d = distance_to_segment(p, a, b);
            if !skip(e) && d <= best_d && (best.is_none() || d < best_d) {
                (best, best_d) = (Some((e, d)), d);
            }
        }
        best
    }

    /// Smallest angle between `direction` and the edges that leave `v`, in radians; pi without edges.
    pub fn smallest_angle(&self, v: VertexIx, direction: DVec2) -> f64 {
        let from = self.at(v);
        self.neighbours(v).map(|w| angle_between(direction, self.at(w) - from)).fold(std::f64::consts::PI, f64::min)
    }

    /// Chains of edges, each from one vertex for which `ends` holds to the next. Every other vertex must have degree 2. A loop
    /// without an end starts at its lowest vertex. Each edge comes with whether the chain runs from its `a` to its `b`. Chains
    /// are ordered by their oldest edge.
    pub fn chains(&self, ends: impl Fn(VertexIx) -> bool) -> Vec<Vec<(EdgeIx, bool)>> {
        let mut used = vec![false; self.edges.len()];
        let mut out = Vec::new();
        let follow = |start: EdgeIx, from: VertexIx, used: &mut Vec<bool>| {
            let mut chain = Vec::new();
            let (mut e, mut v) = (start, from);
            loop {
                used[e as usize] = true;
                let edge = self.edge(e);
                chain.push((e, edge.a == v));
                v = edge.other(v);
                if ends(v) {
                    break;
                }
                match self.edges_at(v).iter().copied().find(|n| !used[*n as usize]) {
                    Some(next) => e = next,
                    None => break,
                }
            }
            chain
        };
        for pass in 0..2 {
            for v in self.vertices() {
                // The first pass follows chains from their ends; only loops without an end are left for the second.
                if pass == 0 && !ends(v) {
                    continue;
                }
                for &e in self.edges_at(v) {
                    if !used[e as usize] {
                        out.push(follow(e, v, &mut used));
                    }
                }
            }
        }
        out.sort_by_cached_key(|c: &Vec<(EdgeIx, bool)>| c.iter().map(|(e, _)| *e).min());
        out
    }

    /// Vertices along a chain of [`chains`](Self::chains), first to last.
    pub fn chain_vertices(&self, chain: &[(EdgeIx, bool)]) -> Vec<VertexIx> {
        let mut out = Vec::with_capacity(chain.len() + 1);
        for (i, (e, forward)) in chain.iter().enumerate() {
            let edge = self.edge(*e);
            let (a, b) = if *forward { (edge.a, edge.b) } else { (edge.b, edge.a) };
            if i == 0 {
                out.push(a);
            }
            out.push(b);
        }
        out
    }

    /// Connected components as a number per vertex; vertices without edges get `None`.
    pub fn components(&self) -> Vec<Option<u32>> {
        let mut out = vec![None; self.positions.len()];
        let mut next = 0;
        for start in self.vertices() {
            if out[start as usize].is_some() || self.degree(start) == 0 {
                continue;
            }
            let mut stack = vec![start];
            out[start as usize] = Some(next);
            while let Some(v) = stack.pop() {
                for w in self.neighbours(v) {
                    if out[w as usize].is_none() {
                        out[w as usize] = Some(next);
                        stack.push(w);
                    }
                }
            }
            next += 1;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2Swizzles;

    #[test]
    fn split_hit_clear_and_chain() {
        let mut g = PlanarGraph::new();
        let [a, b, c] = [(0., 0.), (10., 0.), (20., 0.)].map(|(x, y)| g.add_vertex(DVec2::new(x, y)));
        g.add_edge(a, b, 'x');
        let e = g.add_edge(b, c, 'y');
        assert_eq!(g.chains(|v| g.degree(v) != 2).len(), 1);
        let hit = g.first_hit(DVec2::new(15., -5.), DVec2::new(15., 5.), |_| false).unwrap();
        assert_eq!((hit.edge, hit.t, hit.at), (e, 0.5, DVec2::new(15., 0.)));
        let m = g.split_edge(e, hit.at);
        assert!(!g.is_live(e) && g.degree(m) == 2 && g.split_edge(g.edges_at(m)[0], g.at(m)) == m);
        assert_eq!(g.clearance(DVec2::new(0., 3.), DVec2::new(20., 4.), 50.0, |_| false), 3.0);
        let d = g.add_vertex(DVec2::new(15., 9.));
        g.add_edge(m, d, 'z');
        let chains = g.chains(|v| g.degree(v) != 2);
        assert_eq!(chains.len(), 3);
        assert!(chains.iter().any(|ch| g.chain_vertices(ch) == [a, b, m]));
        assert_eq!(g.components().iter().flatten().max(), Some(&0));
    }

    #[test]
    fn searches_are_the_same_without_an_index() {
        let mut s = crate::space::Seed(5).stream("test", &[]);
        let mut graphs = [PlanarGraph::new(), PlanarGraph::without_index()];
        for i in 0..200u32 {
            let p = DVec2::new(s.range(0.0, 900.0), s.range(0.0, 900.0));
            let remove = s.chance(0.2).then(|| s.index(i as usize) as u32);
            for g in &mut graphs {
                let (a, b) = (g.add_vertex(p), g.add_vertex(p.yx() * 0.5 + 9.0));
                g.add_edge(a, b, i);
                remove.map(|e| g.remove_edge(e));
                g.move_vertex(a / 2, p.yx());
            }
            let around = Bounds::square(p, s.range(1.0, 400.0));
            assert_eq!(graphs[0].edges_near(around), graphs[1].edges_near(around));
        }
    }

    #[test]
    fn a_loop_is_one_chain() {
        let mut g = PlanarGraph::new();
        let v = [(0., 0.), (10., 0.), (5., 8.)].map(|(x, y)| g.add_vertex(DVec2::new(x, y)));
        for i in 0..3 {
            g.add_edge(v[i], v[(i + 1) % 3], ());
        }
        let chains = g.chains(|v| g.degree(v) != 2);
        assert_eq!(chains.len(), 1);
        assert_eq!(g.chain_vertices(&chains[0]).len(), 4);
    }
}
