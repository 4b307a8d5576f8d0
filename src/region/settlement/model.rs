//! A settlement, its id, and values for each size class.

use crate::network::SizeClass;
use crate::space::{Bounds, Origin};
use serde::{Deserialize, Serialize};

/// Stable id of a settlement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct SettlementId(pub u64);

/// One value for each size class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(deny_unknown_fields)]
pub struct PerSize<T> {
    /// The value for cities.
    pub city: T,
    /// The value for towns.
    pub town: T,
    /// The value for villages.
    pub village: T,
}

impl<T> PerSize<T> {
    /// The value for a size class.
    pub fn of(&self, size: SizeClass) -> &T {
        match size {
            SizeClass::City => &self.city,
            SizeClass::Town => &self.town,
            SizeClass::Village => &self.village,
        }
    }

    /// The value for a size class, to be changed.
    pub(super) fn of_mut(&mut self, size: SizeClass) -> &mut T {
        match size {
            SizeClass::City => &mut self.city,
            SizeClass::Town => &mut self.town,
            SizeClass::Village => &mut self.village,
        }
    }
}

/// A settlement: its position, size and style.
#[derive(Clone, Debug, PartialEq)]
pub struct Settlement {
    /// Stable id: a hash of the tier and the lattice cell, or of the position of a pinned settlement. Never 0.
    pub id: SettlementId,
    /// Centre, a whole-metre plan point. Everything in the settlement is local to this origin.
    pub centre: Origin,
    /// Radius in metres that the outline is shaped from. The outline never reaches beyond it.
    pub radius: f64,
    /// Size class sigma.
    pub size: SizeClass,
    /// Name of the settlement's style.
    pub style: String,
    /// Name of the settlement.
    pub name: String,
}

impl Settlement {
    /// Whether the settlement's circle shares a point with a box (plan metres).
    pub(in crate::region) fn touches(&self, bounds: Bounds) -> bool {
        let centre = self.centre.plan();
        centre.distance_squared(centre.clamp(bounds.min, bounds.max)) <= self.radius * self.radius
    }
}
