//! Fairing: the doglegs that streets take to meet a port or each other go, junctions move to where streets go straight on
//! across them, and bends become curves. All of it keeps the rules of the repair; what would break one stays as it was.

use super::Work;
use super::canvas::Node;
use super::proposal::Join;
use crate::network::{Edge, EdgeIx, VertexIx};
use crate::space::{Bounds, distance_to_segment, math::angle_between, quantize};
use crate::streets::MadeBy;
use crate::town::FieldKind;
use glam::DVec2;
use std::f64::consts::PI;

/// Least cosine of the angle between a port's street and the stub that it begins as.
const PORT: f64 = 0.93;

/// Greatest cosine of the angle between two streets of which one goes on as the other.
const THROUGH: f64 = -0.87;

/// Metres from which moving a junction is worth it.
const WORTH: f64 = 0.5;

/// Rounds: a junction that has moved lets its neighbours move.
const ROUNDS: usize = 3;

/// Turn of a street, in radians, from which a bend becomes a curve, and by how much the curve turns at once at most.
const BEND: f64 = 0.3;
const STEP: f64 = 0.4;

/// Length of street at each side of a bend that becomes a curve, in metres, and as a share of what is there.
const CURVE: f64 = 20.0;
const CURVE_SHARE: f64 = 0.45;

impl Work<'_> {
    /// Makes the streets of the finished cell fair.
    pub(super) fn make_fair(&mut self) {
        if self.dogleg > 0.0 {
            self.straighten_streets();
            for _ in 0..ROUNDS {
                self.align_junctions();
            }
        }
        // Blocks of a grid have corners.
        if self.brief.style.main.field != FieldKind::Grid {
            self.round_bends();
        }
    }

    /// The streets, as the vertices along them, that may be changed.
    fn loose_streets(&self) -> Vec<(Vec<EdgeIx>, Vec<VertexIx>, MadeBy)> {
        let g = &self.canvas.graph;
        let chains = g.chains(|v| self.canvas.is_end(v)).into_iter();
        let streets = chains.map(|c| (c.iter().map(|(e, _)| *e).collect(), g.chain_vertices(&c), self.maker(&c)));
        let is_pinned = |v: &VertexIx| self.canvas.nodes[*v as usize].pinned;
        streets
            .filter(|(_, line, _)| line.len() > 2 && line[0] != line[line.len() - 1] && !line.iter().any(is_pinned))
            .collect()
    }

    /// Lays streets straight from end to end that are within [`Work::dogleg`] of it.
    fn straighten_streets(&mut self) {
        for (edges, vertices, made_by) in self.loose_streets() {
            let (first, last) = (vertices[0], vertices[vertices.len() - 1]);
            let g = &self.canvas.graph;
            let (a, b) = (g.at(first), g.at(last));
            let off = vertices.iter().map(|v| distance_to_segment(g.at(*v), a, b)).fold(0.0, f64::max);
            if off <= self.dogleg && self.leaves_port(first, b) && self.leaves_port(last, a) {
                self.lay_again(&edges, [first, last], &[a, b], made_by);
            }
        }
    }

    /// Rounds the bends of streets.
    fn round_bends(&mut self) {
        for (edges, vertices, made_by) in self.loose_streets() {
            let line: Vec<DVec2> = vertices.iter().map(|v| self.canvas.graph.at(*v)).collect();
            let mut rounded = vec![line[0]];
            for w in line.windows(3) {
                let turn = PI - angle_between(w[0] - w[1], w[2] - w[1]);
                if turn < BEND {
                    rounded.push(w[1]);
                    continue;
                }
                let along = CURVE.min(CURVE_SHARE * w[0].distance(w[1]).min(w[1].distance(w[2])));
                let [from, to] = [w[0], w[2]].map(|p| w[1] + (p - w[1]).normalize_or_zero() * along);
                let steps = (turn / STEP).ceil().max(2.0);
                // A quadratic curve with the bend as its control point.
                let point = |t: f64| from.lerp(w[1], t).lerp(w[1].lerp(to, t), t);
                rounded.extend((0..=steps as usize).map(|i| quantize(point(i as f64 / steps))));
            }
            rounded.push(line[line.len() - 1]);
            if rounded.len() > line.len() {
                self.lay_again(&edges, [vertices[0], vertices[vertices.len() - 1]], &rounded, made_by);
            }
        }
    }

    /// Lays the street between two vertices of which these are the edges along another line, if that may be.
    fn lay_again(&mut self, edges: &[EdgeIx], [first, last]: [VertexIx; 2], line: &[DVec2], made_by: MadeBy) {
        let joins = [first, last].map(|v| self.rejoin(v));
        self.proposal.line(line, joins[0], joins[1]);
        if self.take_for_proposal(edges).is_some() {
            let mut before = first;
            for at in &line[1..line.len() - 1] {
                let v = self.canvas.add_vertex(*at, Node::default());
                self.canvas.add_edge(before, v, made_by);
                before = v;
            }
            self.canvas.add_edge(before, last, made_by);
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
