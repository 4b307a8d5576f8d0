//! Tiers: the class and the beeline of a pair of settlements.

use crate::network::{SizeClass, StreetClass};
use crate::region::settlement::Settlement;

/// Class tau = min(sigma, sigma) of the roads of a pair (Galin 2011, section 3), as a size class.
pub(super) fn tier_of(a: &Settlement, b: &Settlement) -> SizeClass {
    a.size.min(b.size)
}

/// Beeline between the centres of two settlements, in metres.
pub(super) fn beeline(a: &Settlement, b: &Settlement) -> f64 {
    a.centre.offset_to(b.centre).length()
}

/// Street class of the roads of a tier.
pub(super) fn class_of(tier: SizeClass) -> StreetClass {
    match tier {
        SizeClass::City => StreetClass::Highway,
        SizeClass::Town => StreetClass::Major,
        SizeClass::Village => StreetClass::Minor,
    }
}

/// Tier of the roads of a street class; `None` for streets.
pub(super) fn tier_of_class(class: StreetClass) -> Option<SizeClass> {
    SizeClass::ALL.into_iter().find(|tier| class_of(*tier) == class)
}
