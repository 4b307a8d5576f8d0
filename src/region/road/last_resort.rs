//! A road for settlements that would get none, because no way to any other is cheap enough: the way to the nearest one that any
//! way leads to, whatever it costs.

use super::budget::Budget;
use super::distance::Distances;
use super::inputs::{Inputs, Way};
use super::partners::Partners;
use super::tier::{beeline, tier_of};
use super::wishes::Wish;
use crate::layer::{Cancel, LayerCache, LayerError, Weigh};
use crate::network::SizeClass;
use crate::region::settlement::{Settlement, SettlementId};
use std::sync::Arc;

/// A settlement tries the way to so many others.
pub(super) const MOST_TRIES: usize = 6;

/// The other end of a settlement's last resort, if it needs one and there is one.
struct Held(Option<SettlementId>);

impl Weigh for Held {
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

/// The last resorts of settlements.
pub(super) struct LastResorts {
    inputs: Arc<Inputs>,
    distances: Arc<Distances>,
    partners: Arc<Partners>,
    held: LayerCache<SettlementId, Held>,
}

impl LastResorts {
    pub fn new(inputs: Arc<Inputs>, distances: Arc<Distances>, partners: Arc<Partners>, budget: Budget) -> Self {
        Self { inputs, distances, partners, held: budget.cache(1) }
    }

    /// Whether the road of a pair is the last resort of one of its settlements.
    pub fn joins(&self, a: &Settlement, b: &Settlement, cancel: &Cancel) -> Result<bool, LayerError> {
        Ok(self.of(a, cancel)? == Some(b.id) || self.of(b, cancel)? == Some(a.id))
    }

    /// The other end of a settlement's last resort.
    fn of(&self, s: &Settlement, cancel: &Cancel) -> Result<Option<SettlementId>, LayerError> {
        let held = self.held.get(&s.id, || {
            let mut others = Vec::new();
            for tier in SizeClass::ALL.into_iter().filter(|tier| *tier <= s.size) {
                others.extend(self.partners.of(tier, s)?);
            }
            others.retain(|other| self.inputs.wishes.of(s, other) != Some(&Wish::Ban));
            others.sort_by(|a, b| beeline(s, a).total_cmp(&beeline(s, b)).then(a.id.cmp(&b.id)));
            for other in &others {
                if self.inputs.settlements.touch(s, other)?
                    || self.distances.corridor_path(tier_of(s, other), s, other, cancel)?.cost.is_finite()
                {
                    return Ok(Held(None));
                }
            }
            for other in others.iter().take(MOST_TRIES) {
                if self.distances.coarse_path((tier_of(s, other), Way::Costlier), s, other, cancel)?.cost.is_finite() {
                    return Ok(Held(Some(other.id)));
                }
            }
            Ok(Held(None))
        })?;
        Ok(held.0)
    }
}
