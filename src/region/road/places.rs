//! What roads ask of settlements.

use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::{Outline, Settlement, Settlements};
use crate::space::Bounds;
use std::sync::Arc;

/// Settlements found by place. [`Settlements`] in a world; tests and finite domains bring their own.
pub(super) trait Places: Send + Sync {
    /// Settlements of one size class whose centre lies in `bounds` (plan metres), sorted by id.
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError>;

    /// Settlements whose circle overlaps `bounds` (plan metres), sorted by id.
    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError>;

    /// The same of at least the size `tier`.
    fn overlapping_of(&self, bounds: Bounds, tier: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = self.overlapping(bounds)?;
        out.retain(|s| s.size >= tier);
        Ok(out)
    }

    /// Outline of a settlement.
    fn outline(&self, settlement: &Settlement) -> Result<Arc<Outline>, LayerError>;

    /// Whether two settlements touch: then the border is the way between them, and no road is.
    fn touch(&self, _: &Settlement, _: &Settlement) -> Result<bool, LayerError> {
        Ok(false)
    }

    /// Settlements of at least the size `tier` whose centre lies in `bounds`, sorted by id.
    fn of_tier(&self, bounds: Bounds, tier: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = Vec::new();
        for size in [SizeClass::Village, SizeClass::Town, SizeClass::City] {
            if size >= tier {
                out.extend(self.centred_in_of(bounds, size)?);
            }
        }
        out.sort_by_key(|s| s.id);
        Ok(out)
    }
}

impl Places for Settlements {
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Settlements::centred_in_of(self, bounds, size)
    }

    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Settlements::overlapping(self, bounds)
    }

    fn overlapping_of(&self, bounds: Bounds, tier: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Settlements::overlapping_of(self, bounds, tier)
    }

    fn outline(&self, settlement: &Settlement) -> Result<Arc<Outline>, LayerError> {
        Settlements::outline(self, settlement)
    }

    fn touch(&self, a: &Settlement, b: &Settlement) -> Result<bool, LayerError> {
        Ok(self.border(a, b)?.is_some())
    }
}
