//! Smoothing: vertices move and corners become round, without making roads meet that did not meet before.
//!
//! Vertices with two ways are moved by up to three rounds of binomial smoothing, and their corners are rounded by a parabola. How
//! far a line may deviate from its lattice edges is known beforehand. Where two lines, or a line and an outline, are not
//! farther apart than both may deviate, neither is moved. Where not even the rounding of corners leaves room, neither is changed
//! at all. This decision needs only what lies within a few steps, and no order.

use super::budget::Budget;
use super::inputs::Inputs;
use super::overpass::BuiltGraphs;
use super::tile::{tile_bounds, tiles_around};
use super::vertex::{Graph, Key, Position, Vertex, Way};
use crate::layer::{Cancel, LayerCache, LayerError, Reach, Weigh};
use crate::space::{
    Bounds, Origin, distance_to_segment, math::angle_between, orient, polygon_distance, segment_distance,
};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Distance in metres that lines keep from each other after smoothing.
const APART: f64 = 6.0;
/// Padding of a tile's shapes in steps: the neighbourhood of a vertex (three edges each way), the same of the lines that it might
/// meet, and outlines beside these lines.
const PADDING_STEPS: f64 = 18.0;
/// Distance in steps around a tile within which outlines are read.
const OUTLINE_STEPS: f64 = 16.0;
/// Lines can only meet after smoothing if they are at most this many steps apart before.
const FARTHEST_STEPS: f64 = 4.0;
/// Number of rings of tiles around a tile whose graphs its shapes read.
pub(super) const RING: i64 = 2;

/// The new position of a vertex with two ways.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub position: Position,
    /// Whether the corner is rounded.
    pub round: bool,
}

/// Shapes of the vertices with two ways in one tile.
#[derive(Default)]
pub(super) struct TileShapes(pub BTreeMap<Key, Shape>);

impl Weigh for TileShapes {
    fn bytes(&self) -> usize {
        self.0.len() * (size_of::<Key>() + size_of::<Shape>() + 16) + 32
    }
}

/// The shapes of all tiles, remembered.
pub(super) struct Shapes {
    inputs: Arc<Inputs>,
    built: Arc<BuiltGraphs>,
    shapes: LayerCache<[i64; 2], TileShapes>,
}

impl Shapes {
    pub fn new(inputs: Arc<Inputs>, built: Arc<BuiltGraphs>, budget: Budget) -> Self {
        Self { inputs, built, shapes: budget.cache(2) }
    }

    /// The shapes of a tile.
    pub fn of_tile(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<TileShapes>, LayerError> {
        self.shapes.get(&tile.to_array(), || {
            let around = tiles_around(tile, RING).map(|t| self.built.graph(t, cancel));
            shapes(&self.inputs, tile, &around.collect::<Result<Vec<_>, _>>()?, cancel)
        })
    }
}

struct Bend {
    /// Displacement of the vertex.
    by: DVec2,
    /// How far the line may deviate from its lattice edges near the vertex.
    deviation: f64,
    /// Vertex before and after.
    around: [Key; 2],
}

/// The graphs of a tile and the tiles around it, as one.
struct Around<'a> {
    vertices: BTreeMap<Key, &'a Vertex>,
    origin: Origin,
}

impl Around<'_> {
    fn vertex(&self, key: Key) -> Option<&Vertex> {
        self.vertices.get(&key).copied()
    }

    /// Box of a way from a vertex, relative to the origin.
    fn bounds(&self, v: &Vertex, way: &Way) -> Bounds {
        Bounds::of([v.position.local_to(self.origin), way.position.local_to(self.origin)])
    }

    /// The vertex after `at`, coming from `from`, if the line continues there.
    fn beyond(&self, from: Key, at: Key) -> Option<(Key, Position)> {
        let v = self.vertex(at)?;
        if !v.continues() || at.is_gate() {
            return None;
        }
        v.ways.iter().find(|w| w.to != from).map(|w| (w.to, w.position))
    }

    fn bend(&self, key: Key) -> Option<Bend> {
        let v = self.vertex(key).filter(|_| !key.is_gate())?;
        let [a, b] = v.ways.as_slice() else { return None };
        if !v.continues() {
            return None;
        }
        let (pa, pb) = (a.position.from(&v.position), b.position.from(&v.position));
        let around = [a.to, b.to];
        let corner = (pa + pb).length() / 8.0;
        let still = Bend { by: DVec2::ZERO, deviation: corner, around };
        if a.to.is_gate() || b.to.is_gate() {
            // The tie stays where it was found to be free.
            return Some(still);
        }
        if a.level != 0 || b.level != 0 || angle_between(-pa, pb) > 1.4 {
            return Some(Bend { deviation: 0.0, ..still });
        }
        // The road runs straight onto a bridge or into a tunnel.
        let spans = |k: Key| self.vertex(k).is_some_and(|v| v.ways.iter().any(|w| w.level != 0));
        if spans(a.to) || spans(b.to) {
            return Some(still);
        }
        // Weights from Pascal's triangle: one to three rows, as far as the line continues on both sides.
        let second = (self.beyond(key, a.to), self.beyond(key, b.to));
        let by = match second {
            (Some((ka, a2)), Some((kb, b2))) => {
                let pairs = (a2.from(&v.position) + b2.from(&v.position), pa + pb);
                match (self.beyond(a.to, ka), self.beyond(b.to, kb)) {
                    (Some((_, a3)), Some((_, b3))) => {
                        ((a3.from(&v.position) + b3.from(&v.position)) + pairs.0 * 6.0 + pairs.1 * 15.0) / 64.0
                    }
                    _ => (pairs.0 + pairs.1 * 4.0) / 16.0,
                }
            }
            _ => (pa + pb) / 4.0,
        };
        Some(Bend { by, ..still })
    }
}

/// Shapes of one tile, from the graphs of the tiles within [`RING`].
fn shapes(inputs: &Inputs, tile: I64Vec2, graphs: &[Arc<Graph>], cancel: &Cancel) -> Result<TileShapes, LayerError> {
    cancel.check()?;
    let step = inputs.step();
    let own = tile_bounds(tile, step);
    let around = Around {
        vertices: graphs.iter().flat_map(|g| g.vertices.iter().map(|(k, v)| (*k, v))).collect(),
        origin: Origin::at(own.min),
    };
    // Only lines that end in the tile decide about its vertices, and only lines near these can meet them.
    let beside = |key: &Key, v: &Vertex, all: Bounds| {
        let own = v.ways.iter().filter(|w| key.tile() == tile || w.to.tile() == tile);
        own.fold(all, |all, way| all.union(around.bounds(v, way)))
    };
    let reached = around.vertices.iter().fold(Bounds::EMPTY, |all, (key, v)| beside(key, v, all));
    let reached = reached.grown(FARTHEST_STEPS * step as f64);
    let mut bends: BTreeMap<Key, Bend> = BTreeMap::new();
    for (key, v) in &around.vertices {
        for way in v.ways.iter().filter(|w| around.bounds(v, w).overlaps(reached)) {
            for key in [*key, way.to] {
                if !bends.contains_key(&key) {
                    bends.extend(around.bend(key).map(|b| (key, b)));
                }
            }
        }
    }
    // The rounding of a corner also depends on how far its neighbours move.
    let moved =
        |k: &Key| bends.get(k).map_or_else(|| around.bend(*k).map_or(0.0, |b| b.by.length()), |b| b.by.length());
    let deviation: BTreeMap<Key, Deviation> = bends
        .iter()
        .map(|(k, b)| {
            let (own, around) = (b.by.length(), moved(&b.around[0]) + moved(&b.around[1]));
            let round = b.deviation + around / 8.0;
            (*k, Deviation { moved: own + own / 4.0 + round, round })
        })
        .collect();
    let Kept { still, sharp } = conflicts(inputs, &around, &bends, &deviation, (tile, reached))?;
    let mut out = TileShapes::default();
    for (key, bend) in bends.iter().filter(|(k, _)| k.tile() == tile) {
        let Some(v) = around.vertex(*key) else { continue };
        let position = if still.binary_search(key).is_err() { v.position.moved(bend.by) } else { v.position };
        let round = sharp.binary_search(key).is_err() && bend.deviation + bend.by.length() > 0.3;
        out.0.insert(*key, Shape { position, round });
    }
    Ok(out)
}

/// How far a line may deviate from its lattice edges near a vertex: if the vertex moves, and if its corner is only rounded.
#[derive(Clone, Copy, Default)]
struct Deviation {
    moved: f64,
    round: f64,
}

struct Line {
    ends: [Key; 2],
    at: [DVec2; 2],
    bounds: Bounds,
    deviation: [Deviation; 2],
    level: i8,
    /// The corner that a ramp rounds, relative to the origin.
    bend: Option<DVec2>,
}

/// Vertices that must stay where they are, and vertices whose corners must also stay sharp. Both are sorted.
struct Kept {
    still: Vec<Key>,
    sharp: Vec<Key>,
}

impl Line {
    fn most(&self, of: fn(&Deviation) -> f64) -> f64 {
        of(&self.deviation[0]).max(of(&self.deviation[1]))
    }

    /// How far the curve of a ramp comes out of its straight line towards another line, at most.
    fn bulge(&self, f: &Line) -> f64 {
        let [a, b] = self.at;
        let towards = |bend: DVec2| f.at.iter().any(|p| orient(a, b, *p) * orient(a, b, bend) > 0.0);
        self.bend.filter(|bend| towards(*bend)).map_or(0.0, |bend| distance_to_segment(bend, a, b))
    }

    /// Whether two lines might meet after smoothing.
    fn clashes(&self, f: &Line, bends: &BTreeMap<Key, Bend>, of: fn(&Deviation) -> f64) -> bool {
        match self.ends.iter().position(|k| f.ends.contains(k)) {
            // Where one line passes over the other, they are on two levels.
            None if self.ends.iter().any(|k| f.ends.iter().any(|o| k.below() == Some(*o) || o.below() == Some(*k))) => {
                false
            }
            None => {
                let apart = segment_distance(self.at[0], self.at[1], f.at[0], f.at[1]);
                apart < self.most(of) + f.most(of) + self.bulge(f) + f.bulge(self) + APART
            }
            // A ramp was found to meet its roads nowhere else.
            Some(_) if self.bend.is_some() || f.bend.is_some() => false,
            // Neighbours along one line share the corner that is rounded.
            Some(x) if bends.contains_key(&self.ends[x]) => false,
            Some(x) => {
                let y = usize::from(f.ends[1] == self.ends[x]);
                let margin = of(&self.deviation[1 - x]) + of(&f.deviation[1 - y]) + APART;
                let off = |p: DVec2, l: &Line| segment_distance(p, p, l.at[0], l.at[1]);
                off(self.at[1 - x], f).min(off(f.at[1 - y], self)) < margin
            }
        }
    }
}

fn conflicts(
    inputs: &Inputs,
    around: &Around,
    bends: &BTreeMap<Key, Bend>,
    deviation: &BTreeMap<Key, Deviation>,
    (tile, reached): (I64Vec2, Bounds),
) -> Result<Kept, LayerError> {
    let step = inputs.step() as f64;
    let own = tile_bounds(tile, inputs.step());
    let is_own = |line: &Line| line.ends.iter().any(|k| k.tile() == tile);
    let deviation_of = |k: &Key| deviation.get(k).copied().unwrap_or_default();
    let mut lines = Vec::new();
    for (key, v) in &around.vertices {
        for way in v.ways.iter().filter(|w| *key < w.to || !around.vertices.contains_key(&w.to)) {
            if !around.bounds(v, way).overlaps(reached) {
                continue;
            }
            let at = [v.position.local_to(around.origin), way.position.local_to(around.origin)];
            let deviation = [deviation_of(key), deviation_of(&way.to)];
            let bend = way.ramp.map(|r| r.bend.local_to(around.origin));
            let bounds = Bounds::of(at.into_iter().chain(bend));
            let bounds = bounds.grown((deviation[0].moved.max(deviation[1].moved) + APART) / 2.0);
            lines.push(Line { ends: [*key, way.to], at, bounds, deviation, level: way.level, bend });
        }
    }
    let mut out = Kept { still: Vec::new(), sharp: Vec::new() };
    let both: [fn(&Deviation) -> f64; 2] = [|s| s.moved, |s| s.round];
    for (i, e) in lines.iter().enumerate() {
        let beside = is_own(e);
        for f in lines[i + 1..].iter().filter(|f| beside || is_own(f)) {
            if e.level != f.level || !e.bounds.overlaps(f.bounds) {
                continue;
            }
            // If all four ends stay, only their corners can still make the lines meet.
            for (of, held) in both.into_iter().zip([&mut out.still, &mut out.sharp]) {
                if e.clashes(f, bends, of) {
                    held.extend(e.ends.iter().chain(&f.ends).filter(|k| bends.contains_key(k)));
                }
            }
        }
    }
    lines.retain(is_own);
    let reach = Reach::new("roads", own, PADDING_STEPS * step);
    for s in inputs.settlements.overlapping(reach.check(own.grown(OUTLINE_STEPS * step))?)? {
        let circle = Bounds::square(s.centre.offset_to(around.origin), 2.0 * s.radius);
        if !lines.iter().any(|e| e.bounds.overlaps(circle)) {
            continue;
        }
        let outline = inputs.settlements.outline(&s)?;
        let shift = around.origin.offset_to(outline.origin);
        let bounds = outline.bounds().moved(-around.origin.plan());
        for e in lines.iter().filter(|e| e.bounds.overlaps(bounds)) {
            for (of, held) in both.into_iter().zip([&mut out.still, &mut out.sharp]) {
                let margin = e.most(of) + APART;
                if let Some(tie) = e.ends.iter().position(|k| k.is_gate()) {
                    // Only the outer half of a tie is rounded.
                    let outer = e.at[1 - tie] + shift;
                    let half = (e.at[0] + e.at[1]) / 2.0 + shift;
                    if polygon_distance(half, outer, &outline.polygon) < margin {
                        held.push(e.ends[1 - tie]);
                    }
                } else if polygon_distance(e.at[0] + shift, e.at[1] + shift, &outline.polygon) < margin {
                    held.extend(e.ends);
                }
            }
        }
    }
    for held in [&mut out.still, &mut out.sharp] {
        held.sort_unstable();
        held.dedup();
    }
    Ok(out)
}

/// Points of a corner between the middles of its two sides.
pub(super) fn corner(before: &Shape, at: &Shape, after: &Shape) -> Vec<Position> {
    let (a, b) = (before.position.from(&at.position) / 2.0, after.position.from(&at.position) / 2.0);
    if !at.round || (a + b).length() < 1.0 {
        return vec![at.position];
    }
    // A parabola that begins and ends at the same distance from the corner has the least curvature.
    let reach = a.length().min(b.length());
    let begins = (a.length() - reach > 4.0) || !before.round;
    let ends = (b.length() - reach > 4.0) || !after.round;
    let (a, b) = (a.normalize_or_zero() * reach, b.normalize_or_zero() * reach);
    // Symmetric in both sides, so that both directions give the same points.
    let mut points = Vec::new();
    points.extend(begins.then_some(0.0));
    points.extend([0.125, 0.375, 0.625, 0.875]);
    points.extend(ends.then_some(1.0));
    points.into_iter().map(|t: f64| at.position.moved(a * ((1.0 - t) * (1.0 - t)) + b * (t * t))).collect()
}
