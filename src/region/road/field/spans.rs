//! Bridges and tunnels that a search tries.

use super::edges::Edges;
use super::existing::ExistingSpan;
use crate::layer::LayerError;
use crate::region::road::cost::LEAST_COST;
use crate::region::road::lattice::{DIRECTIONS, STENCIL};
use std::collections::BTreeMap;

/// Height in metres by which the ground falls below a bridge over dry land somewhere, and rises above a tunnel.
const CLEARANCE: f64 = 8.0;
/// Greatest height in metres of ground that is dug away under a bridge or filled in above a tunnel.
const EARTHWORK: f64 = 2.0;
/// Greatest number of bridges and tunnels that are tried from one node along one heading.
const MOST_SPANS: usize = 4;

/// A bridge or tunnel, with an edge on the ground before and after it, all along one heading.
#[derive(Clone, Copy, Debug)]
pub(in crate::region::road) struct SpanEdge {
    /// Slot where the bridge or tunnel ends.
    pub last: usize,
    /// Slot after the edge behind it.
    pub to: usize,
    /// Number of edges of the bridge or tunnel.
    pub edges: usize,
    /// Cost of the bridge or tunnel alone: a lower bound until the ground along it was looked at.
    pub cost: f32,
    checked: Checked,
}

/// What the ground along a span allows.
#[derive(Clone, Copy, Debug)]
enum Checked {
    NotYet,
    /// A tunnel (or else a bridge), and its cost.
    Span(bool, f32),
    Nothing,
}

/// The bridges and tunnels of a corridor, found when they are asked for.
pub(super) struct Spans {
    /// By slot, one bit per heading: whether spans were searched, and whether there are any.
    searched: Vec<u16>,
    found: Vec<u16>,
    spans: BTreeMap<(usize, usize), Vec<SpanEdge>>,
}

impl Spans {
    pub fn new(slots: usize) -> Self {
        Self { searched: vec![0; slots], found: vec![0; slots], spans: BTreeMap::new() }
    }

    /// Forgets the spans that were found, after edges were closed.
    pub fn forget(&mut self) {
        self.searched.fill(0);
        self.found.fill(0);
        self.spans.clear();
    }

    /// Whether there are spans that begin one edge along a heading.
    #[inline]
    pub fn any(&mut self, edges: &mut Edges, slot: usize, heading: usize) -> Result<bool, LayerError> {
        if self.searched[slot] >> heading & 1 == 0 {
            self.searched[slot] |= 1 << heading;
            let found = find(edges, slot, heading)?;
            if !found.is_empty() {
                self.found[slot] |= 1 << heading;
                self.spans.insert((slot, heading), found);
            }
        }
        Ok(self.found[slot] >> heading & 1 == 1)
    }

    /// The spans that begin one edge along a heading.
    pub fn of(&mut self, edges: &mut Edges, slot: usize, heading: usize) -> Result<&[SpanEdge], LayerError> {
        let any = self.any(edges, slot, heading)?;
        Ok(self.spans.get(&(slot, heading)).filter(|_| any).map_or(&[], Vec::as_slice))
    }

    /// The difference between the whole cost and the lower bound of the span with `count` edges, including the edges
    /// before and after it, and whether the span is a tunnel.
    pub fn surcharge(
        &mut self,
        edges: &mut Edges,
        slot: usize,
        heading: usize,
        count: usize,
    ) -> Result<(f32, bool), LayerError> {
        let none = (f32::INFINITY, false);
        let first = edges.corridor.next(slot, heading);
        let index = self.of(edges, slot, heading)?.iter().position(|s| s.edges == count);
        let (Some(first), Some(index)) = (first, index) else { return Ok(none) };
        let mut span = self.of(edges, slot, heading)?[index];
        if let Checked::NotYet = span.checked {
            let found = check(edges, first, span.last, heading, count)?;
            span.checked = found.map_or(Checked::Nothing, |(tunnel, cost)| Checked::Span(tunnel, cost as f32));
            if let Some(held) = self.spans.get_mut(&(slot, heading)) {
                held[index] = span;
            }
        }
        let Checked::Span(tunnel, cost) = span.checked else { return Ok(none) };
        let own = cost - span.cost;
        Ok((own + edges.surcharge(slot, heading)? + edges.surcharge(span.last, heading)?, tunnel))
    }
}

/// Searches the spans that begin one edge along a heading.
fn find(edges: &mut Edges, slot: usize, heading: usize) -> Result<Vec<SpanEdge>, LayerError> {
    let mut out = Vec::new();
    let Some((first, cost)) = edges.lower_bound(slot, heading)? else { return Ok(out) };
    if cost.is_infinite() || edges.ground_at(first)?.depth > 0.0 {
        return Ok(out);
    }
    let node = edges.corridor.nodes[first];
    let length = edges.lengths[heading];
    for i in 0..edges.existing.spans.len() {
        let ExistingSpan { first: at, heading: along, edges: count, tunnel } = edges.existing.spans[i];
        let end = edges.corridor.slot(node + STENCIL[heading] * count as i64);
        if let (true, Some(last)) = (at == node && along == heading, end)
            && let Some((to, after)) = edges.lower_bound(last, heading)?
            && after.is_finite()
        {
            let cost = (length * count as f64) as f32;
            out.push(SpanEdge { last, to, edges: count, cost, checked: Checked::Span(tunnel, cost) });
        }
    }
    if !out.is_empty() || !edges.is_bad(first, heading)? {
        return Ok(out);
    }
    let most = edges.t.bridge_limit.max(edges.t.tunnel_limit);
    let back = (heading + 8) % DIRECTIONS;
    let mut last = first;
    for count in 1.. {
        let Some(next) = edges.corridor.next(last, heading) else { break };
        let taken = edges.existing.is_taken(last, heading) || edges.existing.is_taken(next, back);
        if count as f64 * length > most || taken || out.len() >= MOST_SPANS {
            break;
        }
        last = next;
        if count < 2 || edges.ground_at(last)?.depth > 0.0 || !edges.is_bad(last, back)? {
            continue;
        }
        let Some((to, after)) = edges.lower_bound(last, heading)? else { break };
        if after.is_finite()
            && let Some(cost) = least_cost(edges, first, last, count as f64 * length)?
        {
            out.push(SpanEdge { last, to, edges: count, cost: cost as f32, checked: Checked::NotYet });
        }
    }
    Ok(out)
}

/// Cost of a straight road between two dry nodes, without the extra cost of a bridge or tunnel. `None` if it is too steep.
fn cost_of_road(edges: &mut Edges, a: usize, b: usize, length: f64) -> Result<Option<f64>, LayerError> {
    let grade = f64::from((edges.ground_at(a)?.surface - edges.ground_at(b)?.surface).abs()) / length;
    if grade > edges.steepest_span() {
        return Ok(None);
    }
    let steep = grade / edges.t.slope_limit;
    let ends = f64::from(edges.extra[a] + edges.extra[b]) / 2.0;
    Ok(Some(length * (1.0 + ends + edges.t.slope * steep * steep).max(LEAST_COST)))
}

/// Extra cost of a tunnel over a road of the same length on the ground.
fn extra_of_tunnel(edges: &Edges, length: f64) -> f64 {
    edges.t.tunnel + length * edges.t.tunnel_metre
}

/// Least cost of a bridge or tunnel between two dry nodes, whatever the ground between them. `None` if neither is possible.
fn least_cost(edges: &mut Edges, a: usize, b: usize, length: f64) -> Result<Option<f64>, LayerError> {
    let Some(road) = cost_of_road(edges, a, b, length)? else { return Ok(None) };
    let bridge = if length <= edges.t.bridge_limit { edges.extra_of_bridge(length, 0.0) } else { f64::INFINITY };
    let tunnel = if length <= edges.t.tunnel_limit { extra_of_tunnel(edges, length) } else { f64::INFINITY };
    Ok(Some(road + bridge.min(tunnel)).filter(|c| c.is_finite()))
}

/// Whether a straight line of `count` edges between two dry nodes can be a tunnel or a bridge, and the cost of it.
fn check(
    edges: &mut Edges,
    a: usize,
    b: usize,
    heading: usize,
    count: usize,
) -> Result<Option<(bool, f64)>, LayerError> {
    let length = count as f64 * edges.lengths[heading];
    let Some(road) = cost_of_road(edges, a, b, length)? else { return Ok(None) };
    let ends = [edges.ground_at(a)?, edges.ground_at(b)?].map(|g| f64::from(g.surface));
    let (mut bridge, mut tunnel) = (length <= edges.t.bridge_limit, length <= edges.t.tunnel_limit);
    let (mut depth, mut below, mut above) = (0f64, 0f64, 0f64);
    // First the nodes, whose samples are at hand; then, if both are still possible, the points half-way between them.
    for halves in (2..2 * count).step_by(2).chain((1..2 * count).step_by(2)) {
        let part = halves as f64 / 2.0;
        let node = edges.corridor.nodes[a] + STENCIL[heading] * (halves / 2) as i64;
        let ground = if halves % 2 == 0 { edges.ground.at_node(node)? } else { edges.ground_along(a, heading, part) };
        let deck = ends[0] + (ends[1] - ends[0]) * part / count as f64;
        let rise = f64::from(ground.surface) - deck;
        depth = depth.max(ground.depth.into());
        (below, above) = (below.max(-rise), above.max(rise));
        bridge &= rise <= EARTHWORK && depth <= edges.t.depth_limit;
        tunnel &= rise >= -EARTHWORK && depth <= 0.0;
        if !bridge && !tunnel {
            return Ok(None);
        }
    }
    if bridge && (depth > 0.0 || below >= CLEARANCE) {
        return Ok(Some((false, road + edges.extra_of_bridge(length, depth))));
    }
    let dug = tunnel && above >= CLEARANCE;
    Ok(dug.then(|| (true, road + extra_of_tunnel(edges, length))))
}
