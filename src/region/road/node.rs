//! Settlements that are nodes of the lattice: way points of the user, and in a finite domain those too small for the lattice,
//! whose disc would be smaller than 1.5 steps.
//!
//! The nearest node of the lattice stands for such a settlement; roads end there and pass through. Where roads have their
//! form, the plane around that node is bent smoothly, without folds, so that the node comes to lie at the settlement's centre.
//! Where nodes of two settlements are neighbours, or the nearest nodes are under water, it comes only part of the way.

use super::lattice::{node_at, node_near};
use super::search::Window;
use super::site::{Site, Tie};
use crate::region::{Settlement, SettlementId};
use crate::space::{Bounds, Origin, quantize, segments};
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
    of: BTreeMap<SettlementId, I64Vec2>,
    at: BTreeMap<[i64; 2], SettlementId>,
    /// How far the node at a place is shifted, in metres, and how far around it the plane is bent, in steps.
    shift: BTreeMap<[i64; 2], (DVec2, i64)>,
    step: i64,
}

impl Nodes {
    /// A node for each of some settlements, which are sorted by id: the nearest dry one in the domain that is free, in turn.
    pub fn new(settlements: &[Arc<Settlement>], domain: Bounds, terrain: &dyn Terrain, step: i64) -> Self {
        let mut out = Self { step, ..Self::default() };
        for s in settlements {
            let free = |n: I64Vec2| !out.at.contains_key(&n.to_array()) && domain.contains(node_at(n, step));
            let nearest = |dry: bool| {
                let fits = |n: &I64Vec2| free(*n) && (!dry || terrain.sample(node_at(*n, step)).depth() == 0.0);
                around(node_near(s.centre.plan(), step)).filter(fits).min_by(|a, b| nearer(*a, *b, s.centre, step))
            };
            if let Some(node) = nearest(true).or_else(|| nearest(false)) {
                out.of.insert(s.id, node);
                out.at.insert(node.to_array(), s.id);
            }
        }
        for s in settlements {
            let Some(node) = out.of.get(&s.id).copied() else { continue };
            let others = |within: i64| {
                let beside = |n: &[i64; 2]| (I64Vec2::from_array(*n) - node).abs().max_element() < within;
                let rows = [node.x - within + 1, i64::MIN]..=[node.x + within - 1, i64::MAX];
                out.at.range(rows).any(|(n, other)| *other != s.id && beside(n))
            };
            let most = step as f64 * if others(2) { SHIFT.1 } else { SHIFT.0 };
            let off = s.centre.offset_to(Origin(node * step));
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

    /// The node that stands for a settlement, on a lattice of this step.
    pub fn node(&self, s: &Settlement, step: i64) -> Option<I64Vec2> {
        self.of.get(&s.id).copied().filter(|_| step == self.step)
    }

    /// Where roads end at a settlement that is a node. It closes nothing.
    pub fn site(&self, s: &Settlement) -> Option<Site> {
        let node = *self.of.get(&s.id)?;
        let gate = Origin(node * self.step).offset_to(s.centre);
        let window = Window { min: I64Vec2::ZERO, size: I64Vec2::ZERO };
        Some(Site { ties: vec![Tie { vertex: 0, gate, node, way: 0.0 }], window, closed: Vec::new() })
    }

    /// How far a point local to an origin is moved, rounded to the quantum grid; the same wherever the origin is.
    fn moved(&self, origin: Origin, p: DVec2) -> DVec2 {
        let (base, p) = self.local(origin, p);
        let first = (p / self.step as f64).floor().as_i64vec2();
        // In the same order from any origin, for sums of floats depend on it.
        let side = 2 * BENT.0;
        let near = (0..side * side).map(|i| first + 1 - BENT.0 + I64Vec2::new(i % side, i / side));
        let all = near.fold(DVec2::ZERO, |out, node| match self.shift.get(&(base + node).to_array()) {
            Some((shift, reach)) => {
                let off = (p - node_at(node, self.step)) / (self.step * reach) as f64;
                out + *shift * bump(off.x) * bump(off.y)
            }
            None => out,
        });
        quantize(all)
    }

    /// A node near an origin, and a point local to that origin as seen from it.
    fn local(&self, origin: Origin, p: DVec2) -> (I64Vec2, DVec2) {
        let base = origin.0.div_euclid(I64Vec2::splat(self.step));
        (base, p + (origin.0 - base * self.step).as_dvec2())
    }

    /// Whether a segment comes into a square of the lattice where points are moved.
    fn touches(&self, origin: Origin, a: DVec2, b: DVec2) -> bool {
        let step = self.step as f64;
        let ((base, a), (_, b)) = (self.local(origin, a), self.local(origin, b));
        let low = (a.min(b) / step).floor().as_i64vec2() + base + 1 - BENT.0;
        let high = (a.max(b) / step).floor().as_i64vec2() + base + BENT.0;
        (low.x..=high.x).any(|x| (low.y..=high.y).any(|y| self.shift.contains_key(&[x, y])))
    }

    /// A line on the bent plane, and indices of its points there. The line is local to `origin` and on the quantum grid.
    pub fn bend(&self, origin: Origin, line: Vec<DVec2>, indices: &mut [&mut usize]) -> Vec<DVec2> {
        if self.shift.is_empty() || !segments(&line).any(|(a, b)| self.touches(origin, a, b)) {
            return line;
        }
        let mut out: Vec<DVec2> = Vec::with_capacity(line.len());
        let mut put = |p: DVec2| {
            if out.last() != Some(&p) {
                out.push(p);
            }
            out.len() - 1
        };
        let bent = |p: DVec2| p + self.moved(origin, p);
        let mut places = vec![put(bent(line[0]))];
        for (a, b) in segments(&line) {
            let fine = FINE * self.step as f64;
            let count = if self.touches(origin, a, b) { (a.distance(b) / fine).ceil().max(1.0) as usize } else { 1 };
            for i in 1..count {
                put(bent(quantize(a.lerp(b, i as f64 / count as f64))));
            }
            places.push(put(bent(b)));
        }
        for index in indices {
            **index = places[**index];
        }
        out
    }
}

/// 1 at 0, 0 from 1 on, smooth.
fn bump(x: f64) -> f64 {
    let x = x.abs().min(1.0);
    (1.0 - x) * (1.0 - x) * (1.0 + 2.0 * x)
}

/// Nodes around a node, itself included.
pub(super) fn around(node: I64Vec2) -> impl Iterator<Item = I64Vec2> {
    let side = 2 * FARTHEST + 1;
    (0..side * side).map(move |i| node + I64Vec2::new(i % side, i / side) - FARTHEST)
}

/// Which of two nodes is nearer to a place.
pub(super) fn nearer(a: I64Vec2, b: I64Vec2, to: Origin, step: i64) -> std::cmp::Ordering {
    let from = |n: I64Vec2| Origin(n * step).offset_to(to).length_squared();
    from(a).total_cmp(&from(b)).then(a.to_array().cmp(&b.to_array()))
}
