//! What maps have and streets of a town have not: points that do not show, stumps, and two streets that leave a junction side by
//! side.

use crate::network::{PlanarGraph, StreetClass, VertexIx};
use crate::space::{closest_on_segment, math::angle_between, simplify_line};
use glam::DVec2;

/// Points this near to a street's line do not show, in metres.
const FLAT: f64 = 0.6;
/// Dead ends shorter than this are driveways, in metres.
const STUMP: f64 = 6.0;
/// Streets that leave a vertex at a smaller angle run together for a while, in degrees. Patches may not have less than 20.
const SIDE_BY_SIDE: f64 = 22.0;
/// Distance from the longer of two such streets up to which the end of the shorter one lies on it, in metres.
const ON_IT: f64 = 4.0;
/// Number of rounds in which streets are pulled together.
const ROUNDS: usize = 6;

/// A graph with the same streets, tidied.
pub(super) fn tidy(graph: &PlanarGraph<StreetClass>) -> PlanarGraph<StreetClass> {
    let mut graph = simplified(graph);
    for _ in 0..ROUNDS {
        if !pull_together(&mut graph) {
            break;
        }
    }
    remove_stumps(&mut graph);
    simplified(&graph)
}

/// Whether a street goes on at a vertex as it came: there is nothing but a bend.
fn is_bend(graph: &PlanarGraph<StreetClass>, v: VertexIx) -> bool {
    matches!(graph.edges_at(v), [e, f] if graph.edge(*e).data == graph.edge(*f).data)
}

/// The graph without the points that do not show.
fn simplified(graph: &PlanarGraph<StreetClass>) -> PlanarGraph<StreetClass> {
    let mut out = PlanarGraph::new();
    let mut places: Vec<Option<VertexIx>> = vec![None; graph.vertex_count()];
    let mut at_end = |out: &mut PlanarGraph<StreetClass>, v: VertexIx| {
        *places[v as usize].get_or_insert_with(|| out.add_vertex(graph.at(v)))
    };
    for chain in graph.chains(|v| !is_bend(graph, v)) {
        let vertices = graph.chain_vertices(&chain);
        let class = graph.edge(chain[0].0).data;
        let line: Vec<DVec2> = vertices.iter().map(|v| graph.at(*v)).collect();
        let (first, last) = (vertices[0], vertices[vertices.len() - 1]);
        let mut line = simplify_line(&line, FLAT);
        if first == last && line.len() < 4 {
            // A loop needs three corners.
            line = vertices.iter().map(|v| graph.at(*v)).collect();
        }
        let mut before = at_end(&mut out, first);
        for (i, at) in line.iter().enumerate().skip(1) {
            let v = if i + 1 == line.len() { at_end(&mut out, last) } else { out.add_vertex(*at) };
            if v != before && out.edge_between(before, v).is_none() {
                out.add_edge(before, v, class);
            }
            before = v;
        }
    }
    out
}

/// Where two streets leave a vertex side by side, the shorter one leaves the longer one instead, at its own end. Returns whether
/// anything changed.
fn pull_together(graph: &mut PlanarGraph<StreetClass>) -> bool {
    let mut changed = false;
    for v in graph.vertices() {
        while let Some((short, long)) = side_by_side(graph, v) {
            changed = true;
            let Some(edge) = graph.remove_edge(short) else { break };
            let end = edge.other(v);
            let other = graph.edge(long).other(v);
            let (at, (a, b)) = (graph.at(end), graph.segment(long));
            let foot = closest_on_segment(at, a, b).1;
            let middle = if foot.distance(graph.at(other)) < ON_IT { other } else { graph.split_edge(long, foot) };
            if foot.distance(at) < ON_IT {
                merge(graph, end, middle);
            } else if end != middle && graph.edge_between(end, middle).is_none() {
                graph.add_edge(end, middle, edge.data);
            }
        }
    }
    changed
}

/// Two edges at a vertex that are side by side, the shorter one first.
fn side_by_side(graph: &PlanarGraph<StreetClass>, v: VertexIx) -> Option<(u32, u32)> {
    let at = graph.at(v);
    let edges = graph.edges_at(v);
    let way = |e: u32| graph.at(graph.edge(e).other(v)) - at;
    let pairs = edges.iter().enumerate().flat_map(|(i, e)| edges[..i].iter().map(move |f| (*e, *f)));
    let (e, f) = pairs.into_iter().find(|(e, f)| angle_between(way(*e), way(*f)).to_degrees() < SIDE_BY_SIDE)?;
    Some(if way(e).length() <= way(f).length() { (e, f) } else { (f, e) })
}

/// Leads the edges of a vertex to another one.
fn merge(graph: &mut PlanarGraph<StreetClass>, from: VertexIx, to: VertexIx) {
    if from == to {
        return;
    }
    for e in graph.edges_at(from).to_vec() {
        let Some(edge) = graph.remove_edge(e) else { continue };
        let end = edge.other(from);
        if end != to && graph.edge_between(end, to).is_none() {
            graph.add_edge(end, to, edge.data);
        }
    }
}

/// Removes the shortest dead ends.
fn remove_stumps(graph: &mut PlanarGraph<StreetClass>) {
    for chain in graph.chains(|v| !is_bend(graph, v)) {
        let vertices = graph.chain_vertices(&chain);
        let (first, last) = (vertices[0], vertices[vertices.len() - 1]);
        let length: f64 = chain.iter().map(|(e, _)| graph.edge_length(*e)).sum();
        if length < STUMP && [first, last].iter().any(|v| graph.degree(*v) == 1) {
            for (e, _) in chain {
                graph.remove_edge(e);
            }
        }
    }
}
