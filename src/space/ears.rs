//! Triangles of simple polygons.

use crate::space::orient;
use glam::DVec2;

/// Triangles of a simple counter-clockwise polygon as indices of its corners, by cutting off ears. Triangles of a polygon that
/// crosses itself may overlap or run clockwise.
pub fn ears(polygon: &[DVec2]) -> Vec<[usize; 3]> {
    let mut left: Vec<usize> = (0..polygon.len()).collect();
    let mut out = Vec::with_capacity(polygon.len().saturating_sub(2));
    while left.len() > 3 {
        let n = left.len();
        let corner = |k: usize| [left[(k + n - 1) % n], left[k], left[(k + 1) % n]];
        let is_ear = |k: &usize| {
            let t = corner(*k);
            let [a, b, c] = t.map(|i| polygon[i]);
            let holds = |p: DVec2| orient(a, b, p) >= 0.0 && orient(b, c, p) >= 0.0 && orient(c, a, p) >= 0.0;
            orient(a, b, c) > 0.0 && !left.iter().any(|i| !t.contains(i) && holds(polygon[*i]))
        };
        // A polygon that crosses itself runs out of ears; its rest is cut in order.
        let k = (0..n).find(is_ear).unwrap_or(0);
        out.push(corner(k));
        left.remove(k);
    }
    out.extend(<[usize; 3]>::try_from(left).ok());
    out
}
