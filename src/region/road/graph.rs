//! The union of all courses as a planar graph, tile by tile.
//!
//! Courses run on edges of one lattice, so shared stretches are shared edges, and crossings are rational points with
//! small denominators: the graph is exact, with whole numbers for coordinates.
//!
//! Bridges and tunnels are levels of their own: edges of different levels cross without meeting, and a bridge's inner
//! vertices are others than those on the ground below. Levels meet where a bridge or tunnel begins or ends.

use super::Work;
use super::course::{Course, courses};
use super::lattice::{STENCIL, heading, node_at};
use crate::layer::{Cancel, LayerError, Reach, Weigh};
use crate::network::SizeClass;
use crate::network::{JunctionId, StreetClass};
use crate::region::SettlementId;
use crate::space::{Bounds, Origin, line_length, quantize};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;

/// Parts of a lattice step in which coordinates of vertices are whole: crossings of edges of the stencil lie at multiples
/// of 1/2, 1/3, 1/4 and 1/5.
const PARTS: i64 = 60;
/// Edge length of a tile, in steps of the lattice.
pub(super) const TILE_STEPS: i64 = 8;
/// How far around its tile a graph reads courses, in steps: an edge with a point in the tile reaches no further than two out of
/// it, and each edge that crosses it does so there.
const PADDING_STEPS: i64 = 2;
/// Added to that in metres: gates lie between the nodes of the lattice, and far out their places in the plan are rounded.
const PADDING_MORE: f64 = 1.0;

/// Name of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Key {
    /// A node of the lattice or a crossing, in parts of a step.
    At { x: i64, y: i64 },
    /// The same on a bridge (level 1) or in a tunnel (level -1), but for its ends.
    Span { x: i64, y: i64, level: i8 },
    /// The vertex of a road that passes over a highway, at the place of the highway's own.
    Over { x: i64, y: i64 },
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

    /// The point `p`, in parts of a step, on a level.
    fn on(p: I64Vec2, level: i8) -> Self {
        if level == 0 { Self::At { x: p.x, y: p.y } } else { Self::Span { x: p.x, y: p.y, level } }
    }

    /// Lattice cell that the vertex lies in.
    pub fn cell(self) -> I64Vec2 {
        match self {
            Self::At { x, y } | Self::Span { x, y, .. } | Self::Over { x, y } => {
                I64Vec2::new(x, y).div_euclid(I64Vec2::splat(PARTS))
            }
            Self::Gate { x, y, .. } => I64Vec2::new(x, y),
        }
    }

    /// The node of the lattice that it is, if it is one on the ground.
    pub fn lattice_node(self) -> Option<I64Vec2> {
        let cell = self.cell();
        (self == Self::node(cell)).then_some(cell)
    }

    /// The vertex at the same place of a road that passes over this one.
    pub fn over(self) -> Self {
        let (x, y) = match self {
            Self::At { x, y } => (x, y),
            other => return other,
        };
        Self::Over { x, y }
    }

    /// The vertex that this one passes over, if it does.
    pub fn under(self) -> Option<Self> {
        match self {
            Self::Over { x, y } => Some(Self::At { x, y }),
            _ => None,
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
            Self::Span { x, y, level } => [4, x as u64, y as u64, level as u64],
            Self::Over { x, y } => [5, x as u64, y as u64, 0],
            Self::Gate { settlement, vertex, .. } => [2, settlement, u64::from(vertex), 0],
        }
    }

    /// Name of the vertex as a junction.
    pub fn junction(self) -> JunctionId {
        JunctionId::of(&self.words())
    }

    /// Where the vertex lies; that of a gate is known to its settlement only, and this is the corner of its cell.
    pub fn place(self, step: i64) -> Place {
        let cell = self.cell();
        let parts = match self {
            Self::At { x, y } | Self::Span { x, y, .. } | Self::Over { x, y } => I64Vec2::new(x, y) - cell * PARTS,
            Self::Gate { .. } => I64Vec2::ZERO,
        };
        let offset = quantize((parts * step).as_dvec2() / PARTS as f64);
        Place { origin: Origin(cell * step), offset }
    }
}

/// What decides which of two roads stays where they are merged: the lesser rank. First the class, then the length of the
/// course, then its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Rank {
    pub class: StreetClass,
    /// Bits of the course's length in metres, which is not negative.
    length: u64,
    course: u64,
}

impl Rank {
    fn of(course: &Course, step: i64) -> Self {
        let length = line_length(&course.line(step)).to_bits();
        Self { class: course.class, length, course: course.id.0 }
    }
}

/// A way from a vertex to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub to: Key,
    pub place: Place,
    /// That of the first of the courses that take this way.
    pub rank: Rank,
    /// 1 on a bridge, -1 in a tunnel that the search for a course chose, 0 elsewhere.
    pub level: i8,
}

/// A vertex of the graph.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    pub place: Place,
    /// Ways that leave it, by where they lead.
    pub ways: Vec<Way>,
}

impl Vertex {
    /// Whether a line of one class goes on here: whether this is no junction.
    pub fn goes_on(&self) -> bool {
        matches!(self.ways.as_slice(), [a, b] if a.rank.class == b.rank.class)
    }
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
    rank: Rank,
    level: i8,
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
    let padding = (PADDING_STEPS * step) as f64 + PADDING_MORE;
    let read = Reach::new("roads", own, padding).check(own.grown(padding))?;
    let mut edges: BTreeMap<(i8, [i64; 2], usize), Rank> = BTreeMap::new();
    // Nodes where a bridge or tunnel begins or ends: others along the same line touch ground there too.
    let mut landings: Vec<[i64; 2]> = Vec::new();
    let mut out = Graph::default();
    for tier in [SizeClass::City, SizeClass::Town, SizeClass::Village] {
        for course in courses(work, tier, read, cancel)? {
            let rank = Rank::of(&course, step);
            for span in &course.spans {
                landings.extend([span.first, span.last].map(|i| (course.nodes[i] - corner).to_array()));
            }
            for (i, pair) in course.nodes.windows(2).enumerate() {
                let (a, b) = (pair[0] - corner, pair[1] - corner);
                let out_of = |v: I64Vec2| {
                    v.cmplt(I64Vec2::splat(-PADDING_STEPS)) | v.cmpgt(I64Vec2::splat(TILE_STEPS + PADDING_STEPS))
                };
                let Some(h) = heading(a, b) else { continue };
                if (out_of(a) & out_of(b)).any() {
                    continue;
                }
                let (from, h) = if h < 8 { (a, h) } else { (b, h - 8) };
                edges.entry((course.level(i), from.to_array(), h)).and_modify(|r| *r = rank.min(*r)).or_insert(rank);
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
                join(&mut out, tile, (gate, place), (node, node_place), rank, 0);
            }
        }
    }
    landings.sort_unstable();
    let edges: Vec<Edge> = edges
        .into_iter()
        .map(|((level, a, h), rank)| Edge { a: a.into(), b: I64Vec2::from(a) + STENCIL[h], rank, level })
        .collect();
    for (e, points) in edges.iter().zip(crossings(&edges)) {
        let key = |p: I64Vec2| {
            let node = p.div_euclid(I64Vec2::splat(PARTS));
            let lands = node * PARTS == p && landings.binary_search(&node.to_array()).is_ok();
            let at = p + corner * PARTS;
            if lands || e.level == 0 { key_at(work, at) } else { Key::on(at, e.level) }
        };
        let keys: Vec<Key> = points.into_iter().map(key).collect();
        for pair in keys.windows(2) {
            let ends = [(pair[0], pair[0].place(step)), (pair[1], pair[1].place(step))];
            join(&mut out, tile, ends[0], ends[1], e.rank, e.level);
        }
    }
    Ok(out)
}

/// The settlement that a node stands for.
fn stands_for(work: &Work, node: I64Vec2) -> Option<SettlementId> {
    work.nodes.settlement(node)
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
pub(super) fn join(out: &mut Graph, tile: I64Vec2, a: (Key, Place), b: (Key, Place), rank: Rank, level: i8) {
    for ((key, place), (to, there)) in [(a, b), (b, a)] {
        if key.tile() != tile {
            continue;
        }
        let vertex = out.vertices.entry(key).or_insert_with(|| Vertex { place, ways: Vec::new() });
        match vertex.ways.binary_search_by_key(&to, |w| w.to) {
            Ok(i) => vertex.ways[i].rank = vertex.ways[i].rank.min(rank),
            Err(i) => vertex.ways.insert(i, Way { to, place: there, rank, level }),
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

/// The point inside of both edges, in parts of a step, if they are of one level.
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
    use super::*;

    #[test]
    fn crossings_of_the_stencil_are_whole_and_lie_on_both_edges() {
        let mut count = 0;
        for r in STENCIL {
            for s in STENCIL {
                for x in -2..=2 {
                    for y in -2..=2 {
                        let rank = Rank { class: StreetClass::Minor, length: 0, course: 0 };
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
