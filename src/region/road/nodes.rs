//! Settlements that are nodes of the lattice: the user's way points and, in a finite domain, settlements whose disc would be
//! smaller than 1.5 steps.
//!
//! The nearest lattice node stands for such a settlement; roads end there and pass through. When roads get their shape, the
//! plane around that node is warped smoothly and without folds, so that the node comes to lie at the settlement's centre.
//! Where the nodes of two settlements are neighbours, or the nearest nodes are under water, it moves only part of the way.

use super::lattice::{compare_distance, node_at, node_near, nodes_around};
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::{Bounds, Origin, quantize, segments};
use crate::terrain::Terrain;
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The node of a settlement is at most this many columns and rows away from the nearest node.
pub(super) const FARTHEST: i64 = 3;
/// Greatest shift of a node along each axis, in steps: for a node alone, and for one beside another shifted node. With these
/// limits nothing folds: the determinant of the map is at least 0.01.
const SHIFT: (f64, f64) = (0.5, 0.12);
/// How far around a node the plane is warped along each axis, in steps: with room, so that roads reach the node without a
/// hook, and without room. With room, no disc, border or other warp lies that near.
const WARPED: (i64, i64) = (2, 1);
/// Length of the segments of warped roads, in steps.
const FINE: f64 = 0.125;

/// The nodes that stand for settlements.
#[derive(Default)]
pub(super) struct Nodes {
    of: BTreeMap<SettlementId, I64Vec2>,
    at: BTreeMap<[i64; 2], SettlementId>,
    /// For each node, its shift in metres and how far around it the plane is warped, in steps.
    shift: BTreeMap<[i64; 2], (DVec2, i64)>,
    step: i64,
}

impl Nodes {
    /// A node for each settlement, in their order: the nearest free node in the domain, dry if possible. The settlements are
    /// sorted by id.
    pub fn new(settlements: &[Arc<Settlement>], domain: Bounds, terrain: &dyn Terrain, step: i64) -> Self {
        let mut out = Self { step, ..Self::default() };
        for s in settlements {
            let free = |n: I64Vec2| !out.at.contains_key(&n.to_array()) && domain.contains(node_at(n, step));
            let nearest = |dry: bool| {
                let fits = |n: &I64Vec2| free(*n) && (!dry || terrain.sample(node_at(*n, step)).depth() == 0.0);
                nodes_around(node_near(s.centre.plan(), step), FARTHEST)
                    .filter(fits)
                    .min_by(|a, b| compare_distance(*a, *b, s.centre, step))
            };
            if let Some(node) = nearest(true).or_else(|| nearest(false)) {
                out.of.insert(s.id, node);
                out.at.insert(node.to_array(), s.id);
            }
        }
        for s in settlements {
            let Some(node) = out.of.get(&s.id).copied() else { continue };
            let others = |within: i64| {
                let near = |n: &[i64; 2]| (I64Vec2::from_array(*n) - node).abs().max_element() < within;
                let rows = [node.x - within + 1, i64::MIN]..=[node.x + within - 1, i64::MAX];
                out.at.range(rows).any(|(n, other)| *other != s.id && near(n))
            };
            let most = step as f64 * if others(2) { SHIFT.1 } else { SHIFT.0 };
            let off = s.centre.offset_to(Origin(node * step));
            let shift = off.clamp(DVec2::splat(-most), DVec2::splat(most));
            let margin = (WARPED.0 * step) as f64;
            let inside = domain.grown(-margin).contains(node_at(node, step));
            let room = inside && shift == off && !others(2 * WARPED.0);
            out.shift.insert(node.to_array(), (shift, if room { WARPED.0 } else { WARPED.1 }));
        }
        out
    }

    /// The settlement that a node stands for.
    pub fn settlement(&self, node: I64Vec2) -> Option<SettlementId> {
        self.at.get(&node.to_array()).copied()
    }

    /// The node that stands for a settlement, if it is one on the lattice of spacing `step`.
    pub fn node(&self, s: &Settlement, step: i64) -> Option<I64Vec2> {
        self.of.get(&s.id).copied().filter(|_| step == self.step)
    }

    /// Displacement of a point that is local to `origin`, rounded to the quantum grid. It does not depend on the origin.
    fn displacement(&self, origin: Origin, p: DVec2) -> DVec2 {
        let (base, p) = self.local(origin, p);
        let first = (p / self.step as f64).floor().as_i64vec2();
        // In the same order from any origin, because sums of floats depend on their order.
        let side = 2 * WARPED.0;
        let near = (0..side * side).map(|i| first + 1 - WARPED.0 + I64Vec2::new(i % side, i / side));
        let all = near.fold(DVec2::ZERO, |out, node| match self.shift.get(&(base + node).to_array()) {
            Some((shift, reach)) => {
                let off = (p - node_at(node, self.step)) / (self.step * reach) as f64;
                out + *shift * bump(off.x) * bump(off.y)
            }
            None => out,
        });
        quantize(all)
    }

    /// A node near an origin, and a point relative to that node that was local to the origin.
    fn local(&self, origin: Origin, p: DVec2) -> (I64Vec2, DVec2) {
        let base = origin.0.div_euclid(I64Vec2::splat(self.step));
        (base, p + (origin.0 - base * self.step).as_dvec2())
    }

    /// Whether a segment enters a cell of the lattice where points are displaced.
    fn touches(&self, origin: Origin, a: DVec2, b: DVec2) -> bool {
        let step = self.step as f64;
        let ((base, a), (_, b)) = (self.local(origin, a), self.local(origin, b));
        let low = (a.min(b) / step).floor().as_i64vec2() + base + 1 - WARPED.0;
        let high = (a.max(b) / step).floor().as_i64vec2() + base + WARPED.0;
        (low.x..=high.x).any(|x| (low.y..=high.y).any(|y| self.shift.contains_key(&[x, y])))
    }

    /// A line on the warped plane. The line is local to `origin` and on the quantum grid. `indices` of its points become
    /// indices into the result.
    pub fn warp(&self, origin: Origin, line: Vec<DVec2>, indices: &mut [&mut usize]) -> Vec<DVec2> {
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
        let warped = |p: DVec2| p + self.displacement(origin, p);
        let mut places = vec![put(warped(line[0]))];
        for (a, b) in segments(&line) {
            let fine = FINE * self.step as f64;
            let count = if self.touches(origin, a, b) { (a.distance(b) / fine).ceil().max(1.0) as usize } else { 1 };
            for i in 1..count {
                put(warped(quantize(a.lerp(b, i as f64 / count as f64))));
            }
            places.push(put(warped(b)));
        }
        for index in indices {
            **index = places[**index];
        }
        out
    }
}

/// A smooth bump: 1 at 0, and 0 from 1 on.
fn bump(x: f64) -> f64 {
    let x = x.abs().min(1.0);
    (1.0 - x) * (1.0 - x) * (1.0 + 2.0 * x)
}
