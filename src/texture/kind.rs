//! The textures, their names and sizes.

/// What a surface looks like from close by. Between the first four, the ground passes smoothly from each to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Texture {
    /// Sand, beds of water and snow.
    Sand,
    /// Dry, uneven grass with herbs.
    Meadow,
    /// Lush grass.
    Grass,
    /// The floor of woods: leaves and moss.
    Litter,
    /// Bare rock. Steep ground has it, whatever else grows nearby.
    Rock,
    /// The carriageway of country roads: chippings in tar.
    Chippings,
    /// The carriageway of streets.
    Asphalt,
    /// Flagstones of pavements.
    Flags,
    /// Dressed stone and concrete.
    Stone,
    /// Worn paint on a carriageway.
    Paint,
    /// Plastered walls.
    Plaster,
    /// Walls of bricks.
    Brick,
    /// Roof tiles and slates.
    Tiles,
    /// Flat roofs: felt under gravel.
    Felt,
}

impl Texture {
    /// Every texture, in the order of the layers of an array.
    pub const ALL: [Self; 14] = [
        Self::Sand,
        Self::Meadow,
        Self::Grass,
        Self::Litter,
        Self::Rock,
        Self::Chippings,
        Self::Asphalt,
        Self::Flags,
        Self::Stone,
        Self::Paint,
        Self::Plaster,
        Self::Brick,
        Self::Tiles,
        Self::Felt,
    ];

    /// Edge of the square in metres.
    pub fn size(self) -> f32 {
        match self {
            Self::Sand | Self::Grass | Self::Chippings | Self::Plaster => 3.0,
            Self::Stone | Self::Paint | Self::Brick => 2.0,
            Self::Tiles => 2.4,
            Self::Asphalt | Self::Flags | Self::Litter | Self::Felt => 4.0,
            Self::Meadow => 5.0,
            Self::Rock => 12.0,
        }
    }

    /// The opacity of a vertex that has this texture: in meshes of opaque parts it names the texture. 255 steps lead from the first
    /// texture of the list to opacity 1.
    pub fn alpha(self) -> f32 {
        Self::between(f32::from(self as u8))
    }

    /// The same for a place on the list, 0 for the first texture. Between two whole numbers the textures blend.
    pub fn between(place: f32) -> f32 {
        place / 255.0
    }
}
