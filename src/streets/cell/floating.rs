//! Floating streets: streets that no way connects to a port are connected to the rest.

use super::canvas::Maker;
use super::draft::Draft;
use super::mend::{Mend, build_best, landing};
use super::obstacle::NONE;
use super::proposal::Join;
use super::rules::Limits;
use crate::network::{EdgeIx, VertexIx};
use crate::space::{Bounds, math::rotate};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

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
        if !connect_part(draft, &components, part, &rules, Maker::Repair)
            && !connect_part(draft, &components, part, &closest, Maker::Link)
        {
            return;
        }
    }
}

/// Connects the streets that no way connects to a port, the largest parts first, where a street can that keeps the rules of repair.
/// Parts that none can connect are removed, but for those of pinned pieces, which [`connect_floating`] may still connect.
pub fn connect_parts(draft: &mut Draft<'_>) {
    loop {
        let components = draft.canvas.graph.components();
        let g = &draft.canvas.graph;
        let mut lengths: BTreeMap<u32, f64> = BTreeMap::new();
        for (e, edge) in g.edges().filter(|(_, edge)| floats(draft, &components, edge.a)) {
            if let Some(part) = components[edge.a as usize] {
                *lengths.entry(part).or_default() += g.edge_length(e);
            }
        }
        let mut parts: Vec<(f64, u32)> = lengths.into_iter().map(|(part, length)| (length, part)).collect();
        parts.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let rules = draft.rules.repair;
        let is_connected =
            |(_, part): &(f64, u32)| connect_part(draft, &components, Some(*part), &rules, Maker::Repair);
        if parts.iter().any(is_connected) {
            continue;
        }
        let g = &draft.canvas.graph;
        let part = |v: VertexIx| components[v as usize];
        let pinned: BTreeSet<u32> =
            g.vertices().filter(|v| draft.canvas.nodes[*v as usize].pinned).filter_map(part).collect();
        let goes = |a: VertexIx| floats(draft, &components, a) && !part(a).is_some_and(|part| pinned.contains(&part));
        let loose = g.edges().filter(|(_, edge)| goes(edge.a)).map(|(e, _)| e);
        for e in loose.collect::<Vec<_>>() {
            draft.canvas.graph.remove_edge(e);
        }
        return;
    }
}

/// Builds the cheapest street from the component `part` of the graph to another component. It begins at a dead end or at the
/// side of a street.
fn connect_part(
    draft: &mut Draft<'_>,
    components: &[Option<u32>],
    part: Option<u32>,
    limits: &Limits,
    maker: Maker,
) -> bool {
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
    build_best(draft, mends, limits, TRIES, maker)
}

#[cfg(test)]
mod tests {
    use super::super::growth::propagate;
    use super::super::output::finish;
    use super::super::stubs::{grow_from_stubs, lay_stubs};
    use super::*;
    use crate::layer::Cancel;
    use crate::space::{centroid, distance_to_segment, math::direction, point_in_polygon};
    use crate::streets::filler::Cause;
    use crate::testing::{PortCell, styles};

    #[test]
    fn a_link_pins_no_street_that_was_there() {
        let styles = styles();
        let mut links = 0;
        for seed in 0..40 {
            let cell = PortCell::new(seed, &styles);
            let brief = cell.brief();
            let mut draft = Draft::new(&brief);
            lay_stubs(&mut draft);
            grow_from_stubs(&mut draft);
            propagate(&mut draft, &Cancel::new(), |_, _, _, _| false).expect("nobody cancels");
            // A piece in the middle of a block, from which no street may lead that keeps to the rules.
            let closest = draft.rules.closest;
            let place = |k: u32| centroid(&cell.border) + direction(f64::from(k)) * (8.0 * f64::from(k));
            let ends = |k: u32| [place(k), place(k) + direction(f64::from(k)) * 20.0];
            let lay = |k: &u32| {
                draft.gather(place(*k), 100.0);
                draft.trial.proposal.line(&ends(*k), Join::Free(true), Join::Free(true));
                point_in_polygon(place(*k), &cell.border) && draft.build_if_fits(&closest, Maker::Piece(0))
            };
            let Some([from, to]) = (0..20).find(lay).map(ends) else { continue };
            let piece = draft.trial.built.clone();
            piece.iter().for_each(|v| draft.canvas.nodes[*v as usize].pinned = true);
            draft.rules.repair = Limits { min_piece: 500.0, ..draft.rules.repair };
            connect_parts(&mut draft);
            assert!(piece.iter().all(|v| draft.canvas.graph.degree(*v) > 0), "cell {seed}: a pinned piece is gone");
            connect_floating(&mut draft, &piece);
            let g = &draft.canvas.graph;
            links += g.edges().filter(|(_, e)| e.data.by == Maker::Link).count();
            for v in g.vertices().filter(|v| draft.canvas.nodes[*v as usize].pinned) {
                assert!(distance_to_segment(g.at(v), from, to) < 0.1, "cell {seed}: a pin at {}", g.at(v));
            }
            let out = finish(&draft, "", &["piece".into()]);
            let defects: Vec<_> = out.exceptions.iter().filter(|e| e.cause == Cause::Defect).collect();
            assert!(defects.is_empty(), "cell {seed}: {defects:?}");
        }
        assert!(links > 10, "{links} links");
    }
}
