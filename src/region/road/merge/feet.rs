//! Feet of lesser roads, moved along the better road that they stand on: out of sharp angles and bends, and to the foot of
//! another that stands a little further on the far side, so that two forks become one crossing. Small rings of roads lose the
//! last of their sides in rank (`ring`).
//!
//! A foot moves within the better road's stretch to the next junction and sweeps a triangle (or two) that nothing enters, so
//! the graph stays planar and joined: the way from the old foot to the new one is part of the better road. From both ends of
//! a stretch feet move to its half at most, but to its end only where nothing stands on that side; a stretch does not move
//! itself while feet move along it. So moves never meet, and all are made at once, each from what was there before. At every
//! vertex that a way leaves, two stay that are not about to.

use super::super::Work;
use super::super::graph::{Graph, Key, Place, TILE_STEPS, join, tile_bounds};
use super::super::{RoadSettings, around};
use super::connect::{ON_IT, parts};
use super::net::Net;
use super::rules::Rules;
use super::{EDGE_STEPS, longest_connector, plain};
use crate::layer::{Cancel, LayerError, Reach};
use crate::space::math::angle_between;
use crate::space::{Bounds, point_in_polygon, segment_distance};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;

/// Longest way whose foot moves, in steps.
const STEM_STEPS: f64 = 2.35;
/// Least distance in metres between two feet on one road, and between the old foot and the new.
const LEAST_MOVE: f64 = 28.0;
/// Least angle in radians at a new foot.
const LEAST_ANGLE: f64 = 0.62;
/// Angle at a new foot that needs no better.
const BLUNT: f64 = 0.95;
/// Greatest bend in radians where a moved way begins.
const MOST_BEND: f64 = 1.3;
/// A stretch of road that bends more at a junction is no through road there.
const THROUGH: f64 = 0.9;
/// A fork's way that bends more before its foot has a kink.
const KINK: f64 = 0.95;
/// Greatest sum of squared bends, in radians, that a crossing is worth.
const CROSSING_WORTH: f64 = 1.3;

/// Greatest distance in metres along a road of two feet that become one crossing.
fn staggered(settings: &RoadSettings) -> f64 {
    0.7 * settings.merge
}

/// Length in metres of the longest way whose foot moves.
pub fn longest_stem(settings: &RoadSettings) -> f64 {
    STEM_STEPS * settings.step as f64
}

/// How far in metres around its tile the graph depends on the one before: a stem into the tile, its foot's partner and
/// either what stands beyond that or the partner's stem and what might cross its new course.
pub fn padding(settings: &RoadSettings) -> f64 {
    let edge = EDGE_STEPS * settings.step as f64;
    let (stem, apart) = (longest_stem(settings).max(edge), staggered(settings));
    2.0 * stem + apart + (longest_connector(settings) / 2.0).max(apart) + ON_IT
}

/// The graph of one tile after feet have moved.
pub(in super::super) fn feet(work: &Work, tile: I64Vec2, cancel: &Cancel) -> Result<Graph, LayerError> {
    cancel.check()?;
    if work.settings.merge <= 0.0 {
        return Ok(Graph { vertices: work.merged(tile, cancel)?.vertices.clone() });
    }
    if let Some(plain) = plain(work, tile, cancel)? {
        return Ok(plain);
    }
    let own = tile_bounds(tile, work.settings.step);
    let reach = Reach::new("roads", own, padding(&work.settings));
    let ring = (padding(&work.settings) / (TILE_STEPS * work.settings.step) as f64).ceil() as i64;
    let graphs = around(tile, ring).map(|t| work.merged(t, cancel)).collect::<Result<Vec<_>, _>>()?;
    let net = Net::new(work, tile, reach, &graphs)?;
    let feet = Feet { rules: Rules::new(work, net) };
    let near = feet.net().own.grown(longest_stem(&work.settings));
    let mut moves: Vec<Move> = Vec::new();
    for node in feet.net().nodes_in(near)? {
        moves.extend(feet.moves(node)?);
    }
    feet.rebuild(tile, near, &moves)
}

/// A way that ends elsewhere than before.
struct Move {
    edge: usize,
    foot: usize,
    to: Spot,
}

/// Where a foot comes to stand.
#[derive(Clone, Copy)]
struct Spot {
    key: Key,
    place: Place,
    on: On,
}

#[derive(Clone, Copy, PartialEq)]
enum On {
    Edge(usize),
    Node(usize),
}

/// A lesser way and the two of the road that it stands on.
struct Fork {
    stem: usize,
    road: [usize; 2],
}

/// A stretch of road from one fork to another.
struct Stretch {
    edges: Vec<usize>,
    /// From end to end.
    nodes: Vec<usize>,
    length: f64,
}

pub(super) struct Feet<'a> {
    pub(super) rules: Rules<'a>,
}

impl Feet<'_> {
    pub(super) fn net(&self) -> &Net {
        &self.rules.net
    }

    fn towards(&self, node: usize, edge: usize) -> DVec2 {
        self.net().step(node, self.net().far(edge, node))
    }

    fn is_better(&self, edge: usize, than: usize) -> bool {
        let [a, b] = [edge, than].map(|e| &self.net().edges[e]);
        !a.fixed && a.rank < b.rank
    }

    /// The fork of three ways at a vertex.
    fn fork(&self, node: usize) -> Option<Fork> {
        let n = &self.net().nodes[node];
        let mut ways: [usize; 3] = n.ways.as_slice().try_into().ok()?;
        ways.sort_by_key(|e| self.net().edges[*e].rank);
        let [a, b, stem] = ways;
        let through = angle_between(-self.towards(node, a), self.towards(node, b)) < THROUGH;
        let ground = self.net().edges[stem].level == 0;
        let is_fork = ground && through && self.is_better(a, stem) && self.is_better(b, stem) && parts(n.key).is_some();
        is_fork.then_some(Fork { stem, road: [a, b] })
    }

    /// The road from a vertex along an edge, over at most one vertex that is no junction.
    fn stretch(&self, node: usize, edge: usize) -> Stretch {
        let next = self.net().far(edge, node);
        let mut out = Stretch { edges: vec![edge], nodes: vec![node, next], length: self.net().apart(node, next) };
        if let Some(on) = self.goes_on(next, edge) {
            let end = self.net().far(on, next);
            out.edges.push(on);
            out.nodes.push(end);
            out.length += self.net().apart(next, end);
        }
        out
    }

    /// The other way of a vertex with two.
    fn goes_on(&self, node: usize, edge: usize) -> Option<usize> {
        let n = &self.net().nodes[node];
        let on = n.ways.iter().copied().find(|e| *e != edge)?;
        let plain = n.ways.len() == 2 && parts(n.key).is_some();
        (plain && !self.net().edges[on].fixed).then_some(on)
    }

    /// The fork nearest along the road on whose far side another way stands, and the stretch that leads there.
    fn partner(&self, node: usize) -> Option<(usize, Stretch)> {
        let fork = self.fork(node)?;
        let most = staggered(&self.rules.work.settings);
        let side = |along: DVec2, stem: DVec2| along.perp_dot(stem) > 0.0;
        let found = fork.road.into_iter().filter_map(|e| {
            if self.net().apart(node, self.net().far(e, node)) > most {
                return None;
            }
            let stretch = self.stretch(node, e);
            let [.., before, end] = stretch.nodes.as_slice() else { return None };
            let (before, end) = (*before, *end);
            let other = if stretch.length <= most && end != node { self.fork(end)? } else { return None };
            let own = side(self.towards(node, e), self.towards(node, fork.stem));
            let theirs = side(self.net().step(before, end), self.towards(end, other.stem));
            (other.road.contains(stretch.edges.last()?) && own != theirs).then_some((end, stretch))
        });
        let key = |f: &(usize, Stretch)| (f.1.length, self.net().nodes[f.0].key);
        found.min_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.cmp(&key(b).1)))
    }

    /// Whether a way might leave a vertex.
    fn wants(&self, edge: usize, node: usize) -> bool {
        let is_stem = |n| self.fork(n).is_some_and(|f| f.stem == edge);
        self.is_bad(edge, node) || self.is_last(edge) || (is_stem(node) && self.partner(node).is_some())
    }

    /// Whether a way stands at a sharp angle, or at a fork after a kink.
    fn is_bad(&self, edge: usize, node: usize) -> bool {
        let kinked = || self.fork(node).is_some_and(|f| f.stem == edge) && self.bend(edge, node) > KINK;
        self.rules.is_sharp(edge, node) || kinked()
    }

    /// How much a way bends before its foot.
    fn bend(&self, edge: usize, foot: usize) -> f64 {
        let far = self.net().far(edge, foot);
        match self.net().nodes[far].ways.as_slice() {
            [a, b] => angle_between(-self.towards(far, *a), self.towards(far, *b)),
            _ => 0.0,
        }
    }

    /// Number of ways that stay at a vertex.
    pub(super) fn stays(&self, node: usize) -> usize {
        self.net().nodes[node].ways.iter().filter(|e| !self.wants(**e, node)).count()
    }

    /// Whether a way is one that may be moved.
    fn may_move(&self, edge: usize, foot: usize) -> bool {
        let (e, far) = (&self.net().edges[edge], self.net().far(edge, foot));
        let ends = e.ends.map(|n| parts(self.net().nodes[n].key));
        let short = self.net().apart(foot, far) <= longest_stem(&self.rules.work.settings);
        !e.fixed && short && ends.iter().all(Option::is_some) && !self.wants(edge, far)
    }

    /// Moves of the feet at a vertex.
    fn moves(&self, node: usize) -> Result<Vec<Move>, LayerError> {
        let mut out = Vec::new();
        let net = self.net();
        let ways = &net.nodes[node].ways;
        if ways.len() < 3 || parts(net.nodes[node].key).is_none() {
            return Ok(out);
        }
        let partner = self.partner(node);
        for e in ways.iter().copied().filter(|e| self.is_bad(*e, node)) {
            let alone = partner.is_none() || self.rules.is_sharp(e, node);
            let to =
                if alone && self.stays(node) >= 2 && self.may_move(e, node) { self.blunter(e, node)? } else { None };
            out.extend(to.map(|to| Move { edge: e, foot: node, to }));
        }
        if let (Some(fork), Some((other, stretch))) = (self.fork(node), partner) {
            let mutual = self.partner(other).is_some_and(|(back, _)| back == node);
            let steady = [node, other].iter().all(|n| !net.nodes[*n].ways.iter().any(|e| self.is_last(*e)));
            if mutual && steady && !self.rules.is_sharp(fork.stem, node) {
                let to = self.crossing(node, other, &stretch)?;
                out.extend(to.map(|to| Move { edge: fork.stem, foot: node, to }));
            }
        }
        Ok(out)
    }

    /// A place along the better road where a way that stands at a sharp angle or after a kink comes to stand better.
    fn blunter(&self, edge: usize, foot: usize) -> Result<Option<Spot>, LayerError> {
        let net = self.net();
        let bent = self.bend(edge, foot);
        let sharp = self.rules.is_sharp(edge, foot);
        let mut scored: Vec<(f64, Spot)> = Vec::new();
        for base in net.nodes[foot].ways.iter().copied().filter(|b| self.is_better(*b, edge)) {
            let end = net.far(base, foot);
            if net.edges[base].level != 0 || self.wants(base, foot) || self.wants(base, end) {
                continue;
            }
            let plain = self.goes_on(end, base).is_some();
            for eighth in 1..=if plain { 8 } else { 4 } {
                let Some(spot) = self.spot(base, foot, eighth) else { continue };
                if let Some(score) = self.swing(edge, foot, &[foot], &[base], &spot)?
                    && (sharp || score < 0.7 * bent * bent)
                {
                    scored.push((score, spot));
                }
            }
        }
        scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.key.cmp(&b.1.key)));
        for (_, spot) in scored {
            if self.is_free(edge, foot, &spot)? {
                return Ok(Some(spot));
            }
        }
        Ok(None)
    }

    fn is_free(&self, edge: usize, foot: usize, spot: &Spot) -> Result<bool, LayerError> {
        let (net, from) = (self.net(), self.net().far(edge, foot));
        let by = spot.place.from(&net.nodes[from].place);
        let to = if let On::Node(n) = spot.on { Some(n) } else { None };
        self.rules.lets_through(from, by, to, net.edges[edge].rank)
    }

    /// The point some eighths along an edge from a vertex, if it is not next to another.
    fn spot(&self, edge: usize, from: usize, eighths: i64) -> Option<Spot> {
        let net = self.net();
        let to = net.far(edge, from);
        if eighths == 8 {
            return Some(self.at_node(to));
        }
        let [a, b] = [from, to].map(|n| parts(net.nodes[n].key));
        let (a, by) = (a?, b? - a?);
        // Whole parts on the edge itself, so that it stays straight.
        let count = gcd(by.x.abs(), by.y.abs()).max(1);
        let p = a + by / count * ((count * eighths + 4) / 8);
        let key = Key::At { x: p.x, y: p.y };
        let place = key.place(self.rules.work.settings.step);
        let off = [from, to].map(|n| place.from(&net.nodes[n].place).length());
        off.iter().all(|d| *d >= LEAST_MOVE).then_some(Spot { key, place, on: On::Edge(edge) })
    }

    fn at_node(&self, node: usize) -> Spot {
        let n = &self.net().nodes[node];
        Spot { key: n.key, place: n.place, on: On::Node(node) }
    }

    /// Where the way at a fork goes so that it and that of its partner cross the road together: the better of either's foot
    /// and places between.
    fn crossing(&self, node: usize, other: usize, stretch: &Stretch) -> Result<Option<Spot>, LayerError> {
        let feet = [node, other];
        let [Some(one), Some(two)] = feet.map(|n| self.fork(n)) else { return Ok(None) };
        let stems = [one.stem, two.stem];
        if self.rules.is_sharp(stems[1], other) {
            return Ok(None);
        }
        let mut spots = feet.map(|n| self.at_node(n)).to_vec();
        match (stretch.edges.as_slice(), stretch.nodes.as_slice()) {
            ([edge], _) => {
                // From the same end, whichever of the two asks.
                let first = if self.net().nodes[node].key < self.net().nodes[other].key { node } else { other };
                spots.extend([2, 3, 4, 5, 6].into_iter().filter_map(|k| self.spot(*edge, first, k)));
            }
            (_, [_, between, _]) => spots.push(self.at_node(*between)),
            _ => {}
        }
        let mut scored: Vec<(f64, Spot)> = Vec::new();
        for spot in spots {
            let mut sum = Some(0.0);
            for (i, (stem, foot)) in stems.into_iter().zip(feet).enumerate() {
                if spot.on == On::Node(foot) {
                    continue;
                }
                // The corners of what the way sweeps, without its own end and the new foot.
                let mut corners = stretch.nodes.clone();
                if i == 1 {
                    corners.reverse();
                }
                let reached = corners.iter().position(|n| spot.on == On::Node(*n));
                let count = reached.unwrap_or(1);
                let swung = if self.may_move(stem, foot) {
                    self.swing(stem, foot, &corners[..count], &stretch.edges, &spot)?
                } else {
                    None
                };
                sum = sum.zip(swung).map(|(a, b)| a + b);
            }
            scored.extend(sum.filter(|s| *s < CROSSING_WORTH).map(|s| (s, spot)));
        }
        scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.key.cmp(&b.1.key)));
        for (_, spot) in scored {
            let mut free = true;
            for (stem, foot) in stems.into_iter().zip(feet) {
                free = free && (spot.on == On::Node(foot) || self.is_free(stem, foot, &spot)?);
            }
            if free {
                return Ok((spot.on != On::Node(node)).then_some(spot));
            }
        }
        Ok(None)
    }

    /// How much a way bends if its foot moves to a spot, and how sharply it stands there; `None` where that is too much, or
    /// something lies in what it sweeps: the corners, the spot and its own far end.
    fn swing(
        &self,
        edge: usize,
        foot: usize,
        corners: &[usize],
        base: &[usize],
        spot: &Spot,
    ) -> Result<Option<f64>, LayerError> {
        let net = self.net();
        let from = net.far(edge, foot);
        let by = spot.place.from(&net.nodes[from].place);
        if by.length() > longest_connector(&self.rules.work.settings) || by.length() < LEAST_MOVE {
            return Ok(None);
        }
        let at_spot: Vec<DVec2> = match spot.on {
            On::Edge(e) => net.edges[e].ends.map(|n| net.step(from, n) - by).to_vec(),
            On::Node(n) => {
                let others = net.nodes[n].ways.iter().filter(|e| **e != edge && net.far(**e, n) != from);
                others.map(|e| self.towards(n, *e)).collect()
            }
        };
        let meet = at_spot.iter().map(|u| angle_between(-by, *u)).fold(f64::INFINITY, f64::min);
        let others = net.nodes[from].ways.iter().filter(|e| **e != edge && On::Node(net.far(**e, from)) != spot.on);
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
        let bounds = Bounds::of(swept.iter().copied()).moved(net.nodes[from].at).grown(ON_IT);
        for e in net.edges_in(bounds)? {
            let both = net.edges[e].ends;
            let [p, q] = both.map(|n| net.step(from, n));
            let own =
                e == edge || base.contains(&e) || both.contains(&from) || both.iter().any(|n| spot.on == On::Node(*n));
            if !own && segment_distance(ends[0], ends[1], p, q) < ON_IT {
                return Ok(None);
            }
            let within = |n: &usize| !corners.contains(n) && *n != from && spot.on != On::Node(*n);
            if both.iter().filter(|n| within(n)).any(|n| point_in_polygon(net.step(from, *n), &swept)) {
                return Ok(None);
            }
        }
        let lacks = (BLUNT - meet).max(0.0);
        Ok(Some(bend * bend + 3.0 * lacks * lacks))
    }

    /// The graph of the tile with feet where they have moved.
    fn rebuild(&self, tile: I64Vec2, near: Bounds, moves: &[Move]) -> Result<Graph, LayerError> {
        let net = self.net();
        let moved: BTreeMap<usize, &Move> = moves.iter().map(|m| (m.edge, m)).collect();
        let mut out = Graph::default();
        for e in net.edges_in(near)? {
            if self.goes(e) {
                continue;
            }
            let edge = &net.edges[e];
            let [a, b] = edge.ends.map(|n| (net.nodes[n].key, net.nodes[n].place));
            let mut chain = vec![a, b];
            if let Some(m) = moved.get(&e) {
                chain[usize::from(edge.ends[1] == m.foot)] = (m.to.key, m.to.place);
            }
            let on_it = moves.iter().filter(|m| m.to.on == On::Edge(e)).map(|m| (m.to.key, m.to.place));
            chain.splice(1..1, on_it);
            chain.sort_by(|p, q| p.1.from(&a.1).length_squared().total_cmp(&q.1.from(&a.1).length_squared()));
            chain.dedup_by_key(|c| c.0);
            for pair in chain.windows(2) {
                join(&mut out, tile, pair[0], pair[1], edge.rank, edge.level);
            }
        }
        Ok(out)
    }
}

fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
