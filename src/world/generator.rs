//! The face of the generator.

use super::area::Area;
use super::assets::WorldAssets;
use super::error::WorldError;
use super::route::Route;
use super::settings::Settings;
use super::source::WorldSource;
use crate::chunk::{self, Chunk};
use crate::edits::{Edits, RejectedEdit};
use crate::layer::{Cancel, LayerCache, LayerError, Reach};
use crate::mesh::{self, ChunkMesh, Detail, HorizonFeatures, HorizonTile, HorizonTown};
use crate::network::{Junction, JunctionId, Street, StreetId};
use crate::region::{Roads, Settlement, Settlements};
use crate::space::{Bounds, ChunkCoord, Origin, Seed, closest_on_line};
use crate::stack::{AtOrigin, Overlap, PlacedStreet, SeamedTown, Stack, StackParts};
use crate::surface::{SurfaceKind, SurfacePoint};
use crate::terrain::{DrawnGround, Terrain};
use glam::DVec2;
use std::sync::Arc;

/// An endless world, a pure function of its [`WorldSource`]. Cheap to clone; clones share their caches.
///
/// Methods with a [`Cancel`] fail with [`LayerError::Cancelled`] once it is set. Their other errors are defects of a layer.
///
/// ```
/// use bevy_sprawl::{layer::Cancel, space::{ChunkCoord, Seed}, world::{World, WorldSource}};
///
/// let world = World::new(WorldSource::new(Seed(7)))?;
/// let chunk = world.chunk(ChunkCoord::new(0, -3), &Cancel::new())?;
/// println!("{} streets, {} buildings", chunk.streets.len(), chunk.footprints.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct World {
    inner: Arc<Inner>,
}

struct Inner {
    source: WorldSource,
    stack: Stack,
    chunks: LayerCache<ChunkCoord, Chunk>,
}

/// The street nearest to a point.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestStreet {
    /// The street, local to `origin`.
    pub street: Street,
    /// The origin that the street is local to.
    pub origin: Origin,
    /// Nearest point of the street's centre line, in plan metres.
    pub at: DVec2,
    /// Distance to `at` in metres.
    pub distance: f64,
}

impl World {
    /// The world of a source. It leaves out edits that it cannot fulfil: see [`World::rejected_edits`].
    ///
    /// # Errors
    ///
    /// If settings or edits are outside their ranges, or a named style, patch set or patch is missing from the assets.
    pub fn new(source: WorldSource) -> Result<Self, WorldError> {
        Self::make(source, None)
    }

    /// The world of another source, as [`World::new`] makes it. If both worlds have the same settlements and roads, as after a
    /// change of styles, patch sets and pinned patches, the new world takes over the ones that this world has found.
    pub fn remade(&self, source: WorldSource) -> Result<Self, WorldError> {
        Self::make(source, Some(self))
    }

    fn make(source: WorldSource, earlier: Option<&Self>) -> Result<Self, WorldError> {
        let WorldSource { seed, settings, assets, edits, terrain } = &source;
        settings.check()?;
        edits.check()?;
        assets.check(settings)?;
        let mib = |mib: f64| (mib * 1024.0 * 1024.0) as usize;
        let (terrain, settlements, roads) = match earlier.filter(|e| e.source().has_region_of(&source)) {
            Some(earlier) => {
                let stack = earlier.stack();
                (stack.terrain().clone(), stack.settlements().clone(), stack.roads().clone())
            }
            None => {
                let terrain = terrain.make(*seed, settings);
                let region = mib(settings.cache.region_mib);
                let has_style = |style: &str| assets.styles.contains_key(style);
                let settlements = Arc::new(Settlements::with_edits(
                    *seed,
                    &settings.settlements,
                    terrain.clone(),
                    &edits.settlements,
                    has_style,
                    region / 4,
                ));
                let (ground, bytes) = (terrain.clone(), region / 4 * 3);
                let roads = Roads::with_edits(&settings.roads, ground, settlements.clone(), edits, bytes);
                (terrain, settlements, Arc::new(roads))
            }
        };
        let stack = Stack::new(StackParts {
            seed: *seed,
            terrain,
            settlements,
            roads,
            styles: assets.styles.clone(),
            sets: assets.patch_sets.clone(),
            pins: edits.patches.clone(),
            bytes: mib(settings.cache.town_mib),
        });
        let chunks = LayerCache::new(mib(settings.cache.chunk_mib));
        Ok(Self { inner: Arc::new(Inner { source, stack, chunks }) })
    }

    /// The inputs of the world.
    pub fn source(&self) -> &WorldSource {
        &self.inner.source
    }

    /// The settings of the generator.
    pub fn settings(&self) -> &Settings {
        &self.inner.source.settings
    }

    /// The styles and patch sets.
    pub fn assets(&self) -> &WorldAssets {
        &self.inner.source.assets
    }

    /// The edits, fulfilled or not.
    pub fn edits(&self) -> &Edits {
        &self.inner.source.edits
    }

    /// The edits that the world cannot fulfil and leaves out, each with the reason. To find out, this makes the roads that
    /// edits concern and the main cells in which patches are pinned.
    pub fn rejected_edits(&self, cancel: &Cancel) -> Result<Vec<RejectedEdit>, LayerError> {
        let mut out = self.settlements().rejected_edits().to_vec();
        out.extend(self.roads().rejected_edits(cancel)?);
        out.extend(self.inner.stack.rejected_pins(cancel)?);
        Ok(out)
    }

    /// The seed.
    pub fn seed(&self) -> Seed {
        self.inner.source.seed
    }

    /// The layers below the chunk.
    pub fn stack(&self) -> &Stack {
        &self.inner.stack
    }

    /// The ground.
    pub fn terrain(&self) -> &Arc<dyn Terrain> {
        self.inner.stack.terrain()
    }

    /// The settlements.
    pub fn settlements(&self) -> &Settlements {
        self.inner.stack.settlements()
    }

    /// The roads between settlements.
    pub fn roads(&self) -> &Roads {
        self.inner.stack.roads()
    }

    /// Main streets, main cells and seams of a settlement.
    pub fn town(&self, settlement: &Arc<Settlement>, cancel: &Cancel) -> Result<Arc<SeamedTown>, LayerError> {
        self.inner.stack.town(settlement, cancel)
    }

    /// What a chunk owns, and the ground under it.
    pub fn chunk(&self, coord: ChunkCoord, cancel: &Cancel) -> Result<Arc<Chunk>, LayerError> {
        let inner = &*self.inner;
        let Settings { chunk_size, driving, .. } = inner.source.settings;
        inner.chunks.get(&coord, || chunk::assemble(&inner.stack, coord, chunk_size, driving, cancel))
    }

    /// The vertex buffers of a chunk at a level of detail.
    pub fn mesh(&self, coord: ChunkCoord, detail: Detail, cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
        mesh::build(&*self.chunk(coord, cancel)?, &**self.terrain(), detail, cancel)
    }

    /// The vertex buffers of a tile of the land beyond the chunks, from the tile's south-west corner.
    pub fn horizon(&self, tile: HorizonTile, cancel: &Cancel) -> Result<ChunkMesh, LayerError> {
        let chunk_size = self.settings().chunk_size;
        let settlements = self.settlements().overlapping(tile.bounds(chunk_size))?;
        let outlines: Vec<_> = settlements.iter().map(|s| self.settlements().outline(s)).collect::<Result<_, _>>()?;
        let towns = settlements.iter().zip(&outlines).filter_map(|(settlement, outline)| {
            let parcels = &self.assets().styles.get(&settlement.style)?.parcels;
            Some(HorizonTown { settlement, outline, parcels })
        });
        let mut features = HorizonFeatures { towns: towns.collect(), roads: Vec::new() };
        if tile.level <= HorizonTile::ROADS {
            features.roads = self.roads().overlapping(tile.bounds(chunk_size), cancel)?;
        }
        mesh::horizon(tile, chunk_size, &**self.terrain(), &features, cancel)
    }

    /// Everything that overlaps a box (plan metres). Streets are whole and have the junctions at both ends.
    pub fn area(&self, bounds: Bounds, cancel: &Cancel) -> Result<Area, LayerError> {
        Area::gather(&self.inner.stack, bounds, self.inner.source.settings.chunk_size, cancel)
    }

    /// Height of the natural ground at a plan point, in metres, before streets cut and fill it. Answers in microseconds.
    pub fn natural_height(&self, p: DVec2) -> f64 {
        DrawnGround::new(&**self.terrain()).height(p)
    }

    /// The ground or the street at a plan point, not counting decks of bridges: what the chunk there draws. Makes the chunk if it
    /// is not known yet.
    pub fn surface_at(&self, p: DVec2, cancel: &Cancel) -> Result<SurfacePoint, LayerError> {
        let chunk = self.chunk(ChunkCoord::containing(p, self.settings().chunk_size), cancel)?;
        let point = chunk.surface_at(chunk.origin.to_local(p));
        Ok(point.unwrap_or_else(|| SurfacePoint { height: self.natural_height(p), kind: SurfaceKind::Ground }))
    }

    /// Height of the ground or the street at a plan point, in metres, as [`surface_at`](Self::surface_at) gives it.
    pub fn height_at(&self, p: DVec2, cancel: &Cancel) -> Result<f64, LayerError> {
        Ok(self.surface_at(p, cancel)?.height)
    }

    /// The street with an id, if it overlaps a box (plan metres). An id does not tell where the street lies.
    pub fn street(
        &self,
        id: StreetId,
        bounds: Bounds,
        cancel: &Cancel,
    ) -> Result<Option<AtOrigin<PlacedStreet>>, LayerError> {
        let overlap = self.overlapping("street", bounds, cancel)?;
        Ok(overlap.streets.into_iter().find(|found| found.item.street.id == id))
    }

    /// The junction with an id, if a street that overlaps a box (plan metres) ends there.
    pub fn junction(
        &self,
        id: JunctionId,
        bounds: Bounds,
        cancel: &Cancel,
    ) -> Result<Option<AtOrigin<Junction>>, LayerError> {
        let overlap = self.overlapping("junction", bounds, cancel)?;
        Ok(overlap.junctions.into_iter().find(|found| found.item.id == id))
    }

    fn overlapping(&self, question: &'static str, bounds: Bounds, cancel: &Cancel) -> Result<Overlap, LayerError> {
        self.inner.stack.overlapping(bounds, &Reach::new(question, bounds, 0.0), cancel)
    }

    /// The settlement whose outline holds a plan point.
    pub fn settlement_at(&self, p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
        self.settlements().at(p)
    }

    /// The street nearest to a plan point, within `reach` metres.
    pub fn nearest_street(&self, p: DVec2, reach: f64, cancel: &Cancel) -> Result<Option<NearestStreet>, LayerError> {
        let bounds = Bounds::square(p, 2.0 * reach);
        let overlap = self.overlapping("nearest street", bounds, cancel)?;
        let mut best: Option<NearestStreet> = None;
        for found in overlap.streets {
            let local = found.origin.to_local(p);
            let at = closest_on_line(local, &found.item.street.line).1;
            let distance = at.distance(local);
            if distance <= reach && best.as_ref().is_none_or(|b| distance < b.distance) {
                let (street, origin) = (found.item.street, found.origin);
                best = Some(NearestStreet { street, origin, at: origin.to_plan(at), distance });
            }
        }
        Ok(best)
    }

    /// The shortest way along streets between two plan points. Only streets within `margin` metres of the box around both points
    /// are used. `None` when no street is that near to a point, or no way leads there.
    pub fn route(&self, from: DVec2, to: DVec2, margin: f64, cancel: &Cancel) -> Result<Option<Route>, LayerError> {
        Route::find(&self.inner.stack, from, to, margin, cancel)
    }

    /// Forgets every chunk and filled main cell; towns and roads stay. Forgotten things are made again, the same, when asked for.
    pub fn forget_chunks(&self) {
        self.inner.chunks.clear();
        self.inner.stack.forget_cells();
    }

    /// Bytes that the caches of towns, streets, parcels and chunks hold now.
    pub fn cached_bytes(&self) -> u64 {
        self.inner.stack.bytes() + self.inner.chunks.bytes()
    }
}
