//! The world-aligned lattice that roads are searched on, and its stencil.

use crate::space::Origin;
use glam::{DVec2, I64Vec2};

/// Number of headings of the stencil.
pub(super) const DIRECTIONS: usize = 16;

/// Steps of the stencil, counter-clockwise from east; step `i + 8` is the opposite of step `i`. No step passes over a
/// node, so two different edges share at most one point.
pub(super) const STENCIL: [I64Vec2; DIRECTIONS] = {
    const fn v(x: i64, y: i64) -> I64Vec2 {
        I64Vec2::new(x, y)
    }
    [
        v(1, 0),
        v(2, 1),
        v(1, 1),
        v(1, 2),
        v(0, 1),
        v(-1, 2),
        v(-1, 1),
        v(-2, 1),
        v(-1, 0),
        v(-2, -1),
        v(-1, -1),
        v(-1, -2),
        v(0, -1),
        v(1, -2),
        v(1, -1),
        v(2, -1),
    ]
};

/// The heading of the stencil that leads from node `a` to node `b`, if an edge joins them.
pub(super) fn heading(a: I64Vec2, b: I64Vec2) -> Option<usize> {
    STENCIL.iter().position(|s| *s == b - a)
}

/// Length in steps of the shortest path along edges of the stencil between two nodes that are `d` apart.
pub(super) fn stencil_distance(d: I64Vec2) -> f64 {
    let (high, low) = (d.x.abs().max(d.y.abs()) as f64, d.x.abs().min(d.y.abs()) as f64);
    let (five, two) = (5f64.sqrt(), 2f64.sqrt());
    if 2.0 * low <= high { low * five + (high - 2.0 * low) } else { (high - low) * five + (2.0 * low - high) * two }
}

/// Node nearest to the plan point `p` on the lattice of spacing `step`.
pub(super) fn node_near(p: DVec2, step: i64) -> I64Vec2 {
    (p / step as f64).round().as_i64vec2()
}

/// Plan position of a node of the lattice of spacing `step`.
pub(super) fn node_at(node: I64Vec2, step: i64) -> DVec2 {
    (node * step).as_dvec2()
}

/// The nodes up to `ring` columns and rows from a node, row by row from the south-west; the node itself included.
pub(super) fn nodes_around(node: I64Vec2, ring: i64) -> impl Iterator<Item = I64Vec2> {
    let side = 2 * ring + 1;
    (0..side * side).map(move |i| node + I64Vec2::new(i % side, i / side) - ring)
}

/// Compares the distances of two nodes from a place.
pub(super) fn compare_distance(a: I64Vec2, b: I64Vec2, to: Origin, step: i64) -> std::cmp::Ordering {
    let from = |n: I64Vec2| Origin(n * step).offset_to(to).length_squared();
    from(a).total_cmp(&from(b)).then(a.to_array().cmp(&b.to_array()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stencil_is_ordered_and_its_distance_bounds_the_beeline() {
        for (i, s) in STENCIL.iter().enumerate() {
            assert_eq!(STENCIL[(i + 8) % 16], -*s);
            assert!(s.perp_dot(STENCIL[(i + 1) % 16]) > 0);
            assert_eq!(stencil_distance(*s), s.as_dvec2().length());
        }
        for x in -20..20 {
            for y in -20..20 {
                let d = I64Vec2::new(x, y);
                let ratio = stencil_distance(d) / d.as_dvec2().length();
                assert!(d == I64Vec2::ZERO || (1.0 - 1e-12..1.03).contains(&ratio));
            }
        }
    }
}
