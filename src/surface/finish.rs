//! What the surface is made of.

/// What one stands on at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub enum SurfaceKind {
    /// Open ground.
    Ground,
    /// Water over the ground.
    Water,
    /// The level edge of a country road.
    Verge,
    /// A pavement behind a kerb.
    Pavement,
    /// Where vehicles drive.
    Carriageway,
    /// A marked crossing for people on a carriageway.
    Crossing,
}

/// The material of a triangle of the surface. Where shapes overlap, the greater finish shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Finish {
    /// Open ground.
    Ground,
    /// The level edge of a country road.
    Verge,
    /// Paving behind a kerb.
    Pavement,
    /// The carriageway of a country road.
    Road,
    /// The carriageway of a street.
    Asphalt,
    /// The carriageway between the stripes of a crossing.
    Crossing,
    /// Paint on a carriageway.
    Marking,
    /// A painted stripe of a crossing.
    Stripe,
}

impl Finish {
    /// What one stands on.
    pub fn kind(self) -> SurfaceKind {
        match self {
            Self::Ground => SurfaceKind::Ground,
            Self::Verge => SurfaceKind::Verge,
            Self::Pavement => SurfaceKind::Pavement,
            Self::Road | Self::Asphalt | Self::Marking => SurfaceKind::Carriageway,
            Self::Crossing | Self::Stripe => SurfaceKind::Crossing,
        }
    }

    /// Whether the finish lies above a kerb.
    pub fn is_raised(self) -> bool {
        self == Self::Pavement
    }
}
