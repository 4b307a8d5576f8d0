//! Vertices of the graph of roads, with exact names and positions.

use super::route::Route;
use super::tile::TILE_STEPS;
use crate::layer::Weigh;
use crate::network::{JunctionId, StreetClass};
use crate::space::{Origin, line_length, quantize};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;

/// Coordinates of vertices are whole multiples of this part of a lattice step: edges of the stencil cross at multiples of 1/2,
/// 1/3, 1/4 and 1/5 of a step.
pub(super) const PARTS: i64 = 60;

/// The point nearest to a share of the way from `a` to `b`, all in parts of a step, that lies exactly on the line between them.
pub(super) fn part_of_way(a: I64Vec2, b: I64Vec2, share: f64) -> I64Vec2 {
    let by = b - a;
    let count = greatest_divisor(by.x.abs(), by.y.abs()).max(1);
    a + by / count * (count as f64 * share + 0.5).floor() as i64
}

fn greatest_divisor(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { greatest_divisor(b, a % b) }
}

/// Name of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Key {
    /// A lattice node or a crossing on the ground, in parts of a step.
    Ground { x: i64, y: i64 },
    /// The same on a bridge (level 1) or in a tunnel (level -1), except at its ends.
    Span { x: i64, y: i64, level: i8 },
    /// The vertex of a road that passes over a highway, at the position of the highway's vertex.
    Overpass { x: i64, y: i64 },
    /// A gate: the lattice cell that it lies in, its settlement and its vertex of the outline.
    Gate { x: i64, y: i64, settlement: u64, vertex: u32 },
}

/// A position in the plan, exact everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Position {
    /// Whole metres.
    pub origin: Origin,
    /// Offset on the quantum grid.
    pub offset: DVec2,
}

impl Position {
    /// The position relative to an origin.
    pub fn local_to(&self, origin: Origin) -> DVec2 {
        self.origin.offset_to(origin) + self.offset
    }

    /// The vector from `other` to this position.
    pub fn from(&self, other: &Position) -> DVec2 {
        self.origin.offset_to(other.origin) + (self.offset - other.offset)
    }

    /// The position moved by `by`, which is rounded to the quantum grid.
    pub fn moved(&self, by: DVec2) -> Position {
        Position { origin: self.origin, offset: self.offset + quantize(by) }
    }

    /// The position in plan metres, rounded far from the origin.
    pub fn plan(&self) -> DVec2 {
        self.origin.to_plan(self.offset)
    }
}

impl Key {
    pub fn of_node(n: I64Vec2) -> Self {
        Self::Ground { x: n.x * PARTS, y: n.y * PARTS }
    }

    /// The point `p`, in parts of a step, on a level.
    pub fn on_level(p: I64Vec2, level: i8) -> Self {
        if level == 0 { Self::Ground { x: p.x, y: p.y } } else { Self::Span { x: p.x, y: p.y, level } }
    }

    /// The position of a vertex on the ground, in parts of a step; `None` for other vertices.
    pub fn ground_parts(self) -> Option<I64Vec2> {
        match self {
            Self::Ground { x, y } => Some(I64Vec2::new(x, y)),
            Self::Gate { .. } | Self::Span { .. } | Self::Overpass { .. } => None,
        }
    }

    /// Lattice cell that the vertex lies in.
    pub fn cell(self) -> I64Vec2 {
        match self {
            Self::Ground { x, y } | Self::Span { x, y, .. } | Self::Overpass { x, y } => {
                I64Vec2::new(x, y).div_euclid(I64Vec2::splat(PARTS))
            }
            Self::Gate { x, y, .. } => I64Vec2::new(x, y),
        }
    }

    /// The lattice node at the vertex, if the vertex is a node on the ground.
    pub fn lattice_node(self) -> Option<I64Vec2> {
        let cell = self.cell();
        (self == Self::of_node(cell)).then_some(cell)
    }

    /// The vertex at the same position of a road that passes over this one.
    pub fn overpass(self) -> Self {
        match self {
            Self::Ground { x, y } => Self::Overpass { x, y },
            other => other,
        }
    }

    /// The vertex that this one passes over, if it is an overpass.
    pub fn below(self) -> Option<Self> {
        match self {
            Self::Overpass { x, y } => Some(Self::Ground { x, y }),
            _ => None,
        }
    }

    /// Tile that the vertex lies in.
    pub fn tile(self) -> I64Vec2 {
        self.cell().div_euclid(I64Vec2::splat(TILE_STEPS))
    }

    pub fn is_gate(self) -> bool {
        matches!(self, Self::Gate { .. })
    }

    /// Words that identify the vertex.
    pub fn words(self) -> [u64; 4] {
        match self {
            Self::Ground { x, y } => [1, x as u64, y as u64, 0],
            Self::Span { x, y, level } => [4, x as u64, y as u64, level as u64],
            Self::Overpass { x, y } => [5, x as u64, y as u64, 0],
            Self::Gate { settlement, vertex, .. } => [2, settlement, u64::from(vertex), 0],
        }
    }

    /// Id of the vertex as a junction.
    pub fn junction(self) -> JunctionId {
        JunctionId::of(&self.words())
    }

    /// Position of the vertex. Only its settlement knows the position of a gate; for a gate this is the corner of its cell.
    pub fn position(self, step: i64) -> Position {
        let cell = self.cell();
        let parts = match self {
            Self::Ground { x, y } | Self::Span { x, y, .. } | Self::Overpass { x, y } => {
                I64Vec2::new(x, y) - cell * PARTS
            }
            Self::Gate { .. } => I64Vec2::ZERO,
        };
        let offset = quantize((parts * step).as_dvec2() / PARTS as f64);
        Position { origin: Origin(cell * step), offset }
    }
}

/// Decides which of two roads stays where they merge: the one with the lesser rank. First the class counts, then the length
/// of the route, then its id.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Rank {
    pub class: StreetClass,
    /// Bits of the route's length in metres, which is not negative.
    length: u64,
    route: u64,
}

impl Rank {
    pub fn of(route: &Route, step: i64) -> Self {
        let length = line_length(&route.line(step)).to_bits();
        Self { class: route.class, length, route: route.id.0 }
    }

    /// The rank of a one-way ramp of the road with this rank.
    pub fn of_ramp(self) -> Self {
        Self { class: StreetClass::Ramp, ..self }
    }
}

/// The course of a one-way ramp along a way.
#[derive(Clone, Copy, Debug)]
pub(super) struct RampCourse {
    /// The corner that the ramp rounds between both ends of the way.
    pub bend: Position,
    /// Whether traffic goes along the way, and not against it.
    pub ahead: bool,
}

/// A way from a vertex to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub to: Key,
    pub position: Position,
    /// The least rank of the routes that take this way.
    pub rank: Rank,
    /// 1 on a bridge and -1 in a tunnel that the search for a route chose, 0 elsewhere.
    pub level: i8,
    /// The course of the ramp that the way is, if it is one of a diamond interchange.
    pub ramp: Option<RampCourse>,
}

/// A vertex of the graph.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    pub position: Position,
    /// Ways that leave the vertex, sorted by where they lead.
    pub ways: Vec<Way>,
}

impl Vertex {
    /// Whether a line of one class continues here, so that the vertex is no junction.
    pub fn continues(&self) -> bool {
        matches!(self.ways.as_slice(), [a, b] if a.rank.class == b.rank.class)
    }
}

/// The vertices in one tile, with all their ways.
#[derive(Clone, Default)]
pub(super) struct Graph {
    pub vertices: BTreeMap<Key, Vertex>,
}

impl Weigh for Graph {
    fn bytes(&self) -> usize {
        self.vertices.values().map(|v| 96 + v.ways.len() * size_of::<Way>()).sum::<usize>() + 64
    }
}

impl Graph {
    /// Adds a way in both directions, as far as its ends lie in the tile.
    pub fn join(&mut self, tile: I64Vec2, a: (Key, Position), b: (Key, Position), rank: Rank, level: i8) {
        for ((key, position), (to, there)) in [(a, b), (b, a)] {
            self.add((tile, key, position), Way { to, position: there, rank, level, ramp: None });
        }
    }

    /// Adds a one-way ramp from `a` to `b` that rounds a corner between them.
    pub fn join_by_ramp(&mut self, tile: I64Vec2, a: (Key, Position), b: (Key, Position), rank: Rank, bend: Position) {
        for ((key, position), (to, there), ahead) in [(a, b, true), (b, a, false)] {
            let ramp = Some(RampCourse { bend, ahead });
            self.add((tile, key, position), Way { to, position: there, rank, level: 0, ramp });
        }
    }

    /// Adds a way from a vertex, if the vertex lies in the tile.
    fn add(&mut self, (tile, key, position): (I64Vec2, Key, Position), way: Way) {
        if key.tile() != tile {
            return;
        }
        let vertex = self.vertices.entry(key).or_insert_with(|| Vertex { position, ways: Vec::new() });
        match vertex.ways.binary_search_by_key(&way.to, |w| w.to) {
            Ok(i) => vertex.ways[i].rank = vertex.ways[i].rank.min(way.rank),
            Err(i) => vertex.ways.insert(i, way),
        }
    }
}
