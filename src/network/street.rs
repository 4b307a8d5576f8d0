//! Junctions, streets and their classes.

use crate::network::traffic::{Side, Traffic};
use crate::space::{Bounds, line_length, stable_hash};
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Least distance between local streets that share no junction, in metres.
pub const STREET_FLOOR: f64 = 14.5;

/// Stable name of a junction: a hash of what made it, the same in every run and in every chunk that sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct JunctionId(pub u64);

/// Stable name of a street: a hash of what made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct StreetId(pub u64);

impl JunctionId {
    /// The id of the junction that `words` name.
    pub fn of(words: &[u64]) -> Self {
        Self(stable_hash(words))
    }
}

impl StreetId {
    /// The id of the street that `words` name.
    pub fn of(words: &[u64]) -> Self {
        Self(stable_hash(words))
    }
}

/// Class of a street: three classes of roads between settlements and their ramps, two of main streets, and local streets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub enum StreetClass {
    /// Road between cities (tau = 2).
    Highway,
    /// Road between a town and a town or city (tau = 1).
    Major,
    /// Road to a village (tau = 0).
    Minor,
    /// One-way ramp between two roads at an interchange. Traffic goes from the street's junction `from` to its junction `to`.
    Ramp,
    /// Main street that runs through a town.
    Arterial,
    /// Any other main street.
    Main,
    /// Street inside a main cell.
    Local,
}

impl StreetClass {
    /// All classes: roads, main streets, local streets; the more important first.
    pub const ALL: [Self; 7] =
        [Self::Highway, Self::Major, Self::Minor, Self::Ramp, Self::Arterial, Self::Main, Self::Local];

    /// Width of the carriageway, in metres.
    pub fn carriageway(self) -> f64 {
        match self {
            Self::Highway => 15.0,
            Self::Major => 9.5,
            Self::Minor => 6.5,
            Self::Ramp => 5.0,
            Self::Arterial => 12.0,
            Self::Main => 9.0,
            Self::Local => 6.0,
        }
    }

    /// Width of the pavement on each side, in metres.
    pub fn pavement(self) -> f64 {
        match self {
            Self::Highway | Self::Major | Self::Minor | Self::Ramp => 0.0,
            Self::Arterial => 3.5,
            Self::Main => 3.0,
            Self::Local => 2.0,
        }
    }

    /// Half of the full width, pavements included, in metres.
    pub fn half_width(self) -> f64 {
        self.carriageway() / 2.0 + self.pavement()
    }

    /// Whether this is a road between settlements, or a ramp of one.
    pub fn is_road(self) -> bool {
        matches!(self, Self::Highway | Self::Major | Self::Minor | Self::Ramp)
    }

    /// Whether this is a class of links between settlements, unlike ramps.
    pub fn is_link(self) -> bool {
        matches!(self, Self::Highway | Self::Major | Self::Minor)
    }

    /// Whether traffic that drives on the right goes only from the junction `from` of a street to its junction `to`.
    pub fn is_one_way(self) -> bool {
        self == Self::Ramp
    }

    /// Whether this is a main street of a town.
    pub fn is_main(self) -> bool {
        matches!(self, Self::Arterial | Self::Main)
    }

    /// Lower-case name, as in exported files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Highway => "highway",
            Self::Major => "major",
            Self::Minor => "minor",
            Self::Ramp => "ramp",
            Self::Arterial => "arterial",
            Self::Main => "main",
            Self::Local => "local",
        }
    }
}

/// A vertex of the street network: where streets meet or end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Junction {
    /// Stable name.
    pub id: JunctionId,
    /// Local position in metres, on the [`QUANTUM`](crate::space::QUANTUM) grid.
    pub at: DVec2,
}

/// An edge of the street network, between two junctions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Street {
    /// Stable name.
    pub id: StreetId,
    /// Class, which sets the widths.
    pub class: StreetClass,
    /// Junction at the first point of `line`.
    pub from: JunctionId,
    /// Junction at the last point of `line`.
    pub to: JunctionId,
    /// Centre line: two local points or more, in metres on the quantum grid, from the junction `from` to the junction `to`.
    pub line: Vec<DVec2>,
    /// Height level: 0 on the ground; streets of different levels cross without meeting.
    pub level: i8,
    /// Whether the street crosses water or another street on a bridge.
    pub bridge: bool,
    /// Whether the street runs under the ground.
    pub tunnel: bool,
    /// If the street is part of the ring of a roundabout, the side on which the island lies.
    pub island: Option<Side>,
}

impl Street {
    /// A street on the ground.
    pub fn new(id: StreetId, class: StreetClass, from: JunctionId, to: JunctionId, line: Vec<DVec2>) -> Self {
        Self { id, class, from, to, line, level: 0, bridge: false, tunnel: false, island: None }
    }

    /// Size in memory, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Self>() + self.line.len() * size_of::<DVec2>()
    }

    /// Length of the centre line in metres.
    pub fn length(&self) -> f64 {
        line_length(&self.line)
    }

    /// Box around the centre line.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.line.iter().copied())
    }

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

    /// The same street moved by `offset`, in whole metres so that no rounding occurs.
    pub fn moved(&self, offset: DVec2) -> Self {
        Self { line: self.line.iter().map(|p| *p + offset).collect(), ..self.clone() }
    }
}

/// Junctions and streets in one local frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Network {
    /// Junctions, each id once.
    pub junctions: Vec<Junction>,
    /// Streets, each id once, with both ends among `junctions`.
    pub streets: Vec<Street>,
}
