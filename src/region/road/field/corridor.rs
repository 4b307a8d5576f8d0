//! The nodes of a corridor around a line.

use crate::region::road::lattice::{DIRECTIONS, STENCIL, node_at};
use crate::region::road::window::Window;
use crate::space::{Bounds, closest_on_segment, segments};
use glam::{DVec2, I64Vec2};

/// Marks a node outside the corridor.
const NONE: u32 = u32::MAX;

/// The nodes near a line, numbered by *slots*.
pub(in crate::region::road) struct Corridor {
    pub(super) window: Window,
    /// Slot of each node of the window.
    slots: Vec<u32>,
    /// Index in the window of each slot.
    indices: Vec<usize>,
    /// What a step along each heading adds to an index in the window.
    shifts: [isize; DIRECTIONS],
    /// Node of each slot.
    pub nodes: Vec<I64Vec2>,
    /// Distance from the line of each slot, in metres.
    pub off: Vec<f32>,
}

impl Corridor {
    /// The nodes of the lattice of spacing `step` within `width` of a line (plan metres). If `range` is given, only nodes from
    /// its first (south-west) to its second (north-east) node.
    pub fn around(line: &[DVec2], width: f64, step: i64, range: Option<(I64Vec2, I64Vec2)>) -> Self {
        // Three more nodes on each side: more than an edge of the stencil reaches.
        let bounds = Bounds::of(line.iter().copied()).grown(width + 3.0 * step as f64);
        let window = Window::around(bounds, step);
        let (low, high) = range.unwrap_or((window.min, window.min + window.size - 1));
        // Squared distances from the line.
        let mut apart = vec![f64::INFINITY; window.len()];
        for (a, b) in segments(line) {
            let part = Window::around(Bounds::of([a, b]).grown(width), step);
            for node in part.nodes().filter(|n| n.cmpge(low).all() && n.cmple(high).all() && window.contains(*n)) {
                let at = node_at(node, step);
                let held = &mut apart[window.index(node)];
                *held = held.min(at.distance_squared(closest_on_segment(at, a, b).1));
            }
        }
        let mut out = Self {
            slots: vec![NONE; window.len()],
            indices: Vec::new(),
            shifts: STENCIL.map(|s| (s.y * window.size.x + s.x) as isize),
            nodes: Vec::new(),
            off: Vec::new(),
            window,
        };
        for (i, (node, squared)) in window.nodes().zip(apart).enumerate() {
            let off = squared.sqrt();
            if off <= width {
                out.slots[i] = out.nodes.len() as u32;
                out.indices.push(i);
                out.nodes.push(node);
                out.off.push(off as f32);
            }
        }
        out
    }

    /// Slot of a node, if the node lies in the corridor.
    pub fn slot(&self, node: I64Vec2) -> Option<usize> {
        let slot = if self.window.contains(node) { self.slots[self.window.index(node)] } else { NONE };
        (slot != NONE).then_some(slot as usize)
    }

    /// The neighbour of a slot along a heading.
    pub(super) fn next(&self, slot: usize, heading: usize) -> Option<usize> {
        // The window is more than one step larger than the corridor on all sides.
        let next = self.slots[self.indices[slot].wrapping_add_signed(self.shifts[heading])];
        (next != NONE).then_some(next as usize)
    }
}
