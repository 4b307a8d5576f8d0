//! The network of main streets while it is planned.

use super::rules::Rules;
use super::site::Site;
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use glam::DVec2;

/// What a street begins or ends at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// A vertex of the network.
    Vertex(VertexIx),
    /// An edge of the network, at this point.
    Edge(EdgeIx, DVec2),
    /// A gate that has no street yet.
    Gate(usize),
    /// Nothing.
    Free,
}

/// The network of main streets while it is planned. Edges carry their class.
pub(super) struct Sketch<'a> {
    pub site: Site<'a>,
    pub rules: Rules,
    pub graph: PlanarGraph<StreetClass>,
    /// Vertex in `graph` of each gate that has a street.
    pub gate_vertices: Vec<Option<VertexIx>>,
    /// Middles of roundabouts and squares.
    pub open_spaces: Vec<DVec2>,
}

impl<'a> Sketch<'a> {
    pub fn new(site: Site<'a>, rules: Rules) -> Self {
        let gate_vertices = vec![None; site.gates.len()];
        Self { site, rules, graph: PlanarGraph::new(), gate_vertices, open_spaces: Vec::new() }
    }

    /// Removes all streets.
    pub fn clear(&mut self) {
        self.graph = PlanarGraph::new();
        self.gate_vertices = vec![None; self.site.gates.len()];
    }

    pub fn is_empty(&self) -> bool {
        self.graph.edges().next().is_none()
    }

    pub fn is_gate(&self, v: VertexIx) -> bool {
        self.gate_vertices.contains(&Some(v))
    }

    /// Whether a vertex lies on a bank line of the river.
    pub fn is_on_bank(&self, v: VertexIx) -> bool {
        self.site.river.as_ref().is_some_and(|river| river.way.bank_at(self.graph.at(v)).is_some())
    }

    /// Vertices of degree 1 that are not gates.
    pub fn dead_ends(&self) -> Vec<VertexIx> {
        self.graph.vertices().filter(|v| self.graph.degree(*v) == 1 && !self.is_gate(*v)).collect()
    }

    /// Adds a street along `path`, whose first and last points are those of `start` and `end`; returns its end vertices.
    pub fn add(&mut self, path: &[DVec2], start: End, end: End) -> (VertexIx, VertexIx) {
        let first = self.end_vertex(start, path[0]);
        let last = self.end_vertex(end, path[path.len() - 1]);
        let mut before = first;
        for p in &path[1..path.len() - 1] {
            let v = self.graph.add_vertex(*p);
            self.graph.add_edge(before, v, StreetClass::Main);
            before = v;
        }
        self.graph.add_edge(before, last, StreetClass::Main);
        (first, last)
    }

    /// The vertex of an end at `p`. Adds a vertex if there is none yet.
    fn end_vertex(&mut self, end: End, p: DVec2) -> VertexIx {
        match end {
            End::Vertex(v) => v,
            End::Edge(e, p) => self.graph.split_edge(e, p),
            End::Free => self.graph.add_vertex(p),
            End::Gate(i) => {
                let v = self.graph.add_vertex(p);
                self.gate_vertices[i] = Some(v);
                v
            }
        }
    }

    /// Removes streets that end in nothing, until none is left.
    pub fn prune(&mut self) {
        let mut dead_ends = self.dead_ends();
        while let Some(mut v) = dead_ends.pop() {
            while let [e] = *self.graph.edges_at(v)
                && !self.is_gate(v)
            {
                let other = self.graph.edge(e).other(v);
                self.graph.remove_edge(e);
                v = other;
            }
        }
    }
}
