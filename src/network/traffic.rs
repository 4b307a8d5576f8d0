//! On which side traffic drives, and which way it goes along a street.

use serde::{Deserialize, Serialize};

/// A side of a street, going along its line; or the side of the road on which traffic drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub enum Side {
    /// The left.
    Left,
    /// The right.
    #[default]
    Right,
}

/// The directions in which traffic goes along a street.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traffic {
    /// In both directions.
    Both,
    /// From the junction `from` to the junction `to` only.
    Along,
    /// From the junction `to` to the junction `from` only.
    Against,
}
