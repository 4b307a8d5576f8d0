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

/// Rounds in which it is seen where junctions would come to lie: one that has moved lets its neighbours move.
const ROUNDS: usize = 3;

impl Work<'_> {
    /// Makes the streets of the finished cell fair.
    pub(super) fn make_fair(&mut self) {
        if self.dogleg > 0.0 {
            self.straighten_streets();
            self.align_junctions();
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
            if !self.leaves_port(first, b) || !self.leaves_port(last, a) {
                continue;
            }
            let taken = self.take_away(&edges);
            if self.proposal_fits() {
                self.canvas.add_last_edge(first, last, made_by);
            } else {
                self.put_back(&edges, taken);
            }
        }
    }

    /// Moves junctions to where the streets that go on across them do so straight.
    fn align_junctions(&mut self) {
        // First it is seen where all would come to lie if all could, then each is moved there, and then those next to one
        // that could not.
        let g = &self.canvas.graph;
        let mut places: Vec<DVec2> = g.vertices().map(|v| g.at(v)).collect();
        for _ in 0..ROUNDS {
            for v in 0..places.len() as VertexIx {
                if let Some(to) = self.straight_on(v, &places) {
                    places[v as usize] = to;
                }
            }
        }
        for v in 0..places.len() as VertexIx {
            self.move_junction(v, places[v as usize]);
        }
        let g = &self.canvas.graph;
        places.iter_mut().zip(g.vertices()).for_each(|(p, v)| *p = g.at(v));
        for v in 0..places.len() as VertexIx {
            if let Some(to) = self.straight_on(v, &places)
                && self.move_junction(v, to)
            {
                places[v as usize] = to;
            }
        }
    }

    /// Moves the junction `v` if that is worth it and keeps the rules.
    fn move_junction(&mut self, v: VertexIx, to: DVec2) -> bool {
        let g = &self.canvas.graph;
        if to.distance_squared(g.at(v)) < WORTH * WORTH || !g.neighbours(v).all(|w| self.leaves_port(w, to)) {
            return false;
        }
        self.proposal.clear();
        self.proposal.push(to, Join::Free(false));
        for (i, w) in g.neighbours(v).enumerate() {
            self.proposal.push(g.at(w), self.rejoin(w));
            self.proposal.edges.push((0, i + 1));
        }
        let edges = g.edges_at(v).to_vec();
        let taken = self.take_away(&edges);
        let fits = self.proposal_fits();
        self.put_back(&edges, taken);
        if fits {
            self.canvas.move_vertex(v, to);
        }
        fits
    }

    /// Where the streets that go on across the junction `v` do so straight, with all vertices at these places; `None` where
    /// none does, where it is too far and for what may not move.
    fn straight_on(&self, v: VertexIx, places: &[DVec2]) -> Option<DVec2> {
        let node = self.canvas.nodes[v as usize];
        let g = &self.canvas.graph;
        if g.degree(v) < 3 || node.port.is_some() || node.pinned {
            return None;
        }
        let at = places[v as usize];
        let arms: Vec<DVec2> = g.neighbours(v).map(|w| places[w as usize]).collect();
        let ways: Vec<DVec2> = arms.iter().map(|arm| (arm - at).normalize_or_zero()).collect();
        // Of the pairs of streets of which one goes on as the other, the straightest without these.
        let straightest = |without: [usize; 2]| {
            let rest = || (0..arms.len()).filter(move |x| !without.contains(x));
            let pairs = rest().flat_map(|i| rest().take_while(move |k| *k < i).map(move |k| (i, k)));
            let pairs = pairs.map(|(i, k)| (ways[i].dot(ways[k]), i, k)).filter(|p| p.0 < THROUGH);
            pairs.min_by(|x, y| x.0.total_cmp(&y.0))
        };
        let (_, i, k) = straightest([usize::MAX; 2])?;
        let (a, b) = (arms[i], arms[k]);
        // The other street: one across, or one that ends here.
        let (c, d) = match straightest([i, k]) {
            Some((_, x, y)) => (arms[x], arms[y]),
            None => (arms[(0..arms.len()).find(|x| ![i, k].contains(x))?], at),
        };
        let (ab, cd) = (b - a, d - c);
        let sine = ab.perp_dot(cd);
        if sine.abs() < 0.5 * ab.length() * cd.length() {
            return None;
        }
        let t = (c - a).perp_dot(cd) / sine;
        let to = quantize(a + ab * t);
        ((0.0..=1.0).contains(&t) && to.distance(g.at(v)) <= self.dogleg).then_some(to)
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

    fn take_away(&mut self, edges: &[EdgeIx]) -> Vec<Edge<MadeBy>> {
        edges.iter().filter_map(|e| self.canvas.graph.remove_edge(*e)).collect()
    }

    fn put_back(&mut self, edges: &[EdgeIx], taken: Vec<Edge<MadeBy>>) {
        edges.iter().zip(taken).for_each(|(e, edge)| self.canvas.graph.restore_edge(*e, edge));
    }

    /// Whether the proposal keeps the rules of the repair.
    fn proposal_fits(&mut self) -> bool {
        let limits = &self.relaxed;
        if !self.checker.find_joints(&self.canvas, &self.proposal, limits) {
            return false;
        }
        let reach = limits.gap.max(limits.wall_gap).max(30.0) + 1.0;
        let bounds = Bounds::of(self.proposal.points.iter().copied()).grown(reach);
        self.canvas.gather_segs(bounds, &mut self.near);
        self.checker.check_apart(&self.canvas, &self.proposal, &self.near, limits)
    }
}
