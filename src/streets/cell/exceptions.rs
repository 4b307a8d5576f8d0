//! Exceptions: where the finished streets of a cell break a rule of the style, and what made them.

use super::canvas::Maker;
use super::checker::BETWEEN;
use super::draft::Draft;
use super::obstacle::nearest_pairs;
use super::rules::NEAR_ALONG;
use crate::network::{EdgeIx, VertexIx};
use crate::seam::APPROACH_LENGTH;
use crate::space::{Bounds, distance_to_segment, line_length, math, segment_distance, segments};
use crate::streets::filler::{Cause, Exception, Rule};
use glam::DVec2;

/// Angle in radians, length and distance in metres by which a street may miss a rule: more than positions lose when they are
/// rounded to the grid, again and again.
const SLACK: (f64, f64) = (0.005, 0.1);

/// A finished street.
pub struct Finished<'a> {
    /// The vertices at its ends.
    pub ends: [VertexIx; 2],
    /// Its vertices in the graph.
    pub vertices: Vec<VertexIx>,
    /// Its edges in the graph.
    pub chain: Vec<(EdgeIx, bool)>,
    /// Its line.
    pub line: &'a [DVec2],
}

/// What is wrong with the streets of a finished cell.
struct Inspection<'d, 's> {
    draft: &'d Draft<'d>,
    streets: &'s [Finished<'s>],
    arms: Arms,
    found: Vec<Exception>,
}

/// A street at one of its ends.
#[derive(Clone, Copy, Default)]
struct Arm {
    /// The vertex at the other end.
    to: VertexIx,
    /// Its length in metres.
    length: f64,
    /// The first step of its line from here.
    way: DVec2,
    /// Whether it connects a pinned piece here.
    is_link: bool,
}

/// The streets that end at each vertex.
struct Arms {
    /// Where those of each vertex begin in `arms`; one number more than there are vertices.
    first: Vec<usize>,
    arms: Vec<Arm>,
}

impl Arms {
    fn new(draft: &Draft<'_>, streets: &[Finished<'_>]) -> Self {
        let mut first = vec![0; draft.canvas.graph.vertex_count() + 1];
        for v in streets.iter().flat_map(|s| s.ends) {
            first[v as usize + 1] += 1;
        }
        for v in 1..first.len() {
            first[v] += first[v - 1];
        }
        let mut free = first.clone();
        let mut arms = vec![Arm::default(); 2 * streets.len()];
        let mut put = |v: VertexIx, arm: Arm| {
            arms[free[v as usize]] = arm;
            free[v as usize] += 1;
        };
        let is_link = |end: Option<&(EdgeIx, bool)>| end.is_some_and(|(e, _)| is_link(draft, *e));
        for Finished { ends: [a, b], line, chain, .. } in streets {
            let (n, length) = (line.len(), line_length(line));
            put(*a, Arm { to: *b, length, way: line[1] - line[0], is_link: is_link(chain.first()) });
            put(*b, Arm { to: *a, length, way: line[n - 2] - line[n - 1], is_link: is_link(chain.last()) });
        }
        Self { first, arms }
    }

    /// The streets that end at a vertex, in their order.
    fn at(&self, v: VertexIx) -> &[Arm] {
        &self.arms[self.first[v as usize]..self.first[v as usize + 1]]
    }
}

/// Buffers of a search along streets.
#[derive(Default)]
struct Search {
    /// The ends of streets that were reached, with the shortest ways to them in metres.
    reached: Vec<(VertexIx, f64)>,
    open: Vec<(VertexIx, f64)>,
}

/// Whether an edge connects a pinned piece, as near to others as streets may be at all.
fn is_link(draft: &Draft<'_>, edge: EdgeIx) -> bool {
    draft.canvas.graph.edge(edge).data.by == Maker::Link
}

/// Finds the places where `streets`, all of a cell, break a rule of its style.
pub fn exceptions(draft: &Draft<'_>, streets: &[Finished<'_>]) -> Vec<Exception> {
    let arms = Arms::new(draft, streets);
    let mut inspection = Inspection { draft, streets, arms, found: Vec::new() };
    inspection.lengths();
    inspection.junctions();
    inspection.bends();
    inspection.clearances();
    inspection.found
}

impl Inspection<'_, '_> {
    fn report(&mut self, rule: Rule, cause: Cause, at: DVec2) {
        self.found.push(Exception { rule, cause, at });
    }

    fn is_pinned(&self, v: VertexIx) -> bool {
        self.draft.canvas.nodes[v as usize].pinned
    }

    /// Whether a street is of a pinned piece or connects one.
    fn has_pin(&self, street: usize) -> bool {
        let Finished { vertices, chain, .. } = &self.streets[street];
        vertices.iter().any(|v| self.is_pinned(*v)) || chain.iter().any(|(e, _)| is_link(self.draft, *e))
    }

    /// Whether a street that connects a pinned piece ends at a vertex.
    fn is_linked(&self, v: VertexIx) -> bool {
        self.draft.canvas.graph.edges_at(v).iter().any(|e| is_link(self.draft, *e))
    }

    fn is_port(&self, v: VertexIx) -> bool {
        self.draft.canvas.nodes[v as usize].port.is_some()
    }

    /// The build that all edges of a street are of, if that laid a piece.
    fn piece(&self, street: usize) -> Option<u32> {
        let mut made = self.streets[street].chain.iter().map(|(e, _)| self.draft.canvas.graph.edge(*e).data);
        let first = made.next()?;
        (matches!(first.by, Maker::Piece(_)) && made.all(|m| m.build == first.build)).then_some(first.build)
    }

    fn lengths(&mut self) {
        let (asked, fitted) = (self.draft.brief.rules.min_length, self.draft.rules.local.min_length);
        for i in 0..self.streets.len() {
            let street = &self.streets[i];
            let length = line_length(street.line);
            if length >= asked - SLACK.1 {
                continue;
            }
            let [a, b] = street.ends;
            let [port, other] = if self.is_port(b) { [b, a] } else { [a, b] };
            // A port whose street finds no way on, or only that to another port.
            let leads_nowhere = self.is_port(other) || self.draft.canvas.graph.degree(other) == 1;
            let cause = if self.has_pin(i) || self.is_linked(a) || self.is_linked(b) {
                Cause::Pin
            } else if self.is_port(port) && leads_nowhere {
                Cause::Port
            } else if length >= fitted - SLACK.1 {
                Cause::Cell
            } else if self.piece(i).is_some() {
                Cause::Drawing
            } else {
                Cause::Defect
            };
            self.report(Rule::Length, cause, street.line[0]);
        }
    }

    fn junctions(&mut self) {
        let most = (self.draft.rules.local.degree.1 as usize).max(2);
        for v in self.draft.canvas.graph.vertices() {
            let arms = self.arms.at(v);
            let at = self.draft.canvas.graph.at(v);
            let cause = |by_link: bool| if by_link || self.is_pinned(v) { Cause::Pin } else { Cause::Defect };
            let others = || arms.iter().filter(|arm| !arm.is_link).count();
            let degree = (arms.len() > most).then(|| (Rule::Degree, cause(others() <= most)));
            let pairs = arms.iter().enumerate().flat_map(|(i, a)| arms[..i].iter().map(move |b| (a, b)));
            let sharp = pairs.filter(|(a, b)| self.is_sharp(a.way, b.way)).map(|(a, b)| a.is_link || b.is_link);
            let angle = sharp.reduce(|a, b| a && b).map(|by_link| (Rule::Angle, cause(by_link)));
            degree.into_iter().chain(angle).for_each(|(rule, cause)| self.report(rule, cause, at));
        }
    }

    fn is_sharp(&self, a: DVec2, b: DVec2) -> bool {
        math::angle_between(a, b) < self.draft.rules.local.min_angle_deg.to_radians() - SLACK.0
    }

    fn bends(&mut self) {
        for i in 0..self.streets.len() {
            let line = self.streets[i].line;
            for w in line.windows(3).filter(|w| (w[0] - w[1]).dot(w[2] - w[1]) > 0.0) {
                if self.is_sharp(w[0] - w[1], w[2] - w[1]) {
                    let cause = if self.has_pin(i) { Cause::Pin } else { Cause::Defect };
                    self.report(Rule::Angle, cause, w[1]);
                }
            }
        }
    }

    /// Streets that do not meet.
    fn clearances(&mut self) {
        let least = self.draft.brief.rules.clearance - SLACK.1;
        let bounds: Vec<Bounds> =
            self.streets.iter().map(|s| Bounds::of(s.line.iter().copied()).grown(least)).collect();
        let mut order: Vec<usize> = (0..self.streets.len()).collect();
        order.sort_by(|a, b| bounds[*a].min.x.total_cmp(&bounds[*b].min.x).then(a.cmp(b)));
        let mut search = Search::default();
        for (n, &i) in order.iter().enumerate() {
            for &k in order[n + 1..].iter().take_while(|k| bounds[**k].min.x <= bounds[i].max.x) {
                let (a, b) = (self.streets[i].ends, self.streets[k].ends);
                if bounds[i].overlaps(bounds[k]) && !a.iter().any(|v| b.contains(v)) {
                    self.clearance((i, bounds[i]), (k, bounds[k]), least, &mut search);
                }
            }
            self.clearance_of_border(i, bounds[i], least, &mut search);
        }
    }

    /// Distance between two streets, given with the boxes around them that are `least` metres larger.
    fn clearance(
        &mut self,
        (i, around_a): (usize, Bounds),
        (k, around_b): (usize, Bounds),
        least: f64,
        search: &mut Search,
    ) {
        let (a, b) = (self.streets[i].line, self.streets[k].line);
        let near = |p: &(DVec2, DVec2), q: &(DVec2, DVec2)| {
            let (low, high) = (p.0.min(p.1) - least, p.0.max(p.1) + least);
            q.0.max(q.1).cmpge(low).all() && q.0.min(q.1).cmple(high).all()
        };
        let mut worst: Option<(f64, DVec2, DVec2)> = None;
        let in_box = |bounds: Bounds| move |s: &(DVec2, DVec2)| bounds.overlaps(Bounds::of([s.0, s.1]));
        for p in segments(a).filter(in_box(around_b)) {
            for q in segments(b).filter(in_box(around_a)).filter(|q| near(&p, q)) {
                if segment_distance(p.0, p.1, q.0, q.1) >= least {
                    continue;
                }
                for (x, y) in nearest_pairs(p, q) {
                    let distance = x.distance(y);
                    if distance < least
                        && worst.is_none_or(|w| distance < w.0)
                        && self.far_along((i, x), (k, y), distance, search)
                    {
                        worst = Some((distance, x, y));
                    }
                }
            }
        }
        let Some((distance, x, y)) = worst else { return };
        let cause = if self.has_pin(i) || self.has_pin(k) {
            Cause::Pin
        } else if self.on_stub(i, x) || self.on_stub(k, y) {
            Cause::Port
        } else if self.fits_cell(distance) {
            Cause::Cell
        } else if self.piece(i).is_some() && self.piece(i) == self.piece(k) {
            Cause::Drawing
        } else {
            Cause::Defect
        };
        self.report(Rule::Clearance, cause, x);
    }

    /// Distance from the main streets around the cell, at one place for each street at most.
    fn clearance_of_border(&mut self, i: usize, bounds: Bounds, least: f64, search: &mut Search) {
        let brief = self.draft.brief;
        let n = brief.border.len();
        for w in (0..n).filter(|w| brief.street_half_width.get(*w).copied().flatten().is_some()) {
            let (c, d) = (brief.border[w], brief.border[(w + 1) % n]);
            if !Bounds::of([c, d]).overlaps(bounds) {
                continue;
            }
            let mut worst: Option<(f64, DVec2)> = None;
            for (p, q) in segments(self.streets[i].line) {
                for (x, y) in nearest_pairs((p, q), (c, d)) {
                    let distance = x.distance(y);
                    let is_worse = distance < least && worst.is_none_or(|w| distance < w.0);
                    if is_worse && !self.port_near((i, x), y, distance, search) {
                        worst = Some((distance, x));
                    }
                }
            }
            let Some((distance, x)) = worst else { continue };
            let cause = match () {
                () if self.has_pin(i) => Cause::Pin,
                () if self.on_stub(i, x) => Cause::Port,
                () if self.fits_cell(distance) => Cause::Cell,
                () => Cause::Defect,
            };
            self.report(Rule::Clearance, cause, x);
            return;
        }
    }

    /// Whether streets may be so near to each other because the cell is too narrow for the clearance that the style asks.
    fn fits_cell(&self, distance: f64) -> bool {
        distance >= self.draft.rules.local.clearance - SLACK.1
    }

    /// Whether a port makes a point of a street near to a point of a main street, `distance` from it.
    fn port_near(&self, (i, x): (usize, DVec2), y: DVec2, distance: f64, search: &mut Search) -> bool {
        let most = longest_way(distance);
        let g = &self.draft.canvas.graph;
        self.reaches((i, x), most, search, |v, way| self.is_port(v) && way + g.at(v).distance(y) <= most)
    }

    /// Whether `p` lies on the stub of a port that the street begins at.
    fn on_stub(&self, street: usize, p: DVec2) -> bool {
        self.streets[street].ends.iter().any(|v| {
            self.draft.canvas.nodes[*v as usize].port.is_some_and(|port| {
                let port = self.draft.brief.ports[port];
                distance_to_segment(p, port.at, port.at + port.inward * APPROACH_LENGTH) < 1.0
            })
        })
    }

    /// Whether two points of streets are farther apart along the streets than `distance` allows.
    fn far_along(&self, (i, x): (usize, DVec2), (k, y): (usize, DVec2), distance: f64, search: &mut Search) -> bool {
        let most = longest_way(distance);
        let [a, b] = self.streets[k].ends;
        let [to_a, to_b] = self.to_ends(k, y);
        !self.reaches((i, x), most, search, |v, way| v == a && way + to_a <= most || v == b && way + to_b <= most)
    }

    /// Ways from a point of a street to its ends.
    fn to_ends(&self, street: usize, p: DVec2) -> [f64; 2] {
        let line = self.streets[street].line;
        let (mut before, mut best) = (0.0, (f64::INFINITY, 0.0));
        for (a, b) in segments(line) {
            let off = distance_to_segment(p, a, b);
            if off < best.0 {
                best = (off, before + a.distance(p));
            }
            before += a.distance(b);
        }
        [best.1, before - best.1]
    }

    /// Whether a way of at most `most` metres leads from a point of a street to an end of streets that `is_it` holds for, given the
    /// vertex there and the length of the way.
    fn reaches(
        &self,
        (street, p): (usize, DVec2),
        most: f64,
        search: &mut Search,
        is_it: impl Fn(VertexIx, f64) -> bool,
    ) -> bool {
        let Search { reached, open } = search;
        reached.clear();
        open.clear();
        open.extend(self.streets[street].ends.into_iter().zip(self.to_ends(street, p)));
        // Few ends are so near that an order of search would pay.
        while let Some((v, way)) = open.pop() {
            match reached.iter_mut().find(|at| at.0 == v) {
                Some(at) if at.1 <= way => continue,
                Some(at) => at.1 = way,
                None if way > most => continue,
                None => reached.push((v, way)),
            }
            if is_it(v, way) {
                return true;
            }
            open.extend(self.arms.at(v).iter().map(|arm| (arm.to, way + arm.length)));
        }
        false
    }
}

/// Greatest way along the streets between two points so far from each other, if that distance is less than the clearance.
fn longest_way(distance: f64) -> f64 {
    // Checks look at points some metres apart.
    (distance + SLACK.1) * NEAR_ALONG + BETWEEN
}
