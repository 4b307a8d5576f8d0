//! A river in the plan: quays along its bank lines, bridges between them, and a street from the centre to the first. They
//! are laid before anything grows, so that the streets of both banks grow on from one network.

use super::grow::STEP;
use super::link::smooth;
use super::sketch::{End, Sketch, tidy};
use crate::network::{EdgeIx, Face, PlanarGraph, StreetClass, VertexIx};
use crate::region::Waterway;
use crate::space::{Stream, closest_on_line, left_normal, segments};
use crate::town::MainRules;
use glam::DVec2;

/// Distance from a bank line towards the water that no street but a bridge goes beyond, in metres.
const BRINK: f64 = 2.0;
/// Greatest deviation from the distance between bridges that is aimed at, as a share.
const UNEVEN: f64 = 0.18;
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

/// The bank line on whose side the centre lies.
fn near_bank(way: &Waterway) -> usize {
    let [a, b] = way.spans[way.first];
    usize::from(way.banks[0][a].length() > way.banks[1][b].length())
}

/// Lays quays, bridges and the street from the centre to the first bridge. The vertices from which streets grow on; the
/// centre is the first of the sketch's.
pub(super) fn lay(sketch: &mut Sketch, rules: &MainRules, stream: &mut Stream) -> Vec<VertexIx> {
    let centre = sketch.graph.add_vertex(DVec2::ZERO);
    let Some(way) = sketch.river.as_ref().map(|r| r.way) else { return Vec::new() };
    let margin = sketch.rules.margin;
    // Indices of the bank lines' points that quays run between.
    let range = |side: usize, first: usize| {
        let clear =
            |i: &usize| sketch.ring.clearance(way.banks[side][*i], way.banks[side][*i], margin, |_| false) >= margin;
        let last = way.banks[side].len() - 1;
        let low = (1..=first).rev().take_while(clear).last()?;
        let high = (first..last).take_while(clear).last()?;
        Some((low, high))
    };
    let [left, right] = way.spans[way.first];
    let (Some(left), Some(right)) = (range(0, left), range(1, right)) else { return Vec::new() };
    let ranges = [left, right];
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
    for span in bridges(way, ranges, rules.bridges, stream) {
        let [a, b] = way.spans[span];
        let (a, b) = (at(0, a), at(1, b));
        sketch.graph.add_edge(a, b, StreetClass::Main);
        starts.extend([a, b]);
    }
    let near = near_bank(way);
    let span = way.spans[way.first];
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
    starts
}

/// The spans at which bridges stand, the first before all others.
fn bridges(way: &Waterway, ranges: [(usize, usize); 2], apart: f64, stream: &mut Stream) -> Vec<usize> {
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
    let mut out = vec![way.first];
    for back in [false, true] {
        let (mut run, mut at) = (0.0, way.first);
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
