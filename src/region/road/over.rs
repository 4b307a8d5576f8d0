//! Crossings of highways on two levels. Makes the graph in which lesser roads pass over a highway on a bridge instead of
//! meeting it, tile by tile; reads the graph after merging about 1 km around, and where roads are only bridged the graph before it and the courses.
//!
//! A crossing has two ways of the highway and two of another road, each going on nearly straight. The other road gets a vertex
//! of its own there ([`Key::Over`]), so that its line runs on, and `piece` makes a bridge of the stretch around it. With
//! [`Crossing::Interchange`] a ramp joins both roads in one of the four quarters, as in a quadrant interchange: whatever was
//! joined stays so. With [`Crossing::Bridge`] there is no ramp; that is done only where no course turns from one road to the
//! other and nothing has been merged near, as what merging leaves out may be joined by way of the crossing. Where neither is
//! possible, a junction stays.
//!
//! Crossings that are near each other stay junctions, the triangle between ramp and roads holds nothing else, and the decision
//! is a function of the graph around, so there is no order.

use super::course::courses;
use super::graph::{Graph, Key, TILE_STEPS, Vertex, join, tile_bounds};
use super::merge::{Net, Rules, longest_connector, longest_stem, parts};
use super::{Crossing, RoadSettings, Work, around};
use crate::layer::{Cancel, LayerError, Reach};
use crate::network::SizeClass;
use crate::network::StreetClass;
use crate::space::math::angle_between;
use crate::space::{Bounds, orient, point_in_polygon, segment_distance};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Height of a carriageway above that of the highway it passes over, in metres.
pub(crate) const CLEARANCE: f64 = 6.4;
/// Length of the bridge to either side of the crossing, in metres.
pub(super) const HALF_LENGTH: f64 = 130.0;
/// Length beyond the end of the bridge, in metres, within which the road has no junction.
const RUN_OUT: f64 = 45.0;
/// Greatest bend of a road at the crossing, in radians.
const MOST_BEND: f64 = 0.6;
/// Least angle between the two roads there.
const LEAST_ANGLE: f64 = 0.7;
/// Distance in metres that the bridge keeps from other roads, and the crossing from the highway's next vertex.
const CLEAR: f64 = 40.0;
/// Distance from a crossing, in metres, within which there is no other.
const ALONE: f64 = 480.0;
/// Distance from a crossing, in metres, within which nothing may have been merged if there is no ramp: what has gone lay within
/// the merge distance of the better ways that join its ends, and is a few hundred metres long.
const UNMERGED: f64 = 480.0;
/// Least distance along the highway from the crossing to a ramp, and that from which on no further vertex is tried.
const RAMP_AT: (f64, f64) = (90.0, 200.0);
/// Least angle in radians between a ramp and a road.
const RAMP_ANGLE: f64 = 0.5;

/// Share of the height by which an overpass rises above the straight line between its ends, at `t` from -1 at one end over
/// 0 at the crossing to 1 at the other.
pub(crate) fn rise(t: f64) -> f64 {
    let s = 1.0 - (t * t).min(1.0);
    s * s
}

/// Greatest slope of [`rise`].
const STEEPEST: f64 = 1.54;

/// A crossing on two levels.
struct Separated {
    node: usize,
    /// Edges of the road that passes over.
    over: [usize; 2],
    /// Ends of the ramp, if there is one.
    ramp: Option<[usize; 2]>,
}

/// A vertex along a road.
struct Stop {
    node: usize,
    /// Metres from where one set out.
    along: f64,
    /// Whether the road goes on alone there.
    plain: bool,
}

/// Length in metres of the longest way in the graph, and of the longest ramp.
pub(super) fn longest(settings: &RoadSettings) -> f64 {
    longest_connector(settings).max(longest_stem(settings))
}

/// How far in metres around its tile the graph depends on that after merging: a way into the tile, and what lies around the
/// crossing where it begins.
pub(super) fn padding(settings: &RoadSettings) -> f64 {
    let along = (HALF_LENGTH + RUN_OUT).max(RAMP_AT.1) + longest(settings) + CLEAR;
    longest(settings) + along.max(ALONE).max(UNMERGED)
}

/// The graph of one tile with highways passed over.
pub(super) fn separated(work: &Work, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<Graph>, LayerError> {
    let own = work.feet(tile, cancel)?;
    let rules = |class| work.settings.class(class).over_highways != Crossing::Junction;
    let lets = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor].into_iter().any(rules);
    if own.vertices.is_empty() || !lets {
        return Ok(own);
    }
    // Most tiles have no highway near, or nothing that crosses it, and there the graph after merging is not needed: a way to the
    // crossing, one whose foot has moved there, and half of one to a vertex that its road had before.
    let is_highway = |v: &Vertex| v.ways.iter().any(|w| w.rank.class == StreetClass::Highway);
    let ring = (padding(&work.settings) / (TILE_STEPS * work.settings.step) as f64).ceil() as i64;
    let (mut highway, mut others, mut rank) = (false, false, None);
    for v in work.near(tile, 2.5 * longest(&work.settings), cancel)? {
        highway |= is_highway(&v);
        others |= v.ways.iter().any(|w| *rank.get_or_insert(w.rank) != w.rank);
    }
    if !highway || !others {
        return Ok(own);
    }
    let graphs = around(tile, ring).map(|t| work.feet(t, cancel)).collect::<Result<Vec<_>, _>>()?;
    if !graphs.iter().any(|g| g.vertices.values().any(|v| v.ways.len() == 4 && is_highway(v))) {
        return Ok(own);
    }
    let bounds = tile_bounds(tile, work.settings.step);
    let reach = Reach::new("roads", bounds, padding(&work.settings));
    let net = Net::new(work, tile, reach, &graphs)?;
    let vertices = graphs.iter().flat_map(|g| &g.vertices).map(|(k, v)| (*k, v)).collect();
    let over = Over { work, rules: Rules::new(work, net), vertices, cancel };
    let near = over.net().own.grown(longest(&work.settings));
    let mut found = Vec::new();
    for node in over.net().nodes_in(near)? {
        found.extend(over.separated(node)?);
    }
    if found.is_empty() { Ok(own) } else { Ok(Arc::new(over.rebuild(tile, &found)?)) }
}

struct Over<'a> {
    work: &'a Work,
    rules: Rules<'a>,
    /// The graph that the net was made from.
    vertices: BTreeMap<Key, &'a Vertex>,
    cancel: &'a Cancel,
}

impl Over<'_> {
    fn net(&self) -> &Net {
        &self.rules.net
    }

    fn towards(&self, node: usize, edge: usize) -> DVec2 {
        self.net().step(node, self.net().far(edge, node))
    }

    fn class(&self, edge: usize) -> StreetClass {
        self.net().edges[edge].rank.class
    }

    /// The ways of the highway and of the road that crosses it at a vertex, as far as the shape of the crossing goes.
    fn crossing(&self, node: usize) -> Option<([usize; 2], [usize; 2])> {
        let n = &self.net().nodes[node];
        let mut ways: [usize; 4] = n.ways.as_slice().try_into().ok()?;
        let plain = |e: &usize| !self.net().edges[*e].fixed;
        if parts(n.key).is_none() || !ways.iter().all(plain) {
            return None;
        }
        let key = |e: usize| (self.net().edges[e].rank, self.net().nodes[self.net().far(e, node)].key);
        ways.sort_by_key(|e| key(*e));
        let [a, rest @ ..] = ways;
        let bend = |e: usize, f: usize| angle_between(-self.towards(node, e), self.towards(node, f));
        let b = rest.into_iter().min_by(|x, y| bend(a, *x).total_cmp(&bend(a, *y)))?;
        let mut others = rest.into_iter().filter(|e| *e != b);
        let [c, d] = [others.next()?, others.next()?];
        let straight = bend(a, b) < MOST_BEND && bend(c, d) < MOST_BEND;
        let classes = self.class(a) == StreetClass::Highway
            && self.class(b) == StreetClass::Highway
            && self.class(c) == self.class(d);
        let least = [(a, c), (a, d), (b, c), (b, d)]
            .map(|(e, f)| angle_between(self.towards(node, e), self.towards(node, f)))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        (straight && classes && least > LEAST_ANGLE).then_some(([a, b], [c, d]))
    }

    /// The road from a vertex over an edge, vertex by vertex, to the first at `length` or further, or to a junction.
    fn run(&self, node: usize, edge: usize, length: f64) -> Vec<Stop> {
        let (mut at, mut via, mut along) = (node, edge, 0.0);
        let mut out: Vec<Stop> = Vec::new();
        while along < length {
            let next = self.net().far(via, at);
            along += self.net().apart(at, next);
            let n = &self.net().nodes[next];
            let goes_on = |e: &usize| !self.net().edges[*e].fixed && self.class(*e) == self.class(edge);
            let on = n.ways.iter().copied().find(|e| *e != via).filter(goes_on);
            let plain = n.ways.len() == 2 && parts(n.key).is_some() && next != node;
            let on = on.filter(|_| plain);
            out.push(Stop { node: next, along, plain: on.is_some() });
            match on {
                Some(on) => (at, via) = (next, on),
                None => break,
            }
        }
        out
    }

    /// Whether and how a vertex becomes a crossing on two levels.
    fn separated(&self, node: usize) -> Result<Option<Separated>, LayerError> {
        let Some((highway, over)) = self.crossing(node) else { return Ok(None) };
        let rule = self.work.settings.class(self.class(over[0])).over_highways;
        if rule == Crossing::Junction || !self.has_room(node, highway, over)? {
            return Ok(None);
        }
        if rule == Crossing::Bridge {
            let free = self.is_unmerged(node)? && !self.is_turned_at(node, over)?;
            return Ok(free.then_some(Separated { node, over, ramp: None }));
        }
        let ramp = self.ramp(node, highway, over)?;
        Ok(ramp.map(|ends| Separated { node, over, ramp: Some(ends) }))
    }

    /// Whether a bridge fits: on the ground, and between what is near.
    fn has_room(&self, node: usize, highway: [usize; 2], over: [usize; 2]) -> Result<bool, LayerError> {
        let net = self.net();
        let at = net.nodes[node].at;
        let crossings = net.nodes_in(Bounds::square(at, 2.0 * ALONE))?;
        if crossings.into_iter().any(|n| n != node && net.apart(node, n) < ALONE && self.crossing(n).is_some()) {
            return Ok(false);
        }
        if highway.iter().any(|e| net.apart(node, net.far(*e, node)) < CLEAR) {
            return Ok(false);
        }
        let mut ends = [0.0; 2];
        for (edge, end) in over.into_iter().zip(&mut ends) {
            let run = self.run(node, edge, HALF_LENGTH + RUN_OUT);
            if run.last().is_none_or(|s| s.along < HALF_LENGTH + RUN_OUT) {
                return Ok(false);
            }
            let line: Vec<usize> = std::iter::once(node).chain(run.iter().map(|s| s.node)).collect();
            let mut left = HALF_LENGTH;
            for pair in line.windows(2) {
                let by = net.step(pair[0], pair[1]);
                let part = (left / by.length()).min(1.0);
                if !self.is_clear(node, pair, by * part, &highway)? {
                    return Ok(false);
                }
                left -= by.length();
                if left <= 0.0 {
                    let place = net.nodes[pair[0]].place.moved(by * part);
                    *end = self.work.terrain.height(place.origin.to_plan(place.offset));
                    break;
                }
            }
        }
        let most = self.work.settings.class(self.class(over[0])).slope_limit;
        Ok((ends[0] - ends[1]).abs() / (2.0 * HALF_LENGTH) + STEEPEST * CLEARANCE / HALF_LENGTH <= 1.1 * most)
    }

    /// Whether nothing but the highway is near a stretch of the bridge.
    fn is_clear(&self, node: usize, pair: &[usize], by: DVec2, highway: &[usize]) -> Result<bool, LayerError> {
        let net = self.net();
        let from = net.nodes[pair[0]].at;
        for e in net.edges_in(Bounds::of([from, from + by]).grown(CLEAR))? {
            let ends = net.edges[e].ends;
            if highway.contains(&e) || ends.iter().any(|n| pair.contains(n) || *n == node) {
                continue;
            }
            let [p, q] = ends.map(|n| net.step(pair[0], n));
            if segment_distance(DVec2::ZERO, by, p, q) < CLEAR {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether merging has changed nothing near a vertex.
    fn is_unmerged(&self, node: usize) -> Result<bool, LayerError> {
        let Key::At { .. } = self.net().nodes[node].key else { return Ok(false) };
        let place = self.net().nodes[node].place;
        let ring = (UNMERGED / (TILE_STEPS * self.work.settings.step) as f64).ceil() as i64;
        let near = |v: &Vertex| v.place.from(&place).length() < UNMERGED;
        let same = |v: &Vertex, w: &Vertex| v.ways.iter().map(|w| w.to).eq(w.ways.iter().map(|w| w.to));
        let mut count = 0;
        for tile in around(self.net().nodes[node].key.tile(), ring) {
            let graph = self.work.graph(tile, self.cancel)?;
            for (key, v) in graph.vertices.iter().filter(|(_, v)| near(v)) {
                count += 1;
                if !self.vertices.get(key).is_some_and(|w| same(v, w)) {
                    return Ok(false);
                }
            }
        }
        Ok(count == self.vertices.values().filter(|v| near(v)).count())
    }

    /// Whether a course turns from one road to the other at a vertex. Between nodes of the lattice none does.
    fn is_turned_at(&self, node: usize, over: [usize; 2]) -> Result<bool, LayerError> {
        let n = &self.net().nodes[node];
        let Some(cell) = n.key.lattice_node() else { return Ok(false) };
        let directions = over.map(|e| self.towards(node, e).normalize_or_zero());
        let is_over = |other: I64Vec2| {
            let d = (other - cell).as_dvec2().normalize_or_zero();
            directions.iter().any(|o| o.dot(d) > 0.9999)
        };
        let around = Bounds::square(n.place.origin.to_plan(n.place.offset), 2.0);
        for tier in SizeClass::ALL {
            for course in courses(self.work, tier, around, self.cancel)? {
                let turns = |w: &[I64Vec2]| w[1] == cell && is_over(w[0]) != is_over(w[2]);
                if course.nodes.windows(3).any(turns) {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Ends of the best ramp, on the highway and on the other road.
    fn ramp(&self, node: usize, highway: [usize; 2], over: [usize; 2]) -> Result<Option<[usize; 2]>, LayerError> {
        let net = self.net();
        let longest = longest(&self.work.settings);
        let mut scored: Vec<(f64, [usize; 2])> = Vec::new();
        for h in highway {
            let on_highway = self.run(node, h, RAMP_AT.1);
            for o in over {
                let on_over = self.run(node, o, HALF_LENGTH + RUN_OUT);
                for (i, p) in on_highway.iter().enumerate().filter(|(_, p)| p.plain && p.along >= RAMP_AT.0) {
                    for (k, q) in on_over.iter().enumerate() {
                        let by = net.step(p.node, q.node);
                        if !q.plain || q.along < HALF_LENGTH + RUN_OUT || by.length() > longest {
                            continue;
                        }
                        let meets = |n: usize, by: DVec2| {
                            let angles = net.nodes[n].ways.iter().map(|e| angle_between(by, self.towards(n, *e)));
                            angles.fold(f64::INFINITY, f64::min)
                        };
                        let least = meets(p.node, by).min(meets(q.node, -by));
                        if least < RAMP_ANGLE || !self.is_empty(node, &on_highway[..=i], &on_over[..=k])? {
                            continue;
                        }
                        scored.push((by.length() - 200.0 * least.min(0.8), [p.node, q.node]));
                    }
                }
            }
        }
        let key = |n: &[usize; 2]| n.map(|n| net.nodes[n].key);
        scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(key(&a.1).cmp(&key(&b.1))));
        for (_, ends) in scored {
            let rank = net.edges[over[0]].rank.max(net.edges[over[1]].rank);
            if self.rules.lets_through(ends[0], net.step(ends[0], ends[1]), Some(ends[1]), rank)? {
                return Ok(Some(ends));
            }
        }
        Ok(None)
    }

    /// Whether nothing is between two roads from a vertex and the ramp that joins their ends.
    fn is_empty(&self, node: usize, p: &[Stop], q: &[Stop]) -> Result<bool, LayerError> {
        let net = self.net();
        let mut corners = vec![node];
        corners.extend(p.iter().map(|s| s.node));
        corners.extend(q.iter().rev().map(|s| s.node));
        let polygon: Vec<DVec2> = corners.iter().map(|n| net.step(node, *n)).collect();
        let [from, to] = [polygon[p.len()], polygon[p.len() + 1]];
        let bounds = Bounds::of(polygon.iter().copied()).moved(net.nodes[node].at).grown(CLEAR);
        for e in net.edges_in(bounds)? {
            let ends = net.edges[e].ends;
            let at = ends.map(|n| net.step(node, n));
            let inside = |i: usize| !corners.contains(&ends[i]) && point_in_polygon(at[i], &polygon);
            if inside(0) || inside(1) {
                return Ok(false);
            }
            let touches = ends.iter().filter(|n| corners.contains(n)).count();
            let of_ramp = ends.iter().any(|n| *n == corners[p.len()] || *n == corners[p.len() + 1]);
            if !of_ramp && touches < 2 && segment_distance(from, to, at[0], at[1]) < CLEAR {
                return Ok(false);
            }
            // A road that folds back would cut the ramp.
            let cuts = orient(from, to, at[0]) * orient(from, to, at[1]) < 0.0
                && orient(at[0], at[1], from) * orient(at[0], at[1], to) < 0.0;
            if cuts {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The graph of the tile with the crossings on two levels.
    fn rebuild(&self, tile: I64Vec2, found: &[Separated]) -> Result<Graph, LayerError> {
        let net = self.net();
        let mut out = Graph::default();
        let ends = |n: usize| (net.nodes[n].key, net.nodes[n].place);
        for e in net.edges_in(net.own)? {
            let edge = &net.edges[e];
            let [a, b] = edge.ends.map(|n| {
                let over = found.iter().any(|s| s.node == n && s.over.contains(&e));
                let (key, place) = ends(n);
                (if over { key.over() } else { key }, place)
            });
            join(&mut out, tile, a, b, edge.rank, edge.level);
        }
        for s in found {
            if let Some([p, q]) = s.ramp {
                let rank = net.edges[s.over[0]].rank.max(net.edges[s.over[1]].rank);
                join(&mut out, tile, ends(p), ends(q), rank, 0);
            }
        }
        Ok(out)
    }
}
