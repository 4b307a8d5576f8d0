//! The finished cell: the graph becomes streets and junctions with stable ids.

use super::canvas::Maker;
use super::draft::Draft;
use super::exceptions::{Finished, exceptions};
use super::rounding::rounded;
use crate::network::{
    EdgeIx, Face, Junction, JunctionId, Street, StreetClass, StreetId, VertexIx, is_round, island_side,
};
use crate::space::quantum_key;
use crate::streets::filler::{CellStreets, LocalStreet, MadeBy, StreetOrigin};
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The streets of the finished cell, made by the filler of this name. `pieces` names what it laid, by the number in
/// [`Maker::Piece`].
pub fn finish(draft: &Draft<'_>, filler: &'static str, pieces: &[Arc<str>]) -> CellStreets {
    let g = &draft.canvas.graph;
    let mut out = CellStreets::default();
    let cell = draft.brief.id.0;
    let name = |v: VertexIx| match draft.canvas.nodes[v as usize].port {
        Some(port) => draft.brief.ports[port].junction,
        None => {
            let [x, y] = quantum_key(g.at(v));
            JunctionId::of(&[cell, x, y])
        }
    };
    // A street that comes back to where it began is divided at its middle, so that its ends differ.
    let mut divided = vec![false; g.vertex_count()];
    let mut chains = g.chains(|v| draft.canvas.is_end(v));
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
    let is_end = |v: VertexIx| draft.canvas.is_end(v) || divided[v as usize];
    if any {
        chains = g.chains(is_end);
    }
    let rings = rings(draft);
    let mut finished = Vec::with_capacity(chains.len());
    let mut lines = Vec::with_capacity(chains.len());
    for chain in chains {
        let vertices = g.chain_vertices(&chain);
        let line: Vec<DVec2> = vertices.iter().map(|v| g.at(*v)).collect();
        let ends = [vertices[0], vertices[vertices.len() - 1]];
        let class = vertices.iter().find_map(|v| draft.canvas.nodes[*v as usize].port);
        let class = class.map_or(StreetClass::Local, |port| draft.brief.ports[port].class);
        let (first, second) = (quantum_key(line[0]), quantum_key(line[1]));
        let last = quantum_key(line[line.len() - 1]);
        let id = StreetId::of(&[cell, first[0], first[1], second[0], second[1], last[0], last[1]]);
        let origin = match draft.canvas.maker(&chain) {
            Maker::Growth => StreetOrigin::Growth,
            Maker::Repair | Maker::Link => StreetOrigin::Repair,
            Maker::Piece(number) => StreetOrigin::Piece(pieces[number as usize].clone()),
        };
        let line = rounded(&draft.canvas, &draft.rules, &vertices, line);
        let island = island_side(chain.iter().map(|(e, forward)| rings.get(e).map(|along| along == forward)));
        let street = Street { island, ..Street::new(id, class, name(ends[0]), name(ends[1]), line) };
        lines.push(LocalStreet { street, made_by: MadeBy { filler, origin } });
        finished.push((ends, vertices, chain));
    }
    let streets: Vec<Finished<'_>> = finished
        .into_iter()
        .zip(&lines)
        .map(|((ends, vertices, chain), s)| Finished { ends, vertices, chain, line: &s.street.line })
        .collect();
    out.exceptions = exceptions(draft, &streets);
    out.streets = lines;
    for v in g.vertices() {
        if g.degree(v) > 0 && is_end(v) && draft.canvas.nodes[v as usize].port.is_none() {
            out.junctions.push(Junction { id: name(v), at: g.at(v) });
        }
    }
    for (i, port) in draft.brief.ports.iter().enumerate() {
        if g.degree(i as VertexIx) == 0 {
            out.unmet.push(port.junction);
        }
    }
    out
}

/// The edges on the rings of roundabouts, each with whether its ring, counter-clockwise, passes it from its first vertex to its
/// second.
fn rings(draft: &Draft<'_>) -> BTreeMap<EdgeIx, bool> {
    let g = &draft.canvas.graph;
    if !draft.has_rings {
        return BTreeMap::new();
    }
    let is_ring = |face: &Face| {
        let arms = face.vertices.iter().filter(|v| g.degree(**v) > 2).count();
        arms >= 2 && face.area() > 0.0 && is_round(&face.polygon)
    };
    let rings = g.faces().into_iter().filter(is_ring);
    rings.flat_map(|face| face.walk).map(|h| (h.edge, h.forward)).collect()
}
