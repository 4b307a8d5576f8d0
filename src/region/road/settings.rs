//! Settings of roads.

use super::tier_settings::{TierNumber, TierSettings};
use crate::layer::{RangeError, Ranged, Walk};
use crate::network::{SizeClass, StreetClass};
use serde::Serialize;

/// Settings of roads, one set per class. A file names only what differs from the default of each class.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub struct RoadSettings {
    /// Spacing in metres of the lattice that roads are searched on: 64 to 512.
    pub step: i64,
    /// Distance in metres below which roads that run beside each other merge: 0 (never) to 400.
    pub merge: f64,
    /// Roads between cities.
    pub highway: TierSettings,
    /// Roads between a town and a town or city.
    pub major: TierSettings,
    /// Roads between a village and any settlement.
    pub minor: TierSettings,
}

impl Default for RoadSettings {
    fn default() -> Self {
        let (highway, major, minor) = (TierSettings::highway(), TierSettings::major(), TierSettings::minor());
        Self { step: 128, merge: 275.0, highway, major, minor }
    }
}

impl Ranged for RoadSettings {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { step, merge, highway: _, major: _, minor: _ } = self;
        walk.number("step", step, 64.0, 512.0)?;
        walk.number("merge", merge, 0.0, 400.0)?;
        self.walk_tiers(walk, |number| (number.low, number.high))
    }
}

impl RoadSettings {
    /// Checks that every value lies in its range.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is out of range or NaN.
    pub fn check(&self) -> Result<(), RangeError> {
        self.check_ranges()
    }

    /// Walks over the settings of all classes; `range` may widen the range of a number.
    pub(super) fn walk_tiers(
        &mut self,
        walk: &mut Walk<'_>,
        range: impl Fn(&TierNumber) -> (f64, f64),
    ) -> Result<(), RangeError> {
        [("highway", &mut self.highway), ("major", &mut self.major), ("minor", &mut self.minor)]
            .into_iter()
            .try_for_each(|(name, tier)| walk.inside(name, |walk| tier.walk(walk, &range)))
    }

    /// The [costlier settings](TierSettings::costlier) of all classes.
    pub(super) fn costlier(&self) -> Self {
        let (highway, major, minor) = (self.highway.costlier(), self.major.costlier(), self.minor.costlier());
        Self { highway, major, minor, ..*self }
    }

    /// Settings of the roads of a street class.
    pub(super) fn class(&self, class: StreetClass) -> &TierSettings {
        match class {
            StreetClass::Highway => &self.highway,
            StreetClass::Major => &self.major,
            _ => &self.minor,
        }
    }

    /// Settings of the roads of a tier.
    pub(super) fn tier(&self, tier: SizeClass) -> &TierSettings {
        match tier {
            SizeClass::City => &self.highway,
            SizeClass::Town => &self.major,
            SizeClass::Village => &self.minor,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_in_range_and_errors_name_the_field() {
        assert_eq!(RoadSettings::default().check(), Ok(()));
        let mut s = RoadSettings::default();
        s.major.gamma = f64::NAN;
        assert_eq!(s.check().unwrap_err().field, "major.gamma");
    }
}
