//! Repair: dead ends that can be connected are, stumps go, and blocks that came out too large are divided.

use super::Work;
use super::near::{NONE, Seg};
use super::proposal::{Join, Limits};
use crate::layer::{Cancel, LayerError};
use crate::network::{EdgeIx, Face, PlanarGraph, VertexIx};
use crate::space::{
    Bounds, centroid,
    math::{angle_of, rotate},
};
use crate::streets::MadeBy;
use glam::DVec2;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_2;

/// Connections that are checked exactly for one dead end or one block.
const TRIES: usize = 10;

/// Streets across a block of which it is found where they end, and so many of them together, of which the best is built.
const LOOKED_AT: usize = 15;

const TOGETHER: usize = 5;

/// Angle to square of streets that are laid aslant across a block, in radians.
const SLANT: f64 = 0.3;

/// A street that would mend something, and what it costs.
struct Mend {
    cost: f64,
    /// Its points; two of them where it is straight.
    line: [DVec2; 3],
    points: usize,
    first: Join,
    last: Join,
}

/// Where a street across a block may begin.
struct Start {
    cost: f64,
    from: DVec2,
    /// Direction square to the street that it leaves.
    square: DVec2,
    way: DVec2,
    /// From the one to the other.
    angle: f64,
    /// The street that it leaves.
    edge: EdgeIx,
}

impl Mend {
    fn straight(cost: f64, from: DVec2, to: DVec2, first: Join, last: Join) -> Self {
        Self { cost, line: [from, to, to], points: 2, first, last }
    }
}

impl Work<'_> {
    /// Mends the network. Repair beats deletion: only stumps are removed.
    pub(super) fn repair(&mut self, cancel: &Cancel) -> Result<(), LayerError> {
        self.connect_cut_off();
        for round in 0..2 {
            self.connect_dead_ends();
            self.remove_stumps();
            cancel.check()?;
            if self.divide_blocks() == 0 && round == 0 {
                break;
            }
        }
        self.connect_cut_off();
        self.connect_dead_ends();
        self.remove_stumps();
        self.lengthen_stubs();
        Ok(())
    }

    /// Dead ends that may be mended with the length of their streets, the shortest first.
    fn dead_ends(&self) -> Vec<(f64, VertexIx, bool)> {
        let g = &self.canvas.graph;
        let mut out: Vec<_> = g
            .vertices()
            .filter(|v| self.canvas.is_dead_end(*v) && self.canvas.nodes[*v as usize].open)
            .map(|v| {
                let (end, length) = self.canvas.follow(v, g.edges_at(v)[0], |_| {});
                (length, v, self.canvas.nodes[end as usize].port.is_some())
            })
            .collect();
        out.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        out
    }

    fn connect_dead_ends(&mut self) {
        let stay = self.brief.style.local.dead_ends;
        for (length, v, _) in self.dead_ends() {
            if stay > 0.0 && self.rng.chance(stay) {
                // One that is long enough is not asked again; a stump goes.
                self.canvas.nodes[v as usize].open &= length < self.stump;
            } else if self.canvas.is_dead_end(v) {
                self.connect(v);
            }
        }
    }

    /// Connects the dead end `v` by a straight street or one with a bend, if any keeps the relaxed rules.
    fn connect(&mut self, v: VertexIx) -> bool {
        let at = self.canvas.graph.at(v);
        let Some(onward) = self.canvas.onward(v) else { return false };
        let reach = 1.5 * self.brief.style.local.length;
        let limits = self.relaxed;
        self.gather(at, reach + limits.gap + 30.0);
        let mut mends: Vec<Mend> = Vec::new();
        let mut line = Vec::new();
        for step in -8i32..=8 {
            let angle = f64::from(step) * 0.17;
            let direction = rotate(onward, angle);
            if let Some((end, last, distance)) = self.landing(at, direction, reach, v, &mut line) {
                let welcome = if matches!(last, Join::At(w) if self.canvas.is_dead_end(w)) { 0.6 } else { 1.0 };
                let cost = distance * welcome * (1.0 + 0.5 * angle.abs());
                mends.push(Mend::straight(cost, at, end, Join::At(v), last));
            }
        }
        let ahead = self.ray(at, at + onward * reach, v).map_or(reach, |h| h.1 * reach);
        for share in [34.0, 52.0, 75.0] {
            if share > ahead - 18.0 {
                break;
            }
            let bend = at + onward * share;
            for angle in [1.57, -1.57, 1.1, -1.1] {
                if let Some((end, last, distance)) = self.landing(bend, rotate(onward, angle), reach, NONE, &mut line) {
                    let cost = 1.5 * (share + distance);
                    mends.push(Mend { cost, line: [at, bend, end], points: 3, first: Join::At(v), last });
                }
            }
        }
        self.build_best(mends, &limits, TRIES)
    }

    /// Builds the best street from the component `part` of the graph to any other, from an end or from the side of one of
    /// its streets.
    pub(super) fn connect_part(&mut self, components: &[Option<u32>], part: Option<u32>, limits: Limits) -> bool {
        let g = &self.canvas.graph;
        let of_part: Vec<EdgeIx> =
            g.edges().filter(|(_, e)| components[e.a as usize] == part).map(|(i, _)| i).collect();
        let bounds = Bounds::of(of_part.iter().flat_map(|e| <[DVec2; 2]>::from(g.segment(*e))));
        let reach = 4.0 * self.brief.style.local.length;
        self.canvas.gather(bounds, reach, &mut self.near);
        let g = &self.canvas.graph;
        let elsewhere = |join: Join| match join {
            Join::At(v) => components.get(v as usize).is_some_and(|c| *c != part),
            Join::On(e) => components.get(g.edge(e).a as usize).is_some_and(|c| *c != part),
            Join::Free(_) => false,
        };
        let mut mends: Vec<Mend> = Vec::new();
        let mut line = Vec::new();
        let mut add = |from: DVec2, start: DVec2, direction: DVec2, first: Join, leaving: VertexIx, factor: f64| {
            if let Some((end, last, distance)) = self.landing(start, direction, reach, leaving, &mut line)
                && elsewhere(last)
            {
                mends.push(Mend::straight(distance * factor, from, end, first, last));
            }
        };
        for &e in &of_part {
            let edge = g.edge(e);
            for (v, other) in [(edge.a, edge.b), (edge.b, edge.a)] {
                if g.degree(v) == 1 && self.canvas.nodes[v as usize].open {
                    let (at, onward) = (g.at(v), (g.at(v) - g.at(other)).normalize_or_zero());
                    for step in -8i32..=8 {
                        let angle = f64::from(step) * 0.17;
                        add(at, at, rotate(onward, angle), Join::At(v), v, 1.0 + 0.5 * angle.abs());
                    }
                }
            }
            let (a, b) = g.segment(e);
            let side = (b - a).perp().normalize_or_zero();
            let parts = (a.distance(b) / 14.0).ceil().max(2.0) as usize;
            for k in 1..parts {
                let from = crate::space::quantize(a.lerp(b, k as f64 / parts as f64));
                for (out, angle) in [side, -side].into_iter().flat_map(|s| [0.0, 0.4, -0.4].map(|a| (s, a))) {
                    add(from, from + out * 0.5, rotate(out, angle), Join::On(e), NONE, 1.5 + 0.5 * f64::abs(angle));
                }
            }
        }
        self.build_best(mends, &limits, 60)
    }

    /// Where a street from `from` in `direction` first meets a local street within `reach`: there, or at a vertex next
    /// to it, with its distance, the greater the more aslant it lands. `line` is a buffer.
    fn landing(
        &self,
        from: DVec2,
        direction: DVec2,
        reach: f64,
        leaving: VertexIx,
        line: &mut Vec<DVec2>,
    ) -> Option<(DVec2, Join, f64)> {
        let ahead = self.brief.style.local.snap_radius.max(self.relaxed.gap);
        let to = from + direction * (reach - ahead).max(1.0);
        line.clear();
        line.extend([from, to]);
        let join = self.settle(line, leaving, &self.relaxed)?;
        let end = line[line.len() - 1];
        // Streets meet rather square than aslant.
        let met = match join {
            Join::On(e) => Some(self.canvas.graph.segment(e)),
            Join::At(_) => None,
            Join::Free(_) => return None,
        };
        let along = met.map_or(DVec2::ZERO, |(a, b)| (b - a).normalize_or_zero());
        let slant = along.dot((end - from).normalize_or_zero()).abs();
        Some((end, join, from.distance(end) * (1.0 + slant) * self.off_field(from, end)))
    }

    /// What it costs more that the street from `from` to `end` does not follow the field: 1 for one that does.
    fn off_field(&self, from: DVec2, end: DVec2) -> f64 {
        self.off_by(angle_of(end - from) - self.brief.field.angle(from.midpoint(end)))
    }

    /// The same for a street that heads at this angle to the field.
    fn off_by(&self, off: f64) -> f64 {
        let off = off - (off / FRAC_PI_2).round() * FRAC_PI_2;
        1.0 + 2.5 * self.field_pull * off.abs()
    }

    /// Builds the cheapest of the given streets that keeps to `limits`; so many are tried.
    fn build_best(&mut self, mut mends: Vec<Mend>, limits: &Limits, tries: usize) -> bool {
        mends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        for m in mends.into_iter().take(tries) {
            self.proposal.line(&m.line[..m.points], m.first, m.last);
            if self.build_if_fits(limits, MadeBy::Repair) {
                return true;
            }
        }
        false
    }

    fn remove_stumps(&mut self) {
        loop {
            let stump = self
                .dead_ends()
                .into_iter()
                .find(|(length, v, at_port)| *length < self.stump && !at_port && !self.is_pinned(*v));
            let Some((_, v, _)) = stump else { break };
            if self.canvas.remove_dead_end(v).is_none() {
                break;
            }
        }
    }

    /// Whether the street that ends at the dead end `v` is part of a pinned patch.
    fn is_pinned(&self, v: VertexIx) -> bool {
        let g = &self.canvas.graph;
        let mut pinned = false;
        self.canvas.follow(v, g.edges_at(v)[0], |e| {
            let edge = g.edge(e);
            pinned |= self.canvas.nodes[edge.a as usize].pinned && self.canvas.nodes[edge.b as usize].pinned;
        });
        pinned
    }

    /// Makes cul-de-sacs of port stubs that still lead nowhere.
    fn lengthen_stubs(&mut self) {
        let local = &self.brief.style.local;
        for (length, v, at_port) in self.dead_ends() {
            if !at_port || length > 30.0 {
                continue;
            }
            let (at, Some(onward)) = (self.canvas.graph.at(v), self.canvas.onward(v)) else { continue };
            self.gather(at, local.length + 2.0 * self.limits.gap);
            for (share, angle) in
                [(0.8, 0.0), (0.55, 0.0), (0.35, 0.0), (0.55, 0.4), (0.55, -0.4), (0.35, 0.7), (0.35, -0.7)]
            {
                let end = at + rotate(onward, angle) * (share * local.length);
                self.proposal.line(&[at, end], Join::At(v), Join::Free(false));
                let limits = Limits { gap: 22.0_f64.min(self.limits.gap), ..self.relaxed };
                if self.build_if_fits(&limits, MadeBy::Repair) {
                    break;
                }
            }
        }
    }

    /// Divides blocks that are much larger than the style's; how many streets it added.
    fn divide_blocks(&mut self) -> usize {
        let length = self.brief.style.local.length;
        let most = 2.6 * length * length;
        let mut added = 0;
        let blocks = self.blocks();
        // On how many sides each street has a block; what stands alone in the midst of one has none on its outside.
        let mut sides: Vec<u8> = vec![0; self.canvas.graph.edge_count()];
        for &e in blocks.iter().flat_map(|(_, edges)| edges.iter().flatten()) {
            sides[e as usize] = sides[e as usize].saturating_add(1);
        }
        for (face, edges) in blocks {
            if face.area() > most && self.divide(&face, &edges, &sides) {
                added += 1;
            }
        }
        added
    }

    /// Lays a street across a block, from one of its local streets to another. `sides` is the number of blocks at each edge
    /// of the graph; younger edges are missing there.
    fn divide(&mut self, face: &Face, edges: &[Option<EdgeIx>], sides: &[u8]) -> bool {
        let bounds = Bounds::of(face.polygon.iter().copied());
        self.canvas.gather(bounds, 20.0, &mut self.near);
        let middle = centroid(&face.polygon);
        let limits = Limits { gap: self.limits.gap, wall_gap: self.limits.wall_gap, ..self.relaxed };
        let reach = bounds.size().length();
        // A street across the block can only meet what is around it and in it first.
        std::mem::swap(&mut self.near, &mut self.around);
        (self.near.origin, self.near.within) = (self.around.origin, self.around.within);
        self.near.segs.clear();
        self.near.tips.clone_from(&self.around.tips);
        let is_met = |s: &&Seg| {
            s.is_wall() || sides.get(s.edge as usize).is_none_or(|n| *n < 2) || edges.contains(&Some(s.edge))
        };
        self.near.segs.extend(self.around.segs.iter().filter(is_met));
        let starts = self.starts_across(face, edges, reach, middle);
        let mut line = Vec::new();
        starts.chunks(TOGETHER).any(|starts| {
            let mut mends: Vec<Mend> = Vec::with_capacity(TOGETHER);
            for s in starts {
                if let Some((end, last, distance)) =
                    self.landing(s.from + s.square * 0.5, s.way, reach, NONE, &mut line)
                    && last != Join::On(s.edge)
                    && self.way_is_roughly_free(s.from, end, &limits)
                {
                    let cost = self.cost_across(s.from, end, distance, s.angle, middle);
                    mends.push(Mend::straight(cost, s.from, end, Join::On(s.edge), last));
                }
            }
            self.unfocus();
            let divided = self.build_best(mends, &limits, TOGETHER);
            self.unfocus();
            divided
        })
    }

    /// Where streets across a block may begin, the best first, as far as the coarse grid tells what they cost.
    fn starts_across(&self, face: &Face, edges: &[Option<EdgeIx>], reach: f64, middle: DVec2) -> Vec<Start> {
        let mut starts: Vec<Start> = Vec::with_capacity(4 * edges.len());
        for (i, edge) in edges.iter().enumerate() {
            let Some(edge) = edge.filter(|e| self.canvas.graph.is_live(*e)) else { continue };
            let (a, b) = (face.polygon[i], face.polygon[(i + 1) % face.polygon.len()]);
            let square = (b - a).perp().normalize_or_zero();
            // Of the ways across that which suits the field best: all are about as long.
            let heading = angle_of(square) - self.brief.field.angle(a.midpoint(b));
            let ways = [0.0, SLANT, -SLANT].map(|angle| (self.off_by(heading + angle), angle));
            let dearness = |way: &(f64, f64)| way.0 * (1.0 + 0.5 * way.1.abs());
            let cheaper = |a, b| if dearness(&b) < dearness(&a) { b } else { a };
            let Some((off, angle)) = ways.into_iter().reduce(cheaper) else { continue };
            let way = rotate(square, angle);
            let parts = (a.distance(b) / 18.0).ceil().max(2.0) as usize;
            for k in 1..parts {
                let from = crate::space::quantize(a.lerp(b, k as f64 / parts as f64));
                let [far] = self.canvas.free.ahead([(from, way)], reach);
                let cost = self.cost_across(from, from + way * far, far * off, angle, middle);
                starts.push(Start { cost, from, square, way, angle, edge });
            }
        }
        // Of two that cost the same always the same one, whatever the order in which a selection leaves them.
        let key = |s: &Start| [s.cost, s.from.x, s.from.y, s.square.x, s.square.y, s.angle];
        let cheaper = |a: &Start, b: &Start| {
            let differ = key(a).iter().zip(key(b)).map(|(x, y)| x.total_cmp(&y)).find(|o| o.is_ne());
            differ.unwrap_or(Ordering::Equal)
        };
        if starts.len() > LOOKED_AT {
            starts.select_nth_unstable_by(LOOKED_AT, cheaper);
            starts.truncate(LOOKED_AT);
        }
        starts.sort_by(cheaper);
        starts
    }

    /// What a street across a block costs, of this length and at this angle to square; the more the farther from its middle.
    fn cost_across(&self, from: DVec2, end: DVec2, distance: f64, angle: f64, middle: DVec2) -> f64 {
        distance * (1.0 + 0.5 * angle.abs()) + 1.5 * ((from + end) / 2.0).distance(middle)
    }

    /// Faces between local streets and the border, each with the local edge of every step of its walk.
    fn blocks(&self) -> Vec<(Face, Vec<Option<EdgeIx>>)> {
        let local = &self.canvas.graph;
        let mut graph: PlanarGraph<Option<EdgeIx>> = PlanarGraph::without_index();
        // Local streets keep their vertices, but ports in one place, at both sides of a main street, are one there.
        let mut places: BTreeMap<[u64; 2], VertexIx> = BTreeMap::new();
        for v in local.vertices() {
            graph.add_vertex(local.at(v));
        }
        let place = |p: DVec2| [p.x.to_bits(), p.y.to_bits()];
        for port in (0..self.brief.ports.len() as VertexIx).rev() {
            places.insert(place(local.at(port)), port);
        }
        // A main street that is walked on both sides is there once.
        let mut known: BTreeSet<(VertexIx, VertexIx)> = BTreeSet::new();
        for (a, b) in self.canvas.wall_lines() {
            // Divided at the ports that lie on it.
            let mut cuts: Vec<(f64, DVec2)> = vec![(0.0, a), (1.0, b)];
            let ab = b - a;
            for port in self.brief.ports {
                let t = (port.at - a).dot(ab) / ab.length_squared();
                if t > 0.0 && t < 1.0 && (a + ab * t).distance(port.at) < 0.01 {
                    cuts.push((t, port.at));
                }
            }
            cuts.sort_by(|x, y| x.0.total_cmp(&y.0));
            for pair in cuts.windows(2) {
                let [a, b] = [pair[0].1, pair[1].1].map(|p| {
                    let p = crate::space::quantize(p);
                    *places.entry(place(p)).or_insert_with(|| graph.add_vertex(p))
                });
                if a != b && known.insert((a.min(b), a.max(b))) {
                    graph.add_edge(a, b, None);
                }
            }
        }
        let shared = |v: VertexIx| {
            let port = (v as usize) < self.brief.ports.len();
            port.then(|| places.get(&place(local.at(v))).copied()).flatten().unwrap_or(v)
        };
        for (e, edge) in local.edges() {
            graph.add_edge(shared(edge.a), shared(edge.b), Some(e));
        }
        let faces = graph.faces().into_iter().filter(|f| f.area() > 0.0);
        faces
            .map(|f| {
                let edges = f.walk.iter().map(|h| graph.edge(h.edge).data).collect();
                (f, edges)
            })
            .collect()
    }
}
