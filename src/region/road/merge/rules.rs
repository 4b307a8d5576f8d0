//! Which edges are dropped, and which vertices need a connector in their place.

use super::net::Net;
use super::padding::{OUTLINE_STEPS, WATCHED_STEPS, beside, longest_rung};
use crate::layer::{LayerError, Reach};
use crate::network::StreetClass;
use crate::region::road::inputs::Inputs;
use crate::region::road::vertex::{Position, Rank};
use crate::space::math::angle_between;
use crate::space::{Bounds, polygon_distance, segment_distance};
use glam::DVec2;

/// Roads that fork at a smaller angle, in radians, fork farther out.
pub(super) const SHARP: f64 = 0.55;
/// Length in steps over which a route must run beside others if it does not touch them.
const LEAST_STEPS: f64 = 3.0;
/// Sine of the angle from which a route heads away.
const AWAY: f64 = 0.65;
/// Greatest number of rungs that are tried for a vertex, nearest first.
const MOST_TRIED: usize = 4;
/// Distance in metres between samples of the ground under a connector.
const SAMPLED_EVERY: f64 = 32.0;
/// Distance in metres that connectors keep from ties.
const OFF_TIES: f64 = 18.0;

/// A net, and what was found out about it.
pub(in crate::region::road) struct Rules<'a> {
    pub inputs: &'a Inputs,
    pub net: Net,
    /// What may be read of settlements.
    reach: Reach,
    beside: Vec<Option<bool>>,
    rung: Vec<Option<Option<usize>>>,
    dropped: Vec<Option<bool>>,
}

impl<'a> Rules<'a> {
    /// The rules of a net that reads within `padding` metres of the tile `own` (plan metres).
    pub fn new(inputs: &'a Inputs, net: Net, own: Bounds, padding: f64) -> Self {
        let (nodes, edges) = (net.nodes.len(), net.edges.len());
        let reach = Reach::new("roads", own, padding + OUTLINE_STEPS * inputs.step() as f64 + 1.0);
        Self { inputs, net, reach, beside: vec![None; nodes], rung: vec![None; nodes], dropped: vec![None; edges] }
    }

    /// Whether a vertex runs beside better edges, or comes first after a sharp fork from them.
    pub fn runs_beside(&mut self, node: usize) -> Result<bool, LayerError> {
        if let Some(known) = self.beside[node] {
            return Ok(known);
        }
        let known = self.find_beside(node)?;
        self.beside[node] = Some(known);
        Ok(known)
    }

    fn find_beside(&self, node: usize) -> Result<bool, LayerError> {
        let n = &self.net.nodes[node];
        let (Some(rank), false) = (n.best, n.key.is_gate()) else { return Ok(false) };
        let limit = beside(&self.inputs.settings);
        let Some(distance) = self.net.better_near(node, rank, limit)? else { return Ok(false) };
        let along = self.along(node, rank);
        if along.iter().any(|e| self.is_sharp(*e, self.net.far(*e, node))) {
            return Ok(true);
        }
        // How far the route stays within the limit, in both directions.
        let step = self.inputs.step() as f64;
        let (mut length, mut touches) = (0.0, false);
        let mut ends = [(node, distance); 2];
        let mut ties = Vec::new();
        let along: [Option<usize>; 2] = [along.first().copied(), along.get(1).copied()];
        for (first, end) in along.into_iter().zip(&mut ends) {
            let (mut at, mut via, mut run) = (node, first, 0.0);
            while let Some(edge) = via {
                let next = self.net.far(edge, at);
                run += self.net.apart(at, next);
                if run > WATCHED_STEPS * step {
                    break;
                }
                let Some(distance) = self.net.better_near(next, rank, limit)? else { break };
                length += self.net.apart(at, next);
                *end = (next, distance);
                if distance == 0.0 {
                    touches = true;
                    break;
                }
                at = next;
                via = self.along(next, rank).into_iter().find(|e| *e != edge);
            }
            if via.is_none() {
                ties.push(self.tie(at, rank).min(WATCHED_STEPS * step - run));
            }
        }
        if ties.len() == 2 && !ties.contains(&0.0) {
            // The route runs beside over its whole length.
            length += ties[0] + ties[1];
        }
        let away = (ends[0].1 - ends[1].1).abs() > AWAY * self.net.apart(ends[0].0, ends[1].0);
        Ok(length > 0.0 && !away && (touches || length >= LEAST_STEPS * step))
    }

    /// The edges of a rank at a vertex that are not fixed: at most two, except where a route crosses itself.
    fn along(&self, node: usize, rank: Rank) -> Vec<usize> {
        let ways = &self.net.nodes[node].ways;
        ways.iter().copied().filter(|e| self.net.edges[*e].rank == rank && !self.net.edges[*e].fixed).collect()
    }

    /// Length of the tie in which a route ends at a vertex, 0 if it does not end there.
    fn tie(&self, node: usize, rank: Rank) -> f64 {
        let ties = self.net.nodes[node].ways.iter().filter(|e| {
            let edge = &self.net.edges[**e];
            edge.rank == rank && edge.ends.iter().any(|n| self.net.nodes[*n].key.is_gate())
        });
        ties.map(|e| self.net.apart(node, self.net.far(*e, node))).fold(0.0, f64::max)
    }

    /// Whether an edge leaves a better edge at a sharp angle.
    pub fn is_sharp(&self, edge: usize, fork: usize) -> bool {
        let direction = self.net.step(fork, self.net.far(edge, fork));
        self.net.nodes[fork].ways.iter().any(|b| {
            self.net.is_better(*b, self.net.edges[edge].rank)
                && angle_between(direction, self.net.step(fork, self.net.far(*b, fork))) < SHARP
        })
    }

    /// The vertex on a better road that a vertex is coupled with.
    pub fn rung(&mut self, node: usize) -> Result<Option<usize>, LayerError> {
        if let Some(known) = self.rung[node] {
            return Ok(known);
        }
        let known = self.find_rung(node)?;
        self.rung[node] = Some(known);
        Ok(known)
    }

    fn find_rung(&mut self, node: usize) -> Result<Option<usize>, LayerError> {
        let Some(rank) = self.net.nodes[node].best else { return Ok(None) };
        if !self.runs_beside(node)? {
            return Ok(None);
        }
        let mut near = self.net.nodes_near(node, longest_rung(&self.inputs.settings))?;
        near.retain(|n| self.net.on_better(*n, rank));
        near.sort_by(|a, b| {
            let key = |n: usize| self.net.nodes[n].key;
            self.net.apart(node, *a).total_cmp(&self.net.apart(node, *b)).then(key(*a).cmp(&key(*b)))
        });
        let mut tried = 0;
        for n in near {
            if self.runs_beside(n)? {
                continue;
            }
            if self.is_free(node, n)? {
                return Ok(Some(n));
            }
            tried += 1;
            if tried == MOST_TRIED {
                break;
            }
        }
        Ok(None)
    }

    /// Whether the ground lets a connector between two vertices through, and no outline or tie is in its way.
    pub fn is_free(&self, from: usize, to: usize) -> Result<bool, LayerError> {
        let Some(rank) = self.net.nodes[from].best else { return Ok(false) };
        self.lets_through(from, self.net.step(from, to), Some(to), rank)
    }

    /// The same for a straight line from a vertex to another vertex or to any point, built as a road of a rank.
    pub fn lets_through(&self, from: usize, by: DVec2, to: Option<usize>, rank: Rank) -> Result<bool, LayerError> {
        let a = &self.net.nodes[from];
        let crosses_tie = |e: &usize| {
            let edge = &self.net.edges[*e];
            let [p, q] = edge.ends.map(|n| self.net.step(from, n));
            edge.fixed
                && !edge.ends.contains(&from)
                && !edge.ends.iter().any(|n| Some(*n) == to)
                && segment_distance(DVec2::ZERO, by, p, q) < OFF_TIES
        };
        let around = Bounds::of([a.at, a.at + by]).grown(OFF_TIES);
        if self.net.edges_in(around)?.iter().any(crosses_tie) {
            return Ok(false);
        }
        self.ground_lets_through(&a.position, by, rank.class)
    }

    /// Whether the ground lets a straight road of a class through that begins at a position, and no outline is in its way.
    pub fn ground_lets_through(&self, from: &Position, by: DVec2, class: StreetClass) -> Result<bool, LayerError> {
        let step = self.inputs.step() as f64;
        let most = self.inputs.settings.class(class).slope_limit;
        let parts = (by.length() / SAMPLED_EVERY).ceil().max(1.0);
        let mut before: Option<f64> = None;
        for i in 0..=parts as usize {
            let ground = self.inputs.terrain.sample(from.moved(by * (i as f64 / parts)).plan());
            if ground.depth() > 0.0 {
                return Ok(false);
            }
            if i.is_multiple_of(2) {
                let rise = before.map_or(0.0, |h| (ground.height - h).abs());
                if rise > 1.3 * most * 2.0 * by.length() / parts {
                    return Ok(false);
                }
                before = Some(ground.height);
            }
        }
        let near = Bounds::of([from.plan(), from.moved(by).plan()]).grown(OUTLINE_STEPS * step);
        for s in self.inputs.settlements.overlapping(self.reach.check(near)?)? {
            let outline = self.inputs.settlements.outline(&s)?;
            let at = from.local_to(outline.origin);
            if polygon_distance(at, at + by, &outline.polygon) < OUTLINE_STEPS * step {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether an edge is dropped.
    pub fn is_dropped(&mut self, edge: usize) -> Result<bool, LayerError> {
        if let Some(known) = self.dropped[edge] {
            return Ok(known);
        }
        let known = self.find_dropped(edge)?;
        self.dropped[edge] = Some(known);
        Ok(known)
    }

    fn find_dropped(&mut self, edge: usize) -> Result<bool, LayerError> {
        let (rank, ends) = (self.net.edges[edge].rank, self.net.edges[edge].ends);
        if self.net.edges[edge].fixed {
            return Ok(false);
        }
        let mut across = [0; 2];
        for (end, other) in ends.iter().zip(&mut across) {
            *other = if self.net.on_better(*end, rank) {
                *end
            } else {
                match self.rung(*end)? {
                    Some(n) => n,
                    None => return Ok(false),
                }
            };
        }
        Ok(self.is_joined(edge, across))
    }

    /// Whether better edges within the merge distance of an edge join two vertices.
    fn is_joined(&self, edge: usize, [from, to]: [usize; 2]) -> bool {
        let limit = longest_rung(&self.inputs.settings);
        let most = 2.0 * self.net.apart(self.net.edges[edge].ends[0], self.net.edges[edge].ends[1]) + limit;
        self.net.joins([from, to], most, |e, next| {
            self.net.is_better(e, self.net.edges[edge].rank) && self.net.distance_to_edge(next, edge) <= limit
        })
    }

    /// Whether a vertex lost edges to its rung but keeps others.
    pub fn needs_connector(&mut self, node: usize) -> Result<bool, LayerError> {
        let (Some(rank), true) = (self.net.nodes[node].best, self.runs_beside(node)?) else { return Ok(false) };
        let (mut lost, mut kept) = (false, false);
        for e in self.net.nodes[node].ways.clone() {
            let dropped = self.is_dropped(e)?;
            lost |= dropped && self.net.edges[e].rank == rank;
            kept |= !dropped;
        }
        Ok(lost && kept)
    }
}
