//! The sides of tiles and where streets cross them.

use glam::DVec2;

/// A side of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// At the lesser x.
    West,
    /// At the greater x.
    East,
    /// At the lesser y.
    South,
    /// At the greater y.
    North,
}

impl Side {
    /// All sides.
    pub const ALL: [Self; 4] = [Self::West, Self::East, Self::South, Self::North];

    /// The side of the neighbour that lies along this one.
    pub fn opposite(self) -> Self {
        match self {
            Self::West => Self::East,
            Self::East => Self::West,
            Self::South => Self::North,
            Self::North => Self::South,
        }
    }

    /// The unit vector out of the tile.
    pub fn outward(self) -> DVec2 {
        match self {
            Self::West => DVec2::NEG_X,
            Self::East => DVec2::X,
            Self::South => DVec2::NEG_Y,
            Self::North => DVec2::Y,
        }
    }

    /// The axis across which the side lies: 0 for x, 1 for y. Places along it are coordinates of the other axis.
    pub fn axis(self) -> usize {
        match self {
            Self::West | Self::East => 0,
            Self::South | Self::North => 1,
        }
    }
}

/// Where a street crosses a side of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Metres along the side from its middle, eastwards or northwards.
    pub at: f32,
    /// Width of the carriageway in metres.
    pub width: f32,
    /// How far the street leads along the side, eastwards or northwards, for each metre of it on its way north or east across the
    /// side: 0 at a right angle, almost 1 or -1 beside it.
    pub slant: f32,
}
