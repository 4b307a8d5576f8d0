//! Streets along a river: quays on its bank lines, bridges between them, and a street from the centre to the first bridge.
//!
//! They are laid before anything grows, so that the streets on both banks grow from one network.

use super::curves::{STEP, cubic, simplified};
use super::proposal::Proposal;
use super::rules::Limits;
use super::sketch::{End, Sketch};
use crate::network::{StreetClass, VertexIx};
use crate::region::Waterway;
use crate::space::{Stream, left_normal};
use crate::style::MainRules;
use glam::DVec2;

/// Greatest deviation from the distance between bridges that the style asks for, as a share.
const UNEVEN: f64 = 0.18;
/// Least distance between the ends of a crescent, and of two bridges that bound a part of a quay, in metres.
const CRESCENT: f64 = 90.0;
/// Least distance from a bridge to the end of a quay, in metres.
const QUAY_END: f64 = 20.0;

/// The streets that are laid along a river before others grow.
#[derive(Default)]
pub(super) struct Quays {
    /// Vertices from which streets grow.
    pub starts: Vec<VertexIx>,
    /// For each bank, the index of the bank line's point at which the quay begins, and the vertices of the quay.
    lines: [(usize, Vec<VertexIx>); 2],
    /// The bank on whose side the centre lies: 0 for the left one.
    near: usize,
    /// Index of the span that the first bridge crosses.
    first: usize,
}

impl Quays {
    /// The vertex at a point of a bank line, if a quay passes it.
    fn vertex(&self, side: usize, point: usize) -> Option<VertexIx> {
        let (first, line) = &self.lines[side];
        line.get(point.checked_sub(*first)?).copied()
    }
}

/// The bank on whose side the centre lies.
fn near_bank(way: &Waterway) -> usize {
    let [a, b] = way.spans[way.first];
    usize::from(way.banks[0][a].length() > way.banks[1][b].length())
}

/// Lays quays, bridges, and the street from the centre to the first bridge. The centre is the sketch's first vertex.
pub(super) fn lay(sketch: &mut Sketch, rules: &MainRules, stream: &mut Stream) -> Quays {
    let centre = sketch.graph.add_vertex(DVec2::ZERO);
    let Some(way) = sketch.site.river.as_ref().map(|r| r.way) else { return Quays::default() };
    let near = near_bank(way);
    let Some((first, ranges)) = first_bridge(sketch, way, near) else { return Quays::default() };
    let mut quays: [Vec<VertexIx>; 2] = [Vec::new(), Vec::new()];
    for side in 0..2 {
        let (low, high) = ranges[side];
        quays[side] = (low..=high).map(|i| sketch.graph.add_vertex(way.banks[side][i])).collect();
        for pair in quays[side].windows(2) {
            sketch.graph.add_edge(pair[0], pair[1], StreetClass::Main);
        }
    }
    let at = |side: usize, i: usize| quays[side][i - ranges[side].0];
    let mut starts = Vec::new();
    for span in bridges(way, first, ranges, rules.bridges, stream) {
        let [a, b] = way.spans[span];
        let (a, b) = (at(0, a), at(1, b));
        sketch.graph.add_edge(a, b, StreetClass::Main);
        starts.extend([a, b]);
    }
    let span = way.spans[first];
    let (head, opposite) = (at(near, span[near]), at(1 - near, span[1 - near]));
    let (to, beyond) = (sketch.graph.at(head), sketch.graph.at(opposite));
    let path = simplified(cubic(DVec2::ZERO, to.normalize_or_zero(), to, (beyond - to).normalize_or_zero()));
    let (start, end) = (End::Vertex(centre), End::Vertex(head));
    let curves = path.len() > 1 && Proposal::new(&path, start, end).crosses_nothing(sketch);
    let path = if curves { path } else { vec![DVec2::ZERO, to] };
    sketch.add(&path, start, end);
    // No street comes from the centre to the far bank, so streets grow from all along its quay. On both banks streets grow from
    // the ends of the quay.
    let far = &quays[1 - near];
    let mut run = 0.0;
    for pair in far.windows(2) {
        run += sketch.graph.at(pair[0]).distance(sketch.graph.at(pair[1]));
        if sketch.graph.degree(pair[1]) > 2 {
            run = 0.0;
        } else if run >= sketch.rules.length.max(2.0 * STEP) {
            run = 0.0;
            starts.push(pair[1]);
        }
    }
    starts.extend(quays.iter().flat_map(|quay| [quay[0], quay[quay.len() - 1]]));
    starts.sort_unstable();
    starts.dedup();
    let [left, right] = quays;
    Quays { starts, lines: [(ranges[0].0, left), (ranges[1].0, right)], near, first }
}

/// The span for the first bridge, with the first and last points of both bank lines between which quays may run. Of the spans
/// that a street from the centre reaches, it is the nearest to [`Waterway::first`].
fn first_bridge(sketch: &Sketch, way: &Waterway, near: usize) -> Option<(usize, [(usize, usize); 2])> {
    let river = sketch.site.river.as_ref()?;
    let range = |side: usize, first: usize, margin: f64| {
        let bank = &way.banks[side];
        let clear = |i: &usize| sketch.site.ring.clearance(bank[*i], bank[*i], margin, |_| false) >= margin;
        let low = (1..=first).rev().take_while(clear).last()?;
        let high = (first..bank.len() - 1).take_while(clear).last()?;
        Some((low, high))
    };
    let mut spans: Vec<usize> = (0..way.spans.len()).collect();
    spans.sort_by_key(|k| (k.abs_diff(way.first), *k));
    for (share, ground) in [(1.0, true), (0.6, true), (0.4, true), (0.4, false)] {
        for &k in &spans {
            let head = way.banks[near][way.spans[k][near]];
            if river.blocks(DVec2::ZERO, head) || (ground && !sketch.site.ground_fits(&[DVec2::ZERO, head])) {
                continue;
            }
            let margin = share * sketch.rules.margin;
            if let (Some(left), Some(right)) = (range(0, way.spans[k][0], margin), range(1, way.spans[k][1], margin)) {
                return Some((k, [left, right]));
            }
        }
    }
    None
}

/// Keeps the far bank from losing all its streets as dead ends: lays a crescent from one end of its quay to the other, or
/// else a second bridge.
pub(super) fn keep_far_bank(sketch: &mut Sketch, quays: &Quays) {
    let far = 1 - quays.near;
    let line = &quays.lines[far].1;
    let Some(way) = sketch.site.river.as_ref().map(|r| r.way) else { return };
    let before = sketch.graph.clone();
    sketch.prune();
    let stays = line.iter().any(|v| sketch.graph.degree(*v) > 0);
    sketch.graph = before;
    if stays || line.len() < 3 {
        return;
    }
    let g = &sketch.graph;
    let sign = if far == 0 { 1.0 } else { -1.0 };
    let inland = |i: usize| {
        let along = g.at(line[(i + 1).min(line.len() - 1)]) - g.at(line[i.saturating_sub(1)]);
        left_normal(along).normalize_or_zero() * sign
    };
    let limits =
        Limits { gap: 30.0, min_angle: 0.6, min_length: 60.0, min_part: 20.0, margin: 40.0, ..sketch.rules.limits() };
    for inset in 0..line.len() / 2 {
        let (i, j) = (inset, line.len() - 1 - inset);
        let (a, b) = (g.at(line[i]), g.at(line[j]));
        if a.distance(b) < CRESCENT {
            break;
        }
        let along = (b - a).normalize_or_zero();
        for depth in [0.7, 0.5, 0.35] {
            let top = a.lerp(b, 0.5) + left_normal(along) * (sign * (depth * a.distance(b)).clamp(70.0, 260.0));
            let mut path = cubic(a, inland(i), top, along);
            path.pop();
            path.extend(cubic(top, along, b, -inland(j)));
            let path = simplified(path);
            let (start, end) = (End::Vertex(line[i]), End::Vertex(line[j]));
            if path.len() > 2 && Proposal::new(&path, start, end).fits(sketch, &limits) {
                sketch.add(&path, start, end);
                return;
            }
        }
    }
    let middle = |k: usize| way.banks[0][way.spans[k][0]];
    let bridge = |k: usize| {
        let [a, b] = way.spans[k];
        let (a, b) = (quays.vertex(0, a)?, quays.vertex(1, b)?);
        let apart = middle(k).distance(middle(quays.first));
        (apart >= CRESCENT && g.edge_between(a, b).is_none()).then_some((apart, a, b))
    };
    // The nearest bridge that leaves room for houses between it and the first.
    let found = (0..way.spans.len()).filter_map(bridge).min_by(|x, y| x.0.total_cmp(&y.0));
    if let Some((_, a, b)) = found {
        sketch.graph.add_edge(a, b, StreetClass::Main);
    }
}

/// The spans that bridges cross, `first` before the others; they stand about `distance` metres apart.
fn bridges(
    way: &Waterway,
    first: usize,
    ranges: [(usize, usize); 2],
    distance: f64,
    stream: &mut Stream,
) -> Vec<usize> {
    let inside = |span: usize| {
        way.spans.get(span).is_some_and(|ends| {
            (0..2).all(|side| {
                let (bank, (low, high)) = (&way.banks[side], ranges[side]);
                let i = ends[side];
                i >= low
                    && i <= high
                    && bank[i].distance(bank[low]) >= QUAY_END
                    && bank[i].distance(bank[high]) >= QUAY_END
            })
        })
    };
    let middle = |span: usize| {
        let [a, b] = way.spans[span];
        (way.banks[0][a] + way.banks[1][b]) / 2.0
    };
    let mut out = vec![first];
    for back in [false, true] {
        let (mut run, mut at) = (0.0, first);
        let mut wanted = distance * (1.0 + UNEVEN * stream.signed());
        loop {
            let next = if back { at.checked_sub(1) } else { Some(at + 1) };
            let Some(next) = next.filter(|n| *n < way.spans.len()) else { break };
            run += middle(at).distance(middle(next));
            at = next;
            if run >= wanted && inside(at) {
                out.push(at);
                run = 0.0;
                wanted = distance * (1.0 + UNEVEN * stream.signed());
            }
        }
    }
    out
}
