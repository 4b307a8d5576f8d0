//! Fairing: doglegs, which streets take to meet a port or each other, are straightened, and junctions move to where streets
//! cross them straight. A change that breaks a rule of the [refit](super::refit) is not made.

use super::draft::Draft;
use super::refit::{Line, Refit};
use crate::network::{EdgeIx, VertexIx};
use crate::space::{distance_to_segment, quantize};
use glam::DVec2;

/// Greatest cosine of the angle between two streets at a junction of which one continues the other.
const THROUGH: f64 = -0.87;

/// Least distance that a junction is moved, in metres.
const WORTH: f64 = 0.5;

/// Number of rounds in which the new places of junctions are found: a junction that moves lets its neighbours move.
const ROUNDS: usize = 3;

/// Greatest number of streets at a junction that may be moved.
const MOST_ARMS: usize = 6;

/// Makes the streets of a repaired cell fair, unless streets may wind there.
pub fn make_fair(draft: &mut Draft<'_>) {
    if draft.rules.dogleg > 0.0 {
        let mut fairing = Fairing {
            refit: Refit {
                canvas: &mut draft.canvas,
                near: &mut draft.trial.near,
                ports: draft.brief.ports,
                limits: draft.rules.repair,
            },
            dogleg: draft.rules.dogleg,
        };
        fairing.straighten_streets();
        fairing.align_junctions();
    }
}

/// The fairing of one cell.
struct Fairing<'d> {
    refit: Refit<'d>,
    /// Greatest distance between a street and its chord at which the street is straightened, in metres.
    dogleg: f64,
}

impl Fairing<'_> {
    /// Straightens streets that lie within [`Fairing::dogleg`] of the line between their ends.
    fn straighten_streets(&mut self) {
        for chain in self.refit.canvas.graph.chains(|v| self.refit.canvas.is_end(v)) {
            if chain.len() == 1 {
                continue;
            }
            let vertices = self.refit.canvas.graph.chain_vertices(&chain);
            let (from, to) = (vertices[0], vertices[vertices.len() - 1]);
            let g = &self.refit.canvas.graph;
            let (a, b) = (g.at(from), g.at(to));
            let near = |v: &VertexIx| distance_to_segment(g.at(*v), a, b) <= self.dogleg;
            let inner = &vertices[1..vertices.len() - 1];
            let fixed = |v: &VertexIx| self.refit.canvas.nodes[*v as usize].is_fixed();
            if from == to || !inner.iter().all(near) || inner.iter().any(fixed) {
                continue;
            }
            let edges: Vec<EdgeIx> = chain.iter().map(|(e, _)| *e).collect();
            let length: f64 = edges.iter().map(|e| g.segment(*e)).map(|(a, b)| a.distance(b)).sum();
            let line = Line { from, to, a, b, was: (0, edges.len()) };
            let is_long = line.length() >= self.refit.limits.min_piece;
            if is_long
                && self.refit.keeps_way(line.length(), length, line.length())
                && self.refit.lines_fit(&[line], &edges)
            {
                let made = self.refit.canvas.made(&chain);
                for edge in edges {
                    self.refit.canvas.graph.remove_edge(edge);
                }
                self.refit.canvas.add_last_edge(from, to, made);
            }
        }
    }

    /// Moves junctions to where streets cross them straight.
    fn align_junctions(&mut self) {
        // First it is seen where all would come to lie if all could, then each is moved there, and then those next to one
        // that could not.
        let g = &self.refit.canvas.graph;
        let mut places: Vec<DVec2> = g.vertices().map(|v| g.at(v)).collect();
        let mut restless: Vec<bool> = g.vertices().map(|v| g.degree(v) > 2).collect();
        for _ in 0..ROUNDS {
            for v in g.vertices() {
                if std::mem::take(&mut restless[v as usize])
                    && let Some(to) = self.straight_on(v, &places)
                    && to != places[v as usize]
                {
                    places[v as usize] = to;
                    g.neighbours(v).for_each(|w| restless[w as usize] = true);
                }
            }
        }
        restless.fill(false);
        for v in 0..places.len() as VertexIx {
            let to = places[v as usize];
            if to != self.refit.canvas.graph.at(v) && !self.move_junction(v, to) {
                let g = &self.refit.canvas.graph;
                places[v as usize] = g.at(v);
                g.neighbours(v).for_each(|w| restless[w as usize] = true);
            }
        }
        for v in (0..places.len() as VertexIx).filter(|v| restless[*v as usize]) {
            if let Some(to) = self.straight_on(v, &places)
                && self.move_junction(v, to)
            {
                places[v as usize] = to;
            }
        }
    }

    /// Moves the junction `v` if the distance is worth it and no rule is broken; returns whether it moved.
    fn move_junction(&mut self, v: VertexIx, to: DVec2) -> bool {
        let g = &self.refit.canvas.graph;
        let at = g.at(v);
        if to.distance_squared(at) < WORTH * WORTH {
            return false;
        }
        let line = |(i, w)| Line { from: v, to: w, a: to, b: g.at(w), was: (i, i + 1) };
        let lines: Vec<Line> = g.neighbours(v).enumerate().map(line).collect();
        let mut pairs = lines.iter().enumerate().flat_map(|(i, x)| lines[..i].iter().map(move |y| (x, y)));
        let least = self.refit.limits.min_piece;
        let is_long = |line: &Line| line.length() >= least.min(at.distance(line.b));
        let gone = g.edges_at(v).to_vec();
        let fits = lines.iter().all(is_long)
            && pairs.all(|(x, y)| {
                let before = at.distance(x.b) + at.distance(y.b);
                self.refit.keeps_way(x.length() + y.length(), before, x.b.distance(y.b))
                    && self.refit.keep_apart(x, y)
                    && x.way_from(v).dot(y.way_from(v)) <= self.refit.limits.junction_cosine
            })
            && self.refit.lines_fit(&lines, &gone);
        if fits {
            self.refit.canvas.move_vertex(v, to);
        }
        fits
    }

    /// The place at which streets cross the junction `v` straight if all vertices lie at `places`. `None` if no street crosses
    /// it, if the place is too far away, or if the junction may not move.
    fn straight_on(&self, v: VertexIx, places: &[DVec2]) -> Option<DVec2> {
        let node = self.refit.canvas.nodes[v as usize];
        let g = &self.refit.canvas.graph;
        // The end of a curve belongs to its shape.
        let ends_curve = || g.neighbours(v).any(|w| g.degree(w) == 2 && self.refit.canvas.nodes[w as usize].shaped);
        if g.degree(v) < 3 || node.port.is_some() || node.is_fixed() || ends_curve() {
            return None;
        }
        let at = places[v as usize];
        let mut arms = [(DVec2::ZERO, DVec2::ZERO); MOST_ARMS];
        for (arm, w) in arms.iter_mut().zip(g.neighbours(v)) {
            let end = places[w as usize];
            *arm = (end, (end - at).normalize_or_zero());
        }
        let arms = arms.get(..g.degree(v))?;
        // Of the pairs of streets of which one goes on as the other, the straightest without these.
        let straightest = |without: [usize; 2]| {
            let mut best = (THROUGH, None);
            for i in (0..arms.len()).filter(|i| !without.contains(i)) {
                for k in (0..i).filter(|k| !without.contains(k)) {
                    let cosine = arms[i].1.dot(arms[k].1);
                    if cosine < best.0 {
                        best = (cosine, Some([i, k]));
                    }
                }
            }
            best.1
        };
        let first = straightest([usize::MAX; 2])?;
        let [a, b] = first.map(|i| arms[i].0);
        // The other street: one across, or one that ends here.
        let [c, d] = match straightest(first) {
            Some(second) => second.map(|i| arms[i].0),
            None => [arms[(0..arms.len()).find(|i| !first.contains(i))?].0, at],
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
}
