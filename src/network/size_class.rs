//! Size classes of settlements, which are also the tiers of the road network.

use serde::{Deserialize, Serialize};

/// Size class sigma of a settlement (Galin 2011, section 3), which is also the tier of the lattice that it comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub enum SizeClass {
    /// sigma 0
    Village,
    /// sigma 1
    Town,
    /// sigma 2
    City,
}

impl SizeClass {
    /// Every class, highest tier first.
    pub const ALL: [Self; 3] = [Self::City, Self::Town, Self::Village];

    /// Lower-case name.
    pub fn name(self) -> &'static str {
        match self {
            Self::City => "city",
            Self::Town => "town",
            Self::Village => "village",
        }
    }

    /// The higher tiers, highest first.
    pub(crate) fn higher(self) -> &'static [Self] {
        match self {
            Self::City => &[],
            Self::Town => &Self::ALL[..1],
            Self::Village => &Self::ALL[..2],
        }
    }
}
