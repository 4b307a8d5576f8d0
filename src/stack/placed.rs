//! Streets with what made them, and things with the origin that they are local to.

use crate::network::Street;
use crate::space::Origin;
use crate::streets::MadeBy;
use glam::DVec2;

/// A street with what made it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedStreet {
    /// The street.
    pub street: Street,
    /// What made it; `None` for roads and main streets.
    pub made_by: Option<MadeBy>,
}

impl PlacedStreet {
    /// The same street with every point moved by `offset`.
    pub fn moved(&self, offset: DVec2) -> Self {
        Self { street: self.street.moved(offset), made_by: self.made_by.clone() }
    }
}

/// A thing and the origin that its positions are local to.
#[derive(Clone, Debug)]
pub struct AtOrigin<T> {
    /// The origin.
    pub origin: Origin,
    /// The thing.
    pub item: T,
}
