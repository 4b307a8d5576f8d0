//! Division: a street is laid across every block that is much larger than the style asks.

use super::canvas::Maker;
use super::draft::Draft;
use super::free_grid::FreeGrid;
use super::mend::{Mend, build_best, landing, off_by};
use super::obstacle::{NONE, Obstacle};
use super::proposal::Join;
use super::rules::{Limits, WEDGE};
use crate::network::{EdgeIx, Face, HalfEdge, PlanarGraph, VertexIx};
use crate::space::{
    Bounds, centroid,
    math::{angle_of, rotate},
    stable_hash,
};
use glam::DVec2;
use std::array::from_fn;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Number of places from which a street across a block is tried.
const LOOKED_AT: usize = 6;

/// Number of these places that compete with each other at a time.
const TOGETHER: usize = 3;

/// Greatest distance between two of these places at one street, in metres.
const APART: f64 = 24.0;

/// Number of rays that are cast at once.
const RAYS: usize = 4;

/// Angle off square at which streets are laid aslant across a block, in radians.
const SLANT: f64 = 0.3;

/// A place where a street across a block may begin.
struct Start {
    /// The penalty for leaving the field, and once the length is known the cost.
    cost: f64,
    from: DVec2,
    /// Unit direction square to the street at which it begins.
    square: DVec2,
    way: DVec2,
    /// Angle from `square` to `way`, in radians.
    angle: f64,
    /// The edge at which it begins.
    edge: EdgeIx,
}

/// Divides blocks that are much larger than the style asks; returns how many streets were added. `undivided` holds the blocks
/// that no street can cross, as hashes of their corners: what it holds is not tried again, and what cannot be divided is added.
pub fn divide_blocks(draft: &mut Draft<'_>, undivided: &mut BTreeSet<u64>) -> usize {
    let most = draft.rules.large_block;
    let mut added = 0;
    let streets = streets_and_border(draft);
    let blocks = streets.faces().into_iter().map(|face| (face.area(), face)).filter(|(area, _)| *area > 0.0);
    let blocks: Vec<(f64, Face)> = blocks.collect();
    let local = |h: &HalfEdge| streets.edge(h.edge).data;
    // On how many sides each street has a block; what stands alone in the midst of one has none on its outside.
    let mut sides: Vec<u8> = vec![0; draft.canvas.graph.edge_count()];
    for e in blocks.iter().flat_map(|(_, face)| face.walk.iter().filter_map(local)) {
        sides[e as usize] = sides[e as usize].saturating_add(1);
    }
    for (_, face) in blocks.iter().filter(|(area, _)| *area > most) {
        let edges: Vec<Option<EdgeIx>> = face.walk.iter().map(local).collect();
        let corners: Vec<u64> = face.polygon.iter().flat_map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
        let block = stable_hash(&corners);
        if undivided.contains(&block) {
            continue;
        }
        if divide(draft, face, &edges, &sides) {
            added += 1;
        } else {
            undivided.insert(block);
        }
    }
    added
}

/// Lays a street across a block, from one of its local streets to another. `sides` has the number of blocks at each edge of
/// the graph; edges built since then are missing.
fn divide(draft: &mut Draft<'_>, face: &Face, edges: &[Option<EdgeIx>], sides: &[u8]) -> bool {
    let bounds = Bounds::of(face.polygon.iter().copied());
    draft.canvas.gather(bounds, 20.0, &mut draft.trial.near);
    let middle = centroid(&face.polygon);
    let limits = Limits { gap: draft.rules.growth.gap, wall_gap: draft.rules.growth.wall_gap, ..draft.rules.repair };
    let reach = bounds.size().length();
    // A street across the block can only meet what is around it and in it first.
    draft.trial.narrow(|s: &Obstacle| {
        s.is_wall() || sides.get(s.edge as usize).is_none_or(|n| *n < 2) || edges.contains(&Some(s.edge))
    });
    let starts = starts_across(draft, face, edges, (reach, middle), &limits);
    let mut line = Vec::new();
    starts.chunks(TOGETHER).any(|starts| {
        let mut mends: Vec<Mend> = Vec::with_capacity(TOGETHER);
        for s in starts {
            if let Some((end, last, distance)) = landing(draft, s.from + s.square * 0.5, s.way, reach, NONE, &mut line)
                && last != Join::On(s.edge)
                && way_is_roughly_free(&draft.canvas.free, s.from, end, &limits)
            {
                let cost = cost_across(s.from, end, distance, s.angle, middle);
                mends.push(Mend::straight(cost, s.from, end, Join::On(s.edge), last));
            }
        }
        draft.trial.swap_view();
        let divided = build_best(draft, mends, &limits, TOGETHER, Maker::Repair);
        draft.trial.swap_view();
        divided
    })
}

/// The places where a street across a block may begin, the cheapest first. Where the street would end, what it costs and whether
/// there is room for it is estimated with the coarse grid.
fn starts_across(
    draft: &Draft<'_>,
    face: &Face,
    edges: &[Option<EdgeIx>],
    (reach, middle): (f64, DVec2),
    limits: &Limits,
) -> Vec<Start> {
    let mut starts: Vec<Start> = Vec::with_capacity(4 * edges.len());
    for (i, edge) in edges.iter().enumerate() {
        let Some(edge) = edge.filter(|e| draft.canvas.graph.is_live(*e)) else { continue };
        let (a, b) = (face.polygon[i], face.polygon[(i + 1) % face.polygon.len()]);
        let square = (b - a).perp().normalize_or_zero();
        // Of the ways across that which suits the field best: all are about as long.
        let heading = angle_of(square) - draft.brief.field.angle(a.midpoint(b));
        let ways = [0.0, SLANT, -SLANT].map(|angle| (off_by(draft, heading + angle), angle));
        let dearness = |way: &(f64, f64)| way.0 * (1.0 + 0.5 * way.1.abs());
        let cheaper = |a, b| if dearness(&b) < dearness(&a) { b } else { a };
        let Some((off, angle)) = ways.into_iter().reduce(cheaper) else { continue };
        let way = if angle == 0.0 { square } else { rotate(square, angle) };
        let parts = (a.distance(b) / APART).ceil().max(2.0) as usize;
        let places = (1..parts).map(|k| crate::space::quantize(a.lerp(b, k as f64 / parts as f64)));
        // Both parts of a street between junctions are long enough.
        let g = &draft.canvas.graph;
        let ends = [g.edge(edge).a, g.edge(edge).b].map(|v| (g.at(v), draft.canvas.is_end(v)));
        let is_long = |from: &DVec2| ends.iter().all(|(at, is_end)| !is_end || at.distance(*from) >= limits.min_piece);
        let places = places.filter(is_long);
        starts.extend(places.map(|from| Start { cost: off, from, square, way, angle, edge }));
    }
    for starts in starts.chunks_mut(RAYS) {
        let rays = from_fn(|i| &starts[i.min(starts.len() - 1)]).map(|s| (s.from, s.way));
        let far: [f64; RAYS] = draft.canvas.free.ahead(rays, reach);
        for (s, far) in starts.iter_mut().zip(far) {
            let end = s.from + s.way * far;
            let free = way_is_roughly_free(&draft.canvas.free, s.from, end, limits);
            s.cost = if free { cost_across(s.from, end, far * s.cost, s.angle, middle) } else { f64::INFINITY };
        }
    }
    starts.retain(|s| s.cost < f64::INFINITY);
    // Of two that cost the same always the same one, whatever the order in which a selection leaves them.
    let key = |s: &Start| [s.cost, s.from.x, s.from.y, s.square.x, s.square.y, s.angle];
    let cheaper = |a: &Start, b: &Start| {
        let differ = key(a).iter().zip(key(b)).map(|(x, y)| x.total_cmp(&y)).find(|o| o.is_ne());
        differ.unwrap_or(Ordering::Equal)
    };
    if starts.len() > LOOKED_AT {
        starts.select_nth_unstable_by(LOOKED_AT, cheaper);
        starts.truncate(LOOKED_AT);
    }
    starts.sort_by(cheaper);
    starts
}

/// The cost of a street across a block: it grows with the length, with the angle off square, and with the distance from the
/// middle of the block.
fn cost_across(from: DVec2, end: DVec2, distance: f64, angle: f64, middle: DVec2) -> f64 {
    distance * (1.0 + 0.5 * angle.abs()) + 1.5 * ((from + end) / 2.0).distance(middle)
}

/// The local streets and the border as one graph, of which the faces are the blocks. Each edge has the local edge that it stands
/// for, if it is not of the border.
fn streets_and_border(draft: &Draft<'_>) -> PlanarGraph<Option<EdgeIx>> {
    let local = &draft.canvas.graph;
    let border = 2 * draft.brief.border.len() + draft.brief.ports.len();
    let (vertices, edges) = (local.vertex_count() + border, local.edge_count() + border);
    let mut graph: PlanarGraph<Option<EdgeIx>> = PlanarGraph::without_index();
    graph.reserve(vertices, edges);
    // Local streets keep their vertices, but ports in one place, at both sides of a main street, are one there.
    let mut places: BTreeMap<[u64; 2], VertexIx> = BTreeMap::new();
    for v in local.vertices() {
        graph.add_vertex(local.at(v));
    }
    let place = |p: DVec2| [p.x.to_bits(), p.y.to_bits()];
    for port in (0..draft.brief.ports.len() as VertexIx).rev() {
        places.insert(place(local.at(port)), port);
    }
    // A main street that is walked on both sides is there once.
    let mut known: BTreeSet<(VertexIx, VertexIx)> = BTreeSet::new();
    for (a, b) in draft.canvas.wall_lines() {
        // Divided at the ports that lie on it.
        let mut cuts: Vec<(f64, DVec2)> = vec![(0.0, a), (1.0, b)];
        let ab = b - a;
        for port in draft.brief.ports {
            let t = (port.at - a).dot(ab) / ab.length_squared();
            if t > 0.0 && t < 1.0 && (a + ab * t).distance(port.at) < 0.01 {
                cuts.push((t, port.at));
            }
        }
        cuts.sort_by(|x, y| x.0.total_cmp(&y.0));
        for pair in cuts.windows(2) {
            let [a, b] = [pair[0].1, pair[1].1].map(|p| {
                let p = crate::space::quantize(p);
                *places.entry(place(p)).or_insert_with(|| graph.add_vertex(p))
            });
            if a != b && known.insert((a.min(b), a.max(b))) {
                graph.add_edge(a, b, None);
            }
        }
    }
    let shared = |v: VertexIx| {
        let port = (v as usize) < draft.brief.ports.len();
        port.then(|| places.get(&place(local.at(v))).copied()).flatten().unwrap_or(v)
    };
    for (e, edge) in local.edges() {
        graph.add_edge(shared(edge.a), shared(edge.b), Some(e));
    }
    graph
}

/// A quick test on the coarse grid: false if a street from `from` to `to`, which meets a street at both ends, surely comes too
/// near to an obstacle on its way.
fn way_is_roughly_free(free: &FreeGrid, from: DVec2, to: DVec2, limits: &Limits) -> bool {
    let length = from.distance(to);
    [0.3, 0.5, 0.7].into_iter().all(|share: f64| {
        let needed = (WEDGE * length * share.min(1.0 - share)) as f32;
        free.at(from.lerp(to, share)) >= FreeGrid::least(needed.min(limits.coarse_gap()))
    })
}
