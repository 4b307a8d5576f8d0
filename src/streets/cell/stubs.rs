//! Stubs: the straight first metres of every port's street, which are there whatever comes later.

use super::canvas::{Canvas, Node};
use super::draft::Draft;
use crate::network::{EdgeIx, VertexIx};
use crate::seam::APPROACH_LENGTH;

/// Puts a stub at every port, so that each is met. Its end is the vertex [`stub_end`].
pub fn lay_stubs(draft: &mut Draft<'_>) {
    for (i, port) in draft.brief.ports.iter().enumerate() {
        let node = Node { open: true, wanted_degree: 2, ..Node::default() };
        let end = draft.canvas.add_vertex(port.at + port.inward * APPROACH_LENGTH, node);
        draft.canvas.add_stub(i as VertexIx, end);
    }
}

/// Makes the ends of all stubs candidates of the propagation; no more is laid at the ports.
pub fn grow_from_stubs(draft: &mut Draft<'_>) {
    let ports = draft.brief.ports.len();
    draft.candidates.extend((0..ports).map(|port| stub_end(ports, port)));
    draft.canvas.stamp_stubs(draft.brief.ports);
}

/// The vertex at the end of a port's stub in a cell of so many ports.
pub fn stub_end(ports: usize, port: usize) -> VertexIx {
    (ports + port) as VertexIx
}

/// Whether nothing but its stub is built on a port of a cell of so many ports.
pub fn has_stub(canvas: &Canvas, ports: usize, port: usize) -> bool {
    bare_stub(canvas, ports, port).is_some()
}

/// The stub of a port, if nothing else is built on the port.
fn bare_stub(canvas: &Canvas, ports: usize, port: usize) -> Option<EdgeIx> {
    let end = stub_end(ports, port);
    canvas.graph.edge_between(port as VertexIx, end).filter(|_| canvas.graph.degree(end) == 1)
}

/// Stubs that were taken away to make room for something that begins at their ports.
#[derive(Default)]
pub struct RemovedStubs(Vec<(VertexIx, VertexIx)>);

impl RemovedStubs {
    /// Takes away the stub of a port in a cell of so many ports. False, and nothing changes, if more is built there than the stub,
    /// which then holds what is built.
    pub fn remove(&mut self, canvas: &mut Canvas, ports: usize, port: usize) -> bool {
        let Some(stub) = bare_stub(canvas, ports, port) else { return false };
        canvas.graph.remove_edge(stub);
        self.0.push((port as VertexIx, stub_end(ports, port)));
        true
    }

    /// Puts the stubs back, for what was to begin there does not fit.
    pub fn restore(self, canvas: &mut Canvas) {
        for (port, end) in self.0 {
            canvas.add_stub(port, end);
        }
    }
}
