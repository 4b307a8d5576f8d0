//! The five inputs of a world, and the ground that it stands on.

use super::assets::WorldAssets;
use super::settings::Settings;
use crate::edits::Edits;
use crate::space::Seed;
use crate::terrain::{NoiseTerrain, Terrain};
use std::sync::Arc;

/// What a world is made from. Everything in the world follows from these values alone.
#[derive(Clone, Debug)]
pub struct WorldSource {
    /// The seed.
    pub seed: Seed,
    /// Settings of the generator.
    pub settings: Settings,
    /// Styles and patch sets.
    pub assets: WorldAssets,
    /// The user's wishes. The world goes on without the edits that it cannot fulfil.
    pub edits: Edits,
    /// The ground.
    pub terrain: TerrainSource,
}

impl WorldSource {
    /// A seed with the default settings, the bundled styles and patch sets, no edits, and the ground that the seed gives.
    pub fn new(seed: Seed) -> Self {
        Self {
            seed,
            settings: Settings::default(),
            assets: WorldAssets::bundled(),
            edits: Edits::default(),
            terrain: TerrainSource::Noise,
        }
    }
}

/// The ground of a world. Two of your own are equal if they share the `Arc`.
#[derive(Clone, Default)]
pub enum TerrainSource {
    /// The noise terrain of the seed and of [`Settings::terrain`].
    #[default]
    Noise,
    /// A terrain of your own; [`Settings::terrain`] is not used.
    Own(Arc<dyn Terrain>),
}

impl TerrainSource {
    /// A ground of your own.
    pub fn own(terrain: impl Terrain) -> Self {
        Self::Own(Arc::new(terrain))
    }

    /// The terrain.
    pub(super) fn make(&self, seed: Seed, settings: &Settings) -> Arc<dyn Terrain> {
        match self {
            Self::Noise => Arc::new(NoiseTerrain::new(seed, &settings.terrain)),
            Self::Own(terrain) => terrain.clone(),
        }
    }
}

impl PartialEq for TerrainSource {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Noise, Self::Noise) => true,
            (Self::Own(a), Self::Own(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl std::fmt::Debug for TerrainSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if matches!(self, Self::Noise) { "Noise" } else { "Own" })
    }
}
