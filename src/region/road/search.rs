//! Shortest paths on the coarse lattice: A* over nodes, with the 16 headings of the stencil but without headings in the state.
//! They tell where to search closely ([`geodesic`](super::geodesic)).

use super::lattice::{DIRECTIONS, STENCIL, stencil_distance};
use super::window::Window;
use crate::layer::{Cancel, LayerError};
use glam::I64Vec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The question of a search.
pub(super) struct Query {
    pub window: Window,
    /// Spacing of the nodes in metres.
    pub step: i64,
    pub from: I64Vec2,
    pub to: I64Vec2,
    /// Greatest cost of a path.
    pub limit: f64,
    /// Greatest length of a bridge in metres.
    pub bridge_limit: f64,
    /// Least cost per metre of any edge.
    pub least: f64,
}

/// The cheapest path.
pub(super) struct Path {
    pub cost: f64,
    pub nodes: Vec<I64Vec2>,
}

#[derive(Clone, Copy)]
struct Label {
    cost: f64,
    /// Metres over water up to this node.
    wet: f32,
    /// Heading of the edge that led here; [`DIRECTIONS`] at the start.
    heading: u8,
    closed: bool,
}

/// Searches the cheapest path. `edge(node, index, heading, length)` returns the cost of an edge of that length, at least the
/// least cost per metre, and the share of it that is a bridge; `None` where no road may run.
///
/// The length of a bridge depends on how a node was reached, but only the cheapest label of a node is kept. Where bridges reach
/// their limit, the result is therefore a cheap path, but not always the cheapest.
pub(super) fn search(
    query: &Query,
    cancel: &Cancel,
    mut edge: impl FnMut(I64Vec2, usize, usize, f64) -> Result<Option<(f64, f64)>, LayerError>,
) -> Result<Option<Path>, LayerError> {
    let w = &query.window;
    if !w.contains(query.from) || !w.contains(query.to) {
        return Ok(None);
    }
    let none = Label { cost: f64::INFINITY, wet: 0.0, heading: DIRECTIONS as u8, closed: false };
    let mut labels = vec![none; w.len()];
    let step = query.step as f64;
    // Edges lead in few headings, so that the rest is at least the distance on the stencil. The beeline is up to 3 % shorter, with
    // which a search would visit twice as many nodes.
    let rest = |node: I64Vec2| stencil_distance(query.to - node) * step * query.least;
    // Costs are not negative, so their bits have the same order.
    let mut open = BinaryHeap::new();
    labels[w.index(query.from)].cost = 0.0;
    open.push(Reverse((rest(query.from).to_bits(), w.index(query.from))));
    let lengths = STENCIL.map(|s| s.as_dvec2().length() * step);
    let last = w.index(query.to);
    let mut popped = 0u32;
    while let Some(Reverse((_, index))) = open.pop() {
        let here = labels[index];
        if here.closed {
            continue;
        }
        labels[index].closed = true;
        if index == last {
            break;
        }
        popped += 1;
        if popped.is_multiple_of(4096) {
            cancel.check()?;
        }
        let node = w.node(index);
        for (heading, s) in STENCIL.iter().enumerate() {
            let next = node + *s;
            if !w.contains(next) {
                continue;
            }
            let next_index = w.index(next);
            let length = lengths[heading];
            if labels[next_index].closed || here.cost + length * query.least >= labels[next_index].cost {
                continue;
            }
            let Some((edge_cost, bridge)) = edge(node, index, heading, length)? else { continue };
            let cost = here.cost + edge_cost;
            let wet = if bridge > 0.0 { f64::from(here.wet) + length * bridge } else { 0.0 };
            let all = cost + rest(next);
            if wet > query.bridge_limit || all > query.limit || cost >= labels[next_index].cost {
                continue;
            }
            labels[next_index] = Label { cost, wet: wet as f32, heading: heading as u8, closed: false };
            open.push(Reverse((all.to_bits(), next_index)));
        }
    }
    if !labels[last].closed {
        return Ok(None);
    }
    let mut nodes = vec![query.to];
    let mut index = last;
    while usize::from(labels[index].heading) < DIRECTIONS {
        let node = w.node(index) - STENCIL[usize::from(labels[index].heading)];
        nodes.push(node);
        index = w.index(node);
    }
    nodes.reverse();
    Ok(Some(Path { cost: labels[last].cost, nodes }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn query(from: I64Vec2, to: I64Vec2) -> Query {
        let window = Window { min: I64Vec2::splat(-5), size: I64Vec2::splat(40) };
        Query { window, step: 100, from, to, limit: 1e5, bridge_limit: 150.0, least: 1.0 }
    }

    #[test]
    fn open_ground_gives_the_distance_of_the_stencil() {
        let (a, b) = (I64Vec2::ZERO, I64Vec2::new(23, 7));
        let found = search(&query(a, b), &Cancel::new(), |_, _, _, l| Ok(Some((l, 0.0)))).unwrap().unwrap();
        assert!((found.cost - 100.0 * stencil_distance(b)).abs() < 1e-6);
        assert_eq!((found.nodes[0], found.nodes[found.nodes.len() - 1]), (a, b));
    }

    #[test]
    fn what_guides_a_search_does_not_change_its_result() {
        let mut random = crate::space::Seed(5).stream("test", &[]);
        let cells: Vec<f64> = (0..1600).map(|_| random.range(1.0, 3.0)).collect();
        let edge = |n: I64Vec2, _: usize, h: usize, l: f64| {
            let at = |n: I64Vec2| cells[((n.y + 5) * 40 + n.x + 5) as usize];
            Ok(Some((l * (at(n) + at(n + STENCIL[h])) / 2.0, 0.0)))
        };
        for (x, y) in [(30, 11), (-5, 34), (17, 17), (3, -4), (34, 0)] {
            let guided = query(I64Vec2::ZERO, I64Vec2::new(x, y));
            let blind = Query { least: 1e-12, ..query(guided.from, guided.to) };
            let [a, b] = [guided, blind].map(|q| search(&q, &Cancel::new(), edge).unwrap().unwrap());
            assert_eq!((a.cost.to_bits(), a.nodes), (b.cost.to_bits(), b.nodes));
        }
    }

    #[test]
    fn wide_water_is_not_crossed() {
        let river = |wide: i64| {
            let edge = move |n: I64Vec2, _: usize, h: usize, l: f64| {
                let wet = |n: I64Vec2| (10..10 + wide).contains(&n.x);
                Ok(Some((l, (f64::from(u8::from(wet(n)) + u8::from(wet(n + STENCIL[h])))) / 2.0)))
            };
            search(&query(I64Vec2::ZERO, I64Vec2::new(20, 0)), &Cancel::new(), edge).unwrap()
        };
        assert!(river(1).is_some() && river(4).is_none());
    }
}
