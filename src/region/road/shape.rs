//! Rounding off the courses' corners, so that nothing that was apart meets.
//!
//! Vertices with two ways are moved by up to three rounds of binomial smoothing and their corners rounded by a parabola. How far
//! the line may stray from the lattice's at each is known beforehand; where two lines, or a line and an outline, are not
//! further apart than both may stray, neither is touched. That decision needs only what lies within a few steps, and no
//! order.

use super::Work;
use super::graph::{Graph, Key, Place, Vertex, tile_bounds};
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

/// The graphs of a tile and the eight around it, as one.
struct Around<'a> {
    vertices: BTreeMap<Key, &'a Vertex>,
    origin: Origin,
}

impl Around<'_> {
    fn ways(&self, key: Key) -> Option<&Vertex> {
        self.vertices.get(&key).copied()
    }

    /// The vertex after `at`, coming from `from`, if the line goes on there.
    fn beyond(&self, from: Key, at: Key) -> Option<(Key, Place)> {
        let v = self.ways(at)?;
        if v.ways.len() != 2 || at.is_gate() {
            return None;
        }
        v.ways.iter().find(|w| w.to != from).map(|w| (w.to, w.place))
    }

    fn bend(&self, key: Key) -> Option<Bend> {
        let v = self.ways(key).filter(|_| !key.is_gate())?;
        let [a, b] = v.ways.as_slice() else { return None };
        let (pa, pb) = (a.place.from(&v.place), b.place.from(&v.place));
        let around = [a.to, b.to];
        let corner = (pa + pb).length() / 8.0;
        let still = Bend { by: DVec2::ZERO, stray: corner, around };
        if a.to.is_gate() || b.to.is_gate() {
            // The tie stays as it was found free.
            return Some(still);
        }
        if angle_between(-pa, pb) > 1.4 {
            return Some(Bend { stray: 0.0, ..still });
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

/// Shapes of one tile from the graphs of it and the eight tiles around it.
pub(super) fn shapes(work: &Work, tile: I64Vec2, graphs: &[Arc<Graph>], cancel: &Cancel) -> Result<Shapes, LayerError> {
    cancel.check()?;
    let step = work.settings.step;
    let own = tile_bounds(tile, step);
    let around = Around {
        vertices: graphs.iter().flat_map(|g| g.vertices.iter().map(|(k, v)| (*k, v))).collect(),
        origin: Origin::at(own.min),
    };
    // A corner's rounding also depends on how far its neighbours move.
    let mut bends: BTreeMap<Key, Bend> = BTreeMap::new();
    for key in around.vertices.keys() {
        bends.extend(around.bend(*key).map(|b| (*key, b)));
    }
    let moved = |k: &Key| bends.get(k).map_or(0.0, |b| b.by.length());
    let stray: BTreeMap<Key, f64> = bends
        .iter()
        .map(|(k, b)| {
            let own = b.by.length();
            (*k, own + b.stray + (moved(&b.around[0]) + moved(&b.around[1]) + 2.0 * own) / 8.0)
        })
        .collect();
    let still = conflicts(work, &around, &bends, &stray, own)?;
    let mut out = Shapes::default();
    for (key, bend) in bends.iter().filter(|(k, _)| k.tile() == tile) {
        let Some(v) = around.ways(*key) else { continue };
        let free = still.binary_search(key).is_err() && bend.stray + bend.by.length() > 0.0;
        let place = if free { v.place.moved(bend.by) } else { v.place };
        out.0.insert(*key, Shape { place, round: free && bend.stray > 0.3 });
    }
    Ok(out)
}

struct Line {
    ends: [Key; 2],
    at: [DVec2; 2],
    bounds: Bounds,
    stray: f64,
}

/// Vertices that must stay where they are, sorted.
fn conflicts(
    work: &Work,
    around: &Around,
    bends: &BTreeMap<Key, Bend>,
    stray: &BTreeMap<Key, f64>,
    own: Bounds,
) -> Result<Vec<Key>, LayerError> {
    let step = work.settings.step as f64;
    let near = own.grown(PADDING_STEPS * step).moved(-around.origin.plan());
    let stray_of = |k: &Key| stray.get(k).copied().unwrap_or(0.0);
    let mut lines = Vec::new();
    for (key, v) in &around.vertices {
        for way in v.ways.iter().filter(|w| *key < w.to || !around.vertices.contains_key(&w.to)) {
            let at = [v.place.local_to(around.origin), way.place.local_to(around.origin)];
            let stray = stray_of(key).max(stray_of(&way.to));
            let bounds = Bounds::of(at).grown((stray + APART) / 2.0);
            if bounds.overlaps(near) {
                lines.push(Line { ends: [*key, way.to], at, bounds, stray });
            }
        }
    }
    let mut still = Vec::new();
    for (i, e) in lines.iter().enumerate() {
        for f in &lines[i + 1..] {
            if !e.bounds.overlaps(f.bounds) {
                continue;
            }
            let shared = e.ends.iter().position(|k| f.ends.contains(k));
            let clash = match shared {
                None => segment_distance(e.at[0], e.at[1], f.at[0], f.at[1]) < e.stray + f.stray + APART,
                // Neighbours along one line round the same corner off.
                Some(x) if bends.contains_key(&e.ends[x]) => false,
                Some(x) => {
                    let y = usize::from(f.ends[1] == e.ends[x]);
                    let (far_e, far_f) = (e.at[1 - x], f.at[1 - y]);
                    let margin = stray_of(&e.ends[1 - x]) + stray_of(&f.ends[1 - y]) + APART;
                    let off = |p: DVec2, l: &Line| segment_distance(p, p, l.at[0], l.at[1]);
                    off(far_e, f).min(off(far_f, e)) < margin
                }
            };
            if clash {
                still.extend(e.ends.iter().chain(&f.ends).filter(|k| bends.contains_key(k)));
            }
        }
    }
    let reach = Reach::new("roads", own, (PADDING_STEPS + 4.0) * step);
    for s in work.places.overlapping(reach.check(own.grown((PADDING_STEPS + 2.0) * step))?)? {
        let outline = work.places.outline(&s)?;
        let shift = around.origin.offset_to(outline.origin);
        let bounds = outline.bounds().moved(-around.origin.plan());
        for e in lines.iter().filter(|e| e.bounds.overlaps(bounds)) {
            let margin = e.stray + APART;
            if let Some(tie) = e.ends.iter().position(|k| k.is_gate()) {
                // Only the outer half of a tie is rounded off.
                let outer = e.at[1 - tie] + shift;
                let half = (e.at[0] + e.at[1]) / 2.0 + shift;
                if polygon_distance(half, outer, &outline.polygon) < margin {
                    still.push(e.ends[1 - tie]);
                }
            } else if polygon_distance(e.at[0] + shift, e.at[1] + shift, &outline.polygon) < margin {
                still.extend(e.ends);
            }
        }
    }
    still.sort_unstable();
    still.dedup();
    Ok(still)
}

/// Points of a line's corner between the middles of its two sides, before the next corner.
pub(super) fn corner(before: &Place, at: &Shape, after: &Place) -> Vec<Place> {
    let (a, b) = (before.from(&at.place) / 2.0, after.from(&at.place) / 2.0);
    if !at.round || (a + b).length() < 1.0 {
        return vec![at.place];
    }
    // Symmetric in the two sides, so that both directions give the same points.
    [0.125, 0.375, 0.625, 0.875].map(|t: f64| at.place.moved(a * ((1.0 - t) * (1.0 - t)) + b * (t * t))).to_vec()
}
