//! Realignment of minor legs: lesser roads meet better ones at blunter angles, and staggered junctions become crossings.
//!
//! A *minor leg* is the last edge of a lesser road before a better road. The vertex where it meets the better road is its
//! *attachment*. An attachment moves along the better road out of sharp angles and kinks, and to the attachment of another leg
//! that meets the road a little farther along on the other side, so that two forks become one crossing. Small rings of roads lose
//! the last of their sides in rank ([`Rings`]).
//!
//! An attachment moves within the stretch of the better road up to the next junction. The leg sweeps a triangle (or two) that
//! nothing enters, so the graph stays planar and connected: the better road joins the old attachment with the new one. From each
//! end of a stretch attachments move at most to its middle, and to the other end only if nothing meets the road there on that
//! side. A stretch does not move itself while attachments move along it. So moves never interfere, and all are made at once, each
//! from the graph as it was before. At every vertex that an edge leaves, two edges stay that are not about to leave.

use super::net::Net;
use super::padding::{ON_LINE, longest_connector, longest_leg, longest_stagger};
use super::ring::Rings;
use super::rules::Rules;
use crate::layer::LayerError;
use crate::region::road::vertex::{Graph, Key, Position, part_of_way};
use crate::space::math::angle_between;
use crate::space::{Bounds, point_in_polygon, segment_distance};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;

/// Least distance in metres between two attachments on one road, and between the old attachment and the new.
const LEAST_MOVE: f64 = 28.0;
/// Least angle in radians at a new attachment.
const LEAST_ANGLE: f64 = 0.62;
/// An angle in radians at a new attachment that is blunt enough.
const BLUNT: f64 = 0.95;
/// Greatest bend in radians where a moved leg begins.
const MOST_BEND: f64 = 1.3;
/// A road that bends more at a junction, in radians, is not a through road there.
const THROUGH: f64 = 0.9;
/// A leg that bends more before its attachment, in radians, has a kink.
const KINK: f64 = 0.95;
/// Greatest sum of squared bends, in radians, that a crossing is worth.
const CROSSING_WORTH: f64 = 1.3;

/// An edge that gets another end.
struct Move {
    edge: usize,
    attachment: usize,
    to: Target,
}

/// A place where an edge may be attached.
#[derive(Clone, Copy)]
struct Target {
    key: Key,
    position: Position,
    on: On,
}

#[derive(Clone, Copy, PartialEq)]
enum On {
    Edge(usize),
    Node(usize),
}

/// A minor leg, and the two edges of the road that it meets.
struct Fork {
    leg: usize,
    road: [usize; 2],
}

/// A stretch of road from one fork to another.
struct Stretch {
    edges: Vec<usize>,
    /// Vertices from end to end.
    nodes: Vec<usize>,
    length: f64,
}

/// The realignment of one tile.
pub(super) struct Realignment<'a> {
    rules: Rules<'a>,
}

impl<'a> Realignment<'a> {
    pub fn new(rules: Rules<'a>) -> Self {
        Self { rules }
    }

    /// The graph of the tile after realignment.
    pub fn rebuild(&self, tile: I64Vec2) -> Result<Graph, LayerError> {
        let near = self.net().own.grown(longest_leg(&self.rules.inputs.settings));
        let mut moves: Vec<Move> = Vec::new();
        for node in self.net().nodes_in(near)? {
            moves.extend(self.moves(node)?);
        }
        self.apply(tile, near, &moves)
    }

    fn net(&self) -> &Net {
        &self.rules.net
    }

    fn rings(&self) -> Rings<'_> {
        Rings::new(self.net(), &self.rules.inputs.settings)
    }

    fn towards(&self, node: usize, edge: usize) -> DVec2 {
        self.net().step(node, self.net().far(edge, node))
    }

    fn is_better(&self, edge: usize, than: usize) -> bool {
        self.net().is_better(edge, self.net().edges[than].rank)
    }

    /// The fork of three edges at a vertex.
    fn fork(&self, node: usize) -> Option<Fork> {
        let n = &self.net().nodes[node];
        let mut ways: [usize; 3] = n.ways.as_slice().try_into().ok()?;
        ways.sort_by_key(|e| self.net().edges[*e].rank);
        let [a, b, leg] = ways;
        let through = angle_between(-self.towards(node, a), self.towards(node, b)) < THROUGH;
        let ground = self.net().edges[leg].level == 0;
        let is_fork =
            ground && through && self.is_better(a, leg) && self.is_better(b, leg) && n.key.ground_parts().is_some();
        is_fork.then_some(Fork { leg, road: [a, b] })
    }

    /// The road from a vertex along an edge, past at most one vertex that is no junction.
    fn stretch(&self, node: usize, edge: usize) -> Stretch {
        let next = self.net().far(edge, node);
        let mut out = Stretch { edges: vec![edge], nodes: vec![node, next], length: self.net().apart(node, next) };
        if let Some(on) = self.next_edge(next, edge) {
            let end = self.net().far(on, next);
            out.edges.push(on);
            out.nodes.push(end);
            out.length += self.net().apart(next, end);
        }
        out
    }

    /// The other edge of a vertex with two edges.
    fn next_edge(&self, node: usize, edge: usize) -> Option<usize> {
        let n = &self.net().nodes[node];
        let on = n.ways.iter().copied().find(|e| *e != edge)?;
        let plain = n.ways.len() == 2 && n.key.ground_parts().is_some();
        (plain && !self.net().edges[on].fixed).then_some(on)
    }

    /// The nearest fork along the road where a leg meets the road on the other side, and the stretch that leads there.
    fn partner(&self, node: usize) -> Option<(usize, Stretch)> {
        let fork = self.fork(node)?;
        let most = longest_stagger(&self.rules.inputs.settings);
        let side = |along: DVec2, leg: DVec2| along.perp_dot(leg) > 0.0;
        let found = fork.road.into_iter().filter_map(|e| {
            if self.net().apart(node, self.net().far(e, node)) > most {
                return None;
            }
            let stretch = self.stretch(node, e);
            let [.., before, end] = stretch.nodes.as_slice() else { return None };
            let (before, end) = (*before, *end);
            let other = if stretch.length <= most && end != node { self.fork(end)? } else { return None };
            let own = side(self.towards(node, e), self.towards(node, fork.leg));
            let theirs = side(self.net().step(before, end), self.towards(end, other.leg));
            (other.road.contains(stretch.edges.last()?) && own != theirs).then_some((end, stretch))
        });
        let key = |f: &(usize, Stretch)| (f.1.length, self.net().nodes[f.0].key);
        found.min_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.cmp(&key(b).1)))
    }

    /// Whether an edge might leave a vertex.
    fn may_leave(&self, edge: usize, node: usize) -> bool {
        let is_leg = |n| self.fork(n).is_some_and(|f| f.leg == edge);
        self.is_bad(edge, node) || self.rings().is_last(edge) || (is_leg(node) && self.partner(node).is_some())
    }

    /// Whether an edge is dropped, because it is the last side of a small ring.
    fn is_dropped(&self, edge: usize) -> bool {
        let rings = self.rings();
        let ends = rings.detour(edge).or_else(|| rings.is_last(edge).then_some(self.net().edges[edge].ends));
        ends.is_some_and(|ends| ends.iter().all(|n| self.staying(*n) >= 2))
    }

    /// Whether an edge meets the road at a sharp angle, or at a fork after a kink.
    fn is_bad(&self, edge: usize, node: usize) -> bool {
        let kinked = || self.fork(node).is_some_and(|f| f.leg == edge) && self.bend(edge, node) > KINK;
        self.rules.is_sharp(edge, node) || kinked()
    }

    /// The bend of an edge before its attachment, in radians.
    fn bend(&self, edge: usize, attachment: usize) -> f64 {
        let far = self.net().far(edge, attachment);
        match self.net().nodes[far].ways.as_slice() {
            [a, b] => angle_between(-self.towards(far, *a), self.towards(far, *b)),
            _ => 0.0,
        }
    }

    /// Number of edges at a vertex that are sure to stay.
    fn staying(&self, node: usize) -> usize {
        self.net().nodes[node].ways.iter().filter(|e| !self.may_leave(**e, node)).count()
    }

    /// Whether the attachment of an edge may be moved.
    fn may_move(&self, edge: usize, attachment: usize) -> bool {
        let (e, far) = (&self.net().edges[edge], self.net().far(edge, attachment));
        let ends = e.ends.map(|n| self.net().nodes[n].key.ground_parts());
        let short = self.net().apart(attachment, far) <= longest_leg(&self.rules.inputs.settings);
        !e.fixed && short && ends.iter().all(Option::is_some) && !self.may_leave(edge, far)
    }

    /// Moves of the attachments at a vertex.
    fn moves(&self, node: usize) -> Result<Vec<Move>, LayerError> {
        let mut out = Vec::new();
        let net = self.net();
        let ways = &net.nodes[node].ways;
        if ways.len() < 3 || net.nodes[node].key.ground_parts().is_none() {
            return Ok(out);
        }
        let partner = self.partner(node);
        for e in ways.iter().copied().filter(|e| self.is_bad(*e, node)) {
            let alone = partner.is_none() || self.rules.is_sharp(e, node);
            let to =
                if alone && self.staying(node) >= 2 && self.may_move(e, node) { self.blunter(e, node)? } else { None };
            out.extend(to.map(|to| Move { edge: e, attachment: node, to }));
        }
        if let (Some(fork), Some((other, stretch))) = (self.fork(node), partner) {
            let mutual = self.partner(other).is_some_and(|(back, _)| back == node);
            let steady = [node, other].iter().all(|n| !net.nodes[*n].ways.iter().any(|e| self.rings().is_last(*e)));
            if mutual && steady && !self.rules.is_sharp(fork.leg, node) {
                let to = self.crossing(node, other, &stretch)?;
                out.extend(to.map(|to| Move { edge: fork.leg, attachment: node, to }));
            }
        }
        Ok(out)
    }

    /// A better attachment along the better road for an edge that meets it at a sharp angle or after a kink.
    fn blunter(&self, edge: usize, attachment: usize) -> Result<Option<Target>, LayerError> {
        let net = self.net();
        let bent = self.bend(edge, attachment);
        let sharp = self.rules.is_sharp(edge, attachment);
        let mut scored: Vec<(f64, Target)> = Vec::new();
        for base in net.nodes[attachment].ways.iter().copied().filter(|b| self.is_better(*b, edge)) {
            let end = net.far(base, attachment);
            if net.edges[base].level != 0 || self.may_leave(base, attachment) || self.may_leave(base, end) {
                continue;
            }
            let plain = self.next_edge(end, base).is_some();
            for eighth in 1..=if plain { 8 } else { 4 } {
                let Some(target) = self.target(base, attachment, eighth) else { continue };
                if let Some(score) = self.swing(edge, attachment, &[attachment], &[base], &target)?
                    && (sharp || score < 0.7 * bent * bent)
                {
                    scored.push((score, target));
                }
            }
        }
        scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.key.cmp(&b.1.key)));
        for (_, target) in scored {
            if self.is_free(edge, attachment, &target)? {
                return Ok(Some(target));
            }
        }
        Ok(None)
    }

    fn is_free(&self, edge: usize, attachment: usize, target: &Target) -> Result<bool, LayerError> {
        let (net, from) = (self.net(), self.net().far(edge, attachment));
        let by = target.position.from(&net.nodes[from].position);
        let to = if let On::Node(n) = target.on { Some(n) } else { None };
        self.rules.lets_through(from, by, to, net.edges[edge].rank)
    }

    /// The point some eighths along an edge from a vertex, if it is not too near an end of the edge.
    fn target(&self, edge: usize, from: usize, eighths: i64) -> Option<Target> {
        let net = self.net();
        let to = net.far(edge, from);
        if eighths == 8 {
            return Some(self.at_node(to));
        }
        let [a, b] = [from, to].map(|n| net.nodes[n].key.ground_parts());
        // On the edge itself, so that it stays straight.
        let p = part_of_way(a?, b?, eighths as f64 / 8.0);
        let key = Key::Ground { x: p.x, y: p.y };
        let position = key.position(self.rules.inputs.step());
        let off = [from, to].map(|n| position.from(&net.nodes[n].position).length());
        off.iter().all(|d| *d >= LEAST_MOVE).then_some(Target { key, position, on: On::Edge(edge) })
    }

    fn at_node(&self, node: usize) -> Target {
        let n = &self.net().nodes[node];
        Target { key: n.key, position: n.position, on: On::Node(node) }
    }

    /// The attachment with which the leg at a fork and the leg of its partner cross the road together: the best of both
    /// attachments and of places between them.
    fn crossing(&self, node: usize, other: usize, stretch: &Stretch) -> Result<Option<Target>, LayerError> {
        let attachments = [node, other];
        let [Some(one), Some(two)] = attachments.map(|n| self.fork(n)) else { return Ok(None) };
        let legs = [one.leg, two.leg];
        if self.rules.is_sharp(legs[1], other) {
            return Ok(None);
        }
        let mut targets = attachments.map(|n| self.at_node(n)).to_vec();
        match (stretch.edges.as_slice(), stretch.nodes.as_slice()) {
            ([edge], _) => {
                // From the same end, whichever of the two asks.
                let first = if self.net().nodes[node].key < self.net().nodes[other].key { node } else { other };
                targets.extend([2, 3, 4, 5, 6].into_iter().filter_map(|k| self.target(*edge, first, k)));
            }
            (_, [_, between, _]) => targets.push(self.at_node(*between)),
            _ => {}
        }
        let mut scored: Vec<(f64, Target)> = Vec::new();
        for target in targets {
            let mut sum = Some(0.0);
            for (i, (leg, attachment)) in legs.into_iter().zip(attachments).enumerate() {
                if target.on == On::Node(attachment) {
                    continue;
                }
                // The corners of what the leg sweeps, without its far end and the new attachment.
                let mut corners = stretch.nodes.clone();
                if i == 1 {
                    corners.reverse();
                }
                let reached = corners.iter().position(|n| target.on == On::Node(*n));
                let count = reached.unwrap_or(1);
                let swung = if self.may_move(leg, attachment) {
                    self.swing(leg, attachment, &corners[..count], &stretch.edges, &target)?
                } else {
                    None
                };
                sum = sum.zip(swung).map(|(a, b)| a + b);
            }
            scored.extend(sum.filter(|s| *s < CROSSING_WORTH).map(|s| (s, target)));
        }
        scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.key.cmp(&b.1.key)));
        for (_, target) in scored {
            let mut free = true;
            for (leg, attachment) in legs.into_iter().zip(attachments) {
                free = free && (target.on == On::Node(attachment) || self.is_free(leg, attachment, &target)?);
            }
            if free {
                return Ok((target.on != On::Node(node)).then_some(target));
            }
        }
        Ok(None)
    }

    /// Penalty for the bend of an edge whose attachment moves to a target, and for the angle there. `None` if the bend or the angle
    /// is not acceptable, or if something lies in what the edge sweeps: the polygon of the corners, the target and its far end.
    fn swing(
        &self,
        edge: usize,
        attachment: usize,
        corners: &[usize],
        base: &[usize],
        target: &Target,
    ) -> Result<Option<f64>, LayerError> {
        let net = self.net();
        let from = net.far(edge, attachment);
        let by = target.position.from(&net.nodes[from].position);
        if by.length() > longest_connector(&self.rules.inputs.settings) || by.length() < LEAST_MOVE {
            return Ok(None);
        }
        let at_target: Vec<DVec2> = match target.on {
            On::Edge(e) => net.edges[e].ends.map(|n| net.step(from, n) - by).to_vec(),
            On::Node(n) => {
                let others = net.nodes[n].ways.iter().filter(|e| **e != edge && net.far(**e, n) != from);
                others.map(|e| self.towards(n, *e)).collect()
            }
        };
        let meet = at_target.iter().map(|u| angle_between(-by, *u)).fold(f64::INFINITY, f64::min);
        let others = net.nodes[from].ways.iter().filter(|e| **e != edge && On::Node(net.far(**e, from)) != target.on);
        let away: Vec<DVec2> = others.map(|e| self.towards(from, *e)).collect();
        let beside = away.iter().map(|u| angle_between(by, *u)).fold(f64::INFINITY, f64::min);
        let bend = if let [only] = away.as_slice() { angle_between(-*only, by) } else { 0.0 };
        if meet < LEAST_ANGLE || beside < LEAST_ANGLE || bend > MOST_BEND {
            return Ok(None);
        }
        let mut swept: Vec<DVec2> = vec![DVec2::ZERO];
        swept.extend(corners.iter().map(|n| net.step(from, *n)));
        swept.push(by);
        let ends = [DVec2::ZERO, by];
        let bounds = Bounds::of(swept.iter().copied()).moved(net.nodes[from].at).grown(ON_LINE);
        for e in net.edges_in(bounds)? {
            let both = net.edges[e].ends;
            let [p, q] = both.map(|n| net.step(from, n));
            let own = e == edge
                || base.contains(&e)
                || both.contains(&from)
                || both.iter().any(|n| target.on == On::Node(*n));
            if !own && segment_distance(ends[0], ends[1], p, q) < ON_LINE {
                return Ok(None);
            }
            let within = |n: &usize| !corners.contains(n) && *n != from && target.on != On::Node(*n);
            if both.iter().filter(|n| within(n)).any(|n| point_in_polygon(net.step(from, *n), &swept)) {
                return Ok(None);
            }
        }
        let lacks = (BLUNT - meet).max(0.0);
        Ok(Some(bend * bend + 3.0 * lacks * lacks))
    }

    /// The graph of the tile after some moves.
    fn apply(&self, tile: I64Vec2, near: Bounds, moves: &[Move]) -> Result<Graph, LayerError> {
        let net = self.net();
        let moved: BTreeMap<usize, &Move> = moves.iter().map(|m| (m.edge, m)).collect();
        let mut out = Graph::default();
        for e in net.edges_in(near)? {
            if self.is_dropped(e) {
                continue;
            }
            let edge = &net.edges[e];
            let [a, b] = edge.ends.map(|n| (net.nodes[n].key, net.nodes[n].position));
            let mut chain = vec![a, b];
            if let Some(m) = moved.get(&e) {
                chain[usize::from(edge.ends[1] == m.attachment)] = (m.to.key, m.to.position);
            }
            let on_edge = moves.iter().filter(|m| m.to.on == On::Edge(e)).map(|m| (m.to.key, m.to.position));
            chain.splice(1..1, on_edge);
            chain.sort_by(|p, q| p.1.from(&a.1).length_squared().total_cmp(&q.1.from(&a.1).length_squared()));
            chain.dedup_by_key(|c| c.0);
            for pair in chain.windows(2) {
                out.join(tile, pair[0], pair[1], edge.rank, edge.level);
            }
        }
        Ok(out)
    }
}
