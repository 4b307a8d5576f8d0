//! Floating streets: streets that no way connects to a port are connected to the rest.

use super::draft::Draft;
use super::mend::{Mend, build_best, landing};
use super::obstacle::NONE;
use super::proposal::Join;
use super::rules::Limits;
use crate::network::{EdgeIx, VertexIx};
use crate::space::{Bounds, math::rotate};
use glam::DVec2;

/// Number of connections that are checked exactly.
const TRIES: usize = 60;

/// The indices of those `anchors`, vertices of the graph, that no way connects to a port.
pub fn floating(draft: &Draft<'_>, anchors: &[VertexIx]) -> Vec<usize> {
    if anchors.is_empty() {
        return Vec::new();
    }
    let components = draft.canvas.graph.components();
    (0..anchors.len()).filter(|i| floats(draft, &components, anchors[*i])).collect()
}

/// Whether no way connects the vertex `v` to a port.
fn floats(draft: &Draft<'_>, components: &[Option<u32>], v: VertexIx) -> bool {
    !components[..draft.brief.ports.len()].contains(&components[v as usize])
}

/// Connects the streets around each of `anchors` to the rest of the network where no way connects them to a port.
pub fn connect_floating(draft: &mut Draft<'_>, anchors: &[VertexIx]) {
    for _ in 0..anchors.len() {
        let components = draft.canvas.graph.components();
        let Some(anchor) = anchors.iter().find(|v| floats(draft, &components, **v)) else { return };
        let part = components[*anchor as usize];
        let (rules, closest) = (draft.rules.repair, draft.rules.closest);
        if connect_part(draft, &components, part, &rules) {
            continue;
        }
        if !connect_part(draft, &components, part, &closest) {
            return;
        }
        // What breaks a rule here does so for the sake of the pinned piece.
        for v in &draft.trial.built {
            draft.canvas.nodes[*v as usize].pinned = true;
        }
    }
}

/// Builds the cheapest street from the component `part` of the graph to another component. It begins at a dead end or at the
/// side of a street.
fn connect_part(draft: &mut Draft<'_>, components: &[Option<u32>], part: Option<u32>, limits: &Limits) -> bool {
    let g = &draft.canvas.graph;
    let of_part: Vec<EdgeIx> = g.edges().filter(|(_, e)| components[e.a as usize] == part).map(|(i, _)| i).collect();
    let bounds = Bounds::of(of_part.iter().flat_map(|e| <[DVec2; 2]>::from(g.segment(*e))));
    let reach = 4.0 * draft.rules.local.length;
    draft.canvas.gather(bounds, reach, &mut draft.trial.near);
    let g = &draft.canvas.graph;
    let elsewhere = |join: Join| match join {
        Join::At(v) => components.get(v as usize).is_some_and(|c| *c != part),
        Join::On(e) => components.get(g.edge(e).a as usize).is_some_and(|c| *c != part),
        Join::Free(_) => false,
    };
    let mut mends: Vec<Mend> = Vec::new();
    let mut line = Vec::new();
    let mut add = |from: DVec2, start: DVec2, direction: DVec2, first: Join, leaving: VertexIx, factor: f64| {
        if let Some((end, last, distance)) = landing(draft, start, direction, reach, leaving, &mut line)
            && elsewhere(last)
        {
            mends.push(Mend::straight(distance * factor, from, end, first, last));
        }
    };
    for &e in &of_part {
        let edge = g.edge(e);
        for (v, other) in [(edge.a, edge.b), (edge.b, edge.a)] {
            if g.degree(v) == 1 && draft.canvas.nodes[v as usize].open {
                let (at, onward) = (g.at(v), (g.at(v) - g.at(other)).normalize_or_zero());
                for step in -8i32..=8 {
                    let angle = f64::from(step) * 0.17;
                    add(at, at, rotate(onward, angle), Join::At(v), v, 1.0 + 0.5 * angle.abs());
                }
            }
        }
        let (a, b) = g.segment(e);
        let side = (b - a).perp().normalize_or_zero();
        let parts = (a.distance(b) / 14.0).ceil().max(2.0) as usize;
        for k in 1..parts {
            let from = crate::space::quantize(a.lerp(b, k as f64 / parts as f64));
            for (out, angle) in [side, -side].into_iter().flat_map(|s| [0.0, 0.4, -0.4].map(|a| (s, a))) {
                add(from, from + out * 0.5, rotate(out, angle), Join::On(e), NONE, 1.5 + 0.5 * f64::abs(angle));
            }
        }
    }
    build_best(draft, mends, limits, TRIES)
}
