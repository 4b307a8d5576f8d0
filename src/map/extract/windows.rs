//! Windows that slide over a map.

use super::drawing::draw;
use super::found::MapPatches;
use super::ground::{Ground, GroundBuilding};
use super::options::{ExtractOptions, NoPatch};
use super::shape::Shape;
use crate::network::{PlanarGraph, StreetClass, VertexIx};
use crate::patch::{BuildingDrawing, Patch, PatchDrawing, PatchWindow, WindowDrawing};
use crate::space::Bounds;
use glam::DVec2;
use std::collections::BTreeMap;

/// Pieces of streets shorter than this are left out where the border of a drawing cuts them off, in metres.
const SCRAP: f64 = 12.0;
/// Distance up to which places of crossings are alike, in metres.
const ALIKE: f64 = 6.0;

/// Adds the windows of a map.
pub(super) fn extract(ground: &Ground, options: &ExtractOptions, out: &mut MapPatches) {
    let half = options.size / 2.0;
    let room = ground.bounds();
    let steps = ((room.size() - options.size) / options.interval).floor().max(DVec2::NEG_ONE);
    // As far from one side of the map as from the other.
    let first = room.centre() - steps * options.interval / 2.0;
    for row in 0..=steps.y as i64 {
        for column in 0..=steps.x as i64 {
            let middle = (first + DVec2::new(column as f64, row as f64) * options.interval).round();
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            if !corners.iter().all(|c| ground.covers(middle + DVec2::from(*c) * half)) {
                continue;
            }
            let cut = Cut::of(ground, middle, half + options.margin);
            if cut.graph.edges().next().is_none() || cut.length_within(half) < options.least_streets {
                out.leave_out(NoPatch::FewStreets, 1);
                continue;
            }
            let at = ground.in_map(middle);
            let drawing = cut.drawing(format!("{} {:.0} {:.0}", out.map, at.x, at.y));
            let window = WindowDrawing {
                size: options.size,
                margin: options.margin,
                map: out.map.clone(),
                at: at.into(),
                turned_deg: ground.turned.to_degrees(),
                buildings: buildings(ground, middle, half + options.margin),
            };
            out.add(PatchDrawing { window: Some(window), ..drawing }, |patch| Ok(shape(patch)));
        }
    }
}

/// The buildings whose middles lie within `half` metres of a point along both axes, in metres from that point.
fn buildings(ground: &Ground, middle: DVec2, half: f64) -> Vec<BuildingDrawing> {
    let drawing = |building: &GroundBuilding| BuildingDrawing {
        outline: building.outline.iter().map(|p| ((*p - middle) * 100.0).round() / 100.0).map(DVec2::into).collect(),
        height: building.height,
        storeys: building.storeys,
    };
    ground.buildings_in(Bounds::square(middle, 2.0 * half)).map(drawing).collect()
}

/// The streets in a square, in metres from its middle.
struct Cut {
    graph: PlanarGraph<StreetClass>,
    /// Vertices at which streets end for good.
    dead_ends: Vec<VertexIx>,
}

impl Cut {
    /// The streets within `half` metres of a point along both axes.
    fn of(ground: &Ground, middle: DVec2, half: f64) -> Self {
        let bounds = Bounds::square(middle, 2.0 * half);
        let mut graph = PlanarGraph::without_index();
        let mut vertices: BTreeMap<VertexIx, VertexIx> = BTreeMap::new();
        let local = |p: DVec2| ((p - middle) * 100.0).round() / 100.0;
        for e in ground.graph.edges_near(bounds) {
            let edge = ground.graph.edge(e).clone();
            let (a, b) = ground.graph.segment(e);
            let Some((from, to)) = bounds.clip_segment(a, b) else { continue };
            let mut end = |v: VertexIx, is_whole: bool, at: DVec2| {
                let at = local(at);
                if is_whole { *vertices.entry(v).or_insert_with(|| graph.add_vertex(at)) } else { graph.add_vertex(at) }
            };
            let ends = [end(edge.a, from == 0.0, a.lerp(b, from)), end(edge.b, to == 1.0, a.lerp(b, to))];
            if graph.at(ends[0]).distance(graph.at(ends[1])) > 0.3 {
                graph.add_edge(ends[0], ends[1], edge.data);
            }
        }
        let is_dead_end = |(v, _): &(&VertexIx, &VertexIx)| ground.graph.degree(**v) == 1;
        let mut dead_ends: Vec<VertexIx> = vertices.iter().filter(is_dead_end).map(|(_, v)| *v).collect();
        dead_ends.sort_unstable();
        let mut cut = Self { graph, dead_ends };
        cut.remove_scraps();
        cut
    }

    /// Removes the streets that are cut off from others and too short.
    fn remove_scraps(&mut self) {
        let parts = self.graph.components();
        let mut lengths: BTreeMap<u32, f64> = BTreeMap::new();
        for (e, edge) in self.graph.edges() {
            if let Some(part) = parts[edge.a as usize] {
                *lengths.entry(part).or_default() += self.graph.edge_length(e);
            }
        }
        let is_scrap = |v: VertexIx| parts[v as usize].is_some_and(|part| lengths[&part] < SCRAP);
        let scraps: Vec<_> = self.graph.edges().filter(|(_, edge)| is_scrap(edge.a)).map(|(e, _)| e).collect();
        for e in scraps {
            self.graph.remove_edge(e);
        }
    }

    /// Length of the streets within `half` metres of the middle along both axes.
    fn length_within(&self, half: f64) -> f64 {
        let bounds = Bounds::square(DVec2::ZERO, 2.0 * half);
        let segments = self.graph.edges().map(|(e, _)| self.graph.segment(e));
        segments.filter_map(|(a, b)| bounds.clip_segment(a, b).map(|(s, t)| (t - s) * a.distance(b))).sum()
    }

    /// The streets as a drawing without a window.
    fn drawing(&self, name: String) -> PatchDrawing {
        draw(name, &self.graph, |v| self.dead_ends.binary_search(&v).is_ok())
    }
}

/// The shape of a window: where streets leave it, and what is inside.
fn shape(patch: &Patch) -> Shape {
    let Some(window) = &patch.window else { return Shape::default() };
    let crossings = crossings(patch, window);
    let length: f64 = patch.edges.iter().map(|e| patch.vertices[e.a].distance(patch.vertices[e.b])).sum();
    let mut degrees = vec![0usize; patch.vertices.len()];
    patch.edges.iter().flat_map(|e| [e.a, e.b]).for_each(|v| degrees[v] += 1);
    let junctions = degrees.iter().filter(|d| **d > 2).count();
    let ends = degrees.iter().filter(|d| **d == 1).count();
    let mut key = vec![junctions as i32, ends as i32, (length / 25.0).round() as i32];
    for side in &crossings {
        key.push(side.len() as i32);
        key.extend(side.iter().map(|at| (at / ALIKE).round() as i32));
    }
    let mut figures: Vec<f64> = crossings.iter().map(|side| side.len() as f64 / 4.0).collect();
    figures.extend([length / (8.0 * window.size), junctions as f64 / 12.0, ends as f64 / 12.0]);
    figures.extend(crossings.iter().map(|side| side.iter().sum::<f64>() / (side.len().max(1) as f64 * window.size)));
    Shape { key, figures }
}

/// Where streets cross the four sides of a window, in metres along each side, sorted.
fn crossings(patch: &Patch, window: &PatchWindow) -> [Vec<f64>; 4] {
    let half = window.size / 2.0;
    let mut out: [Vec<f64>; 4] = Default::default();
    for edge in &patch.edges {
        let (a, b) = (patch.vertices[edge.a] - window.middle, patch.vertices[edge.b] - window.middle);
        for (side, (axis, at)) in [(0, -half), (0, half), (1, -half), (1, half)].into_iter().enumerate() {
            if (a[axis] < at) != (b[axis] < at) {
                let along = a.lerp(b, (at - a[axis]) / (b[axis] - a[axis]))[1 - axis];
                if along.abs() <= half {
                    out[side].push(along);
                }
            }
        }
    }
    out.iter_mut().for_each(|side| side.sort_by(f64::total_cmp));
    out
}
