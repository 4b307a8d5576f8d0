//! The nodes of a corridor, and what lies where among them.

use crate::region::road::lattice::{DIRECTIONS, STENCIL, node_at};
use crate::region::road::search::Window;
use crate::space::{Bounds, distance_to_segment, segments};
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
        let mut off = vec![f32::INFINITY; window.len()];
        for (a, b) in segments(line) {
            let part = Window::around(Bounds::of([a, b]).grown(width), step);
            for i in 0..part.len() {
                let node = part.node(i);
                let allowed = range.is_none_or(|(low, high)| node.cmpge(low).all() && node.cmple(high).all());
                if allowed && window.contains(node) {
                    let distance = distance_to_segment(node_at(node, step), a, b);
                    if distance <= width {
                        let held = &mut off[window.index(node)];
                        *held = held.min(distance as f32);
                    }
                }
            }
        }
        let inside: Vec<usize> = (0..window.len()).filter(|i| off[*i].is_finite()).collect();
        let mut slots = vec![NONE; window.len()];
        for (slot, i) in inside.iter().enumerate() {
            slots[*i] = slot as u32;
        }
        let nodes = inside.iter().map(|i| window.node(*i)).collect();
        let shifts = STENCIL.map(|s| (s.y * window.size.x + s.x) as isize);
        Self { off: inside.iter().map(|i| off[*i]).collect(), window, slots, places: inside, shifts, nodes }
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
