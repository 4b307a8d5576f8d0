//! The ground of one search: edges, spans, and what closes or changes them.

use super::corridor::Corridor;
use super::edges::Edges;
use super::ground::CorridorGround;
use super::spans::{SpanEdge, Spans};
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::road::influence::Influences;
use crate::region::road::lattice::{heading, node_at};
use crate::region::road::samples::Samples;
use crate::region::road::tier_settings::TierSettings;
use crate::region::road::window::Window;
use crate::space::Bounds;
use crate::terrain::Terrain;
use glam::{DVec2, I64Vec2};

/// The ground of one search.
pub(in crate::region::road) struct Field<'a> {
    edges: Edges<'a>,
    spans: Spans,
}

impl<'a> Field<'a> {
    /// Open ground for a class of roads. `samples` returns the samples of a window of the lattice of spacing `step`.
    pub fn new(
        corridor: Corridor,
        t: &'a TierSettings,
        step: i64,
        terrain: &'a dyn Terrain,
        samples: impl FnOnce(&Window) -> Samples<'a>,
    ) -> Self {
        let count = corridor.nodes.len();
        let ground = CorridorGround::new(terrain.scan_ground(), samples(&corridor.window), count, step);
        Self { edges: Edges::new(corridor, ground, t, step), spans: Spans::new(count) }
    }

    pub fn corridor(&self) -> &Corridor {
        &self.edges.corridor
    }

    /// Settings of the class of roads.
    pub fn class(&self) -> &'a TierSettings {
        self.edges.t
    }

    /// Spacing of the nodes in metres.
    pub fn step(&self) -> i64 {
        self.edges.step
    }

    /// Least cost per metre of any edge.
    pub fn least_cost(&self) -> f64 {
        self.edges.least_cost
    }

    /// Adds an extra cost per metre at each slot.
    pub fn add(&mut self, cost: impl Fn(usize, I64Vec2) -> f64) {
        for (slot, node) in self.edges.corridor.nodes.iter().enumerate() {
            self.edges.extra[slot] += cost(slot, *node) as f32;
        }
    }

    /// Adds the user's influences. Their costs may be negative, down to a least cost per metre.
    pub fn add_influences(&mut self, influences: &Influences, tier: SizeClass) {
        let step = self.step();
        let terms = influences.terms(tier, Bounds::of(self.corridor().nodes.iter().map(|n| node_at(*n, step))));
        if !terms.is_empty() {
            self.edges.least_cost = self.edges.least_cost.min(terms.least_cost());
            self.add(|_, node| terms.at(node_at(node, step)));
        }
    }

    /// Closes every edge at the nodes of a disc (plan metres).
    pub fn close_disc(&mut self, centre: DVec2, radius: f64) {
        let step = self.step();
        let part = Window::around(Bounds::square(centre, 2.0 * radius), step);
        for node in part.nodes() {
            if node_at(node, step).distance(centre) <= radius {
                self.edges.existing.close(&self.edges.corridor, node, u16::MAX);
            }
        }
    }

    /// Closes edges: `closed` holds one bit per heading for each node of the window.
    pub fn close_edges(&mut self, window: Window, closed: &[u16]) {
        for (node, bits) in window.nodes().zip(closed).filter(|(_, bits)| **bits != 0) {
            self.edges.existing.close(&self.edges.corridor, node, *bits);
        }
    }

    /// Closes every edge at some nodes. Unlike the other methods, this works even after edges were asked for.
    pub fn close_nodes(&mut self, nodes: &[I64Vec2]) {
        self.edges.existing.close_nodes(&self.edges.corridor, nodes);
        self.edges.forget();
        self.spans.forget();
    }

    /// Closes the edge between two nodes, if there is one.
    pub fn close_edge(&mut self, a: I64Vec2, b: I64Vec2) {
        if let (Some(ahead), Some(back)) = (heading(a, b), heading(b, a)) {
            self.edges.existing.close(&self.edges.corridor, a, 1 << ahead);
            self.edges.existing.close(&self.edges.corridor, b, 1 << back);
        }
    }

    /// Adds the edge of an existing road between two nodes. Using it costs no more than its length.
    pub fn add_existing(&mut self, a: I64Vec2, b: I64Vec2, level: i8) {
        self.edges.existing.add_edge(&self.edges.corridor, a, b, level);
    }

    /// Adds a bridge or tunnel of an existing road whose edges were added.
    pub fn add_existing_span(&mut self, nodes: &[I64Vec2], tunnel: bool) {
        self.edges.existing.add_span(nodes, tunnel);
    }

    /// Whether a node lies in the corridor and is not under water.
    pub fn is_dry(&mut self, node: I64Vec2) -> Result<bool, LayerError> {
        match self.corridor().slot(node) {
            Some(slot) => Ok(self.edges.ground_at(slot)?.depth <= 0.0),
            None => Ok(false),
        }
    }

    /// Whether a node is dry and none of its edges is closed.
    pub fn is_free(&mut self, node: I64Vec2) -> Result<bool, LayerError> {
        let open = self.corridor().slot(node).is_some_and(|s| self.edges.existing.closed[s] == 0);
        Ok(open && self.is_dry(node)?)
    }

    /// The neighbour along a heading, and a lower bound of the cost of the edge to it; infinite where no road may run.
    #[inline]
    pub fn lower_bound(&mut self, slot: usize, heading: usize) -> Result<Option<(usize, f32)>, LayerError> {
        self.edges.lower_bound(slot, heading)
    }

    /// The difference between the whole cost of an edge and its lower bound; infinite where no road may run.
    pub fn surcharge(&mut self, slot: usize, heading: usize) -> Result<f32, LayerError> {
        self.edges.surcharge(slot, heading)
    }

    /// Whether there are bridges or tunnels that begin one edge along a heading.
    #[inline]
    pub fn has_spans(&mut self, slot: usize, heading: usize) -> Result<bool, LayerError> {
        self.spans.any(&mut self.edges, slot, heading)
    }

    /// The bridges and tunnels that begin one edge along a heading.
    pub fn spans(&mut self, slot: usize, heading: usize) -> Result<&[SpanEdge], LayerError> {
        self.spans.of(&mut self.edges, slot, heading)
    }

    /// The same as [`surcharge`](Self::surcharge) for the span with so many edges, including the edges before and after it,
    /// and whether the span is a tunnel.
    pub fn span_surcharge(&mut self, slot: usize, heading: usize, count: usize) -> Result<(f32, bool), LayerError> {
        self.spans.surcharge(&mut self.edges, slot, heading, count)
    }
}
