//! A river in the plan: quays along its bank lines, bridges between them, and a street from the centre to the first. They
//! are laid before anything grows, so that the streets of both banks grow on from one network.

use super::grow::STEP;
use super::link::smooth;
use super::sketch::{End, Limits, Sketch, tidy};
use crate::network::{EdgeIx, Face, PlanarGraph, StreetClass, VertexIx};
use crate::region::Waterway;
use crate::space::{Stream, closest_on_line, left_normal, segments};
use crate::style::MainRules;
use glam::DVec2;

/// Distance from a bank line towards the water that no street but a bridge goes beyond, in metres.
const BRINK: f64 = 2.0;
/// Greatest deviation from the distance between bridges that is aimed at, as a share.
const UNEVEN: f64 = 0.18;
/// Least distance between the ends of a crescent, and of two bridges that bound a piece of quay, in metres.
const CRESCENT: f64 = 90.0;
/// Least distance from a bridge to the end of a quay, in metres.
const QUAY_END: f64 = 20.0;

/// A river that runs through the settlement.
pub(super) struct River<'a> {
    pub way: &'a Waterway,
    /// Lines in front of the bank lines that only bridges cross.
    brinks: PlanarGraph<()>,
}

impl<'a> River<'a> {
    pub fn new(way: &'a Waterway) -> Self {
        let mut brinks = PlanarGraph::new();
        for (side, bank) in way.banks.iter().enumerate() {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let last = bank.len() - 1;
            let shifted = |i: usize| {
                let along = bank[(i + 1).min(last)] - bank[i.saturating_sub(1)];
                bank[i] + left_normal(along).normalize_or_zero() * (sign * BRINK)
            };
            let vertices: Vec<VertexIx> = (0..=last).map(|i| brinks.add_vertex(shifted(i))).collect();
            for pair in vertices.windows(2) {
                brinks.add_edge(pair[0], pair[1], ());
            }
        }
        Self { way, brinks }
    }

    /// Whether a street from `a` to `b` leads towards the water.
    pub fn meets(&self, a: DVec2, b: DVec2) -> bool {
        self.brinks.first_hit(a, b, |_| false).is_some()
    }

    /// Whether a face of a graph is water between the banks.
    pub fn holds<E: Clone>(&self, graph: &PlanarGraph<E>, face: &Face) -> bool {
        let mut on = [false; 2];
        face.vertices.iter().all(|v| {
            let bank = self.way.bank_at(graph.at(*v));
            bank.map(|side| on[side] = true).is_some()
        }) && on == [true; 2]
    }

    /// Whether an edge is a piece of a quay or of a bridge.
    pub fn owns<E: Clone>(&self, graph: &PlanarGraph<E>, edge: EdgeIx) -> bool {
        let (a, b) = graph.segment(edge);
        self.way.bank_at(a).is_some() && self.way.bank_at(b).is_some()
    }
}

/// What is laid along a river before streets grow.
#[derive(Default)]
pub(super) struct Quays {
    /// Vertices from which streets grow on.
    pub starts: Vec<VertexIx>,
    /// The vertices along both bank lines, from the index of the bank line's point that comes first.
    lines: [(usize, Vec<VertexIx>); 2],
    /// The bank line on whose side the centre lies.
    near: usize,
    /// The span of the first bridge.
    first: usize,
}

impl Quays {
    /// The vertex at a point of a bank line.
    fn at(&self, side: usize, point: usize) -> Option<VertexIx> {
        let (first, line) = &self.lines[side];
        line.get(point.checked_sub(*first)?).copied()
    }
}

/// The bank line on whose side the centre lies.
fn near_bank(way: &Waterway) -> usize {
    let [a, b] = way.spans[way.first];
    usize::from(way.banks[0][a].length() > way.banks[1][b].length())
}

/// Lays quays, bridges and the street from the centre, which is the first of the sketch's vertices, to the first bridge.
pub(super) fn lay(sketch: &mut Sketch, rules: &MainRules, stream: &mut Stream) -> Quays {
    let centre = sketch.graph.add_vertex(DVec2::ZERO);
    let Some(way) = sketch.river.as_ref().map(|r| r.way) else { return Quays::default() };
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
    let path = tidy(smooth(DVec2::ZERO, to.normalize_or_zero(), to, (beyond - to).normalize_or_zero()));
    let bent = path.len() > 1 && sketch.crosses_nothing(&path, End::Vertex(centre), End::Vertex(head));
    let path = if bent { path } else { vec![DVec2::ZERO, to] };
    sketch.add(&path, End::Vertex(centre), End::Vertex(head));
    // On the farther bank streets grow from the quay, too: nothing comes from the centre. On both they do from its ends.
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

/// The span nearest to the settlement's that a street from the centre reaches, and the first and last points of both bank
/// lines between which quays may run on either side of it.
fn first_bridge(sketch: &Sketch, way: &Waterway, near: usize) -> Option<(usize, [(usize, usize); 2])> {
    let river = sketch.river.as_ref()?;
    let range = |side: usize, first: usize, margin: f64| {
        let bank = &way.banks[side];
        let clear = |i: &usize| sketch.ring.clearance(bank[*i], bank[*i], margin, |_| false) >= margin;
        let low = (1..=first).rev().take_while(clear).last()?;
        let high = (first..bank.len() - 1).take_while(clear).last()?;
        Some((low, high))
    };
    let mut spans: Vec<usize> = (0..way.spans.len()).collect();
    spans.sort_by_key(|k| (k.abs_diff(way.first), *k));
    for (share, ground) in [(1.0, true), (0.6, true), (0.4, true), (0.4, false)] {
        for &k in &spans {
            let head = way.banks[near][way.spans[k][near]];
            if river.meets(DVec2::ZERO, head) || (ground && !sketch.ground_fits(&[DVec2::ZERO, head])) {
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

/// Makes sure that the streets of the farther bank do not all end in nothing: by a crescent from one end of its quay to the
/// other, or else by one more bridge.
pub(super) fn keep_far_bank(sketch: &mut Sketch, quays: &Quays) {
    let far = 1 - quays.near;
    let line = &quays.lines[far].1;
    let Some(way) = sketch.river.as_ref().map(|r| r.way) else { return };
    let whole = sketch.graph.clone();
    sketch.prune();
    let stays = line.iter().any(|v| sketch.graph.degree(*v) > 0);
    sketch.graph = whole;
    if stays || line.len() < 3 {
        return;
    }
    let g = &sketch.graph;
    let sign = if far == 0 { 1.0 } else { -1.0 };
    let inland = |i: usize| {
        let along = g.at(line[(i + 1).min(line.len() - 1)]) - g.at(line[i.saturating_sub(1)]);
        left_normal(along).normalize_or_zero() * sign
    };
    let limits = Limits { gap: 30.0, angle: 0.6, min_length: 60.0, split: 20.0, margin: 40.0, ..sketch.limits() };
    for inset in 0..line.len() / 2 {
        let (i, j) = (inset, line.len() - 1 - inset);
        let (a, b) = (g.at(line[i]), g.at(line[j]));
        if a.distance(b) < CRESCENT {
            break;
        }
        let along = (b - a).normalize_or_zero();
        for depth in [0.7, 0.5, 0.35] {
            let top = a.lerp(b, 0.5) + left_normal(along) * (sign * (depth * a.distance(b)).clamp(70.0, 260.0));
            let mut path = smooth(a, inland(i), top, along);
            path.pop();
            path.extend(smooth(top, along, b, -inland(j)));
            let path = tidy(path);
            let (start, end) = (End::Vertex(line[i]), End::Vertex(line[j]));
            if path.len() > 2 && sketch.fits(&path, start, end, &limits) {
                sketch.add(&path, start, end);
                return;
            }
        }
    }
    let middle = |k: usize| way.banks[0][way.spans[k][0]];
    let bridge = |k: usize| {
        let [a, b] = way.spans[k];
        let (a, b) = (quays.at(0, a)?, quays.at(1, b)?);
        let apart = middle(k).distance(middle(quays.first));
        (apart >= CRESCENT && g.edge_between(a, b).is_none()).then_some((apart, a, b))
    };
    // The nearest that leaves room for houses between the two.
    let found = (0..way.spans.len()).filter_map(bridge).min_by(|x, y| x.0.total_cmp(&y.0));
    if let Some((_, a, b)) = found {
        sketch.graph.add_edge(a, b, StreetClass::Main);
    }
}

/// The spans at which bridges stand, the first before all others.
fn bridges(way: &Waterway, first: usize, ranges: [(usize, usize); 2], apart: f64, stream: &mut Stream) -> Vec<usize> {
    let inside = |span: usize| {
        way.spans.get(span).is_some_and(|of| {
            (0..2).all(|side| {
                let (bank, (low, high)) = (&way.banks[side], ranges[side]);
                let i = of[side];
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
        let mut wanted = apart * (1.0 + UNEVEN * stream.signed());
        loop {
            let next = if back { at.checked_sub(1) } else { Some(at + 1) };
            let Some(next) = next.filter(|n| *n < way.spans.len()) else { break };
            run += middle(at).distance(middle(next));
            at = next;
            if run >= wanted && inside(at) {
                out.push(at);
                run = 0.0;
                wanted = apart * (1.0 + UNEVEN * stream.signed());
            }
        }
    }
    out
}

/// Where a straight way crosses the bank lines, in order.
pub(super) fn fords(way: &Waterway, from: DVec2, to: DVec2) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = way
        .banks
        .iter()
        .flat_map(|bank| segments(bank))
        .filter_map(|(a, b)| crate::space::segment_crossing(from, to, a, b))
        .map(|x| crate::space::quantize(x.at))
        .collect();
    out.sort_by(|a, b| from.distance(*a).total_cmp(&from.distance(*b)));
    out.dedup();
    out
}

/// Points of a bank line in order: those of the line, and `others` that lie on it.
pub(super) fn along_bank(
    bank: &[DVec2],
    others: impl Iterator<Item = (DVec2, VertexIx)>,
) -> Vec<(DVec2, Option<VertexIx>)> {
    let along = |p: DVec2| closest_on_line(p, bank).0;
    let mut out: Vec<(f64, DVec2, Option<VertexIx>)> = others.map(|(p, v)| (along(p), p, Some(v))).collect();
    let bare: Vec<DVec2> = bank.iter().copied().filter(|p| out.iter().all(|o| o.1 != *p)).collect();
    out.extend(bare.into_iter().map(|p| (along(p), p, None)));
    out.sort_by(|a, b| a.0.total_cmp(&b.0));
    out.into_iter().map(|(_, p, v)| (p, v)).collect()
}
