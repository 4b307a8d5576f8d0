//! The ground in a corridor.

use super::corridor::Corridor;
use crate::layer::LayerError;
use crate::region::road::lattice::{STENCIL, node_at};
use crate::region::road::samples::{Ground, Samples};
use crate::space::{math::mix, stable_hash};
use crate::terrain::Scan;
use glam::I64Vec2;

/// Wavelength in metres of the random variation of the cost.
const ROUGH_SPACING: i64 = 450;

/// The ground at the nodes of a corridor and between them.
pub(super) struct CorridorGround<'a> {
    /// Samples at any point.
    scan: Scan<'a>,
    samples: Samples<'a>,
    /// The ground at each slot, once it was asked for.
    at_slots: Vec<Option<Ground>>,
    step: i64,
}

impl<'a> CorridorGround<'a> {
    pub fn new(scan: Scan<'a>, samples: Samples<'a>, slots: usize, step: i64) -> Self {
        Self { scan, samples, at_slots: vec![None; slots], step }
    }

    pub fn at_slot(&mut self, corridor: &Corridor, slot: usize) -> Result<Ground, LayerError> {
        if let Some(held) = self.at_slots[slot] {
            return Ok(held);
        }
        let ground = self.samples.at(corridor.nodes[slot])?;
        self.at_slots[slot] = Some(ground);
        Ok(ground)
    }

    pub fn at_node(&mut self, node: I64Vec2) -> Result<Ground, LayerError> {
        self.samples.at(node)
    }

    /// The ground at a point some `edges` along a heading from a node.
    pub fn along(&mut self, node: I64Vec2, heading: usize, edges: f64) -> Ground {
        let at = node_at(node, self.step) + node_at(STENCIL[heading], self.step) * edges;
        Ground::of(&(self.scan)(at))
    }
}

/// Random variation of the cost at a node, 0 to 1, the same for all classes of roads.
pub(in crate::region::road) fn roughness(node: I64Vec2, step: i64) -> f64 {
    let spacing = I64Vec2::splat(ROUGH_SPACING);
    let cell = (node * step).div_euclid(spacing);
    let part = (node * step - cell * spacing).as_dvec2() / ROUGH_SPACING as f64;
    let at = |x: i64, y: i64| {
        let word = stable_hash(&[0x0072_6f75_6768, (cell.x + x) as u64, (cell.y + y) as u64]);
        (word >> 40) as f64 / (1u64 << 24) as f64
    };
    mix(mix(at(0, 0), at(1, 0), part.x), mix(at(0, 1), at(1, 1), part.x), part.y)
}
