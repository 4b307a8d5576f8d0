//! The face of the generator, layers 1 to 8.

mod area;
mod assets;
mod audit;
mod changed;
#[cfg(test)]
mod river_tests;
mod route;
mod settings;
#[cfg(test)]
mod town_tests;

pub use crate::region::edits::{
    EditList, Edits, Influence, PatchEdit, RejectedEdit, RoadEdit, SettlementEdit, Shape, WayPoint,
};
pub use area::{Area, Owned};
pub use assets::{WorldAssets, WorldError};
pub use audit::{Fault, Finding, audit, unreached_gates};
pub use changed::changed_by_edits;
pub use route::Route;
pub use settings::{CacheSettings, Settings};

use crate::chunk::{self, Chunk, Ground, Layers, SeamedTown};
use crate::layer::{Cancel, LayerCache, LayerError, Reach};
use crate::network::Street;
use crate::region::{Roads, Settlement, Settlements};
use crate::space::{Bounds, ChunkCoord, Origin, Seed, closest_on_line};
use crate::terrain::{NoiseTerrain, Terrain};
use glam::DVec2;
use std::sync::Arc;

/// An endless world, a pure function of seed, settings, assets and edits. Cheap to clone; clones share their caches.
///
/// ```
/// use bevy_sprawl::{layer::Cancel, space::{ChunkCoord, Seed}, world::{Settings, World, WorldAssets}};
///
/// let world = World::new(Seed(7), Settings::default(), WorldAssets::bundled())?;
/// let chunk = world.chunk(ChunkCoord::new(0, -3), &Cancel::new())?;
/// println!("{} streets, {} buildings", chunk.streets.len(), chunk.footprints.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct World {
    inner: Arc<Inner>,
}

struct Inner {
    seed: Seed,
    settings: Settings,
    assets: WorldAssets,
    edits: Edits,
    layers: Layers,
    chunks: LayerCache<ChunkCoord, Chunk>,
}

/// The street nearest to a point.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestStreet {
    /// The street, local to `origin`.
    pub street: Street,
    /// Origin of its line.
    pub origin: Origin,
    /// Nearest point of its centre line, in plan metres.
    pub at: DVec2,
    /// Distance to that point in metres.
    pub distance: f64,
}

impl World {
    /// A world on the default terrain. Fails on settings outside their ranges, and when a style or patch set that is
    /// named is missing from the assets.
    pub fn new(seed: Seed, settings: Settings, assets: WorldAssets) -> Result<Self, WorldError> {
        Self::with_edits(seed, settings, assets, Edits::default())
    }

    /// A world on the default terrain with the user's wishes. Fails as [`World::new`] does, and on edits that
    /// [`Edits::check`] refuses. Those that this world cannot fulfil are left out: see [`World::rejected_edits`].
    pub fn with_edits(seed: Seed, settings: Settings, assets: WorldAssets, edits: Edits) -> Result<Self, WorldError> {
        settings.check()?;
        let terrain = Arc::new(NoiseTerrain::new(seed, &settings.terrain));
        Self::on_terrain_with_edits(seed, settings, assets, terrain, edits)
    }

    /// A world on a terrain of your own; `settings.terrain` is not used. Fails as [`World::new`] does.
    pub fn on_terrain(
        seed: Seed,
        settings: Settings,
        assets: WorldAssets,
        terrain: Arc<dyn Terrain>,
    ) -> Result<Self, WorldError> {
        Self::on_terrain_with_edits(seed, settings, assets, terrain, Edits::default())
    }

    /// The same with the user's wishes. Fails as [`World::with_edits`] does.
    pub fn on_terrain_with_edits(
        seed: Seed,
        settings: Settings,
        assets: WorldAssets,
        terrain: Arc<dyn Terrain>,
        edits: Edits,
    ) -> Result<Self, WorldError> {
        settings.check()?;
        edits.check()?;
        let kits = assets.kits(&settings)?;
        let mib = |mib: f64| (mib * 1024.0 * 1024.0) as usize;
        let region = mib(settings.cache.region_mib);
        let has_style = |style: &str| assets.styles.contains_key(style);
        let (wishes, ground) = (&edits.settlements, terrain.clone());
        let settlements = Settlements::with_edits(seed, &settings.settlements, ground, wishes, has_style, region / 4);
        let settlements = Arc::new(settlements);
        let roads = Roads::with_edits(&settings.roads, terrain.clone(), settlements.clone(), &edits, region / 4 * 3);
        let (sets, pins, bytes) = (assets.patch_sets.clone(), edits.patches.clone(), mib(settings.cache.town_mib));
        let layers = Layers::new(seed, terrain, settlements, roads, kits, sets, pins, bytes);
        let chunks = LayerCache::new(mib(settings.cache.chunk_mib));
        Ok(Self { inner: Arc::new(Inner { seed, settings, assets, edits, layers, chunks }) })
    }

    /// Settings it was made with.
    pub fn settings(&self) -> &Settings {
        &self.inner.settings
    }

    /// Styles and patch sets it was made with.
    pub fn assets(&self) -> &WorldAssets {
        &self.inner.assets
    }

    /// Edits it was made with.
    pub fn edits(&self) -> &Edits {
        &self.inner.edits
    }

    /// The edits that cannot be in this world, and why; it is the world without them. Makes the roads that edits want, and
    /// the main cells that patches are pinned in.
    pub fn rejected_edits(&self, cancel: &Cancel) -> Result<Vec<RejectedEdit>, LayerError> {
        let mut out = self.settlements().rejected_edits().to_vec();
        out.extend(self.roads().rejected_edits(cancel)?);
        out.extend(self.inner.layers.rejected_pins(cancel)?);
        Ok(out)
    }

    /// The seed it was made with.
    pub fn seed(&self) -> Seed {
        self.inner.seed
    }

    /// The layers below the chunk.
    pub fn layers(&self) -> &Layers {
        &self.inner.layers
    }

    /// The ground.
    pub fn terrain(&self) -> &Arc<dyn Terrain> {
        self.inner.layers.terrain()
    }

    /// Its settlements.
    pub fn settlements(&self) -> &Settlements {
        self.inner.layers.settlements()
    }

    /// Its roads.
    pub fn roads(&self) -> &Roads {
        self.inner.layers.roads()
    }

    /// Main streets, main cells and seams of a settlement.
    pub fn town(&self, settlement: &Arc<Settlement>, cancel: &Cancel) -> Result<Arc<SeamedTown>, LayerError> {
        self.inner.layers.town(settlement, cancel)
    }

    /// What a chunk owns.
    pub fn chunk(&self, coord: ChunkCoord, cancel: &Cancel) -> Result<Arc<Chunk>, LayerError> {
        let inner = &*self.inner;
        inner.chunks.get(&coord, || chunk::assemble(&inner.layers, coord, inner.settings.chunk_size, cancel))
    }

    /// Everything that overlaps a box (plan metres), streets whole and with both their junctions.
    pub fn area(&self, bounds: Bounds, cancel: &Cancel) -> Result<Area, LayerError> {
        Area::gather(&self.inner.layers, bounds, self.inner.settings.chunk_size, cancel)
    }

    /// Height of the drawn ground at a plan point, in metres.
    pub fn height_at(&self, p: DVec2) -> f64 {
        Ground::height_at(&**self.terrain(), p)
    }

    /// The settlement whose outline holds a plan point.
    pub fn settlement_at(&self, p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
        self.settlements().at(p)
    }

    /// The street nearest to a plan point, within `reach` metres.
    pub fn nearest_street(&self, p: DVec2, reach: f64, cancel: &Cancel) -> Result<Option<NearestStreet>, LayerError> {
        let bounds = Bounds::square(p, 2.0 * reach);
        let overlap = self.inner.layers.overlapping(bounds, &Reach::new("nearest street", bounds, 0.0), cancel)?;
        let mut best: Option<NearestStreet> = None;
        for found in overlap.streets {
            let local = found.origin.to_local(p);
            let at = closest_on_line(local, &found.it.street.line).1;
            let distance = at.distance(local);
            if distance <= reach && best.as_ref().is_none_or(|b| distance < b.distance) {
                let (street, origin) = (found.it.street, found.origin);
                best = Some(NearestStreet { street, origin, at: origin.to_plan(at), distance });
            }
        }
        Ok(best)
    }

    /// The shortest way along streets between two plan points, looking at streets within `margin` metres of the box around
    /// both. `None` when no street is that near, or none leads there within the box.
    pub fn route(&self, from: DVec2, to: DVec2, margin: f64, cancel: &Cancel) -> Result<Option<Route>, LayerError> {
        Route::find(&self.inner.layers, from, to, margin, cancel)
    }

    /// Forgets every chunk and filled main cell; towns and roads stay. They are made again, the same, when asked for.
    pub fn forget_chunks(&self) {
        self.inner.chunks.clear();
        self.inner.layers.forget_cells();
    }

    /// Bytes that the caches hold now: towns with streets and parcels, and chunks.
    pub fn cached_bytes(&self) -> u64 {
        self.inner.layers.bytes() + self.inner.chunks.bytes()
    }
}
