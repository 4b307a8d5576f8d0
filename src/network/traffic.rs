//! On which side traffic drives, and which way it goes along a street.

use crate::network::Street;
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

impl Street {
    /// The directions of traffic where it drives on this side. Traffic goes around the island of a roundabout with the island on
    /// the other side. A world of traffic on the left is one of traffic on the right whose one-way streets are all reversed.
    pub fn traffic(&self, driving: Side) -> Traffic {
        let along = match self.island {
            Some(island) => island != driving,
            None if self.class.is_one_way() => driving == Side::Right,
            None => return Traffic::Both,
        };
        if along { Traffic::Along } else { Traffic::Against }
    }
}
