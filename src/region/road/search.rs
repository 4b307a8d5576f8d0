//! Shortest paths on a window of the lattice: A* over a stencil of 16 headings.

use super::lattice::{DIRECTIONS, STENCIL};
use crate::layer::{Cancel, LayerError};
use glam::{DVec2, I64Vec2};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A rectangle of nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// South-west node.
    pub min: I64Vec2,
    /// Columns and rows.
    pub size: I64Vec2,
}

impl Window {
    /// The window of all nodes of spacing `step` in a box of the plan, with one node more on each side.
    pub fn around(bounds: crate::space::Bounds, step: i64) -> Self {
        let s = step as f64;
        let min = (bounds.min / s).floor().as_i64vec2() - 1;
        let max = (bounds.max / s).ceil().as_i64vec2() + 1;
        Self { min, size: max - min + 1 }
    }

    pub fn contains(&self, node: I64Vec2) -> bool {
        let d = node - self.min;
        d.cmpge(I64Vec2::ZERO).all() && d.cmplt(self.size).all()
    }

    pub fn index(&self, node: I64Vec2) -> usize {
        let d = node - self.min;
        (d.y * self.size.x + d.x) as usize
    }

    pub fn node(&self, index: usize) -> I64Vec2 {
        self.min + I64Vec2::new(index as i64 % self.size.x, index as i64 / self.size.x)
    }

    pub fn len(&self) -> usize {
        (self.size.x * self.size.y) as usize
    }
}

/// What is searched for.
pub(super) struct Task<'a> {
    pub window: Window,
    /// Spacing of the nodes in metres.
    pub step: i64,
    /// Nodes where the path may begin, with the cost so far.
    pub from: &'a [(I64Vec2, f64)],
    /// Nodes where it may end, with the cost from there on.
    pub to: &'a [(I64Vec2, f64)],
    /// Plan point that no remaining cost is below the beeline to.
    pub goal: DVec2,
    /// Greatest cost.
    pub limit: f64,
    /// Greatest length of a bridge in metres.
    pub bridge_limit: f64,
    /// Cost of a bend by one heading; grows with the square of their number.
    pub turn: f64,
}

/// A path found.
pub(super) struct Found {
    pub cost: f64,
    pub nodes: Vec<I64Vec2>,
    /// Index into [`Task::from`].
    pub from: usize,
    /// Index into [`Task::to`].
    pub to: usize,
}

#[derive(Clone, Copy)]
struct Label {
    cost: f64,
    /// Metres over water just before.
    wet: f32,
    /// Heading that led here; [`DIRECTIONS`] at a start.
    heading: u8,
    closed: bool,
}

/// The cheapest path. `edge(node, index, heading, length)` is the cost of an edge of that length and the share of it
/// that is a bridge, `None` where there is no way.
///
/// Bends and the lengths of bridges depend on how a node was reached; the label with the lowest cost is taken, so the
/// result is a cheap path, not always the cheapest.
pub(super) fn search(
    task: &Task,
    cancel: &Cancel,
    mut edge: impl FnMut(I64Vec2, usize, usize, f64) -> Result<Option<(f64, f64)>, LayerError>,
) -> Result<Option<Found>, LayerError> {
    let w = &task.window;
    let none = Label { cost: f64::INFINITY, wet: 0.0, heading: DIRECTIONS as u8, closed: false };
    let mut labels = vec![none; w.len()];
    let step = task.step as f64;
    let rest = |node: I64Vec2| (node.as_dvec2() * step).distance(task.goal);
    // Costs are not negative, so their bits sort like they do.
    let mut open = BinaryHeap::new();
    for (node, cost) in task.from {
        if w.contains(*node) && *cost < labels[w.index(*node)].cost {
            labels[w.index(*node)].cost = *cost;
            open.push(Reverse(((cost + rest(*node)).to_bits(), w.index(*node))));
        }
    }
    let lengths = STENCIL.map(|s| s.as_dvec2().length() * step);
    let mut best: Option<(f64, usize, usize)> = None;
    let mut popped = 0u32;
    while let Some(Reverse((bits, index))) = open.pop() {
        if best.is_some_and(|b| f64::from_bits(bits) >= b.0) {
            break;
        }
        let here = labels[index];
        if here.closed {
            continue;
        }
        labels[index].closed = true;
        popped += 1;
        if popped.is_multiple_of(4096) {
            cancel.check()?;
        }
        let node = w.node(index);
        for (i, (end, more)) in task.to.iter().enumerate() {
            let whole = here.cost + more;
            if *end == node && whole <= task.limit && best.is_none_or(|b| whole < b.0) {
                best = Some((whole, index, i));
            }
        }
        for (heading, s) in STENCIL.iter().enumerate() {
            let next = node + *s;
            if !w.contains(next) {
                continue;
            }
            let next_index = w.index(next);
            if labels[next_index].closed {
                continue;
            }
            let mut cost = here.cost;
            if usize::from(here.heading) < DIRECTIONS {
                let apart = (heading + DIRECTIONS - usize::from(here.heading)) % DIRECTIONS;
                let bend = apart.min(DIRECTIONS - apart) as f64;
                cost += task.turn * bend * bend;
            }
            let length = lengths[heading];
            if cost + length >= labels[next_index].cost {
                continue;
            }
            let Some((edge_cost, bridge)) = edge(node, index, heading, length)? else { continue };
            cost += edge_cost;
            let wet = if bridge > 0.0 { f64::from(here.wet) + length * bridge } else { 0.0 };
            let all = cost + rest(next);
            if wet > task.bridge_limit || all > task.limit || cost >= labels[next_index].cost {
                continue;
            }
            labels[next_index] = Label { cost, wet: wet as f32, heading: heading as u8, closed: false };
            open.push(Reverse((all.to_bits(), next_index)));
        }
    }
    let Some((cost, last, to)) = best else { return Ok(None) };
    let mut nodes = vec![w.node(last)];
    let mut index = last;
    while usize::from(labels[index].heading) < DIRECTIONS {
        let node = w.node(index) - STENCIL[usize::from(labels[index].heading)];
        nodes.push(node);
        index = w.index(node);
    }
    nodes.reverse();
    let from = task.from.iter().position(|(n, c)| *n == nodes[0] && *c == labels[index].cost).unwrap_or(0);
    Ok(Some(Found { cost, nodes, from, to }))
}

#[cfg(test)]
mod tests {
    use super::super::lattice::stencil_distance;
    use super::*;

    fn task<'a>(from: &'a [(I64Vec2, f64)], to: &'a [(I64Vec2, f64)]) -> Task<'a> {
        let window = Window { min: I64Vec2::splat(-5), size: I64Vec2::splat(40) };
        let goal = to[0].0.as_dvec2() * 100.0;
        Task { window, step: 100, from, to, goal, limit: 1e5, bridge_limit: 150.0, turn: 0.0 }
    }

    #[test]
    fn open_ground_gives_the_distance_of_the_stencil() {
        let (a, b) = (I64Vec2::ZERO, I64Vec2::new(23, 7));
        let (from, to) = ([(a, 5.0)], [(b, 3.0)]);
        let found = search(&task(&from, &to), &Cancel::new(), |_, _, _, l| Ok(Some((l, 0.0)))).unwrap().unwrap();
        assert!((found.cost - 8.0 - 100.0 * stencil_distance(b)).abs() < 1e-6);
        assert_eq!((found.nodes[0], found.nodes[found.nodes.len() - 1]), (a, b));
        // With a cost of bends it bends once.
        let turning = Task { turn: 10.0, ..task(&from, &to) };
        let found = search(&turning, &Cancel::new(), |_, _, _, l| Ok(Some((l, 0.0)))).unwrap().unwrap();
        let bends = found.nodes.windows(3).filter(|n| n[2] - n[1] != n[1] - n[0]).count();
        assert_eq!(bends, 1);
    }

    #[test]
    fn wide_water_is_not_crossed() {
        let (from, to) = ([(I64Vec2::ZERO, 0.0)], [(I64Vec2::new(20, 0), 0.0)]);
        let river = |wide: i64| {
            let edge = move |n: I64Vec2, _: usize, h: usize, l: f64| {
                let wet = |n: I64Vec2| (10..10 + wide).contains(&n.x);
                Ok(Some((l, (f64::from(u8::from(wet(n)) + u8::from(wet(n + STENCIL[h])))) / 2.0)))
            };
            search(&task(&from, &to), &Cancel::new(), edge).unwrap()
        };
        assert!(river(1).is_some() && river(4).is_none());
    }
}
