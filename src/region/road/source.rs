//! Where roads look settlements up.

use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::outline::Outline;
use crate::region::settlement::Settlement;
use crate::region::settlements::Settlements;
use crate::space::Bounds;
use glam::DVec2;
use std::sync::Arc;

/// Settlements, found by place: [`Settlements`] in an endless world, a list in a finite domain.
pub(super) trait SettlementSource: Send + Sync {
    /// Settlements of one size class whose centre lies in `bounds` (plan metres), sorted by id.
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError>;

    /// Settlements whose circle overlaps `bounds` (plan metres), sorted by id.
    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError>;

    /// Settlements of at least the size `least` whose circle overlaps `bounds` (plan metres), sorted by id.
    fn overlapping_of(&self, bounds: Bounds, least: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = self.overlapping(bounds)?;
        out.retain(|s| s.size >= least);
        Ok(out)
    }

    /// Settlements that an edit may mean by a point (plan metres): all whose circle holds it, and perhaps others nearby.
    fn named_near(&self, p: DVec2) -> Result<Vec<Arc<Settlement>>, LayerError> {
        self.overlapping(Bounds::new(p, p))
    }

    /// Outline of a settlement.
    fn outline(&self, settlement: &Settlement) -> Result<Arc<Outline>, LayerError>;

    /// Whether two settlements touch. Their border then joins them, and they need no road.
    fn touch(&self, _: &Settlement, _: &Settlement) -> Result<bool, LayerError> {
        Ok(false)
    }

    /// Settlements of at least the size `least` whose centre lies in `bounds` (plan metres), sorted by id.
    fn centred_in(&self, bounds: Bounds, least: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = Vec::new();
        for size in SizeClass::ALL.into_iter().filter(|size| *size >= least) {
            out.extend(self.centred_in_of(bounds, size)?);
        }
        out.sort_by_key(|s| s.id);
        Ok(out)
    }
}

impl SettlementSource for Settlements {
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Settlements::centred_in_of(self, bounds, size)
    }

    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Settlements::overlapping(self, bounds)
    }

    fn overlapping_of(&self, bounds: Bounds, least: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Settlements::overlapping_of(self, bounds, least)
    }

    fn outline(&self, settlement: &Settlement) -> Result<Arc<Outline>, LayerError> {
        Settlements::outline(self, settlement)
    }

    fn touch(&self, a: &Settlement, b: &Settlement) -> Result<bool, LayerError> {
        Ok(self.border(a, b)?.is_some())
    }
}
