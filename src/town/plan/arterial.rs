//! Which main streets are arterials: the cheapest ways from the gates of roads to the centre.

use super::sketch::Sketch;
use crate::network::{EdgeIx, StreetClass, VertexIx};
use crate::space::math::angle_between;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Cost of a turn of one radian at a junction, in metres of detour.
const TURN_COST: f64 = 90.0;
/// Cost of a metre of street that is already an arterial: less than 1, so that the ways from several gates join.
const SHARED: f64 = 0.6;

/// Makes the streets on the cheapest ways from the gates of roads to the centre arterials.
pub(super) fn mark_arterials(sketch: &mut Sketch) {
    let g = &sketch.graph;
    let by_centre = |a: &VertexIx, b: &VertexIx| g.at(*a).length().total_cmp(&g.at(*b).length()).then(a.cmp(b));
    let junctions = || g.vertices().filter(|v| g.degree(*v) > 0 && !sketch.is_gate(*v));
    let Some(hub) =
        junctions().filter(|v| g.degree(*v) > 2).min_by(by_centre).or_else(|| junctions().min_by(by_centre))
    else {
        return;
    };
    let mut order: Vec<usize> = (0..sketch.site.gates.len()).collect();
    order.retain(|i| sketch.site.gates[*i].class < StreetClass::Main);
    order.sort_by_key(|i| (sketch.site.gates[*i].class, sketch.site.gates[*i].vertex));
    for gate in order {
        if let Some(v) = sketch.gate_vertices[gate] {
            for e in way(sketch, v, hub) {
                if let Some(class) = sketch.graph.data_mut(e) {
                    *class = StreetClass::Arterial;
                }
            }
        }
    }
}

/// Edges of the cheapest way between two vertices. States are half-edges, so that turns can be counted.
fn way(sketch: &Sketch, from: VertexIx, to: VertexIx) -> Vec<EdgeIx> {
    let g = &sketch.graph;
    let slots = g.edges().map(|(e, _)| e as usize + 1).max().unwrap_or(0) * 2;
    let mut before = vec![usize::MAX; slots];
    let mut best = vec![u64::MAX; slots];
    // Costs are whole millimetres, which the queue can order.
    let cost = |e: EdgeIx| {
        let share = if g.edge(e).data == StreetClass::Arterial { SHARED } else { 1.0 };
        (g.edge_length(e) * share * 1000.0) as u64
    };
    let half = |e: EdgeIx, v: VertexIx| 2 * e as usize + usize::from(g.edge(e).a != v);
    let mut queue = BinaryHeap::new();
    for &e in g.edges_at(from) {
        best[half(e, from)] = cost(e);
        queue.push(Reverse((cost(e), half(e, from))));
    }
    while let Some(Reverse((reached, h))) = queue.pop() {
        if reached > best[h] {
            continue;
        }
        let e = (h / 2) as EdgeIx;
        let (tail, v) = if h % 2 == 0 { (g.edge(e).a, g.edge(e).b) } else { (g.edge(e).b, g.edge(e).a) };
        if v == to {
            let mut out = Vec::new();
            let mut h = h;
            while h != usize::MAX {
                out.push((h / 2) as EdgeIx);
                h = before[h];
            }
            return out;
        }
        for &next in g.edges_at(v) {
            if next == e {
                continue;
            }
            let w = g.edge(next).other(v);
            let turn = angle_between(g.at(v) - g.at(tail), g.at(w) - g.at(v));
            let turn = turn.min(1.5);
            let penalty = if g.degree(v) > 2 { TURN_COST * turn * turn * 1000.0 } else { 0.0 };
            let total = reached + cost(next) + penalty as u64;
            let onward = half(next, v);
            if total < best[onward] {
                (best[onward], before[onward]) = (total, h);
                queue.push(Reverse((total, onward)));
            }
        }
    }
    Vec::new()
}
