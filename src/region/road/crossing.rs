//! How roads cross highways.

use crate::layer::Choice;
use crate::network::StreetClass;
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// How a road crosses a highway where the ground and the surroundings allow it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub enum Crossing {
    /// At a junction.
    Junction,
    /// On a bridge without a connection. Where a road turns from one to the other, at a junction.
    Bridge,
    /// On a bridge, with a two-way ramp that connects both: a quadrant interchange. Where it has no room, at a junction.
    Interchange,
    /// On a bridge, with two one-way ramps to the highway and two from it: a diamond interchange. Where these have no room, like
    /// `Interchange`.
    Diamond,
}

impl Choice for Crossing {
    // The plainest first.
    const CHOICES: &'static [Self] = &[Self::Junction, Self::Bridge, Self::Interchange, Self::Diamond];
}

impl Crossing {
    /// Lower-case name, as in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Junction => "junction",
            Self::Bridge => "bridge",
            Self::Interchange => "interchange",
            Self::Diamond => "diamond",
        }
    }
}

/// Why a crossing is not built as the settings of the crossing road say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hindrance {
    /// More than two roads meet there, or a road that does not go on as the same class.
    Roads,
    /// The roads meet at a sharp angle, or one of them bends there.
    Angle,
    /// A junction, a settlement, a bridge or a tunnel is too near on one of the roads.
    Junction,
    /// Another crossing of a highway is too near.
    Crossing,
    /// Another road or a settlement is in the way.
    Obstacle,
    /// The ground is too steep or under water.
    Ground,
    /// The road has no ramp by its settings, but roads turn from one to the other there, or were merged nearby.
    Turn,
}

impl Hindrance {
    /// Lower-case name, as in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Roads => "roads",
            Self::Angle => "angle",
            Self::Junction => "junction",
            Self::Crossing => "crossing",
            Self::Obstacle => "obstacle",
            Self::Ground => "ground",
            Self::Turn => "turn",
        }
    }
}

/// A place where a road crosses a highway on the ground or on a bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighwayCrossing {
    /// Where both roads cross, in plan metres, before lines are smoothed.
    pub at: DVec2,
    /// Class of the road that crosses the highway.
    pub class: StreetClass,
    /// How the crossing is built.
    pub built: Crossing,
    /// What keeps it from being built as the settings of the class say, if something does.
    pub hindrance: Option<Hindrance>,
}
