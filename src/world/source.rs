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

    /// Whether two sources have the same terrain, settlements and roads, with caches of the same size.
    pub(super) fn has_region_of(&self, other: &Self) -> bool {
        let without_patches = |e: &Edits| Edits { patches: Vec::new(), ..e.clone() };
        (self.seed, &self.settings, &self.terrain) == (other.seed, &other.settings, &other.terrain)
            && self.assets.styles.keys().eq(other.assets.styles.keys())
            && without_patches(&self.edits) == without_patches(&other.edits)
    }
}

/// The ground of a world. Two grounds of your own are equal if they share the `Arc`.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::World;

    #[test]
    fn a_world_of_other_patches_takes_over_settlements_and_roads() {
        let world = World::new(WorldSource::new(Seed(3))).expect("the bundled assets make a world");
        let shares_roads = |change: &dyn Fn(&mut WorldSource)| {
            let mut source = world.source().clone();
            change(&mut source);
            let next = world.remade(source).expect("it makes a world");
            Arc::ptr_eq(world.stack().roads(), next.stack().roads())
        };
        assert!(shares_roads(&|s| {
            let mut style = (*s.assets.styles["suburb"]).clone();
            style.parcels.vacant = 1.0;
            s.assets.styles.insert("suburb".into(), Arc::new(style));
        }));
        assert!(!shares_roads(&|s| s.seed = Seed(4)));
        assert!(!shares_roads(&|s| s.settings.roads.minor.reach *= 0.9));
        assert!(!shares_roads(&|s| s.terrain = TerrainSource::own(NoiseTerrain::new(Seed(3), &Default::default()))));
        assert!(!shares_roads(&|s| {
            let (name, style) =
                s.assets.styles.iter().next().map(|(n, s)| (format!("{n}2"), s.clone())).expect("a style");
            s.assets.styles.insert(name, style);
        }));
    }
}
