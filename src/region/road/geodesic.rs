//! Geodesics: cheapest paths on the lattice with position and heading in the state, so that bends cost something and bridges
//! and tunnels are straight (Galin 2011, section 4.1, after Galin 2010).
//!
//! A first search runs backwards over nodes alone, without bends. It gives each node a lower bound of the cost that remains.
//! With these bounds, A* over nodes and headings visits little more than the path it finds.

use super::cost::{bends, corner_radius};
use super::field::{Field, SpanEdge};
use super::lattice::{DIRECTIONS, STENCIL, node_at};
use super::route::Span;
use crate::layer::{Cancel, LayerError};
use crate::space::Bounds;
use crate::space::math::angle_between;
use glam::{DVec2, I64Vec2};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

/// Number of states of a node: one per heading, and one for a start.
const STATES: usize = DIRECTIONS + 1;
/// Cost in metres of a bend at a gate that is sharper than the class otherwise allows.
const SHARP: f64 = 400.0;
/// The first search goes on until costs exceed this multiple of the cheapest path without bends, plus so many metres.
const MARGIN: (f32, f32) = (1.15, 500.0);

/// Where a path may begin or end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    pub node: I64Vec2,
    /// Cost of the stretch beyond the stop.
    pub cost: f64,
    /// The stretch that goes on from there, as a vector in metres; zero if there is none.
    pub beyond: DVec2,
}

/// The cheapest path.
#[derive(Clone, Debug)]
pub(super) struct Geodesic {
    pub cost: f64,
    pub nodes: Vec<I64Vec2>,
    pub spans: Vec<Span>,
    /// Index of the stop where the path begins.
    pub from: usize,
    /// Index of the stop where the path ends.
    pub to: usize,
}

/// A key of the queue. Costs are not negative, so their bits have the same order; equal costs are ordered by state.
fn queued(cost: f32, state: usize) -> Reverse<u64> {
    Reverse(u64::from(cost.to_bits()) << 32 | state as u64)
}

fn unqueued(key: u64) -> (f32, usize) {
    (f32::from_bits((key >> 32) as u32), (key & 0xffff_ffff) as usize)
}

/// Cost of the bend between a heading and the stretch beyond a stop.
fn bend_beyond(field: &Field, stop: &Stop, heading: usize, arriving: bool) -> f32 {
    if stop.beyond == DVec2::ZERO {
        return 0.0;
    }
    let t = field.class();
    let way = if arriving { STENCIL[heading].as_dvec2() } else { -STENCIL[heading].as_dvec2() };
    let headings = angle_between(way, stop.beyond) / (TAU / DIRECTIONS as f64);
    // A settlement has few gates: a sharp bend at one is dear, but better than no road.
    let sharp = corner_radius(way * field.step() as f64, stop.beyond) < t.radius;
    (t.turn * headings * headings + if sharp { SHARP } else { 0.0 }) as f32
}

/// The cheapest path from one of the stops `from` to one of the stops `to`. `None` if there is none in the corridor.
pub(super) fn geodesic(
    field: &mut Field,
    from: &[Stop],
    to: &[Stop],
    cancel: &Cancel,
) -> Result<Option<Geodesic>, LayerError> {
    let Some(rest) = lower_bounds(field, from, to, cancel)? else { return Ok(None) };
    forward(field, from, to, &rest, cancel)
}

/// Lower bounds of the cost from each slot to an end: A* from the ends towards the starts, without headings. `None` if no
/// start is connected to an end.
fn lower_bounds(
    field: &mut Field,
    from: &[Stop],
    to: &[Stop],
    cancel: &Cancel,
) -> Result<Option<Vec<f32>>, LayerError> {
    let count = field.corridor().nodes.len();
    let mut rest = vec![f32::INFINITY; count];
    let mut done = vec![false; count];
    let mut start = vec![f32::INFINITY; count];
    for stop in from {
        if let Some(slot) = field.corridor().slot(stop.node) {
            start[slot] = start[slot].min(stop.cost as f32);
        }
    }
    // A disc around all starts: from each node, the path to its rim is a lower bound.
    let ends = Bounds::of(from.iter().map(|s| node_at(s.node, field.step())));
    let (middle, radius) = (ends.centre(), ends.size().length() / 2.0);
    let (least, step) = (field.least_cost(), field.step());
    let ahead: Vec<f32> = field
        .corridor()
        .nodes
        .iter()
        .map(|n| (least * (node_at(*n, step).distance(middle) - radius).max(0.0)) as f32)
        .collect();
    let mut open = BinaryHeap::new();
    for stop in to {
        if let Some(slot) = field.corridor().slot(stop.node).filter(|s| rest[*s] > stop.cost as f32) {
            rest[slot] = stop.cost as f32;
            open.push(queued(rest[slot] + ahead[slot], slot));
        }
    }
    let (mut best, mut reached) = (f32::INFINITY, f32::INFINITY);
    let mut popped = 0u32;
    let mut spans: Vec<SpanEdge> = Vec::new();
    while let Some(Reverse(key)) = open.pop() {
        let (all, slot) = unqueued(key);
        if done[slot] {
            continue;
        }
        if all > best * MARGIN.0 + MARGIN.1 {
            reached = all;
            break;
        }
        done[slot] = true;
        let cost = rest[slot];
        best = best.min(cost + start[slot]);
        popped += 1;
        if popped.is_multiple_of(4096) {
            cancel.check()?;
        }
        for heading in 0..DIRECTIONS {
            let Some((next, edge)) = field.lower_bound(slot, heading)? else { continue };
            if cost + edge < rest[next] {
                rest[next] = cost + edge;
                open.push(queued(rest[next] + ahead[next], next));
            }
            if edge.is_infinite() || !field.has_spans(slot, heading)? {
                continue;
            }
            spans.clear();
            spans.extend(field.spans(slot, heading)?);
            for span in &spans {
                let after = field.lower_bound(span.last, heading)?.map_or(f32::INFINITY, |e| e.1);
                let whole = cost + edge + span.cost + after;
                if whole < rest[span.to] {
                    rest[span.to] = whole;
                    open.push(queued(whole + ahead[span.to], span.to));
                }
            }
        }
    }
    for (slot, cost) in rest.iter_mut().enumerate().filter(|(slot, _)| !done[*slot]) {
        *cost = (reached - ahead[slot]).max(0.0);
    }
    Ok(best.is_finite().then_some(rest))
}

/// A path to a state.
#[derive(Clone, Copy)]
struct Label {
    cost: f32,
    /// Slot and heading at its end.
    state: u32,
    /// The label that this one continues; a start continues itself.
    before: u32,
    /// Number of edges of the bridge or tunnel that led here, 0 for an edge on the ground.
    edges: u8,
    tunnel: bool,
    /// Whether `cost` is the whole cost, or only a lower bound.
    exact: bool,
}

/// A* over nodes and headings. `rest` is a lower bound of the remaining cost at each slot. The ground between the ends of an
/// edge is looked at only when the edge is about to be used (Cohen, Phillips and Likhachev 2014, lazy weighted A*).
fn forward(
    field: &mut Field,
    from: &[Stop],
    to: &[Stop],
    rest: &[f32],
    cancel: &Cancel,
) -> Result<Option<Geodesic>, LayerError> {
    let turns = bends(field.class(), field.step());
    let count = field.corridor().nodes.len();
    let mut done = vec![0u32; count];
    let mut ends = vec![false; count];
    for stop in to {
        if let Some(slot) = field.corridor().slot(stop.node) {
            ends[slot] = true;
        }
    }
    let mut labels: Vec<Label> = Vec::new();
    let mut open = BinaryHeap::new();
    for stop in from {
        let Some(slot) = field.corridor().slot(stop.node).filter(|s| rest[*s].is_finite()) else { continue };
        let (cost, before) = (stop.cost as f32, labels.len() as u32);
        let state = (slot * STATES + DIRECTIONS) as u32;
        open.push(queued(cost + rest[slot], labels.len()));
        labels.push(Label { cost, state, before, edges: 0, tunnel: false, exact: true });
    }
    let mut best: Option<(f32, usize, usize)> = None;
    let mut popped = 0u32;
    let mut spans: Vec<SpanEdge> = Vec::new();
    let mut ahead: Vec<(usize, f32)> = Vec::new();
    while let Some(Reverse(key)) = open.pop() {
        let (all, index) = unqueued(key);
        if best.is_some_and(|b| all >= b.0) {
            break;
        }
        let mut label = labels[index];
        let (slot, heading) = (label.state as usize / STATES, label.state as usize % STATES);
        if done[slot] >> heading & 1 == 1 {
            continue;
        }
        if !label.exact {
            let before = labels[label.before as usize].state as usize / STATES;
            let (more, tunnel) = match label.edges {
                0 => (field.surcharge(before, heading)?, false),
                edges => field.span_surcharge(before, heading, edges.into())?,
            };
            label = Label { exact: true, cost: label.cost + more, tunnel, ..label };
            labels[index] = label;
            if more > 0.0 {
                if more.is_finite() {
                    open.push(queued(label.cost + rest[slot], index));
                }
                continue;
            }
        }
        done[slot] |= 1 << heading;
        popped += 1;
        if popped.is_multiple_of(4096) {
            cancel.check()?;
        }
        let node = field.corridor().nodes[slot];
        if ends[slot] {
            for (i, stop) in to.iter().enumerate().filter(|(_, s)| s.node == node) {
                let bend = if heading < DIRECTIONS { bend_beyond(field, stop, heading, true) } else { 0.0 };
                let whole = label.cost + stop.cost as f32 + bend;
                if best.is_none_or(|b| whole < b.0) {
                    best = Some((whole, index, i));
                }
            }
        }
        ahead.clear();
        if heading < DIRECTIONS {
            ahead.extend(&turns[heading]);
        } else {
            let start = from.iter().filter(|s| s.node == node).min_by(|a, b| a.cost.total_cmp(&b.cost));
            ahead.extend((0..DIRECTIONS).map(|h| (h, start.map_or(0.0, |s| bend_beyond(field, s, h, false)))));
        }
        for (along, bend) in &ahead {
            let cost = label.cost + bend;
            let mut reach = |to: usize, cost: f32, edges: u8| {
                if done[to] >> along & 1 == 0 && (cost + rest[to]).is_finite() {
                    open.push(queued(cost + rest[to], labels.len()));
                    let state = (to * STATES + along) as u32;
                    labels.push(Label { cost, state, before: index as u32, edges, tunnel: false, exact: false });
                }
            };
            let Some((next, edge)) = field.lower_bound(slot, *along)? else { continue };
            if edge.is_infinite() {
                continue;
            }
            reach(next, cost + edge, 0);
            if !field.has_spans(slot, *along)? {
                continue;
            }
            spans.clear();
            spans.extend(field.spans(slot, *along)?);
            for span in &spans {
                let after = field.lower_bound(span.last, *along)?.map_or(f32::INFINITY, |e| e.1);
                reach(span.to, cost + edge + span.cost + after, span.edges as u8);
            }
        }
    }
    let Some((cost, mut last, to)) = best else { return Ok(None) };
    // Back to the start, then forwards again.
    let mut steps: Vec<Label> = Vec::new();
    while labels[last].before as usize != last {
        steps.push(labels[last]);
        last = labels[last].before as usize;
    }
    let start = field.corridor().nodes[labels[last].state as usize / STATES];
    let (mut node, mut nodes, mut route_spans) = (start, vec![start], Vec::new());
    for step in steps.iter().rev() {
        let along = STENCIL[step.state as usize % STATES];
        let edges = if step.edges == 0 { 1 } else { usize::from(step.edges) + 2 };
        if step.edges > 0 {
            let first = nodes.len();
            route_spans.push(Span { first, last: first + usize::from(step.edges), tunnel: step.tunnel });
        }
        for _ in 0..edges {
            node += along;
            nodes.push(node);
        }
    }
    let starts = from.iter().enumerate().filter(|(_, s)| s.node == start);
    let from = starts.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost)).map_or(0, |s| s.0);
    Ok(Some(Geodesic { cost: cost.into(), nodes, spans: route_spans, from, to }))
}

#[cfg(test)]
mod tests {
    use super::super::field::Corridor;
    use super::super::lattice::node_at;
    use super::super::samples::Samples;
    use super::super::settings::RoadSettings;
    use super::super::tier_settings::TierSettings;
    use super::*;
    use crate::layer::LayerCache;
    use crate::terrain::{Terrain, TerrainSample};

    const STEP: i64 = 128;

    /// Level ground with a river or a ridge across, as wide as given, or a gap in it.
    struct Across {
        river: f64,
        ridge: f64,
        gap: bool,
    }

    impl Terrain for Across {
        fn sample(&self, p: DVec2) -> TerrainSample {
            let off = (p.x - 2_500.0).abs();
            let there = !(self.gap && p.y > 1_500.0);
            let wet = there && off < self.river / 2.0;
            let rise = if there { (self.ridge / 2.0 - off).max(0.0) } else { 0.0 };
            TerrainSample { height: if wet { 4.0 } else { 10.0 + rise }, water_level: 8.0, vegetation: 0.0 }
        }
    }

    fn way(terrain: &Across, t: &TierSettings) -> Option<Geodesic> {
        let cache = LayerCache::new(1 << 24);
        let ends = [I64Vec2::new(0, 0), I64Vec2::new(40, 3)];
        let corridor = Corridor::around(&ends.map(|n| node_at(n, STEP)), 2_500.0, STEP, None);
        let mut field = Field::new(corridor, t, STEP, terrain, |w| Samples::new(&cache, terrain, STEP, w));
        let [from, to] = ends.map(|node| [Stop { node, cost: 0.0, beyond: DVec2::ZERO }]);
        let found = geodesic(&mut field, &from, &to, &Cancel::new()).unwrap();
        if let Some(g) = &found {
            assert_eq!((g.nodes[0], g.nodes[g.nodes.len() - 1]), (ends[0], ends[1]));
            for (i, n) in g.nodes.windows(3).enumerate() {
                let (a, b) = ((n[1] - n[0]).as_dvec2(), (n[2] - n[1]).as_dvec2());
                assert!(corner_radius(a, b) * STEP as f64 >= t.radius);
                // A span is straight, and so are the edges before and after.
                assert!(a == b || !g.spans.iter().any(|s| (s.first..=s.last).contains(&(i + 1))));
            }
            for (i, n) in g.nodes.iter().enumerate() {
                let inside = g.spans.iter().any(|s| s.first < i && i < s.last && !s.tunnel);
                assert!(inside || terrain.sample(node_at(*n, STEP)).depth() == 0.0, "{n} is wet");
            }
        }
        found
    }

    #[test]
    fn water_is_crossed_on_bridges_and_ridges_in_tunnels_or_not_at_all() {
        let highway = RoadSettings::default().highway;
        let plain = way(&Across { river: 0.0, ridge: 0.0, gap: false }, &highway).unwrap();
        assert!(plain.spans.is_empty());
        let river = way(&Across { river: 500.0, ridge: 0.0, gap: false }, &highway).unwrap();
        assert!(river.spans.len() == 1 && !river.spans[0].tunnel);
        assert!(river.cost > plain.cost + highway.bridge + 500.0 * highway.water);
        let ridge = way(&Across { river: 0.0, ridge: 700.0, gap: false }, &highway).unwrap();
        assert!(ridge.spans.len() == 1 && ridge.spans[0].tunnel);
        // Too wide for the class, unless there is a way around.
        let minor = RoadSettings::default().minor;
        for (river, ridge) in [(900.0, 0.0), (0.0, 900.0)] {
            assert!(way(&Across { river, ridge, gap: false }, &minor).is_none());
            let around = way(&Across { river, ridge, gap: true }, &minor).unwrap();
            assert!(around.spans.is_empty() && around.cost > plain.cost);
        }
    }
}
