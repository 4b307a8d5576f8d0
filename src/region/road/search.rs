//! Shortest paths between nodes of a window of the wide lattice: A* over a stencil of 16 headings, without headings in the
//! state. They say where to look closer, in `geodesic`.

use super::lattice::{DIRECTIONS, STENCIL};
use crate::layer::{Cancel, LayerError};
use glam::I64Vec2;
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

    /// Its nodes, by index.
    pub fn nodes(self) -> impl Iterator<Item = I64Vec2> {
        let end = self.min + self.size;
        (self.min.y..end.y).flat_map(move |y| (self.min.x..end.x).map(move |x| I64Vec2::new(x, y)))
    }

    pub fn len(&self) -> usize {
        (self.size.x * self.size.y) as usize
    }
}

/// What is searched for.
pub(super) struct Task {
    pub window: Window,
    /// Spacing of the nodes in metres.
    pub step: i64,
    pub from: I64Vec2,
    pub to: I64Vec2,
    /// Greatest cost.
    pub limit: f64,
    /// Greatest length of a bridge in metres.
    pub bridge_limit: f64,
    /// Least cost per metre of any edge.
    pub least: f64,
}

/// A path found.
pub(super) struct Found {
    pub cost: f64,
    pub nodes: Vec<I64Vec2>,
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

/// The cheapest path. `edge(node, index, heading, length)` is the cost of an edge of that length, at least the least cost
/// per metre, and the share of it that is a bridge; `None` where there is no way.
///
/// The length of a bridge depends on how a node was reached; the label with the lowest cost is taken, so where bridges
/// reach their limit the result is a cheap path, not always the cheapest.
pub(super) fn search(
    task: &Task,
    cancel: &Cancel,
    mut edge: impl FnMut(I64Vec2, usize, usize, f64) -> Result<Option<(f64, f64)>, LayerError>,
) -> Result<Option<Found>, LayerError> {
    let w = &task.window;
    if !w.contains(task.from) || !w.contains(task.to) {
        return Ok(None);
    }
    let none = Label { cost: f64::INFINITY, wet: 0.0, heading: DIRECTIONS as u8, closed: false };
    let mut labels = vec![none; w.len()];
    let step = task.step as f64;
    let rest = |node: I64Vec2| (task.to - node).as_dvec2().length() * step * task.least;
    // Costs are not negative, so their bits sort like they do.
    let mut open = BinaryHeap::new();
    labels[w.index(task.from)].cost = 0.0;
    open.push(Reverse((rest(task.from).to_bits(), w.index(task.from))));
    let lengths = STENCIL.map(|s| s.as_dvec2().length() * step);
    let last = w.index(task.to);
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
            if labels[next_index].closed || here.cost + length * task.least >= labels[next_index].cost {
                continue;
            }
            let Some((edge_cost, bridge)) = edge(node, index, heading, length)? else { continue };
            let cost = here.cost + edge_cost;
            let wet = if bridge > 0.0 { f64::from(here.wet) + length * bridge } else { 0.0 };
            let all = cost + rest(next);
            if wet > task.bridge_limit || all > task.limit || cost >= labels[next_index].cost {
                continue;
            }
            labels[next_index] = Label { cost, wet: wet as f32, heading: heading as u8, closed: false };
            open.push(Reverse((all.to_bits(), next_index)));
        }
    }
    if !labels[last].closed {
        return Ok(None);
    }
    let mut nodes = vec![task.to];
    let mut index = last;
    while usize::from(labels[index].heading) < DIRECTIONS {
        let node = w.node(index) - STENCIL[usize::from(labels[index].heading)];
        nodes.push(node);
        index = w.index(node);
    }
    nodes.reverse();
    Ok(Some(Found { cost: labels[last].cost, nodes }))
}

#[cfg(test)]
mod tests {
    use super::super::lattice::stencil_distance;
    use super::*;

    fn task(from: I64Vec2, to: I64Vec2) -> Task {
        let window = Window { min: I64Vec2::splat(-5), size: I64Vec2::splat(40) };
        Task { window, step: 100, from, to, limit: 1e5, bridge_limit: 150.0, least: 1.0 }
    }

    #[test]
    fn open_ground_gives_the_distance_of_the_stencil() {
        let (a, b) = (I64Vec2::ZERO, I64Vec2::new(23, 7));
        let found = search(&task(a, b), &Cancel::new(), |_, _, _, l| Ok(Some((l, 0.0)))).unwrap().unwrap();
        assert!((found.cost - 100.0 * stencil_distance(b)).abs() < 1e-6);
        assert_eq!((found.nodes[0], found.nodes[found.nodes.len() - 1]), (a, b));
    }

    #[test]
    fn wide_water_is_not_crossed() {
        let river = |wide: i64| {
            let edge = move |n: I64Vec2, _: usize, h: usize, l: f64| {
                let wet = |n: I64Vec2| (10..10 + wide).contains(&n.x);
                Ok(Some((l, (f64::from(u8::from(wet(n)) + u8::from(wet(n + STENCIL[h])))) / 2.0)))
            };
            search(&task(I64Vec2::ZERO, I64Vec2::new(20, 0)), &Cancel::new(), edge).unwrap()
        };
        assert!(river(1).is_some() && river(4).is_none());
    }
}
