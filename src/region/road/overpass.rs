//! Grade-separated crossings: lesser roads pass over a highway on a bridge instead of meeting it. Makes the graph that is built,
//! tile by tile. Reads the merged graph and the terrain within [`padding`]; where roads are only bridged, also the graph before
//! merging and the routes.
//!
//! A crossing has two edges of the highway and two of another road, each road going nearly straight on. The other road gets a
//! vertex of its own there ([`Key::Overpass`]), so that its line runs on, and `sections` makes a bridge of the stretch around
//! it. With [`Crossing::Interchange`], a ramp joins both roads in one of the four quarters, as in a quadrant interchange:
//! everything that was connected stays connected. With [`Crossing::Bridge`] there is no ramp. This is done only where no route
//! turns from one road to the other and nothing was merged nearby, because what merging dropped may be connected by way of the
//! crossing. Where neither is possible, the junction stays.
//!
//! Crossings near each other stay junctions, and the triangle between a ramp and the roads contains nothing else. The decision
//! is a function of the graph nearby, so there is no order of decisions.

use super::budget::Budget;
use super::crossing::Crossing;
use super::graph::Graphs;
use super::inputs::Inputs;
use super::merge::{MergedGraphs, Net, Rules, longest_connector, longest_leg};
use super::routes::Routes;
use super::settings::RoadSettings;
use super::tile::{rings, tile_bounds, tiles_around};
use super::vertex::{Graph, Key, Vertex};
use crate::layer::{Cancel, LayerCache, LayerError, Reach};
use crate::network::{SizeClass, StreetClass};
use crate::space::math::angle_between;
use crate::space::{Bounds, orient, point_in_polygon, segment_distance};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Height in metres of a carriageway above the carriageway of the highway below.
pub(crate) const OVERPASS_CLEARANCE: f64 = 6.4;
/// Length in metres of the bridge on either side of the crossing.
pub(super) const HALF_LENGTH: f64 = 130.0;
/// Length in metres beyond the end of the bridge on which the road has no junction.
const RUN_OUT: f64 = 45.0;
/// Greatest bend of a road at the crossing, in radians.
const MOST_BEND: f64 = 0.6;
/// Least angle between the two roads, in radians.
const LEAST_ANGLE: f64 = 0.7;
/// Distance in metres of the bridge from other roads, and of the crossing from the highway's next vertex.
const CLEAR: f64 = 40.0;
/// Distance in metres from a crossing within which there is no other crossing.
const ALONE: f64 = 480.0;
/// Distance in metres from a crossing without a ramp, within which nothing may have been merged: roads that were dropped lay within
/// the merge distance of the better roads that join their ends, and are a few hundred metres long.
const UNMERGED: f64 = 480.0;
/// Least distance in metres along the highway from the crossing to a ramp, and the distance up to which vertices are tried.
const RAMP_AT: (f64, f64) = (90.0, 200.0);
/// Least angle in radians between a ramp and a road.
const RAMP_ANGLE: f64 = 0.5;

/// Shape of an overpass: its height above the straight line between its ends, as a share of the height at the crossing. `t` runs
/// from -1 at one end over 0 at the crossing to 1 at the other end.
pub(crate) fn overpass_profile(t: f64) -> f64 {
    let s = 1.0 - (t * t).min(1.0);
    s * s
}

/// Greatest slope of [`overpass_profile`].
const STEEPEST: f64 = 1.54;

/// A grade-separated crossing.
struct Separation {
    node: usize,
    /// Edges of the road that passes over.
    upper: [usize; 2],
    /// Ends of the ramp, if there is one.
    ramp: Option<[usize; 2]>,
}

/// A vertex along a road.
struct RunVertex {
    node: usize,
    /// Distance in metres along the road.
    along: f64,
    /// Whether the road continues there and no other road joins it.
    plain: bool,
}

/// Length in metres of the longest way in the graph, and of the longest ramp.
pub(super) fn longest_way(settings: &RoadSettings) -> f64 {
    longest_connector(settings).max(longest_leg(settings))
}

/// Padding of the graph in metres: a way into the tile, and what lies around the crossing where it begins.
pub(super) fn padding(settings: &RoadSettings) -> f64 {
    let along = (HALF_LENGTH + RUN_OUT).max(RAMP_AT.1) + longest_way(settings) + CLEAR;
    longest_way(settings) + along.max(ALONE).max(UNMERGED)
}

/// The graphs of all tiles as they are built, remembered.
pub(super) struct BuiltGraphs {
    inputs: Arc<Inputs>,
    routes: Arc<Routes>,
    graphs: Arc<Graphs>,
    merged: Arc<MergedGraphs>,
    built: LayerCache<[i64; 2], Graph>,
}

impl BuiltGraphs {
    pub fn new(
        inputs: Arc<Inputs>,
        routes: Arc<Routes>,
        graphs: Arc<Graphs>,
        merged: Arc<MergedGraphs>,
        budget: Budget,
    ) -> Self {
        Self { inputs, routes, graphs, merged, built: budget.cache(1) }
    }

    /// The graph of a tile as it is built: with grade-separated crossings of highways.
    pub fn graph(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<Graph>, LayerError> {
        self.built.get_shared(&tile.to_array(), || self.make(tile, cancel))
    }

    fn make(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<Graph>, LayerError> {
        let own = self.merged.realigned(tile, cancel)?;
        let (settings, step) = (&self.inputs.settings, self.inputs.step());
        let separates = |class| settings.class(class).highway_crossings != Crossing::Junction;
        let any = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor].into_iter().any(separates);
        if own.vertices.is_empty() || !any {
            return Ok(own);
        }
        // Most tiles have no highway nearby, or nothing that crosses it, and need no merged graph. The distance covers a way to
        // the crossing, a leg whose attachment moved there, and half a way to a vertex that its road had before.
        let is_highway = |v: &Vertex| v.ways.iter().any(|w| w.rank.class == StreetClass::Highway);
        let (mut highway, mut others, mut rank) = (false, false, None);
        for v in self.graphs.vertices_near(tile, 2.5 * longest_way(settings), cancel)? {
            highway |= is_highway(&v);
            others |= v.ways.iter().any(|w| *rank.get_or_insert(w.rank) != w.rank);
        }
        if !highway || !others {
            return Ok(own);
        }
        let around = tiles_around(tile, rings(padding(settings), step)).map(|t| self.merged.realigned(t, cancel));
        let graphs = around.collect::<Result<Vec<_>, _>>()?;
        if !graphs.iter().any(|g| g.vertices.values().any(|v| v.ways.len() == 4 && is_highway(v))) {
            return Ok(own);
        }
        let bounds = tile_bounds(tile, step);
        let net = Net::new(settings, tile, Reach::new("roads", bounds, padding(settings)), &graphs);
        let separations = Separations {
            inputs: &self.inputs,
            routes: &self.routes,
            graphs: &self.graphs,
            rules: Rules::new(&self.inputs, net, bounds, padding(settings)),
            vertices: graphs.iter().flat_map(|g| &g.vertices).map(|(k, v)| (*k, v)).collect(),
            cancel,
        };
        let near = separations.net().own.grown(longest_way(settings));
        let mut found = Vec::new();
        for node in separations.net().nodes_in(near)? {
            found.extend(separations.at(node)?);
        }
        if found.is_empty() { Ok(own) } else { Ok(Arc::new(separations.rebuild(tile, &found)?)) }
    }
}

/// The search for separations around a tile.
struct Separations<'a> {
    inputs: &'a Inputs,
    routes: &'a Routes,
    graphs: &'a Graphs,
    rules: Rules<'a>,
    /// The merged graph that the net was made from.
    vertices: BTreeMap<Key, &'a Vertex>,
    cancel: &'a Cancel,
}

impl Separations<'_> {
    fn net(&self) -> &Net {
        &self.rules.net
    }

    fn towards(&self, node: usize, edge: usize) -> DVec2 {
        self.net().step(node, self.net().far(edge, node))
    }

    fn class(&self, edge: usize) -> StreetClass {
        self.net().edges[edge].rank.class
    }

    /// The edges of the highway and of the road that crosses it at a vertex, if the shape of the crossing allows a separation.
    fn crossing(&self, node: usize) -> Option<([usize; 2], [usize; 2])> {
        let n = &self.net().nodes[node];
        let mut ways: [usize; 4] = n.ways.as_slice().try_into().ok()?;
        let plain = |e: &usize| !self.net().edges[*e].fixed;
        if n.key.ground_parts().is_none() || !ways.iter().all(plain) {
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

    /// The vertices of a road from a vertex along an edge, up to the first one at a distance of at least `length`, or to a
    /// junction.
    fn run(&self, node: usize, edge: usize, length: f64) -> Vec<RunVertex> {
        let (mut at, mut via, mut along) = (node, edge, 0.0);
        let mut out: Vec<RunVertex> = Vec::new();
        while along < length {
            let next = self.net().far(via, at);
            along += self.net().apart(at, next);
            let n = &self.net().nodes[next];
            let goes_on = |e: &usize| !self.net().edges[*e].fixed && self.class(*e) == self.class(edge);
            let on = n.ways.iter().copied().find(|e| *e != via).filter(goes_on);
            let plain = n.ways.len() == 2 && n.key.ground_parts().is_some() && next != node;
            let on = on.filter(|_| plain);
            out.push(RunVertex { node: next, along, plain: on.is_some() });
            match on {
                Some(on) => (at, via) = (next, on),
                None => break,
            }
        }
        out
    }

    /// The separation at a vertex, if there can be one.
    fn at(&self, node: usize) -> Result<Option<Separation>, LayerError> {
        let Some((highway, upper)) = self.crossing(node) else { return Ok(None) };
        let rule = self.inputs.settings.class(self.class(upper[0])).highway_crossings;
        if rule == Crossing::Junction || !self.has_room(node, highway, upper)? {
            return Ok(None);
        }
        if rule == Crossing::Bridge {
            let free = self.is_unmerged(node)? && !self.has_turn_at(node, upper)?;
            return Ok(free.then_some(Separation { node, upper, ramp: None }));
        }
        let ramp = self.ramp(node, highway, upper)?;
        Ok(ramp.map(|ends| Separation { node, upper, ramp: Some(ends) }))
    }

    /// Whether a bridge fits, on the ground and between other roads.
    fn has_room(&self, node: usize, highway: [usize; 2], upper: [usize; 2]) -> Result<bool, LayerError> {
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
        for (edge, end) in upper.into_iter().zip(&mut ends) {
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
                    let position = net.nodes[pair[0]].position.moved(by * part);
                    *end = self.inputs.terrain.height(position.plan());
                    break;
                }
            }
        }
        let most = self.inputs.settings.class(self.class(upper[0])).slope_limit;
        Ok((ends[0] - ends[1]).abs() / (2.0 * HALF_LENGTH) + STEEPEST * OVERPASS_CLEARANCE / HALF_LENGTH <= 1.1 * most)
    }

    /// Whether no road but the highway is near a stretch of the bridge.
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
        let Key::Ground { .. } = self.net().nodes[node].key else { return Ok(false) };
        let position = self.net().nodes[node].position;
        let ring = rings(UNMERGED, self.inputs.step());
        let near = |v: &Vertex| v.position.from(&position).length() < UNMERGED;
        let same = |v: &Vertex, w: &Vertex| v.ways.iter().map(|w| w.to).eq(w.ways.iter().map(|w| w.to));
        let mut count = 0;
        for tile in tiles_around(self.net().nodes[node].key.tile(), ring) {
            let graph = self.graphs.graph(tile, self.cancel)?;
            for (key, v) in graph.vertices.iter().filter(|(_, v)| near(v)) {
                count += 1;
                if !self.vertices.get(key).is_some_and(|w| same(v, w)) {
                    return Ok(false);
                }
            }
        }
        Ok(count == self.vertices.values().filter(|v| near(v)).count())
    }

    /// Whether a route turns from one road to the other at a vertex. Between lattice nodes none does.
    fn has_turn_at(&self, node: usize, upper: [usize; 2]) -> Result<bool, LayerError> {
        let n = &self.net().nodes[node];
        let Some(cell) = n.key.lattice_node() else { return Ok(false) };
        let directions = upper.map(|e| self.towards(node, e).normalize_or_zero());
        let is_upper = |other: I64Vec2| {
            let d = (other - cell).as_dvec2().normalize_or_zero();
            directions.iter().any(|o| o.dot(d) > 0.9999)
        };
        let around = Bounds::square(n.position.plan(), 2.0);
        for tier in SizeClass::ALL {
            for route in self.routes.passing(tier, around, self.cancel)? {
                let turns = |w: &[I64Vec2]| w[1] == cell && is_upper(w[0]) != is_upper(w[2]);
                if route.nodes.windows(3).any(turns) {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Ends of the best ramp, on the highway and on the other road.
    fn ramp(&self, node: usize, highway: [usize; 2], upper: [usize; 2]) -> Result<Option<[usize; 2]>, LayerError> {
        let net = self.net();
        let longest = longest_way(&self.inputs.settings);
        let mut scored: Vec<(f64, [usize; 2])> = Vec::new();
        for h in highway {
            let on_highway = self.run(node, h, RAMP_AT.1);
            for u in upper {
                let on_upper = self.run(node, u, HALF_LENGTH + RUN_OUT);
                for (i, p) in on_highway.iter().enumerate().filter(|(_, p)| p.plain && p.along >= RAMP_AT.0) {
                    for (k, q) in on_upper.iter().enumerate() {
                        let by = net.step(p.node, q.node);
                        if !q.plain || q.along < HALF_LENGTH + RUN_OUT || by.length() > longest {
                            continue;
                        }
                        let meets = |n: usize, by: DVec2| {
                            let angles = net.nodes[n].ways.iter().map(|e| angle_between(by, self.towards(n, *e)));
                            angles.fold(f64::INFINITY, f64::min)
                        };
                        let least = meets(p.node, by).min(meets(q.node, -by));
                        if least < RAMP_ANGLE || !self.is_empty(node, &on_highway[..=i], &on_upper[..=k])? {
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
            let rank = net.edges[upper[0]].rank.max(net.edges[upper[1]].rank);
            if self.rules.lets_through(ends[0], net.step(ends[0], ends[1]), Some(ends[1]), rank)? {
                return Ok(Some(ends));
            }
        }
        Ok(None)
    }

    /// Whether nothing lies between two roads from a vertex and the ramp that joins their ends.
    fn is_empty(&self, node: usize, p: &[RunVertex], q: &[RunVertex]) -> Result<bool, LayerError> {
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
            // A road that turns back would cross the ramp.
            let cuts = orient(from, to, at[0]) * orient(from, to, at[1]) < 0.0
                && orient(at[0], at[1], from) * orient(at[0], at[1], to) < 0.0;
            if cuts {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The graph of the tile with some separations.
    fn rebuild(&self, tile: I64Vec2, found: &[Separation]) -> Result<Graph, LayerError> {
        let net = self.net();
        let mut out = Graph::default();
        let ends = |n: usize| (net.nodes[n].key, net.nodes[n].position);
        for e in net.edges_in(net.own)? {
            let edge = &net.edges[e];
            let [a, b] = edge.ends.map(|n| {
                let above = found.iter().any(|s| s.node == n && s.upper.contains(&e));
                let (key, position) = ends(n);
                (if above { key.overpass() } else { key }, position)
            });
            out.join(tile, a, b, edge.rank, edge.level);
        }
        for s in found {
            if let Some([p, q]) = s.ramp {
                let rank = net.edges[s.upper[0]].rank.max(net.edges[s.upper[1]].rank);
                out.join(tile, ends(p), ends(q), rank, 0);
            }
        }
        Ok(out)
    }
}
