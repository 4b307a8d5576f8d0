//! Bridges and tunnels that a search tries.

use super::Field;
use crate::layer::LayerError;
use crate::region::road::control::LEAST_SHARE;
use crate::region::road::lattice::{DIRECTIONS, STENCIL};
use glam::I64Vec2;

/// Height in metres that the ground falls below a bridge over dry land somewhere, and rises above a tunnel.
const CLEARANCE: f64 = 8.0;
/// Height in metres of ground that is dug away under a bridge or filled in above a tunnel.
const SCRAPE: f64 = 2.0;
/// Steepest slope of a bridge or tunnel, whatever that of roads is.
const STEEPEST_SPAN: f64 = 0.2;
/// Most bridges and tunnels that are tried from one node in one direction.
const MOST_HOPS: usize = 4;

/// A bridge or tunnel with an edge of the ground before and after, all along one heading.
#[derive(Clone, Copy, Debug)]
pub(in crate::region::road) struct Hop {
    /// Slot where it ends.
    pub last: usize,
    /// Slot after the last edge.
    pub to: usize,
    /// Edges of the bridge or tunnel.
    pub edges: usize,
    /// Cost of the bridge or tunnel alone: a lower bound until the ground along it has been looked at.
    pub cost: f32,
    seen: Seen,
}

/// What the ground along a hop lets it be.
#[derive(Clone, Copy, Debug)]
enum Seen {
    NotYet,
    /// A tunnel or a bridge, and what it costs.
    Span(bool, f32),
    Nothing,
}

/// A bridge or tunnel of an existing road.
pub(super) struct Existing {
    pub first: I64Vec2,
    pub heading: usize,
    pub edges: usize,
    pub tunnel: bool,
}

impl Field<'_> {
    /// What [`Field::hidden`] says, of the one of the [`Field::hops`] with so many edges, with the edges before and after it, and whether it is a
    /// tunnel.
    pub fn hidden_hop(&mut self, slot: usize, heading: usize, edges: usize) -> Result<(f32, bool), LayerError> {
        let none = (f32::INFINITY, false);
        let first = self.strip.next(slot, heading);
        let place = self.hops(slot, heading)?.iter().position(|h| h.edges == edges);
        let (Some(first), Some(place)) = (first, place) else { return Ok(none) };
        let mut hop = self.hops(slot, heading)?[place];
        if let Seen::NotYet = hop.seen {
            let found = self.span(first, hop.last, heading, edges)?;
            hop.seen = found.map_or(Seen::Nothing, |(tunnel, cost)| Seen::Span(tunnel, cost as f32));
            if let Some(held) = self.hops.get_mut(&(slot, heading)) {
                held[place] = hop;
            }
        }
        let Seen::Span(tunnel, cost) = hop.seen else { return Ok(none) };
        Ok((cost - hop.cost + self.hidden(slot, heading)? + self.hidden(hop.last, heading)?, tunnel))
    }

    /// Extra cost of a bridge.
    pub(super) fn bridge(&self, length: f64, depth: f64) -> f64 {
        self.t.bridge + length * self.t.water * (1.0 + depth / self.t.depth_limit.max(1e-3))
    }

    /// Whether the ground does not let the edge on, or is so steep that it is better left. Never where the edge is closed or
    /// there is a road.
    fn is_bad(&mut self, slot: usize, heading: usize) -> Result<bool, LayerError> {
        self.rough(slot, heading)?;
        Ok(self.bad[slot] >> heading & 1 == 1)
    }

    pub(super) fn steepest_span(&self) -> f64 {
        self.t.slope_limit.min(STEEPEST_SPAN)
    }

    /// Whether there are [`Field::hops`].
    #[inline]
    pub fn has_hops(&mut self, slot: usize, heading: usize) -> Result<bool, LayerError> {
        if self.tried[slot] >> heading & 1 == 0 {
            self.tried[slot] |= 1 << heading;
            let found = self.find_hops(slot, heading)?;
            if !found.is_empty() {
                self.hopping[slot] |= 1 << heading;
                self.hops.insert((slot, heading), found);
            }
        }
        Ok(self.hopping[slot] >> heading & 1 == 1)
    }

    /// Bridges and tunnels that begin one edge along a heading.
    pub fn hops(&mut self, slot: usize, heading: usize) -> Result<&[Hop], LayerError> {
        let any = self.has_hops(slot, heading)?;
        Ok(self.hops.get(&(slot, heading)).filter(|_| any).map_or(&[], Vec::as_slice))
    }

    fn find_hops(&mut self, slot: usize, heading: usize) -> Result<Vec<Hop>, LayerError> {
        let mut out = Vec::new();
        let Some((first, cost)) = self.rough(slot, heading)? else { return Ok(out) };
        if cost.is_infinite() || self.ground(first)?.depth > 0.0 {
            return Ok(out);
        }
        let node = self.strip.nodes[first];
        let length = self.lengths[heading];
        for i in 0..self.spans.len() {
            let Existing { first: at, heading: along, edges, tunnel } = self.spans[i];
            let end = self.strip.slot(node + STENCIL[heading] * edges as i64);
            if let (true, Some(last)) = (at == node && along == heading, end)
                && let Some((to, after)) = self.rough(last, heading)?
                && after.is_finite()
            {
                let cost = (length * edges as f64) as f32;
                out.push(Hop { last, to, edges, cost, seen: Seen::Span(tunnel, cost) });
            }
        }
        if !out.is_empty() || !self.is_bad(first, heading)? {
            return Ok(out);
        }
        let most = self.t.bridge_limit.max(self.t.tunnel_limit);
        let back = (heading + 8) % DIRECTIONS;
        let mut last = first;
        for edges in 1.. {
            let Some(next) = self.strip.next(last, heading) else { break };
            let taken =
                |slot: usize, h: usize| (self.closed[slot] | self.existing[slot] | self.spanned[slot]) >> h & 1 == 1;
            if edges as f64 * length > most || taken(last, heading) || taken(next, back) || out.len() >= MOST_HOPS {
                break;
            }
            last = next;
            if edges < 2 || self.ground(last)?.depth > 0.0 || !self.is_bad(last, back)? {
                continue;
            }
            let Some((to, after)) = self.rough(last, heading)? else { break };
            if after.is_finite()
                && let Some(cost) = self.least_span(first, last, edges as f64 * length)?
            {
                out.push(Hop { last, to, edges, cost: cost as f32, seen: Seen::NotYet });
            }
        }
        Ok(out)
    }

    /// What a bridge or tunnel between two dry nodes costs without what it adds to a plain road; `None` if it is too steep.
    fn plain_span(&mut self, a: usize, b: usize, length: f64) -> Result<Option<f64>, LayerError> {
        let grade = f64::from((self.ground(a)?.surface - self.ground(b)?.surface).abs()) / length;
        if grade > self.steepest_span() {
            return Ok(None);
        }
        let steep = grade / self.t.slope_limit;
        let ends = f64::from(self.extra[a] + self.extra[b]) / 2.0;
        Ok(Some(length * (1.0 + ends + self.t.slope * steep * steep).max(LEAST_SHARE)))
    }

    /// Extra cost of a tunnel.
    fn tunnel(&self, length: f64) -> f64 {
        self.t.tunnel + length * self.t.tunnel_metre
    }

    /// Least cost of a bridge or tunnel between two dry nodes, whatever the ground between them; `None` if neither can be.
    fn least_span(&mut self, a: usize, b: usize, length: f64) -> Result<Option<f64>, LayerError> {
        let Some(plain) = self.plain_span(a, b, length)? else { return Ok(None) };
        let bridge = if length <= self.t.bridge_limit { self.bridge(length, 0.0) } else { f64::INFINITY };
        let tunnel = if length <= self.t.tunnel_limit { self.tunnel(length) } else { f64::INFINITY };
        Ok(Some(plain + bridge.min(tunnel)).filter(|c| c.is_finite()))
    }

    /// Whether a straight line between two dry nodes could be a bridge or a tunnel, and what it costs then.
    fn span(&mut self, a: usize, b: usize, heading: usize, edges: usize) -> Result<Option<(bool, f64)>, LayerError> {
        let length = edges as f64 * self.lengths[heading];
        let Some(plain) = self.plain_span(a, b, length)? else { return Ok(None) };
        let ends = [self.ground(a)?, self.ground(b)?].map(|g| f64::from(g.surface));
        let (mut bridge, mut tunnel) = (length <= self.t.bridge_limit, length <= self.t.tunnel_limit);
        let (mut depth, mut below, mut above) = (0f64, 0f64, 0f64);
        // First the nodes, whose samples are at hand; then, if they leave it open, the points between them.
        for halves in (2..2 * edges).step_by(2).chain((1..2 * edges).step_by(2)) {
            let part = halves as f64 / 2.0;
            let node = self.strip.nodes[a] + STENCIL[heading] * (halves / 2) as i64;
            let ground = if halves % 2 == 0 { self.samples.at(node)? } else { self.between(a, heading, part) };
            let deck = ends[0] + (ends[1] - ends[0]) * part / edges as f64;
            let rise = f64::from(ground.surface) - deck;
            depth = depth.max(ground.depth.into());
            (below, above) = (below.max(-rise), above.max(rise));
            bridge &= rise <= SCRAPE && depth <= self.t.depth_limit;
            tunnel &= rise >= -SCRAPE && depth <= 0.0;
            if !bridge && !tunnel {
                return Ok(None);
            }
        }
        if bridge && (depth > 0.0 || below >= CLEARANCE) {
            return Ok(Some((false, plain + self.bridge(length, depth))));
        }
        let dug = tunnel && above >= CLEARANCE;
        Ok(dug.then_some((true, plain + self.tunnel(length))))
    }
}
