//! The union of all routes as a planar graph, tile by tile.
//!
//! Routes run on edges of one lattice, so shared stretches are shared edges, and crossings are rational points with small
//! denominators: the graph is exact, with whole numbers as coordinates.
//!
//! Bridges and tunnels are levels of their own: edges of different levels cross without meeting, and the inner vertices of a
//! bridge differ from the vertices on the ground below. Levels meet where a bridge or tunnel begins or ends.

use super::budget::Budget;
use super::inputs::Inputs;
use super::lattice::{STENCIL, heading};
use super::routes::Routes;
use super::tile::{TILE_STEPS, rings, tile_bounds, tiles_around};
use super::vertex::{Graph, Key, PARTS, Position, Rank, Vertex};
use crate::layer::{Cancel, LayerCache, LayerError, Reach};
use crate::network::SizeClass;
use crate::space::{Bounds, Origin};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Padding of a tile's graph in steps: an edge with a point in the tile reaches at most two steps out of it, and every edge
/// that crosses such an edge does so there.
const PADDING_STEPS: i64 = 2;
/// Added to the padding in metres: gates lie between lattice nodes, and far from the origin their plan positions are rounded.
const PADDING_MORE: f64 = 1.0;

/// An edge between nodes that are relative to the tile's corner.
struct Edge {
    a: I64Vec2,
    b: I64Vec2,
    rank: Rank,
    level: i8,
}

/// The graphs of all tiles before merging, remembered.
pub(super) struct Graphs {
    inputs: Arc<Inputs>,
    routes: Arc<Routes>,
    graphs: LayerCache<[i64; 2], Graph>,
}

impl Graphs {
    pub fn new(inputs: Arc<Inputs>, routes: Arc<Routes>, budget: Budget) -> Self {
        Self { inputs, routes, graphs: budget.cache(3) }
    }

    /// The graph of a tile.
    pub fn graph(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<Graph>, LayerError> {
        self.graphs.get(&tile.to_array(), || self.make(tile, cancel))
    }

    /// Vertices within `distance` metres of a tile.
    pub fn vertices_near(&self, tile: I64Vec2, distance: f64, cancel: &Cancel) -> Result<Vec<Vertex>, LayerError> {
        let own = tile_bounds(tile, self.inputs.step());
        let near = Bounds::new(DVec2::ZERO, own.size()).grown(distance);
        let mut out = Vec::new();
        for t in tiles_around(tile, rings(distance, self.inputs.step())) {
            let graph = self.graph(t, cancel)?;
            let is_near = |v: &&Vertex| near.contains(v.position.local_to(Origin::at(own.min)));
            out.extend(graph.vertices.values().filter(is_near).cloned());
        }
        Ok(out)
    }

    fn make(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Graph, LayerError> {
        cancel.check()?;
        let step = self.inputs.step();
        let corner = tile * TILE_STEPS;
        let padding = (PADDING_STEPS * step) as f64 + PADDING_MORE;
        let read = Reach::new("roads", tile_bounds(tile, step), padding).bounds();
        let mut edges: BTreeMap<(i8, [i64; 2], usize), Rank> = BTreeMap::new();
        // Nodes where a bridge or tunnel begins or ends. Other spans along the same line also touch the ground there.
        let mut landings: Vec<[i64; 2]> = Vec::new();
        let mut out = Graph::default();
        for tier in SizeClass::ALL {
            for route in self.routes.passing(tier, read, cancel)? {
                let rank = Rank::of(&route, step);
                for span in &route.spans {
                    landings.extend([span.first, span.last].map(|i| (route.nodes[i] - corner).to_array()));
                }
                for (i, pair) in route.nodes.windows(2).enumerate() {
                    let (a, b) = (pair[0] - corner, pair[1] - corner);
                    let outside = |v: I64Vec2| {
                        v.cmplt(I64Vec2::splat(-PADDING_STEPS)) | v.cmpgt(I64Vec2::splat(TILE_STEPS + PADDING_STEPS))
                    };
                    let Some(h) = heading(a, b) else { continue };
                    if (outside(a) & outside(b)).any() {
                        continue;
                    }
                    let (from, h) = if h < 8 { (a, h) } else { (b, h - 8) };
                    let key = (route.level(i), from.to_array(), h);
                    edges.entry(key).and_modify(|r| *r = rank.min(*r)).or_insert(rank);
                }
                for (end, node) in [(&route.ends[0], route.nodes.first()), (&route.ends[1], route.nodes.last())] {
                    let Some(node) = node else { continue };
                    if self.inputs.nodes.settlement(*node).is_some() {
                        continue;
                    }
                    let plan = end.centre.to_plan(end.gate);
                    let cell = (plan / step as f64).floor().as_i64vec2();
                    let (settlement, vertex) = (end.settlement.0, end.vertex as u32);
                    let gate = Key::Gate { x: cell.x, y: cell.y, settlement, vertex };
                    let origin = Origin(cell * step);
                    let position = Position { origin, offset: end.centre.offset_to(origin) + end.gate };
                    let node = Key::of_node(*node);
                    out.join(tile, (gate, position), (node, node.position(step)), rank, 0);
                }
            }
        }
        landings.sort_unstable();
        let edges: Vec<Edge> = edges
            .into_iter()
            .map(|((level, a, h), rank)| Edge { a: a.into(), b: I64Vec2::from(a) + STENCIL[h], rank, level })
            .collect();
        for (e, points) in edges.iter().zip(split_points(&edges)) {
            let key = |p: I64Vec2| {
                let node = p.div_euclid(I64Vec2::splat(PARTS));
                let lands = node * PARTS == p && landings.binary_search(&node.to_array()).is_ok();
                let at = p + corner * PARTS;
                if lands || e.level == 0 { self.ground_key(at) } else { Key::on_level(at, e.level) }
            };
            let keys: Vec<Key> = points.into_iter().map(key).collect();
            for pair in keys.windows(2) {
                let ends = [pair[0], pair[1]].map(|k| (k, k.position(step)));
                out.join(tile, ends[0], ends[1], e.rank, e.level);
            }
        }
        Ok(out)
    }

    /// The vertex on the ground at a point in parts of a step. A node that stands for a settlement is its only gate.
    fn ground_key(&self, p: I64Vec2) -> Key {
        let node = p.div_euclid(I64Vec2::splat(PARTS));
        match self.inputs.nodes.settlement(node).filter(|_| p == node * PARTS) {
            Some(id) => Key::Gate { x: node.x, y: node.y, settlement: id.0, vertex: 0 },
            None => Key::Ground { x: p.x, y: p.y },
        }
    }
}

/// For each edge, its ends and the points where other edges cross it, in order, in parts of a step.
fn split_points(edges: &[Edge]) -> Vec<Vec<I64Vec2>> {
    let mut out: Vec<Vec<I64Vec2>> = edges.iter().map(|e| vec![e.a * PARTS, e.b * PARTS]).collect();
    for i in 0..edges.len() {
        for j in i + 1..edges.len() {
            if let Some(p) = crossing(&edges[i], &edges[j]) {
                out[i].push(p);
                out[j].push(p);
            }
        }
    }
    for (e, points) in edges.iter().zip(&mut out) {
        let along = e.b - e.a;
        points.sort_by_key(|p| (*p - e.a * PARTS).dot(along));
        points.dedup();
    }
    out
}

/// The point where two edges of one level cross inside both, in parts of a step.
fn crossing(e: &Edge, f: &Edge) -> Option<I64Vec2> {
    if e.level != f.level {
        return None;
    }
    let (min1, max1, min2, max2) = (e.a.min(e.b), e.a.max(e.b), f.a.min(f.b), f.a.max(f.b));
    if min1.cmpgt(max2).any() || min2.cmpgt(max1).any() {
        return None;
    }
    let (r, s, ac) = (e.b - e.a, f.b - f.a, f.a - e.a);
    let (mut t, mut u, mut den) = (ac.perp_dot(s), ac.perp_dot(r), r.perp_dot(s));
    if den < 0 {
        (t, u, den) = (-t, -u, -den);
    }
    let inside = den > 0 && t > 0 && t < den && u > 0 && u < den;
    inside.then(|| e.a * PARTS + r * (PARTS * t / den))
}

#[cfg(test)]
mod tests {
    use super::super::route::{Route, RouteEnd};
    use super::*;
    use crate::network::{StreetClass, StreetId};
    use crate::region::settlement::SettlementId;

    fn rank() -> Rank {
        let end =
            |i| RouteEnd { settlement: SettlementId(i), centre: Origin::at(DVec2::ZERO), vertex: 0, gate: DVec2::ZERO };
        let (nodes, spans, bounds) = (Vec::new(), Vec::new(), Bounds::EMPTY);
        Rank::of(&Route { id: StreetId(0), class: StreetClass::Minor, ends: [end(1), end(2)], nodes, spans, bounds }, 1)
    }

    #[test]
    fn crossings_of_the_stencil_are_whole_and_lie_on_both_edges() {
        let (mut count, rank) = (0, rank());
        for r in STENCIL {
            for s in STENCIL {
                for x in -2..=2 {
                    for y in -2..=2 {
                        let e = Edge { a: I64Vec2::ZERO, b: r, rank, level: 0 };
                        let a = I64Vec2::new(x, y);
                        let f = Edge { a, b: a + s, rank, level: 0 };
                        if let Some(p) = crossing(&e, &f) {
                            count += 1;
                            assert_eq!((p.perp_dot(r), (p - a * PARTS).perp_dot(s)), (0, 0));
                            assert_eq!(crossing(&f, &e), Some(p));
                            assert_eq!(crossing(&f, &Edge { level: 1, ..e }), None);
                        }
                    }
                }
            }
        }
        assert!(count > 100);
    }
}
