//! Questions that games ask the world.

use super::chunk::{ChunkData, ChunkStatus};
use super::origin::SprawlOrigin;
use super::source::SprawlWorld;
use super::spawn_point::{SpawnPoint, nearest_town, spawn_point};
use super::streaming::ChunkIndex;
use super::task::SprawlTask;
use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::network::{Junction, JunctionId, Street, StreetId};
use crate::region::Settlement;
use crate::space::{ChunkCoord, closest_on_line};
use crate::surface::{LONGEST_PIECE, SurfacePoint};
use crate::world::{NearestStreet, Route, World};
use bevy::ecs::system::SystemParam;
use bevy::prelude::{Entity, Query, Res, Vec3};
use glam::DVec2;
use std::sync::Arc;

/// Questions to the world, for any system. Points are Bevy's; [`Sprawl::to_plan`] and [`Sprawl::to_bevy`] convert.
///
/// No question stalls a frame. There are two kinds:
///
/// | answered at once, in microseconds | answered in the background |
/// |---|---|
/// | [`height`](Self::height), [`on_ground`](Self::on_ground): anywhere | [`route`](Self::route) |
/// | [`surface_at`](Self::surface_at), [`settlement_at`](Self::settlement_at), [`nearest_street`](Self::nearest_street), [`street`](Self::street), [`junction`](Self::junction), [`data`](Self::data), [`is_ready`](Self::is_ready): from loaded chunks; `None` elsewhere | [`nearest_town`](Self::nearest_town), [`spawn_point`](Self::spawn_point), and with [`ask`](Self::ask) anything that the generator knows |
///
/// The second kind returns a [`SprawlTask`], to be polled or awaited.
#[derive(SystemParam)]
pub struct Sprawl<'w, 's> {
    world: Res<'w, SprawlWorld>,
    origin: Res<'w, SprawlOrigin>,
    index: Res<'w, ChunkIndex>,
    chunks: Query<'w, 's, (&'static ChunkStatus, Option<&'static ChunkData>)>,
}

/// Greatest step up onto a bridge, in metres.
const STEP: f64 = 0.5;

/// A route uses streets within this distance of the box around its ends, in metres.
const ROUTE_MARGIN: f64 = 500.0;

impl Sprawl<'_, '_> {
    /// The generator. `None` until there is a world. It works on the calling thread, which may take seconds: call it from a
    /// task, or use [`Sprawl::ask`].
    pub fn world(&self) -> Option<&World> {
        self.world.get()
    }

    /// Asks the generator in the background. The question returns `Ok(None)` where there is no such thing.
    ///
    /// ```no_run
    /// # use bevy::prelude::*;
    /// # use bevy_sprawl::prelude::*;
    /// # use bevy_sprawl::world::NearestStreet;
    /// # fn system(sprawl: Sprawl, goal: Single<&Transform>) {
    /// // The nearest street anywhere, not only in loaded chunks.
    /// let at = sprawl.to_plan(goal.translation);
    /// let street: SprawlTask<NearestStreet> = sprawl.ask(move |world, cancel| world.nearest_street(at, 900.0, cancel));
    /// # }
    /// ```
    pub fn ask<T: Send + 'static>(
        &self,
        question: impl FnOnce(&World, &Cancel) -> Result<Option<T>, LayerError> + Send + 'static,
    ) -> SprawlTask<T> {
        SprawlTask::new(self.world(), question)
    }

    /// The origin, which converts between plan points and Bevy points.
    pub fn origin(&self) -> SprawlOrigin {
        *self.origin
    }

    /// The plan point (x east, y north, metres) below a Bevy point.
    pub fn to_plan(&self, p: Vec3) -> DVec2 {
        self.origin.to_plan(p)
    }

    /// The Bevy point at a plan point and a height in metres.
    pub fn to_bevy(&self, p: DVec2, height: f64) -> Vec3 {
        self.origin.to_bevy(p, height)
    }

    /// The Bevy point on the ground at a plan point, or on the highest bridge deck there if the chunk is loaded. `None` until
    /// there is a world, and outside of it.
    pub fn on_ground(&self, p: DVec2) -> Option<Vec3> {
        Some(self.to_bevy(p, self.surface(p, f64::INFINITY)?))
    }

    /// Height of the surface that a walker at a Bevy point stands on, in metres: the ground or a street, whether it is above or
    /// below the point, or a bridge deck below the point or at most half a metre above it. Where the chunk is not loaded, this is
    /// the natural ground, which streets may cut or fill. `None` until there is a world, and outside of it.
    pub fn height(&self, p: Vec3) -> Option<f32> {
        Some(self.surface(self.to_plan(p), f64::from(p.y) + STEP)? as f32)
    }

    fn surface(&self, p: DVec2, below: f64) -> Option<f64> {
        let world = self.world()?;
        let loaded = self.data(self.chunk_containing(p)?);
        let surface = loaded.and_then(|ChunkData(chunk)| chunk.surface(chunk.origin.to_local(p), below));
        Some(surface.unwrap_or_else(|| world.natural_height(p)))
    }

    /// What is at a Bevy point, whatever its height: ground, water or the part of a street, with its height in metres. Decks of
    /// bridges do not count. `None` where the chunk is not loaded.
    pub fn surface_at(&self, p: Vec3) -> Option<SurfacePoint> {
        let plan = self.to_plan(p);
        let ChunkData(chunk) = self.data(self.chunk_containing(plan)?)?;
        chunk.surface_at(chunk.origin.to_local(plan))
    }

    /// The name of the chunk at a Bevy point. `None` until there is a world, and outside of it.
    pub fn chunk_at(&self, p: Vec3) -> Option<ChunkCoord> {
        self.chunk_containing(self.to_plan(p))
    }

    fn chunk_containing(&self, p: DVec2) -> Option<ChunkCoord> {
        let size = self.world()?.settings().chunk_size;
        SprawlOrigin::is_in_world(p, size).then(|| ChunkCoord::containing(p, size))
    }

    /// The entity of a chunk, if the chunk is wanted or loaded.
    pub fn entity(&self, coord: ChunkCoord) -> Option<Entity> {
        self.index.entity(coord)
    }

    /// The status of a chunk, if the chunk is wanted or loaded.
    pub fn status(&self, coord: ChunkCoord) -> Option<ChunkStatus> {
        Some(*self.chunks.get(self.entity(coord)?).ok()?.0)
    }

    /// The content of a chunk, if the chunk is loaded.
    pub fn data(&self, coord: ChunkCoord) -> Option<&ChunkData> {
        self.chunks.get(self.entity(coord)?).ok()?.1
    }

    /// Whether the chunk at a Bevy point is loaded, so that there is ground to stand on.
    pub fn is_ready(&self, p: Vec3) -> bool {
        self.chunk_at(p).and_then(|coord| self.status(coord)).is_some_and(ChunkStatus::is_there)
    }

    /// The settlement whose outline holds a Bevy point. `None` where the chunk is not loaded.
    pub fn settlement_at(&self, p: Vec3) -> Option<&Arc<Settlement>> {
        self.index.settlement_at(self.to_plan(p))
    }

    /// The street nearest to a Bevy point, within `reach` metres, among the streets of loaded chunks.
    pub fn nearest_street(&self, p: Vec3, reach: f64) -> Option<NearestStreet> {
        let p = self.to_plan(p);
        let mut nearest: Option<(&Chunk, &Street, DVec2, f64)> = None;
        // The piece of a street that is nearest lies in a chunk that knows the street.
        for chunk in self.index.loaded_near(p, reach + LONGEST_PIECE) {
            let local = chunk.origin.to_local(p);
            for street in chunk.streets_here() {
                if !street.bounds().grown(reach).contains(local) {
                    continue;
                }
                let at = closest_on_line(local, &street.line).1;
                let distance = at.distance(local);
                if distance <= nearest.map_or(reach, |(.., nearest)| nearest) {
                    nearest = Some((chunk, street, at, distance));
                }
            }
        }
        nearest.map(|(chunk, street, at, distance)| NearestStreet {
            street: street.clone(),
            origin: chunk.origin,
            at: chunk.origin.to_plan(at),
            distance,
        })
    }

    /// A street of a loaded chunk by its id, with the chunk. The street is local to the chunk's origin.
    pub fn street(&self, id: StreetId) -> Option<(&Chunk, &Street)> {
        self.index.loaded_chunks().find_map(|chunk| {
            let at = chunk.streets.binary_search_by_key(&id, |s| s.street.id).ok()?;
            Some((&**chunk, &chunk.streets[at].street))
        })
    }

    /// A junction of a loaded chunk by its id, with the chunk. The junction is local to the chunk's origin.
    pub fn junction(&self, id: JunctionId) -> Option<(&Chunk, &Junction)> {
        self.index.loaded_chunks().find_map(|chunk| {
            let at = chunk.junctions.binary_search_by_key(&id, |j| j.id).ok()?;
            Some((&**chunk, &chunk.junctions[at]))
        })
    }

    /// Searches in the background for the shortest way along streets between two Bevy points. Only streets within 500 m of the
    /// box around both points are used.
    pub fn route(&self, from: Vec3, to: Vec3) -> SprawlTask<Route> {
        let (from, to) = (self.to_plan(from), self.to_plan(to));
        self.ask(move |world, cancel| world.route(from, to, ROUTE_MARGIN, cancel))
    }

    /// Searches in the background for the town or city (not a village) whose centre is nearest to a Bevy point, within 128 km.
    pub fn nearest_town(&self, p: Vec3) -> SprawlTask<Arc<Settlement>> {
        let p = self.to_plan(p);
        self.ask(move |world, cancel| nearest_town(world, p, cancel))
    }

    /// Searches in the background for a place on a street: within 150 m of the point if there is a street, otherwise in the
    /// middle of the nearest town or city. [`StartOnStreet`](super::StartOnStreet) puts an entity on such a place.
    pub fn spawn_point(&self, near: Vec3) -> SprawlTask<SpawnPoint> {
        let near = self.to_plan(near);
        self.ask(move |world, cancel| spawn_point(world, near, cancel).map(Some))
    }
}
