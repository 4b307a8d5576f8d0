//! Graphs as drawings.

use crate::network::{PlanarGraph, StreetClass, VertexIx};
use crate::patch::{Line, PatchDrawing};

/// A drawing of a graph; `is_dead_end` holds for the vertices at which streets end for good.
pub(super) fn draw(
    name: String,
    graph: &PlanarGraph<StreetClass>,
    is_dead_end: impl Fn(VertexIx) -> bool,
) -> PatchDrawing {
    let mut numbers = vec![None; graph.vertex_count()];
    let mut drawing = PatchDrawing {
        name,
        vertices: Vec::new(),
        streets: Vec::new(),
        main: Vec::new(),
        classes: Vec::new(),
        dead_ends: Vec::new(),
        tags: Vec::new(),
        weight: 1.0,
        at_most: None,
        window: None,
    };
    let is_end = |v: VertexIx| match graph.edges_at(v) {
        [e, f] => graph.edge(*e).data != graph.edge(*f).data,
        _ => true,
    };
    for chain in graph.chains(is_end) {
        let mut line = Vec::with_capacity(chain.len() + 1);
        for v in graph.chain_vertices(&chain) {
            let number = *numbers[v as usize].get_or_insert_with(|| {
                drawing.vertices.push(graph.at(v).into());
                if graph.degree(v) == 1 && is_dead_end(v) {
                    drawing.dead_ends.push(drawing.vertices.len() - 1);
                }
                drawing.vertices.len() as i64 - 1
            });
            line.push(number);
        }
        drawing.classes.push(graph.edge(chain[0].0).data);
        drawing.streets.push(Line(line));
    }
    drawing
}
