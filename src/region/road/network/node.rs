//! Settlements too small for the lattice: a settlement whose disc would be smaller than 1.5 steps is a node.
//!
//! The nearest node of the lattice stands for it; roads end there and pass through. When all roads have their form, the plane
//! around that node is bent smoothly, without folds, so that the node comes to lie at the settlement's centre. Where nodes of
//! two settlements are neighbours, or the nearest nodes are under water, it comes only part of the way.

use super::Finite;
use super::places::Listed;
use crate::region::road::Road;
use crate::region::road::lattice::{node_at, node_near};
use crate::region::road::search::Window;
use crate::region::road::site::{Site, Tie};
use crate::region::{Settlement, SettlementId};
use crate::space::{Bounds, quantize, segments};
use crate::terrain::Terrain;
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A node stands for a settlement at most this many nodes away.
const FARTHEST: i64 = 3;
/// Greatest shift of a node in steps along each axis: alone, and beside another that is shifted. With these nothing folds:
/// the determinant of the map is 1 less at most 0.99.
const SHIFT: (f64, f64) = (0.5, 0.12);
/// How far the plane is bent around a node along each axis, in steps: with room, so that roads come to it without a hook,
/// and without. With room no disc, border or other bend is as near.
const BENT: (i64, i64) = (2, 1);
/// Segments of roads that are bent, in steps.
const FINE: f64 = 0.125;

/// Nodes that stand for settlements.
#[derive(Default)]
pub(super) struct Nodes {
    pub of: BTreeMap<SettlementId, I64Vec2>,
    at: BTreeMap<[i64; 2], SettlementId>,
    /// How far the node at a place is shifted, in metres, and how far around it the plane is bent, in steps.
    shift: BTreeMap<[i64; 2], (DVec2, i64)>,
    step: i64,
}

impl Nodes {
    /// A node for each settlement of a domain that is one: the nearest dry one that is free, in turn by id.
    pub fn new(places: &Listed, domain: Bounds, terrain: &dyn Terrain, step: i64) -> Self {
        let mut out = Self { step, ..Self::default() };
        for s in places.all.iter().filter(|s| places.is_node(s.id)) {
            let centre = s.centre.plan();
            let free = |n: I64Vec2| !out.at.contains_key(&n.to_array()) && domain.contains(node_at(n, step));
            let nearest = |dry: bool| {
                let fits = |n: &I64Vec2| free(*n) && (!dry || terrain.sample(node_at(*n, step)).depth() == 0.0);
                around(node_near(centre, step)).filter(fits).min_by(|a, b| nearer(*a, *b, centre, step))
            };
            if let Some(node) = nearest(true).or_else(|| nearest(false)) {
                out.of.insert(s.id, node);
                out.at.insert(node.to_array(), s.id);
            }
        }
        for s in &places.all {
            let Some(node) = out.of.get(&s.id).copied() else { continue };
            let others = |within: i64| {
                let beside = |n: &[i64; 2]| (I64Vec2::from_array(*n) - node).abs().max_element() < within;
                let rows = [node.x - within + 1, i64::MIN]..=[node.x + within - 1, i64::MAX];
                out.at.range(rows).any(|(n, other)| *other != s.id && beside(n))
            };
            let most = step as f64 * if others(2) { SHIFT.1 } else { SHIFT.0 };
            let off = s.centre.plan() - node_at(node, step);
            let shift = off.clamp(DVec2::splat(-most), DVec2::splat(most));
            let margin = (BENT.0 * step) as f64;
            let inside = domain.grown(-margin).contains(node_at(node, step));
            let room = inside && shift == off && !others(2 * BENT.0);
            out.shift.insert(node.to_array(), (shift, if room { BENT.0 } else { BENT.1 }));
        }
        out
    }

    /// The settlement that a node stands for.
    pub fn settlement(&self, node: I64Vec2) -> Option<SettlementId> {
        self.at.get(&node.to_array()).copied()
    }

    /// Where a plan point comes to lie.
    fn bent(&self, p: DVec2) -> DVec2 {
        let first = (p / self.step as f64).floor().as_i64vec2();
        near(first, first + 1).fold(p, |out, node| match self.shift.get(&node) {
            Some((shift, reach)) => {
                let off = (p - node_at(node.into(), self.step)) / (self.step * reach) as f64;
                out + *shift * bump(off.x) * bump(off.y)
            }
            None => out,
        })
    }

    /// A piece of road on the bent plane.
    pub fn bend(&self, road: &Arc<Road>) -> Arc<Road> {
        let step = self.step as f64;
        let touched = |a: DVec2, b: DVec2| {
            let low = (a.min(b) / step).floor().as_i64vec2();
            let high = (a.max(b) / step).floor().as_i64vec2() + 1;
            near(low, high).any(|node| self.shift.contains_key(&node))
        };
        let plan = |p: DVec2| road.origin.to_plan(p);
        let line = &road.street.line;
        if !segments(line).any(|(a, b)| touched(plan(a), plan(b))) {
            return road.clone();
        }
        let mut out = vec![self.bent(plan(line[0]))];
        for (a, b) in segments(line) {
            let count = if touched(plan(a), plan(b)) { (a.distance(b) / (FINE * step)).ceil().max(1.0) } else { 1.0 };
            out.extend((1..=count as usize).map(|i| self.bent(plan(a.lerp(b, i as f64 / count)))));
        }
        let mut bent = Road::clone(road);
        bent.street.line = out.into_iter().map(|p| quantize(road.origin.to_local(p))).collect();
        bent.street.line.dedup();
        Arc::new(bent)
    }
}

/// Nodes so near to those of a box that the plane around them may be bent there.
fn near(low: I64Vec2, high: I64Vec2) -> impl Iterator<Item = [i64; 2]> {
    let more = BENT.0 - 1;
    (low.x - more..=high.x + more).flat_map(move |x| (low.y - more..=high.y + more).map(move |y| [x, y]))
}

/// 1 at 0, 0 from 1 on, smooth.
fn bump(x: f64) -> f64 {
    let x = x.abs().min(1.0);
    (1.0 - x) * (1.0 - x) * (1.0 + 2.0 * x)
}

/// Nodes around a node, itself included.
fn around(node: I64Vec2) -> impl Iterator<Item = I64Vec2> {
    let side = 2 * FARTHEST + 1;
    (0..side * side).map(move |i| node + I64Vec2::new(i % side, i / side) - FARTHEST)
}

/// Which of two nodes is nearer to a plan point.
fn nearer(a: I64Vec2, b: I64Vec2, to: DVec2, step: i64) -> std::cmp::Ordering {
    let from = |n: I64Vec2| node_at(n, step).distance_squared(to);
    from(a).total_cmp(&from(b)).then(a.to_array().cmp(&b.to_array()))
}

impl Finite {
    /// Where roads end at a settlement that is a node. It closes nothing.
    pub fn site(&self, s: &Settlement) -> Site {
        let step = self.nodes.step;
        let tie =
            |node: &I64Vec2| Tie { vertex: 0, gate: s.centre.to_local(node_at(*node, step)), node: *node, way: 0.0 };
        let window = Window { min: I64Vec2::ZERO, size: I64Vec2::ZERO };
        Site { ties: self.nodes.of.get(&s.id).map(tie).into_iter().collect(), window, closed: Vec::new() }
    }

    /// The node that stands for a settlement on a lattice of some step: the nearest dry one in the domain, if one is near.
    pub fn centre_node(&self, terrain: &dyn Terrain, s: &Settlement, step: i64) -> I64Vec2 {
        if let Some(node) = self.nodes.of.get(&s.id).filter(|_| step == self.nodes.step) {
            return *node;
        }
        let (low, high) = self.range(step);
        let near = node_near(s.centre.plan(), step).clamp(low, high);
        let is_dry = |n: &I64Vec2| terrain.sample(node_at(*n, step)).depth() == 0.0;
        let inside = around(near).filter(|n| n.cmpge(low).all() && n.cmple(high).all() && is_dry(n));
        inside.min_by(|a, b| nearer(*a, *b, s.centre.plan(), step)).unwrap_or(near)
    }
}
