//! The nodes of a corridor, and what lies where among them.

use crate::region::road::lattice::{DIRECTIONS, STENCIL, node_at};
use crate::region::road::search::Window;
use crate::space::{Bounds, closest_on_segment, segments};
use glam::{DVec2, I64Vec2};

/// No slot.
const NONE: u32 = u32::MAX;

/// Nodes near a line.
pub(in crate::region::road) struct Strip {
    pub(super) window: Window,
    /// By index in the window.
    slots: Vec<u32>,
    /// Index in the window, by slot.
    places: Vec<usize>,
    /// What a step along each heading adds to an index.
    shifts: [isize; DIRECTIONS],
    /// Its nodes, by slot.
    pub nodes: Vec<I64Vec2>,
    /// Their distance from the line in metres.
    pub off: Vec<f32>,
}

impl Strip {
    /// Nodes of the lattice of spacing `step` within `width` of a line in plan metres, and from the first to the last of
    /// `range` if there is one.
    pub fn around(line: &[DVec2], width: f64, step: i64, range: Option<(I64Vec2, I64Vec2)>) -> Self {
        // Three nodes more on each side than edges of the stencil reach.
        let bounds = Bounds::of(line.iter().copied()).grown(width + 3.0 * step as f64);
        let window = Window::around(bounds, step);
        let (low, high) = range.unwrap_or((window.min, window.min + window.size - 1));
        // Squares of distances from the line.
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
            places: Vec::new(),
            shifts: STENCIL.map(|s| (s.y * window.size.x + s.x) as isize),
            nodes: Vec::new(),
            off: Vec::new(),
            window,
        };
        for (i, (node, squared)) in window.nodes().zip(apart).enumerate() {
            let off = squared.sqrt();
            if off <= width {
                out.slots[i] = out.nodes.len() as u32;
                out.places.push(i);
                out.nodes.push(node);
                out.off.push(off as f32);
            }
        }
        out
    }

    /// Slot of a node, if it is inside.
    pub fn slot(&self, node: I64Vec2) -> Option<usize> {
        let slot = if self.window.contains(node) { self.slots[self.window.index(node)] } else { NONE };
        (slot != NONE).then_some(slot as usize)
    }

    pub(super) fn next(&self, slot: usize, heading: usize) -> Option<usize> {
        // The window is wider than a step on all sides.
        let next = self.slots[self.places[slot].wrapping_add_signed(self.shifts[heading])];
        (next != NONE).then_some(next as usize)
    }
}
