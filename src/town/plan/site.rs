//! The surroundings that main streets have to fit into: the outline with its gates, the river, and the ground.

use super::river::River;
use crate::network::{EdgeIx, PlanarGraph, VertexIx};
use crate::region::{Gate, Outline};
use crate::space::{Origin, segments};
use crate::terrain::Terrain;
use glam::DVec2;

/// Steepest grade of a main street (rise over run).
const MAX_GRADE: f64 = 0.16;
/// Distance between the points at which the ground along a street is sampled, in metres.
const GROUND_STEP: f64 = 25.0;

/// The surroundings of the main streets, which do not change while streets are planned.
pub(super) struct Site<'a> {
    pub outline: &'a [DVec2],
    /// The outline as a graph, whose vertices and edges have the same indices as in the polygon.
    pub ring: PlanarGraph<()>,
    pub gates: &'a [Gate],
    /// The river that runs through the settlement, if one does.
    pub river: Option<River<'a>>,
    origin: Origin,
    terrain: &'a dyn Terrain,
}

impl<'a> Site<'a> {
    pub fn new(outline: &'a Outline, gates: &'a [Gate], terrain: &'a dyn Terrain) -> Self {
        let mut ring = PlanarGraph::new();
        for p in &outline.polygon {
            ring.add_vertex(*p);
        }
        let n = outline.polygon.len() as VertexIx;
        for i in 0..n {
            ring.add_edge(i, (i + 1) % n, ());
        }
        Self {
            outline: &outline.polygon,
            ring,
            gates,
            river: outline.river.as_ref().map(River::new),
            origin: outline.origin,
            terrain,
        }
    }

    /// The outline's vertices after and before a gate.
    pub fn beside_gate(&self, gate: usize) -> [DVec2; 2] {
        let (n, v) = (self.outline.len(), self.gates[gate].vertex);
        [self.outline[(v + 1) % n], self.outline[(v + n - 1) % n]]
    }

    /// Whether an edge of the outline ends at a gate.
    pub fn ends_at_gate(&self, edge: EdgeIx, gate: usize) -> bool {
        let (n, v) = (self.outline.len(), self.gates[gate].vertex);
        edge as usize == v || edge as usize == (v + n - 1) % n
    }

    /// Whether a street from `a` to `b` would run into the river.
    pub fn is_blocked(&self, a: DVec2, b: DVec2) -> bool {
        self.river.as_ref().is_some_and(|river| river.blocks(a, b))
    }

    /// Whether the ground along a line is dry and not too steep.
    pub fn ground_fits(&self, line: &[DVec2]) -> bool {
        let mut before: Option<(DVec2, f64)> = None;
        segments(line).all(|(a, b)| {
            let steps = (a.distance(b) / GROUND_STEP).ceil().max(1.0);
            (0..=steps as usize).all(|i| {
                let p = a.lerp(b, i as f64 / steps);
                let sample = self.terrain.sample(self.origin.to_plan(p));
                let grade = before.map_or(0.0, |(q, height)| {
                    let run = q.distance(p);
                    if run > 0.0 { (sample.height - height).abs() / run } else { 0.0 }
                });
                before = Some((p, sample.height));
                sample.depth() == 0.0 && grade <= MAX_GRADE
            })
        })
    }
}
