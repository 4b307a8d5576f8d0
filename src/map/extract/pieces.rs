//! Connected pieces of local streets around main streets, and around junctions of local ones.

use super::drawing::draw;
use super::found::MapPatches;
use super::ground::Ground;
use super::options::{ExtractOptions, NoPatch};
use super::shape::Shape;
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use crate::patch::{DrawingRules, Line, Patch, PatchDrawing};
use crate::space::closest_on_segment;
use glam::DVec2;
use std::collections::BTreeMap;

/// Length of a main street on either side of the junction that a piece hangs on, in metres.
const MAIN_ARM: f64 = 45.0;
/// Cosine of the angle between both arms of a main street, up to which it runs straight through a junction.
const THROUGH: f64 = -0.97;
/// Distance at which streets end before another main street, in metres.
const SHORT_OF_MAIN: f64 = 20.0;
/// Lengths and distances this much alike make the same shape, in metres.
const ALIKE: f64 = 8.0;

/// Adds the pieces of a map.
pub(super) fn extract(ground: &Ground, options: &ExtractOptions, out: &mut MapPatches) {
    let graph = &ground.graph;
    let is_local = |e: &EdgeIx| graph.edge(*e).data == StreetClass::Local;
    let mut seeds: Vec<DVec2> = Vec::new();
    for v in graph.vertices() {
        let at = graph.at(v);
        let locals: Vec<EdgeIx> = graph.edges_at(v).iter().copied().filter(is_local).collect();
        let main: Vec<EdgeIx> = graph.edges_at(v).iter().copied().filter(|e| !is_local(e)).collect();
        let is_seed = !locals.is_empty() && (!main.is_empty() || locals.len() > 2);
        if !is_seed || !ground.has_all_streets_at(at) || seeds.iter().any(|s| s.distance(at) < options.interval) {
            continue;
        }
        seeds.push(at);
        let place = ground.in_map(at);
        let name = format!("{} {:.0} {:.0}", out.map, place.x, place.y);
        match main[..] {
            [] => add(Piece::around(graph, v, &locals, options.size / 2.0).drawing(name), options, out),
            [a, b] => {
                let [to_a, to_b] = [a, b].map(|e| (graph.at(graph.edge(e).other(v)) - at).normalize_or_zero());
                if to_a.dot(to_b) > THROUGH {
                    out.leave_out(NoPatch::SharpAngle, 1);
                    continue;
                }
                let along = (to_b - to_a).normalize_or_zero();
                for side in [1.0, -1.0] {
                    let is_beside = |e: &EdgeIx| {
                        let way = graph.at(graph.edge(*e).other(v)) - at;
                        side * along.perp_dot(way) > 0.5 * way.length()
                    };
                    let beside: Vec<EdgeIx> = locals.iter().copied().filter(is_beside).collect();
                    if !beside.is_empty() {
                        let piece = Piece::around(graph, v, &beside, options.size);
                        let mut drawing = piece.drawing(name.clone());
                        add_main(&mut drawing, along);
                        add(drawing, options, out);
                    }
                }
            }
            _ => out.leave_out(NoPatch::SharpAngle, 1),
        }
    }
}

/// Adds the main street that a drawing hangs on, in its first vertex.
fn add_main(drawing: &mut PatchDrawing, along: DVec2) {
    let Some(&first) = drawing.vertices.first() else { return };
    let n = drawing.vertices.len() as i64;
    drawing.vertices.extend([-1.0, 1.0].map(|sign| <(f64, f64)>::from(DVec2::from(first) + along * (sign * MAIN_ARM))));
    drawing.main.push(Line(vec![n, 0, n + 1]));
}

/// Adds a piece, unless no cell could use it.
fn add(drawing: PatchDrawing, options: &ExtractOptions, out: &mut MapPatches) {
    out.add(drawing, |patch| {
        let length: f64 = patch.edges.iter().filter(|e| !e.main).map(|e| length(patch, e.a, e.b)).sum();
        match () {
            () if length < options.least_streets => Err(NoPatch::FewStreets),
            () if patch.connectables.is_empty() => Err(NoPatch::Closed),
            () if patch.flaw(&DrawingRules::NONE).is_some() => Err(NoPatch::Crowded),
            () if patch.edges.iter().any(|e| e.main) && patch.main_line().is_none() => Err(NoPatch::Crowded),
            () => Ok(shape(patch, length)),
        }
    });
}

fn length(patch: &Patch, a: usize, b: usize) -> f64 {
    patch.vertices[a].distance(patch.vertices[b])
}

/// The shape of a piece, wherever it lies and however it is turned.
fn shape(patch: &Patch, length: f64) -> Shape {
    let junctions = (0..patch.vertices.len()).filter(|v| patch.is_intersection(*v)).count();
    let mut key = vec![junctions as i32, patch.connectables.len() as i32, (length / 20.0).round() as i32];
    key.extend(patch.pairs.iter().map(|pair| (pair.distance / ALIKE).round() as i32));
    let ends = patch.connectables.len() as f64;
    let apart = patch.pairs.last().map_or(0.0, |pair| pair.distance / 300.0);
    let has_main = if patch.edges.iter().any(|e| e.main) { 0.5 } else { 0.0 };
    let tags = patch.tags.len() as f64 / 6.0;
    Shape { key, figures: vec![length / 800.0, junctions as f64 / 6.0, ends / 6.0, apart, has_main, tags] }
}

/// Local streets that hang together, in metres from the junction around which they were cut.
struct Piece {
    graph: PlanarGraph<StreetClass>,
    dead_ends: Vec<VertexIx>,
}

impl Piece {
    /// The local streets that lead from a junction along some edges to no more than `radius` metres from it. They end at main
    /// streets.
    fn around(ground: &PlanarGraph<StreetClass>, seed: VertexIx, along: &[EdgeIx], radius: f64) -> Self {
        let centre = ground.at(seed);
        let local = |p: DVec2| ((p - centre) * 100.0).round() / 100.0;
        let mut graph = PlanarGraph::without_index();
        let mut vertices = BTreeMap::from([(seed, graph.add_vertex(DVec2::ZERO))]);
        let mut dead_ends = Vec::new();
        let mut edges: Vec<(VertexIx, EdgeIx)> = along.iter().map(|e| (seed, *e)).collect();
        let mut seen: Vec<EdgeIx> = along.to_vec();
        let mut next = 0;
        while let Some(&(from, e)) = edges.get(next) {
            next += 1;
            let to = ground.edge(e).other(from);
            let (a, b) = (ground.at(from), ground.at(to));
            let start = vertices[&from];
            if b.distance(centre) > radius {
                let end = graph.add_vertex(local(leaving(a, b, centre, radius)));
                if graph.at(start).distance(graph.at(end)) > 0.3 {
                    graph.add_edge(start, end, StreetClass::Local);
                }
                continue;
            }
            let is_main = ground.edges_at(to).iter().any(|f| ground.edge(*f).data != StreetClass::Local);
            if is_main && to != seed {
                // Streets that meet at a main street do not meet in the piece, which has only one.
                let room = a.distance(b) - SHORT_OF_MAIN;
                if room > SHORT_OF_MAIN {
                    let end = graph.add_vertex(local(a + (b - a).normalize() * room));
                    graph.add_edge(start, end, StreetClass::Local);
                }
                continue;
            }
            let end = *vertices.entry(to).or_insert_with(|| graph.add_vertex(local(b)));
            if start != end && graph.edge_between(start, end).is_none() {
                graph.add_edge(start, end, StreetClass::Local);
            }
            if ground.degree(to) == 1 {
                dead_ends.push(end);
            }
            for &f in ground.edges_at(to) {
                if to != seed && !seen.contains(&f) {
                    seen.push(f);
                    edges.push((to, f));
                }
            }
        }
        Self { graph, dead_ends }
    }

    /// The drawing, with the junction around which it was cut as its first vertex.
    fn drawing(&self, name: String) -> PatchDrawing {
        let mut drawing = draw(name, &self.graph, |v| self.dead_ends.contains(&v));
        let seed = drawing.vertices.iter().position(|v| *v == (0.0, 0.0)).unwrap_or(0);
        if seed > 0 {
            drawing.vertices.swap(0, seed);
            let swapped = |i: i64| match i {
                0 => seed as i64,
                i if i == seed as i64 => 0,
                i => i,
            };
            drawing.streets.iter_mut().flat_map(|Line(line)| line).for_each(|i| *i = swapped(*i));
            drawing.dead_ends.iter_mut().for_each(|i| *i = swapped(*i as i64) as usize);
        }
        drawing
    }
}

/// Where the segment from `a` inside a circle to `b` outside leaves it.
fn leaving(a: DVec2, b: DVec2, centre: DVec2, radius: f64) -> DVec2 {
    let (t, foot) = closest_on_segment(centre, a, b);
    let off = foot.distance_squared(centre);
    let onward = (b - a).normalize_or_zero();
    // The foot may lie beyond an end, where the end stands for it.
    let from = if t > 0.0 { foot } else { a };
    let (to, past) = (from - centre, onward.dot(from - centre));
    let root = (past * past + radius * radius - to.length_squared().max(off)).max(0.0).sqrt();
    from + onward * (root - past)
}
