//! The union of all courses as a planar graph, tile by tile.
//!
//! Courses run on edges of one lattice, so shared stretches are shared edges, and crossings are rational points with
//! small denominators: the graph is exact, with whole numbers for coordinates.

use super::Work;
use super::course::courses;
use super::lattice::{STENCIL, heading, node_at};
use crate::layer::{Cancel, LayerError, Reach, Weigh};
use crate::network::{JunctionId, StreetClass};
use crate::region::{SettlementId, SizeClass};
use crate::space::{Bounds, Origin, quantize};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;

/// Parts of a lattice step in which coordinates of vertices are whole: crossings of edges of the stencil lie at multiples
/// of 1/2, 1/3, 1/4 and 1/5.
const PARTS: i64 = 60;
/// Edge length of a tile, in steps of the lattice.
pub(super) const TILE_STEPS: i64 = 16;
/// How far around its tile a graph reads courses, in steps: an edge reaches two steps out of the tile, and so does each
/// edge that crosses it there.
const PADDING_STEPS: i64 = 5;

/// Name of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Key {
    /// A node of the lattice or a crossing, in parts of a step.
    At { x: i64, y: i64 },
    /// A gate: the lattice cell it lies in, its settlement and its vertex in the outline.
    Gate { x: i64, y: i64, settlement: u64, vertex: u32 },
}

/// A position in the plan, exact anywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Whole metres.
    pub origin: Origin,
    /// On the quantum grid.
    pub offset: DVec2,
}

impl Place {
    /// The position relative to another origin.
    pub fn local_to(&self, origin: Origin) -> DVec2 {
        self.origin.offset_to(origin) + self.offset
    }

    /// The position as seen from `other`.
    pub fn from(&self, other: &Place) -> DVec2 {
        self.origin.offset_to(other.origin) + (self.offset - other.offset)
    }

    /// The position moved by `by`, which is rounded to the quantum grid.
    pub fn moved(&self, by: DVec2) -> Place {
        Place { origin: self.origin, offset: self.offset + quantize(by) }
    }
}

impl Key {
    fn node(n: I64Vec2) -> Self {
        Self::At { x: n.x * PARTS, y: n.y * PARTS }
    }

    /// Lattice cell that the vertex lies in.
    pub fn cell(self) -> I64Vec2 {
        match self {
            Self::At { x, y } => I64Vec2::new(x, y).div_euclid(I64Vec2::splat(PARTS)),
            Self::Gate { x, y, .. } => I64Vec2::new(x, y),
        }
    }

    /// Tile that the vertex lies in.
    pub fn tile(self) -> I64Vec2 {
        self.cell().div_euclid(I64Vec2::splat(TILE_STEPS))
    }

    /// Whether this is a gate.
    pub fn is_gate(self) -> bool {
        matches!(self, Self::Gate { .. })
    }

    /// Words that describe the vertex.
    pub fn words(self) -> [u64; 4] {
        match self {
            Self::At { x, y } => [1, x as u64, y as u64, 0],
            Self::Gate { settlement, vertex, .. } => [2, settlement, u64::from(vertex), 0],
        }
    }

    /// Name of the vertex as a junction.
    pub fn junction(self) -> JunctionId {
        JunctionId::of(&self.words())
    }

    fn place(self, step: i64) -> Place {
        let cell = self.cell();
        let parts = match self {
            Self::At { x, y } => I64Vec2::new(x, y) - cell * PARTS,
            Self::Gate { .. } => I64Vec2::ZERO,
        };
        let offset = quantize((parts * step).as_dvec2() / PARTS as f64);
        Place { origin: Origin(cell * step), offset }
    }
}

/// A way from a vertex to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub to: Key,
    pub place: Place,
    pub class: StreetClass,
}

/// A vertex of the graph.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    pub place: Place,
    /// Ways that leave it, by where they lead.
    pub ways: Vec<Way>,
}

/// Vertices in one tile, with all their ways.
#[derive(Default)]
pub(super) struct Graph {
    pub vertices: BTreeMap<Key, Vertex>,
}

impl Weigh for Graph {
    fn bytes(&self) -> usize {
        self.vertices.values().map(|v| 96 + v.ways.len() * size_of::<Way>()).sum::<usize>() + 64
    }
}

/// A lattice edge in the tile's own node coordinates.
struct Edge {
    a: I64Vec2,
    b: I64Vec2,
    class: StreetClass,
}

/// Box of a tile in plan metres.
pub(super) fn tile_bounds(tile: I64Vec2, step: i64) -> Bounds {
    let min = node_at(tile * TILE_STEPS, step);
    Bounds::new(min, min + (TILE_STEPS * step) as f64)
}

/// The graph of one tile.
pub(super) fn graph(work: &Work, tile: I64Vec2, cancel: &Cancel) -> Result<Graph, LayerError> {
    cancel.check()?;
    let step = work.settings.step;
    let corner = tile * TILE_STEPS;
    let own = tile_bounds(tile, step);
    let padding = (PADDING_STEPS * step) as f64;
    let read = Reach::new("roads", own, padding).check(own.grown(padding))?;
    let mut edges: BTreeMap<([i64; 2], usize), StreetClass> = BTreeMap::new();
    let mut out = Graph::default();
    for tier in [SizeClass::City, SizeClass::Town, SizeClass::Village] {
        for course in courses(work, tier, read, cancel)? {
            for pair in course.nodes.windows(2) {
                let (a, b) = (pair[0] - corner, pair[1] - corner);
                let out_of = |v: I64Vec2| {
                    v.cmplt(I64Vec2::splat(-PADDING_STEPS)) | v.cmpgt(I64Vec2::splat(TILE_STEPS + PADDING_STEPS))
                };
                let Some(h) = heading(a, b) else { continue };
                if (out_of(a) & out_of(b)).any() {
                    continue;
                }
                let (from, h) = if h < 8 { (a, h) } else { (b, h - 8) };
                // Wider classes come first, and stay.
                edges.entry((from.to_array(), h)).or_insert(course.class);
            }
            for (end, node) in [(&course.ends[0], course.nodes.first()), (&course.ends[1], course.nodes.last())] {
                let Some(node) = node else { continue };
                if stands_for(work, *node).is_some() {
                    continue;
                }
                let plan = end.centre.to_plan(end.gate);
                let cell = (plan / step as f64).floor().as_i64vec2();
                let (settlement, vertex) = (end.settlement.0, end.vertex as u32);
                let gate = Key::Gate { x: cell.x, y: cell.y, settlement, vertex };
                let origin = Origin(cell * step);
                let place = Place { origin, offset: end.centre.offset_to(origin) + end.gate };
                let node = Key::node(*node);
                let node_place = node.place(step);
                join(&mut out, tile, (gate, place), (node, node_place), course.class);
            }
        }
    }
    let edges: Vec<Edge> = edges
        .into_iter()
        .map(|((a, h), class)| Edge { a: a.into(), b: I64Vec2::from(a) + STENCIL[h], class })
        .collect();
    for (e, points) in edges.iter().zip(crossings(&edges)) {
        let keys: Vec<Key> = points.into_iter().map(|p| p + corner * PARTS).map(|p| key_at(work, p)).collect();
        for pair in keys.windows(2) {
            join(&mut out, tile, (pair[0], pair[0].place(step)), (pair[1], pair[1].place(step)), e.class);
        }
    }
    Ok(out)
}

/// The settlement of a finite domain that a node stands for.
fn stands_for(work: &Work, node: I64Vec2) -> Option<SettlementId> {
    work.finite.as_ref().and_then(|f| f.settlement(node))
}

/// The vertex at a place in parts of a step: a node that stands for a settlement is its only gate.
fn key_at(work: &Work, p: I64Vec2) -> Key {
    let node = p.div_euclid(I64Vec2::splat(PARTS));
    match stands_for(work, node).filter(|_| p == node * PARTS) {
        Some(id) => Key::Gate { x: node.x, y: node.y, settlement: id.0, vertex: 0 },
        None => Key::At { x: p.x, y: p.y },
    }
}

/// Adds a way in both directions, as far as its ends lie in the tile.
fn join(out: &mut Graph, tile: I64Vec2, a: (Key, Place), b: (Key, Place), class: StreetClass) {
    for ((key, place), (to, there)) in [(a, b), (b, a)] {
        if key.tile() != tile {
            continue;
        }
        let vertex = out.vertices.entry(key).or_insert_with(|| Vertex { place, ways: Vec::new() });
        match vertex.ways.binary_search_by_key(&to, |w| w.to) {
            Ok(i) => vertex.ways[i].class = vertex.ways[i].class.min(class),
            Err(i) => vertex.ways.insert(i, Way { to, place: there, class }),
        }
    }
}

/// For each edge its ends and the points where others cross it, in order, in parts of a step.
fn crossings(edges: &[Edge]) -> Vec<Vec<I64Vec2>> {
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

/// The point inside of both edges, in parts of a step.
fn crossing(e: &Edge, f: &Edge) -> Option<I64Vec2> {
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
    use super::*;

    #[test]
    fn crossings_of_the_stencil_are_whole_and_lie_on_both_edges() {
        let mut count = 0;
        for r in STENCIL {
            for s in STENCIL {
                for x in -2..=2 {
                    for y in -2..=2 {
                        let class = StreetClass::Minor;
                        let e = Edge { a: I64Vec2::ZERO, b: r, class };
                        let a = I64Vec2::new(x, y);
                        let f = Edge { a, b: a + s, class };
                        if let Some(p) = crossing(&e, &f) {
                            count += 1;
                            assert_eq!((p.perp_dot(r), (p - a * PARTS).perp_dot(s)), (0, 0));
                            assert_eq!(crossing(&f, &e), Some(p));
                        }
                    }
                }
            }
        }
        assert!(count > 100);
    }
}
