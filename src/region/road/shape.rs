//! Rounding off the courses' corners, so that nothing that was apart meets.
//!
//! Vertices with two ways are moved by up to three rounds of binomial smoothing and their corners rounded by a parabola. How far
//! the line may stray from the lattice's at each is known beforehand; where two lines, or a line and an outline, are not
//! further apart than both may stray, neither is moved, and if not even rounding their corners leaves room, neither is
//! touched. That decision needs only what lies within a few steps, and no order.

use super::Work;
use super::graph::{Graph, Key, Place, Vertex, Way, tile_bounds};
use crate::layer::{Cancel, LayerError, Reach, Weigh};
use crate::space::{Bounds, Origin, math::angle_between, polygon_distance, segment_distance};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Distance in metres that lines keep from each other after smoothing.
const APART: f64 = 6.0;
/// How far around its tile shapes depend on the graph, in steps: a vertex's neighbourhood of three edges each way, that of
/// the lines it might meet, and outlines beside them.
const PADDING_STEPS: f64 = 14.0;

/// Lines are in each other's way only within this distance before they are shaped, in steps.
const FARTHEST_STEPS: f64 = 4.0;

/// Tiles on each side whose graphs shapes read.
pub(super) const RING: i64 = 2;

/// Where a vertex with two ways went.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub place: Place,
    /// Whether the corner is rounded off.
    pub round: bool,
}

/// Shapes of the vertices with two ways in one tile.
#[derive(Default)]
pub(super) struct Shapes(pub BTreeMap<Key, Shape>);

impl Weigh for Shapes {
    fn bytes(&self) -> usize {
        self.0.len() * (size_of::<Key>() + size_of::<Shape>() + 16) + 32
    }
}

struct Bend {
    by: DVec2,
    /// How far the line may stray from the lattice's near the vertex.
    stray: f64,
    /// Vertex before and after.
    around: [Key; 2],
}

/// The graphs of a tile and those around it, as one.
struct Around<'a> {
    vertices: BTreeMap<Key, &'a Vertex>,
    origin: Origin,
}

impl Around<'_> {
    fn ways(&self, key: Key) -> Option<&Vertex> {
        self.vertices.get(&key).copied()
    }

    /// Box of a way from a vertex, relative to the origin.
    fn bounds(&self, v: &Vertex, way: &Way) -> Bounds {
        Bounds::of([v.place.local_to(self.origin), way.place.local_to(self.origin)])
    }

    /// The vertex after `at`, coming from `from`, if the line goes on there.
    fn beyond(&self, from: Key, at: Key) -> Option<(Key, Place)> {
        let v = self.ways(at)?;
        if !v.goes_on() || at.is_gate() {
            return None;
        }
        v.ways.iter().find(|w| w.to != from).map(|w| (w.to, w.place))
    }

    fn bend(&self, key: Key) -> Option<Bend> {
        let v = self.ways(key).filter(|_| !key.is_gate())?;
        let [a, b] = v.ways.as_slice() else { return None };
        if !v.goes_on() {
            return None;
        }
        let (pa, pb) = (a.place.from(&v.place), b.place.from(&v.place));
        let around = [a.to, b.to];
        let corner = (pa + pb).length() / 8.0;
        let still = Bend { by: DVec2::ZERO, stray: corner, around };
        if a.to.is_gate() || b.to.is_gate() {
            // The tie stays as it was found free.
            return Some(still);
        }
        if a.level != 0 || b.level != 0 || angle_between(-pa, pb) > 1.4 {
            return Some(Bend { stray: 0.0, ..still });
        }
        // Straight onto a bridge or into a tunnel.
        let spans = |k: Key| self.ways(k).is_some_and(|v| v.ways.iter().any(|w| w.level != 0));
        if spans(a.to) || spans(b.to) {
            return Some(still);
        }
        // Rows of Pascal's triangle, as many as the line is long on both sides.
        let second = (self.beyond(key, a.to), self.beyond(key, b.to));
        let by = match second {
            (Some((ka, a2)), Some((kb, b2))) => {
                let pairs = (a2.from(&v.place) + b2.from(&v.place), pa + pb);
                match (self.beyond(a.to, ka), self.beyond(b.to, kb)) {
                    (Some((_, a3)), Some((_, b3))) => {
                        ((a3.from(&v.place) + b3.from(&v.place)) + pairs.0 * 6.0 + pairs.1 * 15.0) / 64.0
                    }
                    _ => (pairs.0 + pairs.1 * 4.0) / 16.0,
                }
            }
            _ => (pa + pb) / 4.0,
        };
        Some(Bend { by, ..still })
    }
}

/// Shapes of one tile from the graphs of it and the tiles within [`RING`].
pub(super) fn shapes(work: &Work, tile: I64Vec2, graphs: &[Arc<Graph>], cancel: &Cancel) -> Result<Shapes, LayerError> {
    cancel.check()?;
    let step = work.settings.step;
    let own = tile_bounds(tile, step);
    let around = Around {
        vertices: graphs.iter().flat_map(|g| g.vertices.iter().map(|(k, v)| (*k, v))).collect(),
        origin: Origin::at(own.min),
    };
    // Only lines that end in the tile decide about its vertices, and only lines near these can be in their way.
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
    // A corner's rounding also depends on how far its neighbours move.
    let moved =
        |k: &Key| bends.get(k).map_or_else(|| around.bend(*k).map_or(0.0, |b| b.by.length()), |b| b.by.length());
    let stray: BTreeMap<Key, Stray> = bends
        .iter()
        .map(|(k, b)| {
            let (own, around) = (b.by.length(), moved(&b.around[0]) + moved(&b.around[1]));
            let round = b.stray + around / 8.0;
            (*k, Stray { moved: own + own / 4.0 + round, round })
        })
        .collect();
    let Kept { still, sharp } = conflicts(work, &around, &bends, &stray, (tile, reached))?;
    let mut out = Shapes::default();
    for (key, bend) in bends.iter().filter(|(k, _)| k.tile() == tile) {
        let Some(v) = around.ways(*key) else { continue };
        let place = if still.binary_search(key).is_err() { v.place.moved(bend.by) } else { v.place };
        let round = sharp.binary_search(key).is_err() && bend.stray + bend.by.length() > 0.3;
        out.0.insert(*key, Shape { place, round });
    }
    Ok(out)
}

/// How far the line may stray from the lattice's near a vertex: if it is moved, and if its corner is only rounded off.
#[derive(Clone, Copy, Default)]
struct Stray {
    moved: f64,
    round: f64,
}

struct Line {
    ends: [Key; 2],
    at: [DVec2; 2],
    bounds: Bounds,
    stray: [Stray; 2],
    level: i8,
}

/// Vertices that must stay where they are, and those whose corners must stay sharp too; both sorted.
struct Kept {
    still: Vec<Key>,
    sharp: Vec<Key>,
}

impl Line {
    fn stray(&self, of: fn(&Stray) -> f64) -> f64 {
        of(&self.stray[0]).max(of(&self.stray[1]))
    }

    /// Whether two lines might meet.
    fn clashes(&self, f: &Line, bends: &BTreeMap<Key, Bend>, of: fn(&Stray) -> f64) -> bool {
        match self.ends.iter().position(|k| f.ends.contains(k)) {
            // Where one passes over the other, they are on two levels.
            None if self.ends.iter().any(|k| f.ends.iter().any(|o| k.under() == Some(*o) || o.under() == Some(*k))) => {
                false
            }
            None => {
                let apart = segment_distance(self.at[0], self.at[1], f.at[0], f.at[1]);
                apart < self.stray(of) + f.stray(of) + APART
            }
            // Neighbours along one line round the same corner off.
            Some(x) if bends.contains_key(&self.ends[x]) => false,
            Some(x) => {
                let y = usize::from(f.ends[1] == self.ends[x]);
                let margin = of(&self.stray[1 - x]) + of(&f.stray[1 - y]) + APART;
                let off = |p: DVec2, l: &Line| segment_distance(p, p, l.at[0], l.at[1]);
                off(self.at[1 - x], f).min(off(f.at[1 - y], self)) < margin
            }
        }
    }
}

fn conflicts(
    work: &Work,
    around: &Around,
    bends: &BTreeMap<Key, Bend>,
    stray: &BTreeMap<Key, Stray>,
    (tile, reached): (I64Vec2, Bounds),
) -> Result<Kept, LayerError> {
    let step = work.settings.step as f64;
    let own = tile_bounds(tile, work.settings.step);
    let is_own = |line: &Line| line.ends.iter().any(|k| k.tile() == tile);
    let stray_of = |k: &Key| stray.get(k).copied().unwrap_or_default();
    let mut lines = Vec::new();
    for (key, v) in &around.vertices {
        for way in v.ways.iter().filter(|w| *key < w.to || !around.vertices.contains_key(&w.to)) {
            if !around.bounds(v, way).overlaps(reached) {
                continue;
            }
            let at = [v.place.local_to(around.origin), way.place.local_to(around.origin)];
            let stray = [stray_of(key), stray_of(&way.to)];
            let bounds = Bounds::of(at).grown((stray[0].moved.max(stray[1].moved) + APART) / 2.0);
            lines.push(Line { ends: [*key, way.to], at, bounds, stray, level: way.level });
        }
    }
    let mut out = Kept { still: Vec::new(), sharp: Vec::new() };
    let both: [fn(&Stray) -> f64; 2] = [|s| s.moved, |s| s.round];
    for (i, e) in lines.iter().enumerate() {
        let beside = is_own(e);
        for f in lines[i + 1..].iter().filter(|f| beside || is_own(f)) {
            if e.level != f.level || !e.bounds.overlaps(f.bounds) {
                continue;
            }
            // All four ends stay, so it is their corners alone that might still be too much.
            for (of, held) in both.into_iter().zip([&mut out.still, &mut out.sharp]) {
                if e.clashes(f, bends, of) {
                    held.extend(e.ends.iter().chain(&f.ends).filter(|k| bends.contains_key(k)));
                }
            }
        }
    }
    lines.retain(is_own);
    let reach = Reach::new("roads", own, (PADDING_STEPS + 4.0) * step);
    for s in work.places.overlapping(reach.check(own.grown((PADDING_STEPS + 2.0) * step))?)? {
        let circle = Bounds::square(s.centre.offset_to(around.origin), 2.0 * s.radius);
        if !lines.iter().any(|e| e.bounds.overlaps(circle)) {
            continue;
        }
        let outline = work.places.outline(&s)?;
        let shift = around.origin.offset_to(outline.origin);
        let bounds = outline.bounds().moved(-around.origin.plan());
        for e in lines.iter().filter(|e| e.bounds.overlaps(bounds)) {
            for (of, held) in both.into_iter().zip([&mut out.still, &mut out.sharp]) {
                let margin = e.stray(of) + APART;
                if let Some(tie) = e.ends.iter().position(|k| k.is_gate()) {
                    // Only the outer half of a tie is rounded off.
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

/// Points of a line's corner between the middles of its two sides, before the next corner.
pub(super) fn corner(before: &Shape, at: &Shape, after: &Shape) -> Vec<Place> {
    let (a, b) = (before.place.from(&at.place) / 2.0, after.place.from(&at.place) / 2.0);
    if !at.round || (a + b).length() < 1.0 {
        return vec![at.place];
    }
    // A parabola that begins and ends as far from the corner bends least sharply.
    let reach = a.length().min(b.length());
    let begins = (a.length() - reach > 4.0) || !before.round;
    let ends = (b.length() - reach > 4.0) || !after.round;
    let (a, b) = (a.normalize_or_zero() * reach, b.normalize_or_zero() * reach);
    // Symmetric in the two sides, so that both directions give the same points.
    let mut points = Vec::new();
    points.extend(begins.then_some(0.0));
    points.extend([0.125, 0.375, 0.625, 0.875]);
    points.extend(ends.then_some(1.0));
    points.into_iter().map(|t: f64| at.place.moved(a * ((1.0 - t) * (1.0 - t)) + b * (t * t))).collect()
}
