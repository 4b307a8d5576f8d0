//! Streets along the borders that a settlement shares with others. They are laid when all else stands, so that the
//! settlement attaches to them in their gates and nowhere else: the other settlement holds the very same streets.

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

/// The streets along the borders of a settlement, as parts of the sketch.
#[derive(Default)]
pub(super) struct Laid {
    pub streets: Vec<BorderStreet>,
    /// Vertices of the outline that they pass, with the sketch's vertex there.
    vertices: Vec<(usize, VertexIx)>,
    /// Edges, in ascending order, with the index of their street.
    edges: Vec<(EdgeIx, usize)>,
}

impl Laid {
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
pub(super) fn lay(sketch: &mut Sketch, outline: &Outline, origin: Origin) -> Laid {
    let mut laid = Laid::default();
    for shared in &outline.shared {
        let (border, shift) = (&shared.border, shared.border.origin.offset_to(origin));
        for (street, ends) in border.streets().into_iter().zip(border.gates.windows(2)) {
            let vertices: Vec<VertexIx> =
                (ends[0]..=ends[1]).map(|i| vertex_at(sketch, &mut laid, shared.vertex(i))).collect();
            for pair in vertices.windows(2) {
                let edge = sketch.graph.add_edge(pair[0], pair[1], border.class);
                laid.edges.push((edge, laid.streets.len()));
            }
            laid.streets.push(BorderStreet { border: border.clone(), street: street.moved(shift) });
        }
    }
    laid
}

/// The sketch's vertex at a vertex of the outline; that of its gate where it has one.
fn vertex_at(sketch: &mut Sketch, laid: &mut Laid, of_outline: usize) -> VertexIx {
    if let Some(v) = laid.vertex(of_outline) {
        return v;
    }
    let gate = sketch.gates.iter().position(|g| g.vertex == of_outline);
    let v = match gate.and_then(|g| sketch.gate_vertices[g]) {
        Some(v) => v,
        None => sketch.graph.add_vertex(sketch.outline[of_outline]),
    };
    if let Some(g) = gate {
        sketch.gate_vertices[g] = Some(v);
    }
    laid.vertices.push((of_outline, v));
    v
}
