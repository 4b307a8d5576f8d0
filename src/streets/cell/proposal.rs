//! Proposals: streets that may be added to a cell.

use super::obstacle::nearest;
use super::rules::{Limits, WEDGE};
use crate::network::{EdgeIx, VertexIx};
use crate::space::{quantize, segment_crossing};
use glam::DVec2;

/// How a point of a proposal meets the streets that are built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Join {
    /// The point is a new vertex; the flag says whether the network may go on from it.
    Free(bool),
    /// The point is this vertex.
    At(VertexIx),
    /// The point divides this edge.
    On(EdgeIx),
}

/// Streets that may be added to a cell.
#[derive(Clone, Debug, Default)]
pub struct Proposal {
    /// Points.
    pub points: Vec<DVec2>,
    /// How each point meets the streets that are built.
    pub joins: Vec<Join>,
    /// Whether each point lies on a curve that keeps its shape.
    pub shaped: Vec<bool>,
    /// Straight edges between points.
    pub edges: Vec<(usize, usize)>,
}

impl Proposal {
    /// Removes all points and edges.
    pub fn clear(&mut self) {
        self.points.clear();
        self.joins.clear();
        self.shaped.clear();
        self.edges.clear();
    }

    /// Adds a point.
    pub fn push(&mut self, at: DVec2, join: Join) {
        self.points.push(quantize(at));
        self.joins.push(join);
        self.shaped.push(false);
    }

    /// Leaves out the points without an edge.
    pub fn drop_unused_points(&mut self) {
        let mut slots = vec![0; self.points.len()];
        let mut kept = 0;
        for (i, slot) in slots.iter_mut().enumerate() {
            if self.edges.iter().any(|e| e.0 == i || e.1 == i) {
                self.points[kept] = self.points[i];
                self.joins[kept] = self.joins[i];
                self.shaped[kept] = self.shaped[i];
                *slot = kept;
                kept += 1;
            }
        }
        self.points.truncate(kept);
        self.joins.truncate(kept);
        self.shaped.truncate(kept);
        self.edges.iter_mut().for_each(|e| *e = (slots[e.0], slots[e.1]));
    }

    /// Makes this proposal the street along `line`, whose ends join the network by `first` and `last`.
    pub fn line(&mut self, line: &[DVec2], first: Join, last: Join) {
        self.clear();
        for (i, p) in line.iter().enumerate() {
            let join = if i == 0 {
                first
            } else if i + 1 == line.len() {
                last
            } else {
                Join::Free(false)
            };
            self.push(*p, join);
            if i > 0 {
                self.edges.push((i - 1, i));
            }
        }
    }

    /// Length in metres of the shortest way from one point to another along the edges of the proposal.
    pub fn way(&self, from: usize, to: usize) -> f64 {
        let mut far = vec![f64::INFINITY; self.points.len()];
        far[from] = 0.0;
        // A street has few edges, so that every round of this settles many points.
        for _ in 0..self.points.len() {
            let mut changed = false;
            for &(a, b) in &self.edges {
                let length = self.points[a].distance(self.points[b]);
                for (a, b) in [(a, b), (b, a)] {
                    if far[a] + length < far[b] {
                        (far[b], changed) = (far[a] + length, true);
                    }
                }
            }
            if !changed {
                break;
            }
        }
        far[to]
    }

    /// For each point the least point that the edges of the proposal connect it to: its connected part.
    pub fn parts(&self) -> Vec<usize> {
        let mut parts: Vec<usize> = (0..self.points.len()).collect();
        let mut changed = true;
        while std::mem::take(&mut changed) {
            for &(a, b) in &self.edges {
                let least = parts[a].min(parts[b]);
                changed |= parts[a] != parts[b];
                (parts[a], parts[b]) = (least, least);
            }
        }
        parts
    }

    /// Whether every connected part meets a street that is built.
    pub fn every_part_is_joined(&self) -> bool {
        let parts = self.parts();
        let joined = |part: &usize| (0..self.points.len()).any(|i| parts[i] == *part && self.joined(i));
        parts.iter().all(joined)
    }

    /// Whether a point meets a street that is built.
    pub fn joined(&self, point: usize) -> bool {
        !matches!(self.joins[point], Join::Free(_))
    }

    /// Whether the last edge of each arm keeps to `limits` towards the rest of the proposal. Only arms that meet a street count:
    /// their ends may have moved.
    pub fn ends_keep_apart(&self, limits: &Limits) -> bool {
        let p = self;
        let degree = |x: usize| p.edges.iter().filter(|e| e.0 == x || e.1 == x).count();
        for (i, &(a, b)) in p.edges.iter().enumerate() {
            // Ends that meet nothing lie where the patch has them, or nearer.
            let moved = |x: usize| matches!(p.joins[x], Join::At(_) | Join::On(_)) && degree(x) == 1;
            let Some((end, inner)) = [(a, b), (b, a)].into_iter().find(|(x, _)| moved(*x)) else { continue };
            let (e, f) = (p.points[end], p.points[inner]);
            if e.distance(f) < 2.0 {
                return false;
            }
            let crossing = degree(inner) > 2;
            let (low, high) = (e.min(f) - limits.gap, e.max(f) + limits.gap);
            for (k, &(c, d)) in p.edges.iter().enumerate() {
                if k == i {
                    continue;
                }
                let (s, t) = (p.points[c], p.points[d]);
                if c == inner || d == inner {
                    let other = if c == inner { t } else { s };
                    let cosine = (e - f).normalize_or_zero().dot((other - f).normalize_or_zero());
                    if cosine > if crossing { limits.junction_cosine } else { 0.0 } {
                        return false;
                    }
                    continue;
                }
                if s.max(t).cmplt(low).any() || s.min(t).cmpgt(high).any() {
                    continue;
                }
                if segment_crossing(e, f, s, t).is_some() {
                    return false;
                }
                for (q, r) in [(e, nearest(e, s, t)), (nearest(s, e, f), s), (nearest(t, e, f), t)] {
                    if q.distance(r) < (WEDGE * (q.distance(f) + f.distance(r))).min(limits.gap) {
                        return false;
                    }
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_what_edges_connect() {
        let mut p = Proposal::default();
        for i in 0..7 {
            p.push(DVec2::X * f64::from(i), if i == 6 { Join::At(9) } else { Join::Free(false) });
        }
        p.edges = vec![(5, 6), (1, 3), (4, 3), (2, 5), (0, 4)];
        assert_eq!(p.parts(), [0, 0, 2, 0, 0, 2, 2]);
        assert!(!p.every_part_is_joined());
        p.joins[3] = Join::On(2);
        assert!(p.every_part_is_joined());
    }

    #[test]
    fn points_without_an_edge_are_left_out() {
        let mut p = Proposal::default();
        for i in 0..6 {
            p.push(DVec2::X * f64::from(i), if i == 4 { Join::At(9) } else { Join::Free(false) });
        }
        p.shaped[5] = true;
        p.edges = vec![(5, 1), (4, 1)];
        p.drop_unused_points();
        assert_eq!(p.points, [1.0, 4.0, 5.0].map(|x| DVec2::X * x));
        assert_eq!((&p.joins[1], &p.shaped[..]), (&Join::At(9), &[false, false, true][..]));
        assert_eq!(p.edges, [(2, 0), (1, 0)]);
    }
}
