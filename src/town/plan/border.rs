//! Streets along the borders that a settlement shares with others. They are laid last, so that the settlement's streets
//! attach to them at their gates and nowhere else: the other settlement has the same border streets.

use super::sketch::Sketch;
use crate::network::{EdgeIx, Street, VertexIx};
use crate::region::{Border, Outline};
use crate::space::Origin;
use std::sync::Arc;

/// A street along a border, local to the settlement.
pub(super) struct BorderStreet {
    pub border: Arc<Border>,
    pub street: Street,
}

/// The streets along the borders of a settlement, as a part of the sketch.
#[derive(Default)]
pub(super) struct BorderStreets {
    pub streets: Vec<BorderStreet>,
    /// The outline's vertices that the streets pass, each with the sketch's vertex at the same place.
    vertices: Vec<(usize, VertexIx)>,
    /// The sketch's edges of these streets, in ascending order, each with the index of its street.
    edges: Vec<(EdgeIx, usize)>,
}

impl BorderStreets {
    /// The sketch's vertex at a vertex of the outline that a border street passes.
    pub fn vertex(&self, of_outline: usize) -> Option<VertexIx> {
        self.vertices.iter().find(|(i, _)| *i == of_outline).map(|(_, v)| *v)
    }

    /// Whether a border street passes a vertex of the sketch.
    pub fn passes(&self, v: VertexIx) -> bool {
        self.vertices.iter().any(|(_, w)| *w == v)
    }

    /// The border street that an edge of the sketch belongs to.
    pub fn street(&self, edge: EdgeIx) -> Option<&BorderStreet> {
        let i = self.edges.binary_search_by_key(&edge, |(e, _)| *e).ok()?;
        self.streets.get(self.edges[i].1)
    }
}

/// Lays the streets between the gates of each border.
pub(super) fn lay_borders(sketch: &mut Sketch, outline: &Outline, origin: Origin) -> BorderStreets {
    let mut out = BorderStreets::default();
    for shared in &outline.shared {
        let (border, shift) = (&shared.border, shared.border.origin.offset_to(origin));
        for (street, ends) in border.streets().into_iter().zip(border.gates.windows(2)) {
            let vertices: Vec<VertexIx> =
                (ends[0]..=ends[1]).map(|i| vertex_at(sketch, &mut out, shared.vertex(i))).collect();
            for pair in vertices.windows(2) {
                let edge = sketch.graph.add_edge(pair[0], pair[1], border.class);
                out.edges.push((edge, out.streets.len()));
            }
            out.streets.push(BorderStreet { border: border.clone(), street: street.moved(shift) });
        }
    }
    out
}

/// The sketch's vertex at a vertex of the outline; at a gate the gate's own. Adds a vertex if there is none yet.
fn vertex_at(sketch: &mut Sketch, borders: &mut BorderStreets, of_outline: usize) -> VertexIx {
    if let Some(v) = borders.vertex(of_outline) {
        return v;
    }
    let gate = sketch.site.gates.iter().position(|g| g.vertex == of_outline);
    let v = match gate.and_then(|g| sketch.gate_vertices[g]) {
        Some(v) => v,
        None => sketch.graph.add_vertex(sketch.site.outline[of_outline]),
    };
    if let Some(g) = gate {
        sketch.gate_vertices[g] = Some(v);
    }
    borders.vertices.push((of_outline, v));
    v
}
