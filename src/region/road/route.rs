//! The route of a road: the nodes that it follows on the lattice from gate to gate.

use super::lattice::node_at;
use crate::network::{StreetClass, StreetId};
use crate::region::settlement::SettlementId;
use crate::space::{Bounds, Origin, segments};
use glam::{DVec2, I64Vec2};

/// One end of a route.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RouteEnd {
    pub settlement: SettlementId,
    pub centre: Origin,
    /// Vertex of the outline.
    pub vertex: usize,
    /// Position of the gate, local to the settlement.
    pub gate: DVec2,
}

/// A bridge or a tunnel along a route: a straight line above or below the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    /// Index of the node where the span begins.
    pub first: usize,
    /// Index of the node where the span ends.
    pub last: usize,
    pub tunnel: bool,
}

/// The route of a kept pair.
#[derive(Clone, Debug)]
pub(super) struct Route {
    pub id: StreetId,
    pub class: StreetClass,
    /// The ends at the first and at the last node. The first end has the lower settlement id.
    pub ends: [RouteEnd; 2],
    /// Nodes of the fine lattice, each joined to the next by an edge of the stencil.
    pub nodes: Vec<I64Vec2>,
    /// Bridges and tunnels, in order.
    pub spans: Vec<Span>,
    /// Box in plan metres, gates included.
    pub bounds: Bounds,
}

impl Route {
    /// Approximate size in bytes, heap included.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.nodes.len() * size_of::<I64Vec2>() + self.spans.len() * size_of::<Span>()
    }

    /// Level of the edge after a node: 1 on a bridge, -1 in a tunnel, 0 on the ground.
    pub fn level(&self, edge: usize) -> i8 {
        let span = self.spans.iter().find(|s| (s.first..s.last).contains(&edge));
        span.map_or(0, |s| if s.tunnel { -1 } else { 1 })
    }

    /// Whether the box of any segment overlaps `bounds` (plan metres).
    pub fn passes(&self, bounds: Bounds, step: i64) -> bool {
        self.bounds.overlaps(bounds) && segments(&self.line(step)).any(|(a, b)| Bounds::of([a, b]).overlaps(bounds))
    }

    /// The whole line in plan metres, gates included.
    pub fn line(&self, step: i64) -> Vec<DVec2> {
        let mut out = vec![self.ends[0].centre.to_plan(self.ends[0].gate)];
        out.extend(self.nodes.iter().map(|n| node_at(*n, step)));
        out.push(self.ends[1].centre.to_plan(self.ends[1].gate));
        out
    }
}
