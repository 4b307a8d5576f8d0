//! The patches that a style may use, indexed for the searches.
use crate::patch::{Patch, PatchSet};
use std::sync::Arc;

/// The patches that a style may use, indexed for the searches of Teng 2017, section 3.3.
#[derive(Clone, Debug)]
pub struct PatchDatabase {
    /// The patches, by set and then by place in the file.
    pub patches: Vec<Arc<Patch>>,
}

impl PatchDatabase {
    /// The patches of `sets` that have at least one tag of `allow` (any patch when that is empty) and none of `exclude`.
    pub fn new(_sets: &[&PatchSet], _allow: &[String], _exclude: &[String]) -> Self {
        todo!()
    }

    /// (patch, pair) indices of all pairs of connectable vertices `distance` metres apart, give or take `tolerance`.
    pub fn pairs_near(&self, _distance: f64, _tolerance: f64) -> Vec<(usize, usize)> {
        todo!()
    }
}
