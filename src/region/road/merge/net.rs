//! The graph around a tile, with indices, and a grid to find what is nearby.

use crate::layer::{LayerError, Reach};
use crate::region::road::settings::RoadSettings;
use crate::region::road::tile::tile_bounds;
use crate::region::road::vertex::{Graph, Key, Position, Rank};
use crate::space::{Bounds, Origin, distance_to_segment};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A vertex.
pub(in crate::region::road) struct Node {
    pub key: Key,
    pub position: Position,
    /// Position relative to the tile, on the quantum grid: differences of positions are exact, and the same in every tile.
    /// Nothing else may enter a decision.
    pub at: DVec2,
    /// Indices of the edges that end here.
    pub ways: Vec<usize>,
    /// The least rank of these edges.
    pub best: Option<Rank>,
}

/// A way between two vertices.
pub(in crate::region::road) struct Edge {
    pub ends: [usize; 2],
    pub rank: Rank,
    /// 1 on a bridge, -1 in a tunnel, 0 on the ground.
    pub level: i8,
    /// Whether the edge stays in any case, because it is a tie, a bridge or a tunnel.
    pub fixed: bool,
    /// Whether the edge is part of a toll road, with which roads of other classes do not merge.
    pub toll: bool,
}

/// The graph around a tile.
pub(in crate::region::road) struct Net {
    pub nodes: Vec<Node>,
    pub edges: Vec<Edge>,
    /// Box of the tile, relative to its corner.
    pub own: Bounds,
    reach: Reach,
    origin: Origin,
    near_nodes: Grid,
    near_edges: Grid,
}

/// Indices, found by square.
struct Grid {
    min: DVec2,
    size: f64,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<usize>>,
}

impl Grid {
    fn new(bounds: Bounds, size: f64) -> Self {
        let count = (bounds.size() / size).ceil().max(DVec2::ONE);
        let (columns, rows) = (count.x as usize, count.y as usize);
        Self { min: bounds.min, size, columns, rows, cells: vec![Vec::new(); columns * rows] }
    }

    fn squares(&self, bounds: Bounds) -> impl Iterator<Item = usize> + use<> {
        let most = DVec2::new(self.columns as f64 - 1.0, self.rows as f64 - 1.0);
        let low = ((bounds.min - self.min) / self.size).floor().clamp(DVec2::ZERO, most).as_usizevec2();
        let high = ((bounds.max - self.min) / self.size).floor().clamp(DVec2::ZERO, most).as_usizevec2();
        let columns = self.columns;
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| y * columns + x))
    }

    fn put(&mut self, bounds: Bounds, index: usize) {
        for square in self.squares(bounds) {
            self.cells[square].push(index);
        }
    }

    /// Indices of what may lie in a box, sorted.
    fn get(&self, bounds: Bounds) -> Vec<usize> {
        let mut out: Vec<usize> = self.squares(bounds).flat_map(|s| &self.cells[s]).copied().collect();
        out.sort_unstable();
        out.dedup();
        out
    }
}

impl Net {
    /// The net of the graphs of a tile and the tiles around it. Queries may read within `reach`.
    pub fn new(settings: &RoadSettings, tile: I64Vec2, reach: Reach, graphs: &[Arc<Graph>]) -> Self {
        let plan = tile_bounds(tile, settings.step);
        let origin = Origin::at(plan.min);
        let mut nodes: Vec<Node> = Vec::new();
        let node = |key, position: Position| {
            let at = position.local_to(origin);
            Node { key, position, at, ways: Vec::new(), best: None }
        };
        let mut all: Vec<_> = graphs.iter().flat_map(|g| &g.vertices).collect();
        all.sort_by_key(|(k, _)| **k);
        let keys: Vec<Key> = all.iter().map(|(key, _)| **key).collect();
        nodes.extend(all.iter().map(|(key, v)| node(**key, v.position)));
        // Vertices outside these tiles that ways lead to.
        let mut beyond: BTreeMap<Key, usize> = BTreeMap::new();
        let mut edges: Vec<Edge> = Vec::new();
        for (a, (key, v)) in all.iter().enumerate() {
            for way in &v.ways {
                let b = keys.binary_search(&way.to).unwrap_or_else(|_| {
                    *beyond.entry(way.to).or_insert_with(|| {
                        nodes.push(node(way.to, way.position));
                        nodes.len() - 1
                    })
                });
                // Each edge once: from its first end, or from its only end in these tiles.
                if **key < way.to || b >= all.len() {
                    let fixed = key.is_gate() || way.to.is_gate() || way.level != 0;
                    for end in [a, b] {
                        nodes[end].ways.push(edges.len());
                        nodes[end].best = Some(nodes[end].best.map_or(way.rank, |r| r.min(way.rank)));
                    }
                    let toll = settings.class(way.rank.class).toll;
                    edges.push(Edge { ends: [a, b], rank: way.rank, level: way.level, fixed, toll });
                }
            }
        }
        let bounds = reach.bounds().moved(-origin.plan());
        let size = settings.merge.max(settings.step as f64);
        let (mut near_nodes, mut near_edges) = (Grid::new(bounds, size), Grid::new(bounds, size));
        for (i, n) in nodes.iter().enumerate() {
            near_nodes.put(Bounds::of([n.at]), i);
        }
        for (i, e) in edges.iter().enumerate() {
            near_edges.put(Bounds::of(e.ends.map(|n| nodes[n].at)), i);
        }
        Self { nodes, edges, own: plan.moved(-origin.plan()), reach, origin, near_nodes, near_edges }
    }

    /// The other end of an edge.
    pub fn far(&self, edge: usize, node: usize) -> usize {
        let [a, b] = self.edges[edge].ends;
        if a == node { b } else { a }
    }

    /// Vector from one vertex to another.
    pub fn step(&self, from: usize, to: usize) -> DVec2 {
        self.nodes[to].at - self.nodes[from].at
    }

    /// Whether a path of at most `most` metres joins two vertices. `allowed` decides about each edge, by its index and the vertex
    /// that it leads to.
    pub fn joins(&self, [from, to]: [usize; 2], most: f64, allowed: impl Fn(usize, usize) -> bool) -> bool {
        let mut way: BTreeMap<usize, f64> = BTreeMap::from([(from, 0.0)]);
        let mut open = vec![from];
        while let Some(at) = open.pop() {
            if at == to {
                return true;
            }
            for e in &self.nodes[at].ways {
                let next = self.far(*e, at);
                let there = way[&at] + self.apart(at, next);
                let shorter = way.get(&next).is_none_or(|w| there < *w);
                if shorter && there <= most && allowed(*e, next) {
                    way.insert(next, there);
                    open.push(next);
                }
            }
        }
        false
    }

    /// Distance between two vertices.
    pub fn apart(&self, a: usize, b: usize) -> f64 {
        self.step(a, b).length()
    }

    /// Distance of a vertex from an edge.
    pub fn distance_to_edge(&self, node: usize, edge: usize) -> f64 {
        let [a, b] = self.edges[edge].ends;
        distance_to_segment(DVec2::ZERO, self.step(node, a), self.step(node, b))
    }

    /// Distance of a vertex from the straight line between two others.
    pub fn distance_to_line(&self, node: usize, from: usize, to: usize) -> f64 {
        distance_to_segment(DVec2::ZERO, self.step(node, from), self.step(node, to))
    }

    /// Whether an edge is part of a toll road that a road of that rank does not merge with.
    pub fn is_closed_to(&self, edge: usize, rank: Rank) -> bool {
        self.edges[edge].toll && self.edges[edge].rank.class != rank.class
    }

    /// Whether an edge is better than `rank`, so that a road of that rank may merge with it.
    pub fn is_better(&self, edge: usize, rank: Rank) -> bool {
        let e = &self.edges[edge];
        e.rank < rank && !e.fixed && !self.is_closed_to(edge, rank)
    }

    /// Whether a vertex lies on an edge better than `rank`.
    pub fn on_better(&self, node: usize, rank: Rank) -> bool {
        self.nodes[node].ways.iter().any(|e| self.is_better(*e, rank))
    }

    /// Other vertices within `limit` metres of a vertex, sorted.
    pub fn nodes_near(&self, node: usize, limit: f64) -> Result<Vec<usize>, LayerError> {
        let around = self.readable(Bounds::of([self.nodes[node].at]).grown(limit))?;
        let mut out = self.near_nodes.get(around);
        out.retain(|n| *n != node && self.apart(node, *n) <= limit);
        Ok(out)
    }

    /// Vertices in a box, sorted.
    pub fn nodes_in(&self, bounds: Bounds) -> Result<Vec<usize>, LayerError> {
        let mut out = self.near_nodes.get(self.readable(bounds)?);
        out.retain(|n| bounds.contains(self.nodes[*n].at));
        Ok(out)
    }

    /// Edges whose box overlaps a box, sorted.
    pub fn edges_in(&self, bounds: Bounds) -> Result<Vec<usize>, LayerError> {
        let mut out = self.near_edges.get(self.readable(bounds)?);
        out.retain(|e| Bounds::of(self.edges[*e].ends.map(|n| self.nodes[n].at)).overlaps(bounds));
        Ok(out)
    }

    /// Distance of a vertex from the nearest edge better than `rank`, if it is within `limit`.
    pub fn better_near(&self, node: usize, rank: Rank, limit: f64) -> Result<Option<f64>, LayerError> {
        if self.on_better(node, rank) {
            return Ok(Some(0.0));
        }
        let around = self.readable(Bounds::of([self.nodes[node].at]).grown(limit))?;
        let edges = self.near_edges.get(around).into_iter();
        let better = edges.filter(|e| self.is_better(*e, rank));
        let distance = better.map(|e| self.distance_to_edge(node, e)).fold(f64::INFINITY, f64::min);
        Ok((distance <= limit).then_some(distance))
    }

    /// A box relative to the tile's corner, if it lies within reach.
    fn readable(&self, bounds: Bounds) -> Result<Bounds, LayerError> {
        // Half a metre, because positions are rounded.
        self.reach.check(bounds.grown(-0.5).moved(self.origin.plan()))?;
        Ok(bounds)
    }
}
