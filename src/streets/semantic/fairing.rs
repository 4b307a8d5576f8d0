//! Fairing: the doglegs that streets take to meet a port or each other go, and junctions move to where streets go straight on
//! across them. All of it keeps the rules of the repair; what would break one stays as it was.

use super::Work;
use super::proposal::Join;
use crate::network::{Edge, EdgeIx, VertexIx};
use crate::space::{Bounds, distance_to_segment, quantize};
use crate::streets::MadeBy;
use glam::DVec2;

/// Least cosine of the angle between a port's street and the stub that it begins as.
const PORT: f64 = 0.93;

/// Greatest cosine of the angle between two streets of which one goes on as the other.
const THROUGH: f64 = -0.87;

/// Metres from which moving a junction is worth it.
const WORTH: f64 = 0.5;

/// Rounds: a junction that has moved lets its neighbours move.
const ROUNDS: usize = 3;

impl Work<'_> {
    /// Makes the streets of the finished cell fair.
    pub(super) fn make_fair(&mut self) {
        if self.dogleg > 0.0 {
            self.straighten_streets();
            for _ in 0..ROUNDS {
                self.align_junctions();
            }
        }
    }

    /// Lays streets straight from end to end that are within [`Work::dogleg`] of it.
    fn straighten_streets(&mut self) {
        for chain in self.canvas.graph.chains(|v| self.canvas.is_end(v)) {
            let vertices = self.canvas.graph.chain_vertices(&chain);
            let (first, last) = (vertices[0], vertices[vertices.len() - 1]);
            let g = &self.canvas.graph;
            let (a, b) = (g.at(first), g.at(last));
            let off = vertices.iter().map(|v| distance_to_segment(g.at(*v), a, b)).fold(0.0, f64::max);
            let pinned = vertices.iter().any(|v| self.canvas.nodes[*v as usize].pinned);
            if vertices.len() == 2 || first == last || off > self.dogleg || pinned {
                continue;
            }
            let made_by = self.maker(&chain);
            let edges: Vec<EdgeIx> = chain.iter().map(|(e, _)| *e).collect();
            self.proposal.line(&[a, b], self.rejoin(first), self.rejoin(last));
            if self.leaves_port(first, b) && self.leaves_port(last, a) && self.take_for_proposal(&edges).is_some() {
                self.canvas.add_edge(first, last, made_by);
            }
        }
    }

    /// Moves junctions to where the streets that go on across them do so straight.
    fn align_junctions(&mut self) {
        for v in 0..self.canvas.graph.vertex_count() as VertexIx {
            let node = self.canvas.nodes[v as usize];
            if self.canvas.graph.degree(v) < 3 || node.port.is_some() || node.pinned {
                continue;
            }
            let arms: Vec<VertexIx> = self.canvas.graph.neighbours(v).collect();
            let Some(to) = self.straight_on(v, &arms) else { continue };
            let moved = to.distance(self.canvas.graph.at(v));
            if moved < WORTH || moved > self.dogleg || !arms.iter().all(|w| self.leaves_port(*w, to)) {
                continue;
            }
            self.proposal.clear();
            self.proposal.push(to, Join::Free(false));
            for (i, w) in arms.iter().enumerate() {
                let join = self.rejoin(*w);
                self.proposal.push(self.canvas.graph.at(*w), join);
                self.proposal.edges.push((0, i + 1));
            }
            let edges = self.canvas.graph.edges_at(v).to_vec();
            if let Some(taken) = self.take_for_proposal(&edges) {
                let there = self.canvas.add_vertex(to, node);
                for edge in taken {
                    self.canvas.add_edge(there, edge.other(v), edge.data);
                }
            }
        }
    }

    /// Where the streets from `arms` that go on across `v` do so straight; `None` where none does.
    fn straight_on(&self, v: VertexIx, arms: &[VertexIx]) -> Option<DVec2> {
        let g = &self.canvas.graph;
        let at = g.at(v);
        let way = |i: usize| (g.at(arms[i]) - at).normalize_or_zero();
        let mut pairs: Vec<(f64, usize, usize)> = (0..arms.len())
            .flat_map(|i| (0..i).map(move |k| (i, k)))
            .map(|(i, k)| (way(i).dot(way(k)), i, k))
            .filter(|p| p.0 < THROUGH)
            .collect();
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
        let &(_, i, k) = pairs.first()?;
        let (a, b) = (g.at(arms[i]), g.at(arms[k]));
        // The other street: one across, or one that ends here.
        let across = pairs.iter().find(|p| ![p.1, p.2].iter().any(|x| [i, k].contains(x)));
        let ending = (0..arms.len()).find(|x| ![i, k].contains(x));
        let (c, d) = match across {
            Some(&(_, x, y)) => (g.at(arms[x]), g.at(arms[y])),
            None => (g.at(arms[ending?]), at),
        };
        let (ab, cd) = (b - a, d - c);
        let sine = ab.perp_dot(cd);
        if sine.abs() < 0.5 * ab.length() * cd.length() {
            return None;
        }
        let t = (c - a).perp_dot(cd) / sine;
        (0.0..=1.0).contains(&t).then(|| quantize(a + ab * t))
    }

    /// How a new street meets the vertex `v` in the place of the one that goes: a dead end is a free end.
    fn rejoin(&self, v: VertexIx) -> Join {
        if self.canvas.is_dead_end(v) { Join::Free(false) } else { Join::At(v) }
    }

    /// Whether a straight street from `v` to `to` leaves the main street about squarely, if `v` is a port.
    fn leaves_port(&self, v: VertexIx, to: DVec2) -> bool {
        self.canvas.nodes[v as usize].port.is_none_or(|port| {
            let port = &self.brief.ports[port];
            (to - port.at).normalize_or_zero().dot(port.inward) >= PORT
        })
    }

    /// Takes edges away if the proposal may be built in their place, and returns what they were; else they stay.
    fn take_for_proposal(&mut self, edges: &[EdgeIx]) -> Option<Vec<Edge<MadeBy>>> {
        let taken: Vec<_> = edges.iter().filter_map(|e| self.canvas.graph.remove_edge(*e)).collect();
        let reach = self.relaxed.gap.max(self.relaxed.wall_gap).max(30.0) + 1.0;
        self.canvas.gather(Bounds::of(self.proposal.points.iter().copied()), reach, &mut self.near);
        if self.checker.check(&self.canvas, &self.proposal, &self.near, &self.relaxed) {
            return Some(taken);
        }
        for edge in taken {
            self.canvas.add_edge(edge.a, edge.b, edge.data);
        }
        None
    }
}
