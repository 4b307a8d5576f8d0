//! Convex polygons clipped by lines: the tools that cut out lots and buildings.

use crate::space::{Bounds, cross, left_normal, signed_area};
use glam::DVec2;

/// Points closer than this (metres) are one corner.
const SAME_POINT: f64 = 1e-4;

/// Overlap (metres) up to which two polygons count as neighbours that touch.
const TOUCH: f64 = 0.01;

/// The half-plane to the left of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfPlane {
    /// A point of the line.
    pub at: DVec2,
    /// Unit normal, into the half-plane.
    pub normal: DVec2,
}

impl HalfPlane {
    /// The side to the left of the line from `a` to `b`, which differ.
    pub fn left_of(a: DVec2, b: DVec2) -> Self {
        Self { at: a, normal: left_normal((b - a).normalize_or_zero()) }
    }

    /// Signed distance of `p` from the line, positive inside.
    pub fn depth(&self, p: DVec2) -> f64 {
        (p - self.at).dot(self.normal)
    }

    /// The half-plane moved inwards by `by` metres.
    pub fn moved(self, by: f64) -> Self {
        Self { at: self.at + self.normal * by, normal: self.normal }
    }

    /// The other side of the line.
    pub fn flipped(self) -> Self {
        Self { at: self.at, normal: -self.normal }
    }
}

/// Cuts `polygon` (convex, counter-clockwise) to the part inside `half`; empty when nothing is left.
pub(super) fn clip(polygon: &[DVec2], half: HalfPlane) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::with_capacity(polygon.len() + 1);
    let mut push = |p: DVec2| {
        if out.last().is_none_or(|l| l.distance_squared(p) > SAME_POINT * SAME_POINT) {
            out.push(p);
        }
    };
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (da, db) = (half.depth(a), half.depth(b));
        if da >= 0.0 {
            push(a);
        }
        if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
            push(a + (b - a) * (da / (da - db)));
        }
    }
    while out.len() > 1 && out[0].distance_squared(out[out.len() - 1]) <= SAME_POINT * SAME_POINT {
        out.pop();
    }
    if out.len() < 3 || signed_area(&out) <= 0.0 {
        out.clear();
    }
    out
}

/// Edges of a polygon as half-planes that hold it.
pub(super) fn sides(polygon: &[DVec2]) -> impl Iterator<Item = HalfPlane> + '_ {
    (0..polygon.len()).map(|i| HalfPlane::left_of(polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// Whether two convex polygons share more than their borders.
pub(super) fn overlap(p: &[DVec2], q: &[DVec2]) -> bool {
    let apart = |p: &[DVec2], q: &[DVec2]| {
        sides(p).any(|h| q.iter().map(|v| h.depth(*v)).fold(f64::NEG_INFINITY, f64::max) <= TOUCH)
    };
    let (a, b) = (Bounds::of(p.iter().copied()), Bounds::of(q.iter().copied()));
    a.overlaps(b) && !apart(p, q) && !apart(q, p)
}

/// The part of segment `a`-`b` inside a convex polygon by more than [`TOUCH`].
pub(super) fn segment_inside(polygon: &[DVec2], a: DVec2, b: DVec2) -> Option<(DVec2, DVec2)> {
    let (mut low, mut high) = (0.0f64, 1.0f64);
    for half in sides(polygon) {
        let (da, db) = (half.depth(a) - TOUCH, half.depth(b) - TOUCH);
        if da <= 0.0 && db <= 0.0 {
            return None;
        }
        if da < 0.0 {
            low = low.max(da / (da - db));
        } else if db < 0.0 {
            high = high.min(da / (da - db));
        }
    }
    (low < high).then(|| (a + (b - a) * low, a + (b - a) * high))
}

/// Least and greatest x of a convex polygon at height `y`.
pub(super) fn chord(polygon: &[DVec2], y: f64) -> Option<(f64, f64)> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if (a.y - y) * (b.y - y) <= 0.0 {
            let xs = if a.y == b.y { [a.x, b.x] } else { [a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)); 2] };
            low = low.min(xs[0]).min(xs[1]);
            high = high.max(xs[0]).max(xs[1]);
        }
    }
    (low < high).then_some((low, high))
}

/// A convex polygon without the quadrant where `a` and `b` overlap: an L, if the quadrant's corner lies inside. `None` otherwise.
pub(super) fn without_quadrant(polygon: &[DVec2], a: HalfPlane, b: HalfPlane) -> Option<Vec<DVec2>> {
    let det = cross(a.normal, b.normal);
    if det.abs() < 0.3 {
        return None;
    }
    // Where the two lines meet.
    let (ca, cb) = (a.at.dot(a.normal), b.at.dot(b.normal));
    let corner = DVec2::new(ca * b.normal.y - cb * a.normal.y, cb * a.normal.x - ca * b.normal.x) / det;
    if sides(polygon).any(|h| h.depth(corner) < 1.0) {
        return None;
    }
    let cut = clip(&clip(polygon, a), b);
    let inner = cut.iter().position(|p| p.distance_squared(corner) < 1e-6)?;
    // The cut's border runs along the polygon's border, except at the corner: the corner replaces that stretch.
    let (entry, exit) = (cut[(inner + cut.len() - 1) % cut.len()], cut[(inner + 1) % cut.len()]);
    let mut out = vec![exit, corner, entry];
    let edge_of = |p: DVec2| {
        sides(polygon).map(|h| h.depth(p).abs()).enumerate().min_by(|x, y| x.1.total_cmp(&y.1).then(x.0.cmp(&y.0)))
    };
    let (first, last) = (edge_of(entry)?.0, edge_of(exit)?.0);
    let mut i = first;
    let n = polygon.len();
    loop {
        i = (i + 1) % n;
        out.push(polygon[i]);
        if i == last || out.len() > n + 4 {
            break;
        }
    }
    (signed_area(&out) > 0.0).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<DVec2> {
        vec![DVec2::ZERO, DVec2::new(10., 0.), DVec2::new(10., 10.), DVec2::new(0., 10.)]
    }

    #[test]
    fn clipping_and_overlap() {
        let half = clip(&square(), HalfPlane { at: DVec2::new(4.0, 0.0), normal: DVec2::X });
        assert_eq!(signed_area(&half), 60.0);
        assert!(clip(&square(), HalfPlane { at: DVec2::new(11.0, 0.0), normal: DVec2::X }).is_empty());
        let other: Vec<_> = square().iter().map(|p| *p + DVec2::X * 10.0).collect();
        assert!(!overlap(&square(), &other) && overlap(&half, &square()));
        assert!(segment_inside(&square(), DVec2::new(-5., 5.), DVec2::new(5., 5.)).is_some());
        assert!(segment_inside(&square(), DVec2::new(-5., 0.), DVec2::new(15., 0.)).is_none());
        assert_eq!(chord(&square(), 3.0), Some((0.0, 10.0)));
    }

    #[test]
    fn a_square_without_a_quadrant_is_an_l() {
        let quadrant = |x, y| {
            let at = DVec2::new(6.0, 6.0);
            without_quadrant(&square(), HalfPlane { at, normal: DVec2::X * x }, HalfPlane { at, normal: DVec2::Y * y })
        };
        for (x, y, area) in [(1., 1., 84.), (-1., 1., 76.), (1., -1., 76.), (-1., -1., 64.)] {
            let l = quadrant(x, y).unwrap();
            assert_eq!((l.len(), signed_area(&l)), (6, area));
        }
    }
}
