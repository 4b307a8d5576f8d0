//! Layer 2: settlements on jittered lattices, a tier per size class.
use crate::layer::{LayerError, RangeError};
use crate::region::Outline;
use crate::space::{Bounds, Origin, Seed};
use crate::terrain::Terrain;
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Stable name of a settlement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct SettlementId(pub u64);

/// Size class sigma.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum SizeClass {
    /// sigma 0
    Village,
    /// sigma 1
    Town,
    /// sigma 2
    City,
}

/// A settlement: where it is, how large, in which style.
#[derive(Clone, Debug, PartialEq)]
pub struct Settlement {
    /// Stable name, a hash of tier and lattice cell.
    pub id: SettlementId,
    /// Centre, a whole-metre plan point: the origin that everything in the settlement is local to.
    pub centre: Origin,
    /// Radius in metres that its outline is shaped from; the outline never goes beyond it.
    pub radius: f64,
    /// Size class sigma.
    pub size: SizeClass,
    /// Name of its style.
    pub style: String,
    /// Its name.
    pub name: String,
}

/// Settings of settlements.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SettlementSettings {}

impl SettlementSettings {
    /// Names of the styles that settlements may get.
    pub fn style_names(&self) -> impl Iterator<Item = &str> {
        std::iter::empty()
    }

    /// Checks ranges.
    pub fn check(&self) -> Result<(), RangeError> {
        Ok(())
    }
}

/// All settlements of a world, found by place.
pub struct Settlements {}

impl Settlements {
    /// Settlements of `seed` on `terrain`. `cache_bytes` bounds the memory of what is remembered.
    pub fn new(_seed: Seed, _settings: &SettlementSettings, _terrain: Arc<dyn Terrain>, _cache_bytes: usize) -> Self {
        Self {}
    }

    /// Settlements whose centre lies in `bounds` (plan metres), sorted by id.
    pub fn centred_in(&self, _bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        todo!()
    }

    /// The same of one size class.
    pub fn centred_in_of(&self, _bounds: Bounds, _size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        todo!()
    }

    /// The settlement with this id, if the world has one.
    pub fn by_id(&self, _id: SettlementId) -> Result<Option<Arc<Settlement>>, LayerError> {
        todo!()
    }

    /// Outline of a settlement.
    pub fn outline(&self, _settlement: &Settlement) -> Result<Arc<Outline>, LayerError> {
        todo!()
    }

    /// Settlements whose outline may overlap `bounds` (their circles do), sorted by id.
    pub fn overlapping(&self, _bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        todo!()
    }

    /// The settlement whose outline holds the plan point `p`.
    pub fn at(&self, _p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
        todo!()
    }

    /// Largest radius of any settlement, in metres.
    pub fn largest_radius(&self) -> f64 {
        todo!()
    }
}
