//! A mosaic as streets from junction to junction: junctions that are nearer to each other than streets are long become one, and
//! what has no room is cut off.

use super::weave::Of;
use crate::network::{EdgeIx, PlanarGraph, VertexIx};
use crate::space::{DisjointSets, line_length, simplify_line};
use glam::DVec2;
use std::collections::BTreeMap;

/// Points this near to a street's line do not show, in metres.
const FLAT: f64 = 1.0;
/// Least length between two points of a street, in metres.
const LEAST_PIECE: f64 = 12.0;
/// Halvings of an edge in the search for the place where room ends.
const HALVINGS: usize = 8;

/// How a street ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At a junction of the mosaic.
    Vertex(VertexIx),
    /// At a dead end of the mosaic.
    Dead,
    /// Where it is cut off.
    Cut,
    /// At the stub of a port.
    Port(usize),
}

/// A street that may be laid.
#[derive(Clone, Debug)]
pub struct Strip {
    /// Its line, in the cell's metres.
    pub line: Vec<DVec2>,
    /// Its first end.
    pub first: End,
    /// Its last end.
    pub last: End,
    /// The patch that it is from.
    pub patch: Option<u32>,
}

impl Strip {
    /// Takes out the points at which the street bends too sharply: where the cosine between its parts is more than `cosine`.
    pub fn straighten(&mut self, cosine: f64) {
        let way = |from: DVec2, to: DVec2| (to - from).normalize_or_zero();
        let is_sharp = |w: &[DVec2]| way(w[1], w[0]).dot(way(w[1], w[2])) > cosine;
        while let Some(i) = self.line.windows(3).position(is_sharp) {
            self.line.remove(i + 1);
        }
    }

    /// Length in metres.
    pub fn length(&self) -> f64 {
        line_length(&self.line)
    }
}

/// The streets of a mosaic where `has_room` holds, with junctions nearer than `least` metres along a street as one. `place` gives the
/// cell's metres.
pub fn strips(
    graph: &PlanarGraph<Of>,
    least: f64,
    place: impl Fn(DVec2) -> DVec2,
    has_room: impl Fn(DVec2) -> bool,
) -> Vec<Strip> {
    let chains = graph.chains(|v| graph.degree(v) != 2);
    let mut one = DisjointSets::new();
    for chain in &chains {
        let vertices = graph.chain_vertices(chain);
        let (a, b) = (vertices[0], vertices[vertices.len() - 1]);
        let length: f64 = chain.iter().map(|(e, _)| graph.edge_length(*e)).sum();
        if length < least && [a, b].iter().all(|v| graph.degree(*v) > 2) {
            one.union(a, b);
        }
    }
    let mut sums: BTreeMap<VertexIx, (DVec2, f64)> = BTreeMap::new();
    for v in graph.vertices().filter(|v| graph.degree(*v) > 2) {
        let sum = sums.entry(one.find(v)).or_default();
        *sum = (sum.0 + graph.at(v), sum.1 + 1.0);
    }
    let mut extra = graph.vertex_count() as VertexIx;
    let mut out = Vec::new();
    for chain in &chains {
        let vertices = graph.chain_vertices(chain);
        let ends = [vertices[0], vertices[vertices.len() - 1]].map(|v| one.find(v));
        let mut line: Vec<DVec2> = vertices.iter().map(|v| graph.at(*v)).collect();
        if ends[0] == ends[1] && line_length(&line) < 4.0 * least {
            continue;
        }
        let last = line.len() - 1;
        for (end, i) in ends.into_iter().zip([0, last]) {
            if let Some((sum, count)) = sums.get(&end) {
                line[i] = *sum / *count;
            }
        }
        let line: Vec<DVec2> = line.into_iter().map(&place).collect();
        let [first, last] = ends.map(|v| if graph.degree(v) == 1 { End::Dead } else { End::Vertex(v) });
        let strip = Strip { line, first, last, patch: patch(graph, chain) };
        if ends[0] == ends[1] {
            // Both halves of a loop, which meet in a junction of their own.
            let middle = strip.line.len() / 2;
            let half =
                |line: &[DVec2], first: End, last: End| Strip { line: line.to_vec(), first, last, ..strip.clone() };
            out.push(half(&strip.line[..=middle], strip.first, End::Vertex(extra)));
            out.push(half(&strip.line[middle..], End::Vertex(extra), strip.last));
            extra += 1;
        } else {
            out.push(strip);
        }
    }
    let mut inside = Vec::with_capacity(out.len());
    out.into_iter().for_each(|strip| cut(strip, &has_room, &mut inside));
    inside.iter_mut().for_each(|strip| strip.line = smooth(&strip.line));
    inside
}

/// A line without points that do not show and without short pieces, in which no bend can be rounded.
fn smooth(line: &[DVec2]) -> Vec<DVec2> {
    let line = simplify_line(line, FLAT);
    let (Some(&first), Some(&last)) = (line.first(), line.last()) else { return line };
    let mut out = vec![first];
    for &p in &line[1..line.len().max(2) - 1] {
        if p.distance(out[out.len() - 1]) >= LEAST_PIECE && p.distance(last) >= LEAST_PIECE {
            out.push(p);
        }
    }
    out.push(last);
    out
}

/// The patch that the greatest part of a street is from.
fn patch(graph: &PlanarGraph<Of>, chain: &[(EdgeIx, bool)]) -> Option<u32> {
    let mut lengths: BTreeMap<Option<u32>, f64> = BTreeMap::new();
    for (e, _) in chain {
        *lengths.entry(graph.edge(*e).data.patch).or_default() += graph.edge_length(*e);
    }
    lengths.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(patch, _)| patch)
}

/// The parts of a street that have room.
fn cut(strip: Strip, has_room: &impl Fn(DVec2) -> bool, out: &mut Vec<Strip>) {
    let rooms: Vec<bool> = strip.line.iter().map(|p| has_room(*p)).collect();
    if rooms.iter().all(|room| *room) {
        out.push(strip);
        return;
    }
    let border = |inside: DVec2, outside: DVec2| {
        let (mut a, mut b) = (inside, outside);
        for _ in 0..HALVINGS {
            let middle = (a + b) / 2.0;
            if has_room(middle) { a = middle } else { b = middle }
        }
        crate::space::quantize(a)
    };
    let mut part: Option<Strip> = None;
    for (i, (&at, has_room)) in strip.line.iter().zip(rooms).enumerate() {
        match (&mut part, has_room) {
            (None, true) => {
                let (line, first) = match i.checked_sub(1) {
                    Some(before) => (vec![border(at, strip.line[before]), at], End::Cut),
                    None => (vec![at], strip.first),
                };
                part = Some(Strip { line, first, last: strip.last, patch: strip.patch });
            }
            (Some(part), true) => part.line.push(at),
            (Some(_), false) => {
                if let Some(mut done) = part.take() {
                    done.line.push(border(strip.line[i - 1], at));
                    done.last = End::Cut;
                    out.push(done);
                }
            }
            (None, false) => {}
        }
    }
    out.extend(part);
    out.iter_mut().for_each(|strip| strip.line.dedup());
    out.retain(|strip| strip.line.len() > 1);
}
