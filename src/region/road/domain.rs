//! The rectangle of a finite domain. No search leaves it.

use super::lattice::{compare_distance, node_at, node_near, nodes_around};
use super::nodes::FARTHEST;
use super::window::Window;
use crate::region::settlement::Settlement;
use crate::space::Bounds;
use crate::terrain::Terrain;
use glam::I64Vec2;

/// A finite domain, in plan metres.
#[derive(Clone, Copy)]
pub(super) struct Domain(pub Bounds);

impl Domain {
    /// The node for a settlement's centre on the lattice of spacing `step`: the nearest dry node in the domain, if there is
    /// one nearby.
    pub fn centre_node(&self, terrain: &dyn Terrain, s: &Settlement, step: i64) -> I64Vec2 {
        let (low, high) = self.range(step);
        let near = node_near(s.centre.plan(), step).clamp(low, high);
        let is_dry = |n: &I64Vec2| terrain.sample(node_at(*n, step)).depth() == 0.0;
        let inside = nodes_around(near, FARTHEST).filter(|n| n.cmpge(low).all() && n.cmple(high).all() && is_dry(n));
        inside.min_by(|a, b| compare_distance(*a, *b, s.centre, step)).unwrap_or(near)
    }

    /// South-west and north-east node in the domain.
    pub fn range(&self, step: i64) -> (I64Vec2, I64Vec2) {
        let s = step as f64;
        ((self.0.min / s).ceil().as_i64vec2(), (self.0.max / s).floor().as_i64vec2())
    }

    /// The part of a window that lies in the domain.
    pub fn clip(&self, window: Window, step: i64) -> Window {
        let (low, high) = self.range(step);
        let (min, max) = (window.min.max(low), (window.min + window.size - 1).min(high));
        Window { min, size: (max - min + 1).max(I64Vec2::ZERO) }
    }
}
