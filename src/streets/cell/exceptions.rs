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
use std::collections::BTreeMap;

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
    /// For each vertex of the graph at which streets end, where they lead to and their lengths in metres.
    ways: Vec<Vec<(VertexIx, f64)>>,
    found: Vec<Exception>,
}

/// Finds the places where `streets`, all of a cell, break a rule of its style.
pub fn exceptions(draft: &Draft<'_>, streets: &[Finished<'_>]) -> Vec<Exception> {
    let mut ways: Vec<Vec<(VertexIx, f64)>> = vec![Vec::new(); draft.canvas.graph.vertex_count()];
    for Finished { ends: [a, b], line, .. } in streets {
        let length = line_length(line);
        ways[*a as usize].push((*b, length));
        ways[*b as usize].push((*a, length));
    }
    let mut inspection = Inspection { draft, streets, ways, found: Vec::new() };
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
        vertices.iter().any(|v| self.is_pinned(*v)) || chain.iter().any(|(e, _)| self.is_link(*e))
    }

    /// Whether an edge connects a pinned piece, as near to others as streets may be at all.
    fn is_link(&self, edge: EdgeIx) -> bool {
        self.draft.canvas.graph.edge(edge).data.by == Maker::Link
    }

    /// Whether a street that connects a pinned piece ends at a vertex.
    fn is_linked(&self, v: VertexIx) -> bool {
        self.draft.canvas.graph.edges_at(v).iter().any(|e| self.is_link(*e))
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
        // The ways that leave each vertex, and whether each connects a pinned piece.
        let mut around: BTreeMap<VertexIx, Vec<(DVec2, bool)>> = BTreeMap::new();
        for street in self.streets {
            let n = street.line.len();
            let is_link = |end: Option<&(EdgeIx, bool)>| end.is_some_and(|(e, _)| self.is_link(*e));
            let first = (street.line[1] - street.line[0], is_link(street.chain.first()));
            let last = (street.line[n - 2] - street.line[n - 1], is_link(street.chain.last()));
            around.entry(street.ends[0]).or_default().push(first);
            around.entry(street.ends[1]).or_default().push(last);
        }
        let most = (self.draft.rules.local.degree.1 as usize).max(2);
        for (v, ways) in around {
            let at = self.draft.canvas.graph.at(v);
            let cause = |by_link: bool| if by_link || self.is_pinned(v) { Cause::Pin } else { Cause::Defect };
            let mut found = Vec::new();
            if ways.len() > most {
                let others = ways.iter().filter(|way| !way.1).count();
                found.push((Rule::Degree, cause(others <= most)));
            }
            let pairs = ways.iter().enumerate().flat_map(|(i, a)| ways[..i].iter().map(move |b| (a, b)));
            let sharp: Vec<bool> = pairs.filter(|(a, b)| self.is_sharp(a.0, b.0)).map(|(a, b)| a.1 || b.1).collect();
            if !sharp.is_empty() {
                found.push((Rule::Angle, cause(sharp.iter().all(|by_link| *by_link))));
            }
            found.into_iter().for_each(|(rule, cause)| self.report(rule, cause, at));
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
        for (n, &i) in order.iter().enumerate() {
            for &k in order[n + 1..].iter().take_while(|k| bounds[**k].min.x <= bounds[i].max.x) {
                let (a, b) = (self.streets[i].ends, self.streets[k].ends);
                if bounds[i].overlaps(bounds[k]) && !a.iter().any(|v| b.contains(v)) {
                    self.clearance((i, bounds[i]), (k, bounds[k]), least);
                }
            }
            self.clearance_of_border(i, bounds[i], least);
        }
    }

    /// Distance between two streets, given with the boxes around them that are `least` metres larger.
    fn clearance(&mut self, (i, around_a): (usize, Bounds), (k, around_b): (usize, Bounds), least: f64) {
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
                        && self.far_along((i, x), (k, y), distance)
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
    fn clearance_of_border(&mut self, i: usize, bounds: Bounds, least: f64) {
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
                    if is_worse && !self.port_near(i, x, y, distance) {
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
    fn port_near(&self, i: usize, x: DVec2, y: DVec2, distance: f64) -> bool {
        let most = longest_way(distance);
        let g = &self.draft.canvas.graph;
        self.reached(i, x, most).into_iter().any(|(v, d)| self.is_port(v) && d + g.at(v).distance(y) <= most)
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
    fn far_along(&self, (i, x): (usize, DVec2), (k, y): (usize, DVec2), distance: f64) -> bool {
        let most = longest_way(distance);
        let reached = self.reached(i, x, most);
        let ends = self.streets[k].ends.into_iter().zip(self.to_ends(k, y));
        ends.into_iter().all(|(v, d)| reached.iter().all(|(at, way)| *at != v || way + d > most))
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

    /// The ends of streets that a way of at most `most` metres leads to, with the shortest ways.
    fn reached(&self, street: usize, p: DVec2, most: f64) -> Vec<(VertexIx, f64)> {
        let mut reached: Vec<(VertexIx, f64)> = Vec::new();
        let mut open: Vec<(VertexIx, f64)> =
            self.streets[street].ends.into_iter().zip(self.to_ends(street, p)).collect();
        // Few ends are so near that an order of search would pay.
        while let Some((v, way)) = open.pop() {
            match reached.iter_mut().find(|at| at.0 == v) {
                Some(at) if at.1 <= way => continue,
                Some(at) => at.1 = way,
                None if way > most => continue,
                None => reached.push((v, way)),
            }
            open.extend(self.ways[v as usize].iter().map(|(to, d)| (*to, way + d)));
        }
        reached
    }
}

/// Greatest way along the streets between two points so far from each other, if that distance is less than the clearance.
fn longest_way(distance: f64) -> f64 {
    // Checks look at points some metres apart.
    (distance + SLACK.1) * NEAR_ALONG + BETWEEN
}
