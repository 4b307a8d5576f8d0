//! How roads cross highways.

use crate::layer::Choice;
use serde::{Deserialize, Serialize};

/// How a road crosses a highway where the ground and the surroundings allow it. Elsewhere it crosses at a junction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub enum Crossing {
    /// At a junction.
    Junction,
    /// On a bridge without a connection. Where a road turns from one to the other, at a junction.
    Bridge,
    /// On a bridge, with a ramp that connects both.
    Interchange,
}

impl Choice for Crossing {
    const CHOICES: &'static [Self] = &[Self::Junction, Self::Bridge, Self::Interchange];
}
