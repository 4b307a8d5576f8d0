//! A river between main streets: the lines that only bridges cross, and the faces and edges that belong to the river.

use crate::network::{EdgeIx, Face, PlanarGraph, VertexIx};
use crate::region::Waterway;
use crate::space::{closest_on_line, left_normal, quantize, segment_crossing, segments};
use glam::DVec2;

/// Distance from the bank lines towards the water that only bridges may exceed, in metres.
const BARRIER: f64 = 2.0;

/// A river that runs through a settlement.
pub(super) struct River<'a> {
    pub way: &'a Waterway,
    /// Lines in front of the bank lines that only bridges cross.
    barriers: PlanarGraph<()>,
}

impl<'a> River<'a> {
    pub fn new(way: &'a Waterway) -> Self {
        let mut barriers = PlanarGraph::new();
        for (side, bank) in way.banks.iter().enumerate() {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let last = bank.len() - 1;
            let shifted = |i: usize| {
                let along = bank[(i + 1).min(last)] - bank[i.saturating_sub(1)];
                bank[i] + left_normal(along).normalize_or_zero() * (sign * BARRIER)
            };
            let vertices: Vec<VertexIx> = (0..=last).map(|i| barriers.add_vertex(shifted(i))).collect();
            for pair in vertices.windows(2) {
                barriers.add_edge(pair[0], pair[1], ());
            }
        }
        Self { way, barriers }
    }

    /// Whether a street from `a` to `b` would run into the water.
    pub fn blocks(&self, a: DVec2, b: DVec2) -> bool {
        self.barriers.first_hit(a, b, |_| false).is_some()
    }

    /// Whether a face of a graph is water between both banks.
    pub fn is_water<E: Clone>(&self, graph: &PlanarGraph<E>, face: &Face) -> bool {
        let mut touched = [false; 2];
        face.vertices.iter().all(|v| {
            let bank = self.way.bank_at(graph.at(*v));
            bank.map(|side| touched[side] = true).is_some()
        }) && touched == [true; 2]
    }

    /// Whether an edge is a part of a quay or of a bridge.
    pub fn has_street<E: Clone>(&self, graph: &PlanarGraph<E>, edge: EdgeIx) -> bool {
        let (a, b) = graph.segment(edge);
        self.way.bank_at(a).is_some() && self.way.bank_at(b).is_some()
    }

    /// Where the straight line from `from` to `to` crosses the bank lines, in order.
    pub fn bank_crossings(&self, from: DVec2, to: DVec2) -> Vec<DVec2> {
        let mut out: Vec<DVec2> = self
            .way
            .banks
            .iter()
            .flat_map(|bank| segments(bank))
            .filter_map(|(a, b)| segment_crossing(from, to, a, b))
            .map(|x| quantize(x.at))
            .collect();
        out.sort_by(|a, b| from.distance(*a).total_cmp(&from.distance(*b)));
        out.dedup();
        out
    }

    /// The points of a bank line in order, merged with the vertices `on_line` of a graph that lie on it.
    pub fn bank_points(
        &self,
        side: usize,
        on_line: impl Iterator<Item = (DVec2, VertexIx)>,
    ) -> Vec<(DVec2, Option<VertexIx>)> {
        let bank = &self.way.banks[side];
        let along = |p: DVec2| closest_on_line(p, bank).0;
        let mut out: Vec<(f64, DVec2, Option<VertexIx>)> = on_line.map(|(p, v)| (along(p), p, Some(v))).collect();
        let bare: Vec<DVec2> = bank.iter().copied().filter(|p| out.iter().all(|o| o.1 != *p)).collect();
        out.extend(bare.into_iter().map(|p| (along(p), p, None)));
        out.sort_by(|a, b| a.0.total_cmp(&b.0));
        out.into_iter().map(|(_, p, v)| (p, v)).collect()
    }
}
