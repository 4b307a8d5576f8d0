//! Mending a mosaic: streets that cross get a junction, those that end at the side of a tile lead on, and floating ones are
//! connected by the shortest street, where Bustard and de Valmency 2015 remove them.

use super::buckets::Buckets;
use super::weave::Of;
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use crate::space::math::angle_between;
use crate::space::{Bounds, DisjointSets, closest_on_segment, segment_crossing, segment_distance};
use glam::DVec2;
use std::collections::BTreeMap;

/// Places nearer than this to the end of a street are that end, in metres.
const AT_END: f64 = 10.0;
/// Places nearer than this to each other are one, in metres.
const SAME: f64 = 0.01;
/// Least angle between a street that is added and those that it meets, in radians.
const LEAST_ANGLE: f64 = 0.6;
/// Distances within which floating streets look for others, in metres, the next one where there is none.
const REACHES: [f64; 4] = [60.0, 200.0, 600.0, 4000.0];
/// How much longer than the shortest one a street may be so that it keeps the rules: a factor, and metres.
const SLACK: (f64, f64) = (1.5, 30.0);
/// Longest way straight on from the end of a street to the next one, in metres.
const STRAIGHT_ON: f64 = 160.0;
/// Distance that an added street keeps from others, and length at both its ends within which it need not, in metres.
const CLEARANCE: (f64, f64) = (14.0, 16.0);
/// Least length of a street that becomes a dead end, and how far from the side of the tile it ends, in metres.
const LEAST_DEAD_END: f64 = 50.0;
const OFF_SIDE: f64 = 14.0;
/// Number of streets that are tried for a connection.
const TRIES: usize = 40;

/// A street that may be added: from a vertex to a place on an edge.
struct Link {
    length: f64,
    from: VertexIx,
    on: EdgeIx,
    to: DVec2,
}

/// A graph under repair.
pub struct Mending<'g> {
    graph: &'g mut PlanarGraph<Of>,
    buckets: Buckets,
}

impl<'g> Mending<'g> {
    /// Begins to mend a graph.
    pub fn new(graph: &'g mut PlanarGraph<Of>) -> Self {
        let buckets = Buckets::of(graph);
        Self { graph, buckets }
    }

    /// Puts junctions where edges at these vertices cross others.
    pub fn untangle(&mut self, vertices: &[VertexIx]) {
        let mut edges: Vec<EdgeIx> = vertices.iter().flat_map(|v| self.graph.edges_at(*v).to_vec()).collect();
        edges.sort_unstable();
        edges.dedup();
        while let Some(e) = edges.pop() {
            if !self.graph.is_live(e) {
                continue;
            }
            let (a, b) = self.graph.segment(e);
            let edge = self.graph.edge(e).clone();
            let near = self.buckets.near(self.graph, Bounds::of([a, b]));
            let Some((f, at)) = near.into_iter().find_map(|f| {
                let other = self.graph.edge(f);
                let meets = [other.a, other.b].iter().any(|v| *v == edge.a || *v == edge.b);
                let (c, d) = self.graph.segment(f);
                let crossing = if f == e || meets { None } else { segment_crossing(a, b, c, d) };
                let at = crossing?.at;
                // Two ends at one place cross nowhere, and would be divided there for ever.
                (self.end_at(e, at).is_none() || self.end_at(f, at).is_none()).then_some((f, at))
            }) else {
                continue;
            };
            if let Some(v) = self.end_at(e, at) {
                self.lead_through(f, v);
                edges.push(e);
            } else {
                let v = self.end_at(f, at).unwrap_or_else(|| self.split(f, at));
                edges.extend(self.lead_through(e, v));
            }
        }
    }

    /// The end of an edge that lies at a place.
    fn end_at(&self, e: EdgeIx, at: DVec2) -> Option<VertexIx> {
        let edge = self.graph.edge(e);
        [edge.a, edge.b].into_iter().find(|v| self.graph.at(*v).distance(at) < SAME)
    }

    /// Leads streets on that end at the side of a tile, or takes them back to where they came from. `reach` is the length in metres of
    /// the longest street that is added.
    /// With `dead_ends`, as in a map that has them, long ones end a little before the side instead. As many lead on as make all
    /// streets together `wanted` metres long: where one tile has a street more than the next, neither is right by itself.
    pub fn lead_on(&mut self, loose: &[VertexIx], reach: f64, dead_ends: bool, wanted: f64) {
        let missing = wanted - self.length();
        let mut added = 0.0;
        for (i, &v) in loose.iter().enumerate() {
            // Evenly over all of them, so that no part of the mosaic gets all of what is missing.
            let due = missing * (i + 1) as f64 / loose.len() as f64;
            let Some(&own) = self.graph.edges_at(v).first().filter(|_| self.graph.degree(v) == 1) else { continue };
            let at = self.graph.at(v);
            let back = (self.graph.at(self.graph.edge(own).other(v)) - at).normalize_or_zero();
            let near = self.buckets.near(self.graph, Bounds::of([at]).grown(reach));
            let mut links: Vec<Link> = near
                .into_iter()
                .filter(|e| *e != own)
                .filter_map(|e| self.link(v, e))
                .filter(|link| {
                    link.length > 1.0 && link.length <= reach && (link.to - at).dot(back) < 0.5 * link.length
                })
                .collect();
            links.sort_by(|a, b| a.length.total_cmp(&b.length));
            let class = self.graph.edge(own).data.class;
            let straight = self.straight_on(v, -back, own);
            let found = straight.into_iter().chain(links.into_iter().take(TRIES)).find(|link| self.keeps_rules(link));
            let own_length = self.length_to_junction(v);
            match found.filter(|link| added + (link.length - own_length) / 2.0 <= due) {
                Some(link) => {
                    added += link.length;
                    self.build(&link, class);
                }
                None if dead_ends && own_length > LEAST_DEAD_END => self.shorten(v, own),
                None => {
                    added -= own_length;
                    self.take_back(v);
                }
            }
        }
        // A street that was led on to may be taken back itself, and what is led on to nothing new stays as it was.
        for &v in loose {
            self.take_back(v);
        }
    }

    /// Length of all streets in metres.
    fn length(&self) -> f64 {
        self.graph.edges().map(|(e, _)| self.graph.edge_length(e)).sum()
    }

    /// The street from the end of an edge straight on to the first one that it meets.
    fn straight_on(&self, v: VertexIx, onward: DVec2, own: EdgeIx) -> Option<Link> {
        let at = self.graph.at(v);
        let end = at + onward * STRAIGHT_ON;
        let near = self.buckets.near(self.graph, Bounds::of([at, end])).into_iter().filter(|e| *e != own);
        let met = near.filter_map(|e| {
            let (a, b) = self.graph.segment(e);
            Some((segment_crossing(at, end, a, b)?.at, e))
        });
        let (to, on) = met.min_by(|x, y| x.0.distance(at).total_cmp(&y.0.distance(at)))?;
        // At a junction close by, if there is one.
        let edge = self.graph.edge(on);
        let near = [edge.a, edge.b].map(|v| self.graph.at(v)).into_iter().find(|end| end.distance(to) < AT_END);
        let to = near.unwrap_or(to);
        Some(Link { length: at.distance(to), from: v, on, to }).filter(|link| link.length > 1.0)
    }

    /// Connects streets that hang together with no others, the shortest ones first.
    pub fn connect(&mut self) {
        let parts = self.graph.components();
        let mut members: BTreeMap<u32, Vec<VertexIx>> = BTreeMap::new();
        for v in self.graph.vertices() {
            if let Some(part) = parts[v as usize] {
                members.entry(part).or_default().push(v);
            }
        }
        let mut order: Vec<(u32, Vec<VertexIx>)> = members.into_iter().collect();
        order.sort_by(|a, b| a.1.len().cmp(&b.1.len()).then(a.0.cmp(&b.0)));
        // The largest part is what the others connect to.
        order.pop();
        let mut one = DisjointSets::new();
        let mut part_of: BTreeMap<VertexIx, u32> = BTreeMap::new();
        for (part, vertices) in order {
            let mut other_of = |v: VertexIx| {
                let other = part_of.get(&v).copied().or_else(|| parts.get(v as usize).copied().flatten())?;
                (!one.same(part, other)).then_some(other)
            };
            let Some(nearest) = self.nearest(&vertices, &mut other_of) else { continue };
            let mut links = self.links_of(&vertices, SLACK.0 * nearest + SLACK.1, &mut other_of);
            links.sort_by(|a, b| a.0.length.total_cmp(&b.0.length));
            let fits = links.iter().take(TRIES).position(|(link, _)| self.keeps_rules(link));
            // Nothing lies between the two nearest points of different parts.
            let Some((link, other)) = links.get(fits.unwrap_or(0)) else { continue };
            one.union(part, *other);
            let before = self.graph.vertex_count() as VertexIx;
            self.build(link, StreetClass::Local);
            part_of.extend((before..self.graph.vertex_count() as VertexIx).map(|v| (v, part)));
        }
    }

    /// Distance in metres from some vertices to the nearest edge of another part, or to about that; `None` if all are too far away.
    fn nearest(&self, vertices: &[VertexIx], other: &mut impl FnMut(VertexIx) -> Option<u32>) -> Option<f64> {
        let mut best: Option<f64> = None;
        for reach in REACHES {
            for v in vertices {
                // Once something is found, only what is nearer counts.
                let within = best.unwrap_or(reach);
                let at = self.graph.at(*v);
                for e in self.buckets.near(self.graph, Bounds::of([at]).grown(within)) {
                    let (a, b) = self.graph.segment(e);
                    let far = closest_on_segment(at, a, b).1.distance(at);
                    if far < best.unwrap_or(reach) && other(self.graph.edge(e).a).is_some() {
                        best = Some(far);
                    }
                }
            }
            if best.is_some() {
                break;
            }
        }
        best
    }

    /// The streets between some vertices, which hang together, and other parts within a reach: from each vertex to the edges near it,
    /// and from vertices near it to its edges. Each comes with the part that the other end is of.
    fn links_of(
        &self,
        vertices: &[VertexIx],
        reach: f64,
        other: &mut impl FnMut(VertexIx) -> Option<u32>,
    ) -> Vec<(Link, u32)> {
        let mut out = Vec::new();
        for &v in vertices {
            let at = self.graph.at(v);
            for e in self.buckets.near(self.graph, Bounds::of([at]).grown(reach)) {
                let edge = self.graph.edge(e);
                let Some(part) = other(edge.a) else { continue };
                out.extend(self.link(v, e).map(|link| (link, part)));
                let ends = [edge.a, edge.b];
                let own = self.graph.edges_at(v).iter().flat_map(|e| ends.map(|w| (w, *e)));
                out.extend(own.filter_map(|(w, e)| Some((self.link(w, e)?, part))));
            }
        }
        out.retain(|(link, _)| link.length <= reach);
        out
    }

    /// The shortest street from a vertex to an edge, or to an end of that edge close by.
    fn link(&self, from: VertexIx, on: EdgeIx) -> Option<Link> {
        let at = self.graph.at(from);
        let edge = self.graph.edge(on);
        let (a, b) = self.graph.segment(on);
        let foot = closest_on_segment(at, a, b).1;
        let near = |(_, end): &(VertexIx, DVec2)| end.distance(foot) < AT_END;
        let to = [(edge.a, a), (edge.b, b)].into_iter().filter(near);
        let to = to.min_by(|x, y| x.1.distance(foot).total_cmp(&y.1.distance(foot))).map_or(foot, |(_, end)| end);
        let length = at.distance(to);
        (length > 0.0).then_some(Link { length, from, on, to })
    }

    /// Whether a street crosses no other and meets streets at no small angle.
    fn keeps_rules(&self, link: &Link) -> bool {
        let g = &*self.graph;
        let from = g.at(link.from);
        let way = link.to - from;
        let (a, b) = g.segment(link.on);
        let end = [(g.edge(link.on).a, a), (g.edge(link.on).b, b)].into_iter().find(|(_, at)| *at == link.to);
        let leaves =
            |v: VertexIx, way: DVec2| g.neighbours(v).all(|w| angle_between(g.at(w) - g.at(v), way) >= LEAST_ANGLE);
        let arrives = match end {
            Some((v, _)) => leaves(v, -way),
            None => (way.normalize_or_zero().dot((b - a).normalize_or_zero())).abs() < 0.82,
        };
        arrives
            && leaves(link.from, way)
            && self.buckets.near(g, Bounds::of([from, link.to])).into_iter().all(|e| {
                let edge = g.edge(e);
                let ends = [edge.a, edge.b];
                let meets = e == link.on || ends.contains(&link.from) || end.is_some_and(|(v, _)| ends.contains(&v));
                let (c, d) = g.segment(e);
                meets || segment_crossing(from, link.to, c, d).is_none()
            })
            && self.keeps_clear(from, link.to)
    }

    /// Whether a street runs beside no other.
    fn keeps_clear(&self, from: DVec2, to: DVec2) -> bool {
        let (gap, free) = CLEARANCE;
        let length = from.distance(to);
        if length <= 2.0 * free {
            return true;
        }
        let (a, b) = (from.lerp(to, free / length), to.lerp(from, free / length));
        self.buckets.near(self.graph, Bounds::of([a, b]).grown(gap)).into_iter().all(|e| {
            let (c, d) = self.graph.segment(e);
            segment_distance(a, b, c, d) >= gap
        })
    }

    /// Builds a street.
    fn build(&mut self, link: &Link, class: StreetClass) {
        let to = self.split(link.on, link.to);
        if link.from != to && self.graph.edge_between(link.from, to).is_none() {
            let edge = self.graph.add_edge(link.from, to, Of { class, patch: None });
            self.buckets.add(self.graph, edge);
        }
    }

    /// Divides an edge, and gives the vertex there.
    fn split(&mut self, edge: EdgeIx, at: DVec2) -> VertexIx {
        let before = self.graph.edge_count();
        let v = self.graph.split_edge(edge, at);
        (before..self.graph.edge_count()).for_each(|e| self.buckets.add(self.graph, e as EdgeIx));
        v
    }

    /// Leads an edge through a vertex; gives the new edges.
    fn lead_through(&mut self, edge: EdgeIx, v: VertexIx) -> Vec<EdgeIx> {
        let Some(old) = self.graph.remove_edge(edge) else { return Vec::new() };
        let mut out = Vec::new();
        for end in [old.a, old.b] {
            if end != v && self.graph.edge_between(end, v).is_none() {
                let new = self.graph.add_edge(end, v, old.data);
                self.buckets.add(self.graph, new);
                out.push(new);
            }
        }
        out
    }

    /// Length of a street from its loose end to the next junction, in metres.
    fn length_to_junction(&self, loose: VertexIx) -> f64 {
        let (mut at, mut before, mut length) = (loose, None, 0.0);
        loop {
            let next = self.graph.edges_at(at).iter().find(|e| Some(**e) != before);
            let Some(&edge) = next.filter(|_| at == loose || self.graph.degree(at) == 2) else { return length };
            length += self.graph.edge_length(edge);
            (at, before) = (self.graph.edge(edge).other(at), Some(edge));
            if at == loose {
                return length;
            }
        }
    }

    /// Makes a dead end of a loose one, off the side of the tile.
    fn shorten(&mut self, loose: VertexIx, edge: EdgeIx) {
        let to = self.graph.edge(edge).other(loose);
        let (end, at) = (self.graph.at(loose), self.graph.at(to));
        let Some(old) = self.graph.remove_edge(edge) else { return };
        let length = end.distance(at);
        if length > 2.0 * OFF_SIDE {
            let v = self.graph.add_vertex(end.lerp(at, OFF_SIDE / length));
            let new = self.graph.add_edge(v, to, old.data);
            self.buckets.add(self.graph, new);
        }
    }

    /// Removes a street from its loose end to the next junction.
    fn take_back(&mut self, loose: VertexIx) {
        let mut at = loose;
        while let [edge] = *self.graph.edges_at(at) {
            at = self.graph.edge(edge).other(at);
            self.graph.remove_edge(edge);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streets_that_end_on_others_are_untangled_in_the_end() {
        let of = Of { class: StreetClass::Local, patch: None };
        let mut graph = PlanarGraph::without_index();
        let mut street = |points: [(f64, f64); 2]| {
            let [a, b] = points.map(|p| graph.add_vertex(p.into()));
            graph.add_edge(a, b, of);
            (a, b)
        };
        // Two streets from one place on a third, with an end each, and one through them all.
        let (a, _) = street([(50.0, 0.0), (50.0, 80.0)]);
        let (b, _) = street([(50.0, 0.0), (80.0, 80.0)]);
        let (c, d) = street([(0.0, 0.0), (100.0, 0.0)]);
        street([(0.0, 40.0), (100.0, 40.0)]);
        let mut mending = Mending::new(&mut graph);
        mending.untangle(&[a, b, c, d]);
        let edges: Vec<EdgeIx> = graph.edges().map(|(e, _)| e).collect();
        for (i, e) in edges.iter().enumerate() {
            for f in &edges[..i] {
                let ((a, b), (c, d)) = (graph.segment(*e), graph.segment(*f));
                let apart = [a, b].iter().all(|p| *p != c && *p != d);
                assert!(!apart || segment_crossing(a, b, c, d).is_none(), "{a} {b} and {c} {d}");
            }
        }
    }
}
