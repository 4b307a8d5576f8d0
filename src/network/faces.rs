//! Faces of a planar graph, by walking half-edges.

use crate::network::{EdgeIx, PlanarGraph, VertexIx};
use crate::space::{math::quarters, signed_area};
use glam::DVec2;

/// An edge with a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfEdge {
    /// The edge.
    pub edge: EdgeIx,
    /// Whether it runs from the edge's `a` to its `b`.
    pub forward: bool,
}

/// A face: the closed walk around it, with the face on the left. A dangling edge is walked on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Half-edges in walking order.
    pub walk: Vec<HalfEdge>,
    /// First vertex of each half-edge of `walk`.
    pub vertices: Vec<VertexIx>,
    /// Positions of `vertices`; counter-clockwise for inner faces.
    pub polygon: Vec<DVec2>,
}

impl Face {
    /// Area in square metres; negative for the outer face of a component.
    pub fn area(&self) -> f64 {
        signed_area(&self.polygon)
    }
}

/// Memory is reserved for faces with this many half-edges.
const RESERVED: usize = 16;

impl<E: Clone> PlanarGraph<E> {
    /// All faces, outer ones (negative area) included, ordered by their lowest half-edge.
    pub fn faces(&self) -> Vec<Face> {
        // Half-edge 2e runs a to b, 2e + 1 back.
        let slots = self.edges().map(|(e, _)| e as usize + 1).max().unwrap_or(0) * 2;
        let mut next = vec![usize::MAX; slots];
        let mut order: Vec<(f64, usize)> = Vec::new();
        for v in self.vertices() {
            let leaving = |e: EdgeIx| 2 * e as usize + usize::from(self.edge(e).a != v);
            match *self.edges_at(v) {
                [] => {}
                [e] => next[leaving(e) ^ 1] = leaving(e),
                [e, f] => {
                    next[leaving(e) ^ 1] = leaving(f);
                    next[leaving(f) ^ 1] = leaving(e);
                }
                ref edges => {
                    order.clear();
                    let angle = |e: EdgeIx| quarters(self.at(self.edge(e).other(v)) - self.at(v));
                    order.extend(edges.iter().map(|e| (angle(*e), leaving(*e))));
                    order.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
                    // After a half-edge that comes in, the face on its left continues along the next edge clockwise.
                    for i in 0..order.len() {
                        next[order[(i + 1) % order.len()].1 ^ 1] = order[i].1;
                    }
                }
            }
        }
        let mut seen = vec![false; slots];
        let mut faces = Vec::new();
        for start in 0..slots {
            if seen[start] || next[start] == usize::MAX {
                continue;
            }
            let mut face = Face {
                walk: Vec::with_capacity(RESERVED),
                vertices: Vec::with_capacity(RESERVED),
                polygon: Vec::with_capacity(RESERVED),
            };
            let mut h = start;
            while !seen[h] {
                seen[h] = true;
                let edge = self.edge((h / 2) as EdgeIx);
                let forward = h % 2 == 0;
                let v = if forward { edge.a } else { edge.b };
                face.walk.push(HalfEdge { edge: (h / 2) as EdgeIx, forward });
                face.vertices.push(v);
                face.polygon.push(self.at(v));
                h = next[h];
            }
            faces.push(face);
        }
        faces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_squares_and_a_dangling_edge() {
        let mut g = PlanarGraph::new();
        let at = [(0., 0.), (1., 0.), (2., 0.), (2., 1.), (1., 1.), (0., 1.), (0.5, 0.5)];
        let v = at.map(|(x, y)| g.add_vertex(DVec2::new(x, y)));
        for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0), (1, 4), (0, 6)] {
            g.add_edge(v[a], v[b], ());
        }
        let faces = g.faces();
        let mut areas: Vec<_> = faces.iter().map(Face::area).collect();
        areas.sort_by(f64::total_cmp);
        assert_eq!(areas, [-2.0, 1.0, 1.0]);
        assert!(faces.iter().any(|f| f.walk.len() == 6 && f.area() == 1.0), "the dangling edge is walked twice");
    }
}
