//! The patches that are found in a map.

use super::options::NoPatch;
use super::shape::Shape;
use crate::map::report::LeftOut;
use crate::patch::{Patch, PatchDrawing};
use std::collections::BTreeMap;

/// A patch of a map.
#[derive(Clone, Debug)]
pub struct Extracted {
    /// The patch.
    pub patch: Patch,
    /// Its drawing, as a file has it.
    pub drawing: PatchDrawing,
    pub(super) shape: Shape,
}

/// The patches of a map.
#[derive(Clone, Debug, Default)]
pub struct MapPatches {
    /// Name of the map.
    pub map: String,
    /// The patches, from west to east and from south to north.
    pub patches: Vec<Extracted>,
    /// Length of the map's streets in metres.
    pub length: f64,
    /// Number of its junctions of three streets or more.
    pub junctions: usize,
    /// Number of its buildings.
    pub buildings: usize,
    /// What the reader left out of the file, by reason: buildings whose outlines cross themselves, for one.
    pub not_read: BTreeMap<LeftOut, usize>,
    /// How many parts of the map made no patch, by reason.
    pub left_out: BTreeMap<NoPatch, usize>,
}

impl MapPatches {
    pub(super) fn leave_out(&mut self, reason: NoPatch, count: usize) {
        if count > 0 {
            *self.left_out.entry(reason).or_default() += count;
        }
    }

    /// Adds a patch, unless its drawing is none.
    pub(super) fn add(&mut self, drawing: PatchDrawing, check: impl Fn(&Patch) -> Result<Shape, NoPatch>) {
        let patch = Patch::of(drawing.clone()).map_err(|e| NoPatch::of(e.kind));
        match patch.and_then(|patch| check(&patch).map(|shape| Extracted { patch, drawing, shape })) {
            Ok(patch) => self.patches.push(patch),
            Err(reason) => self.leave_out(reason, 1),
        }
    }
}
