//! The finished cell: chains of edges become streets with stable names.

use super::Work;
use crate::network::{EdgeIx, Junction, JunctionId, Street, StreetClass, StreetId, VertexIx};
use crate::space::QUANTUM;
use crate::streets::{CellStreets, LocalStreet, MadeBy};
use glam::DVec2;

/// A position on the quantum grid as words of a name.
fn words(p: DVec2) -> [u64; 2] {
    let grid = (p / QUANTUM).round();
    [grid.x as i64 as u64, grid.y as i64 as u64]
}

impl Work<'_> {
    /// The streets of the cell.
    pub(super) fn finish(self) -> CellStreets {
        let g = &self.canvas.graph;
        let mut out = CellStreets::default();
        let cell = self.brief.id.0;
        let name = |v: VertexIx| match self.canvas.nodes[v as usize].port {
            Some(port) => self.brief.ports[port].junction,
            None => {
                let [x, y] = words(g.at(v));
                JunctionId::of(&[cell, x, y])
            }
        };
        // A street that comes back to where it began is divided at its middle, so that its ends differ.
        let mut divided = vec![false; g.vertex_count()];
        let mut chains = g.chains(|v| self.canvas.is_end(v));
        let mut any = false;
        for chain in &chains {
            let end = |(e, forward): (EdgeIx, bool), last: bool| {
                let edge = g.edge(e);
                if forward == last { edge.b } else { edge.a }
            };
            let (Some(&first), Some(&last)) = (chain.first(), chain.last()) else { continue };
            if end(first, false) == end(last, true) {
                let vertices = g.chain_vertices(chain);
                divided[vertices[vertices.len() / 2] as usize] = true;
                divided[vertices[0] as usize] = true;
                any = true;
            }
        }
        let is_end = |v: VertexIx| self.canvas.is_end(v) || divided[v as usize];
        if any {
            chains = g.chains(is_end);
        }
        for chain in chains {
            let vertices = g.chain_vertices(&chain);
            let line: Vec<DVec2> = vertices.iter().map(|v| g.at(*v)).collect();
            let (from, to) = (name(vertices[0]), name(vertices[vertices.len() - 1]));
            let class = vertices.iter().find_map(|v| self.canvas.nodes[*v as usize].port);
            let class = class.map_or(StreetClass::Local, |port| self.brief.ports[port].class);
            let (first, second) = (words(line[0]), words(line[1]));
            let last = words(line[line.len() - 1]);
            let id = StreetId::of(&[cell, first[0], first[1], second[0], second[1], last[0], last[1]]);
            let made_by = self.maker(&chain);
            let line = self.rounded(&vertices, line);
            out.streets.push(LocalStreet { street: Street::new(id, class, from, to, line), made_by });
        }
        for v in g.vertices() {
            if g.degree(v) > 0 && is_end(v) && self.canvas.nodes[v as usize].port.is_none() {
                out.junctions.push(Junction { id: name(v), at: g.at(v) });
            }
        }
        for (i, port) in self.brief.ports.iter().enumerate() {
            if g.degree(i as VertexIx) == 0 {
                out.unmet.push(port.junction);
            }
        }
        out
    }

    /// What made the greatest part of a chain.
    pub(super) fn maker(&self, chain: &[(EdgeIx, bool)]) -> MadeBy {
        let g = &self.canvas.graph;
        if let [(e, _)] = chain {
            return g.edge(*e).data;
        }
        let mut shares: Vec<(MadeBy, f64)> = Vec::new();
        for (e, _) in chain {
            let (a, b) = g.segment(*e);
            let (made_by, length) = (g.edge(*e).data, a.distance(b));
            match shares.iter_mut().find(|s| s.0 == made_by) {
                Some(s) => s.1 += length,
                None => shares.push((made_by, length)),
            }
        }
        let best = shares.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
        best.map_or(MadeBy::Growth, |b| b.0)
    }
}
