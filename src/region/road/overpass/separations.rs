//! Decides which crossings are separated, and rebuilds the graph of a tile with them.

use super::diamond::{Diamond, Ramp, RampEnd};
use super::dimensions::{CLEAR, HALF_LENGTH, OVERPASS_CLEARANCE, STEEPEST, UNMERGED};
use super::surroundings::{Cross, Surroundings};
use crate::layer::LayerError;
use crate::network::{SizeClass, StreetClass};
use crate::region::road::crossing::{Crossing, Hindrance};
use crate::region::road::tile::{rings, tiles_around};
use crate::region::road::vertex::{Graph, Key, Position, Rank, Vertex};
use crate::space::{Bounds, segment_distance};
use glam::{DVec2, I64Vec2};

/// Slope that the deck of any overpass may have where it is steepest.
const STEEP_DECK: f64 = 0.1;

/// What joins the roads of a separated crossing.
enum Ramps {
    None,
    /// A two-way ramp between two vertices.
    TwoWay([usize; 2]),
    Diamond(Box<Diamond>),
}

/// A grade-separated crossing.
pub(super) struct Separation {
    node: usize,
    /// Edges of the road that passes over.
    upper: [usize; 2],
    ramps: Ramps,
}

impl Separation {
    fn kind(&self) -> Crossing {
        match self.ramps {
            Ramps::None => Crossing::Bridge,
            Ramps::TwoWay(_) => Crossing::Interchange,
            Ramps::Diamond(_) => Crossing::Diamond,
        }
    }

    /// The one-way ramps.
    fn one_way(&self) -> &[Ramp] {
        if let Ramps::Diamond(diamond) = &self.ramps { &diamond.ramps } else { &[] }
    }

    /// The better rank that the part of an edge next to a vertex gets, if it lies between a crossing and its ramps.
    fn raised(&self, edge: usize, vertex: usize) -> Option<Rank> {
        let Ramps::Diamond(diamond) = &self.ramps else { return None };
        diamond.raised.contains(&(edge, vertex)).then_some(diamond.rank)
    }
}

/// What becomes of a crossing.
pub(super) struct Verdict {
    pub class: StreetClass,
    pub separation: Option<Separation>,
    pub hindrance: Option<Hindrance>,
}

impl Verdict {
    /// How the crossing is built.
    pub fn built(&self) -> Crossing {
        self.separation.as_ref().map_or(Crossing::Junction, Separation::kind)
    }
}

/// The decisions about crossings around a tile.
pub(super) struct Separations<'a> {
    pub ground: Surroundings<'a>,
}

impl Separations<'_> {
    /// What becomes of the crossing at a vertex, if roads cross a highway there.
    pub fn at(&self, node: usize) -> Result<Option<Verdict>, LayerError> {
        let Some(class) = self.ground.crossing_class(node) else { return Ok(None) };
        let settings = &self.ground.inputs.settings;
        let rule = settings.class(class).highway_crossings;
        let toll = settings.highway.toll && class != StreetClass::Highway;
        if rule == Crossing::Junction {
            return Ok(Some(Verdict { class, separation: None, hindrance: None }));
        }
        let no = |hindrance| Ok(Some(Verdict { class, separation: None, hindrance: Some(hindrance) }));
        let cross = match self.ground.cross(node) {
            Ok(cross) => cross,
            Err(hindrance) => return no(hindrance),
        };
        if let Err(hindrance) = self.has_room(&cross)? {
            return no(hindrance);
        }
        let of = |ramps, hindrance| {
            let separation = Some(Separation { node, upper: cross.upper, ramps });
            Ok(Some(Verdict { class, separation, hindrance }))
        };
        let mut hindrance = None;
        if rule == Crossing::Diamond {
            match self.ground.diamond(&cross)? {
                Ok(diamond) => return of(Ramps::Diamond(Box::new(diamond)), None),
                Err(h) => hindrance = Some(h),
            }
        }
        if self.ground.is_mixed(&cross) {
            return no(hindrance.unwrap_or(Hindrance::Roads));
        }
        if rule >= Crossing::Interchange {
            match self.ground.two_way_ramp(&cross)? {
                Ok(ends) => return of(Ramps::TwoWay(ends), hindrance),
                Err(h) => hindrance = hindrance.or(Some(h)),
            }
        }
        let bridges = toll || (rule == Crossing::Bridge && self.is_unmerged(node)?);
        if bridges && !self.has_turn_at(&cross)? {
            return of(Ramps::None, hindrance);
        }
        no(hindrance.unwrap_or(Hindrance::Turn))
    }

    /// Whether a bridge fits, on the ground and between other roads.
    fn has_room(&self, cross: &Cross) -> Result<Result<(), Hindrance>, LayerError> {
        let net = self.ground.net();
        let Cross { node, highway, upper } = *cross;
        if highway.iter().any(|e| net.apart(node, net.far(*e, node)) < CLEAR) {
            return Ok(Err(Hindrance::Junction));
        }
        let mut ends = [0.0; 2];
        let mut reached = [DVec2::ZERO; 2];
        for (i, edge) in upper.into_iter().enumerate() {
            let run = match self.ground.clear_run(node, edge, HALF_LENGTH) {
                Ok(run) => run,
                Err(hindrance) => return Ok(Err(hindrance)),
            };
            let line: Vec<usize> = std::iter::once(node).chain(run.iter().map(|s| s.node)).collect();
            let mut left = HALF_LENGTH;
            for pair in line.windows(2) {
                let by = net.step(pair[0], pair[1]);
                let part = (left / by.length()).min(1.0);
                if !self.is_clear(node, pair, by * part, &highway)? {
                    return Ok(Err(Hindrance::Obstacle));
                }
                left -= by.length();
                if left <= 0.0 {
                    let position = net.nodes[pair[0]].position.moved(by * part);
                    ends[i] = self.ground.inputs.terrain.height(position.plan());
                    reached[i] = net.step(node, pair[0]) + by * part;
                    break;
                }
            }
        }
        if !self.ground.are_own(node, &reached)? {
            return Ok(Err(Hindrance::Crossing));
        }
        let limit = self.ground.inputs.settings.class(self.ground.class(upper[0])).slope_limit;
        let most = (1.1 * limit).max(STEEP_DECK);
        let steepest = (ends[0] - ends[1]).abs() / (2.0 * HALF_LENGTH) + STEEPEST * OVERPASS_CLEARANCE / HALF_LENGTH;
        Ok(if steepest <= most { Ok(()) } else { Err(Hindrance::Ground) })
    }

    /// Whether no road but the highway is near a stretch of the bridge.
    fn is_clear(&self, node: usize, pair: &[usize], by: DVec2, highway: &[usize]) -> Result<bool, LayerError> {
        let net = self.ground.net();
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
        let Key::Ground { .. } = self.ground.net().nodes[node].key else { return Ok(false) };
        let position = self.ground.net().nodes[node].position;
        let ring = rings(UNMERGED, self.ground.inputs.step());
        let near = |v: &Vertex| v.position.from(&position).length() < UNMERGED;
        let same = |v: &Vertex, w: &Vertex| v.ways.iter().map(|w| w.to).eq(w.ways.iter().map(|w| w.to));
        let mut count = 0;
        for tile in tiles_around(self.ground.net().nodes[node].key.tile(), ring) {
            let graph = self.ground.graphs.graph(tile, self.ground.cancel)?;
            for (key, v) in graph.vertices.iter().filter(|(_, v)| near(v)) {
                count += 1;
                if !self.ground.vertices.get(key).is_some_and(|w| same(v, w)) {
                    return Ok(false);
                }
            }
        }
        Ok(count == self.ground.vertices.values().filter(|v| near(v)).count())
    }

    /// Whether a route turns from one road to the other at a vertex. Between lattice nodes none does.
    fn has_turn_at(&self, cross: &Cross) -> Result<bool, LayerError> {
        let Cross { node, upper, .. } = *cross;
        let n = &self.ground.net().nodes[node];
        let Some(cell) = n.key.lattice_node() else { return Ok(false) };
        let directions = upper.map(|e| self.ground.towards(node, e).normalize_or_zero());
        let is_upper = |other: I64Vec2| {
            let d = (other - cell).as_dvec2().normalize_or_zero();
            directions.iter().any(|o| o.dot(d) > 0.9999)
        };
        let around = Bounds::square(n.position.plan(), 2.0);
        for tier in SizeClass::ALL {
            for route in self.ground.routes.passing(tier, around, self.ground.cancel)? {
                let turns = |w: &[I64Vec2]| w[1] == cell && is_upper(w[0]) != is_upper(w[2]);
                if route.nodes.windows(3).any(turns) {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// The graph of the tile with some separations.
    pub fn rebuild(&self, tile: I64Vec2, found: &[Separation]) -> Result<Graph, LayerError> {
        let net = self.ground.net();
        let mut out = Graph::default();
        let end_of = |n: usize| (net.nodes[n].key, net.nodes[n].position);
        let place = |end: &RampEnd| (end.key, end.position);
        for e in net.edges_in(net.own)? {
            let edge = &net.edges[e];
            let [a, b] = edge.ends.map(|n| {
                let above = found.iter().any(|s| s.node == n && s.upper.contains(&e));
                let (key, position) = end_of(n);
                (if above { key.overpass() } else { key }, position)
            });
            let ramps = found.iter().flat_map(Separation::one_way).flat_map(|r| &r.ends);
            let mut between: Vec<(Key, Position)> = ramps.filter(|end| end.edge == Some(e)).map(place).collect();
            between.sort_by(|p, q| {
                let from_a = |at: &(Key, Position)| at.1.from(&a.1).length_squared();
                from_a(p).total_cmp(&from_a(q)).then(p.0.cmp(&q.0))
            });
            between.dedup_by_key(|at| at.0);
            let chain: Vec<(Key, Position)> = std::iter::once(a).chain(between).chain([b]).collect();
            let last = chain.len() - 2;
            for (i, pair) in chain.windows(2).enumerate() {
                let parts = [(0, edge.ends[0]), (last, edge.ends[1])].into_iter().filter(|(at, _)| *at == i);
                let raised = parts.flat_map(|(_, n)| found.iter().filter_map(move |s| s.raised(e, n))).min();
                out.join(tile, pair[0], pair[1], raised.unwrap_or(edge.rank), edge.level);
            }
        }
        for s in found {
            let rank = net.edges[s.upper[0]].rank.max(net.edges[s.upper[1]].rank);
            if let Ramps::TwoWay([p, q]) = s.ramps {
                out.join(tile, end_of(p), end_of(q), rank, 0);
            }
            for ramp in s.one_way() {
                let [from, to] = [0, 1].map(|i| place(&ramp.ends[i]));
                out.join_by_ramp(tile, from, to, rank.of_ramp(), ramp.bend);
            }
        }
        Ok(out)
    }
}
