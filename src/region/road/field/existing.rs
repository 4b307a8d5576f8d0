//! Edges that a search finds closed or already taken by existing roads.

use super::corridor::Corridor;
use crate::region::road::lattice::{DIRECTIONS, STENCIL, heading};
use glam::I64Vec2;

/// A bridge or tunnel of an existing road.
#[derive(Clone, Copy)]
pub(super) struct ExistingSpan {
    pub first: I64Vec2,
    pub heading: usize,
    pub edges: usize,
    pub tunnel: bool,
}

/// The state of the edges at each slot, as one bit per heading.
pub(super) struct Existing {
    /// Edges that no road may take.
    pub closed: Vec<u16>,
    /// Edges of existing roads on the ground.
    pub on_ground: Vec<u16>,
    /// Edges of existing roads on bridges and in tunnels.
    pub on_spans: Vec<u16>,
    /// Bridges and tunnels of existing roads, each from both of its ends.
    pub spans: Vec<ExistingSpan>,
}

impl Existing {
    pub fn new(slots: usize) -> Self {
        Self { closed: vec![0; slots], on_ground: vec![0; slots], on_spans: vec![0; slots], spans: Vec::new() }
    }

    /// Closes edges at a node, given as one bit per heading.
    pub fn close(&mut self, corridor: &Corridor, node: I64Vec2, headings: u16) {
        if let Some(slot) = corridor.slot(node) {
            self.closed[slot] |= headings;
        }
    }

    /// Closes every edge at some nodes, from both ends.
    pub fn close_nodes(&mut self, corridor: &Corridor, nodes: &[I64Vec2]) {
        for node in nodes {
            self.close(corridor, *node, u16::MAX);
            for (heading, s) in STENCIL.iter().enumerate() {
                self.close(corridor, *node + *s, 1 << ((heading + 8) % DIRECTIONS));
            }
        }
    }

    /// Adds the edge of an existing road between two nodes.
    pub fn add_edge(&mut self, corridor: &Corridor, a: I64Vec2, b: I64Vec2, level: i8) {
        let Some(h) = heading(a, b) else { return };
        let held = if level == 0 { &mut self.on_ground } else { &mut self.on_spans };
        for (node, h) in [(a, h), (b, (h + 8) % DIRECTIONS)] {
            if let Some(slot) = corridor.slot(node) {
                held[slot] |= 1 << h;
            }
        }
    }

    /// Adds a bridge or tunnel of an existing road whose edges were added.
    pub fn add_span(&mut self, nodes: &[I64Vec2], tunnel: bool) {
        let [first, second, ..] = *nodes else { return };
        let (Some(h), Some(last)) = (heading(first, second), nodes.last()) else { return };
        let edges = nodes.len() - 1;
        self.spans.push(ExistingSpan { first, heading: h, edges, tunnel });
        self.spans.push(ExistingSpan { first: *last, heading: (h + 8) % DIRECTIONS, edges, tunnel });
    }

    /// Whether any road may not take, or already takes, the edge of a slot along a heading.
    pub fn is_taken(&self, slot: usize, heading: usize) -> bool {
        (self.closed[slot] | self.on_ground[slot] | self.on_spans[slot]) >> heading & 1 == 1
    }
}
