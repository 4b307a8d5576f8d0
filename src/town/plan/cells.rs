//! Main streets and main cells, read off the finished graphs.

use super::border::BorderStreets;
use super::cell_graph::CellGraph;
use super::sketch::Sketch;
use crate::network::{Face, Junction, JunctionId, Side, Street, StreetId, VertexIx, is_round};
use crate::region::SettlementId;
use crate::space::{line_length, point_at, point_in_polygon, pole, quantum_key, stable_hash};
use crate::town::{CellId, CellSide, CellUse, MainCell, MainStreet};
use glam::DVec2;

/// Words that tell the names of a town's junctions, main streets and main cells apart.
const JUNCTION_NAME: u64 = 0x6a;
const STREET_NAME: u64 = 0x6d;
const CELL_NAME: u64 = 0x63;

/// Junctions, main streets and main cells.
pub(super) struct Parts {
    pub junctions: Vec<Junction>,
    pub mains: Vec<MainStreet>,
    pub cells: Vec<MainCell>,
}

/// Reads junctions, streets and cells off the sketch and the graph of its cells.
pub(super) fn parts(
    settlement: SettlementId,
    sketch: &Sketch,
    cell_graph: &CellGraph,
    borders: &BorderStreets,
) -> Parts {
    let (streets, graph, site) = (&sketch.graph, &cell_graph.graph, &sketch.site);
    // A cut that meets a street divides the street, so that a street has one cell on each side. A gate on a border is always a
    // junction, since the neighbour has a street there.
    let is_junction = |v: VertexIx| {
        let degree = streets.degree(v);
        let passed = borders.passes(v) && !sketch.is_gate(v);
        degree > 0 && !passed && (sketch.is_gate(v) || degree != 2 || graph.degree(v) != degree)
    };
    let id = |v: VertexIx| match sketch.gate_vertices.iter().position(|g| *g == Some(v)) {
        Some(gate) => site.gates[gate].junction,
        None => {
            let [x, y] = quantum_key(streets.at(v));
            JunctionId::of(&[settlement.0, JUNCTION_NAME, x, y])
        }
    };
    let junctions =
        streets.vertices().filter(|v| is_junction(*v)).map(|v| Junction { id: id(v), at: streets.at(v) }).collect();
    // Street and direction of each edge of the sketch.
    let slots = streets.edges().map(|(e, _)| e as usize + 1).max().unwrap_or(0);
    let mut along = vec![(usize::MAX, true); slots];
    let mut mains = Vec::new();
    for mut chain in streets.chains(is_junction) {
        let mut vertices = streets.chain_vertices(&chain);
        let shared = borders.street(chain[0].0);
        if shared.is_some_and(|s| s.street.from != id(vertices[0])) {
            // Along a border the line runs the same way on both sides.
            vertices.reverse();
            chain.reverse();
            chain.iter_mut().for_each(|(_, forward)| *forward = !*forward);
        }
        let line: Vec<DVec2> = vertices.iter().map(|v| streets.at(*v)).collect();
        for (e, forward) in &chain {
            along[*e as usize] = (mains.len(), *forward);
        }
        let (from, to) = (id(vertices[0]), id(vertices[vertices.len() - 1]));
        let [x, y] = quantum_key(point_at(&line, line_length(&line) / 2.0).0);
        let name = StreetId::of(&[settlement.0, STREET_NAME, from.0.min(to.0), from.0.max(to.0), x, y]);
        let street = match shared {
            Some(shared) => shared.street.clone(),
            None => {
                let bridge = site.river.as_ref().is_some_and(|r| line.len() == 2 && r.way.crosses(line[0], line[1]));
                Street {
                    bridge,
                    level: i8::from(bridge),
                    ..Street::new(name, streets.edge(chain[0].0).data, from, to, line)
                }
            }
        };
        let border = shared.map(|s| s.border.clone());
        mains.push(MainStreet { street, left: MainStreet::OUTSIDE, right: MainStreet::OUTSIDE, border });
    }
    let mut cells = Vec::new();
    for face in graph.faces().into_iter().filter(|f| f.area() > 0.0) {
        let side_of = |i: usize| {
            let h = face.walk[i];
            let (main, forward) = *along.get(*cell_graph.edges.get(h.edge as usize)? as usize)?;
            Some((main, forward == h.forward))
        };
        for (main, forward) in (0..face.walk.len()).filter_map(side_of) {
            let street = &mut mains[main];
            *(if forward { &mut street.left } else { &mut street.right }) = cells.len();
        }
        let mut cell = cell(settlement, &face, side_of, |i| is_junction(face.vertices[i]));
        if sketch.open_spaces.iter().any(|p| point_in_polygon(*p, &cell.border)) {
            cell.cell_use = CellUse::Open;
            if is_round(&cell.border) {
                for side in &cell.sides {
                    // The cell lies to the left of its border.
                    let island = if side.forward { Side::Left } else { Side::Right };
                    side.main.into_iter().for_each(|main| mains[main].street.island = Some(island));
                }
            }
        } else if site.river.as_ref().is_some_and(|river| river.is_water(graph, &face)) {
            cell.cell_use = CellUse::Water;
        }
        cells.push(cell);
    }
    Parts { junctions, mains, cells }
}

/// The cell of a face. `side_of` gives the main street of a half-edge, and whether the half-edge runs along the street's line.
fn cell(
    settlement: SettlementId,
    face: &Face,
    side_of: impl Fn(usize) -> Option<(usize, bool)>,
    is_junction: impl Fn(usize) -> bool,
) -> MainCell {
    let n = face.walk.len();
    // A side begins where the street changes, or at a junction where a street meets itself.
    let begins = |i: usize| {
        let (before, here) = (side_of((i + n - 1) % n), side_of(i));
        before != here || (here.is_some() && is_junction(i))
    };
    let first = (0..n).find(|i| begins(*i)).unwrap_or(0);
    let border: Vec<DVec2> = (0..n).map(|i| face.polygon[(first + i) % n]).collect();
    let mut sides: Vec<CellSide> = Vec::new();
    for i in 0..n {
        let k = (first + i) % n;
        if i == 0 || begins(k) {
            let side = side_of(k);
            let (main, forward) = (side.map(|s| s.0), side.is_none_or(|s| s.1));
            sides.push(CellSide { main, forward, first: i, count: 0 });
        }
        if let Some(side) = sides.last_mut() {
            side.count += 1;
        }
    }
    // The lowest half-edge names the cell, since no two cells walk the same half-edge.
    let half_edge = |i: usize| {
        let ([ax, ay], [bx, by]) = (quantum_key(border[i]), quantum_key(border[(i + 1) % n]));
        [ax, ay, bx, by]
    };
    let name = (0..n).map(half_edge).min().unwrap_or_default();
    let id = CellId(stable_hash(&[settlement.0, CELL_NAME, name[0], name[1], name[2], name[3]]));
    MainCell { id, cell_use: CellUse::Built, anchor: pole(&border, 4.0).0, border, sides }
}
