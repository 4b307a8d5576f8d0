//! Questions that games ask the world.

use super::chunk::{ChunkData, ChunkStatus};
use super::origin::SprawlOrigin;
use super::source::SprawlWorld;
use super::spawn_point::{SpawnPoint, logged, nearest_town, spawn_point};
use super::streaming::ChunkIndex;
use crate::layer::Cancel;
use crate::region::Settlement;
use crate::space::ChunkCoord;
use crate::world::{NearestStreet, Route, World};
use bevy::ecs::system::SystemParam;
use bevy::prelude::{Entity, Query, Res, Vec3};
use glam::DVec2;
use std::sync::Arc;

/// Questions to the world, for any system. Points are Bevy's; [`Sprawl::to_plan`] and [`Sprawl::to_bevy`] convert.
///
/// Answers come from the generator, for any place, loaded or not. Where nothing has been made yet it is made now, on
/// the calling thread, which may take some milliseconds for the first answer in a town.
#[derive(SystemParam)]
pub struct Sprawl<'w, 's> {
    world: Res<'w, SprawlWorld>,
    origin: Res<'w, SprawlOrigin>,
    index: Res<'w, ChunkIndex>,
    chunks: Query<'w, 's, (&'static ChunkStatus, Option<&'static ChunkData>)>,
}

/// A walker steps up this far onto a bridge, in metres.
const STEP: f64 = 0.5;

/// A route is searched within this distance of the box around its ends, in metres.
const ROUTE_MARGIN: f64 = 500.0;

impl Sprawl<'_, '_> {
    /// The generator, for all other questions. `None` until there is a world.
    pub fn world(&self) -> Option<&World> {
        self.world.get()
    }

    /// The plan point (x east, y north, metres) below a Bevy point.
    pub fn to_plan(&self, p: Vec3) -> DVec2 {
        self.origin.to_plan(p)
    }

    /// The Bevy point at a plan point and a height in metres.
    pub fn to_bevy(&self, p: DVec2, height: f64) -> Vec3 {
        self.origin.to_bevy(p, height)
    }

    /// The Bevy point on the ground at a plan point. Where the chunk is loaded, it lies on the highest bridge deck there.
    pub fn on_ground(&self, p: DVec2) -> Option<Vec3> {
        Some(self.to_bevy(p, self.surface(p, f64::INFINITY)?))
    }

    /// Height of the surface that a walker at a Bevy point stands on, in metres: the drawn ground at that place, whether
    /// it is above or below the point. Where the chunk is loaded, it may also be a bridge deck that is below the point, or
    /// at most half a metre above it.
    pub fn height(&self, p: Vec3) -> Option<f32> {
        Some(self.surface(self.to_plan(p), f64::from(p.y) + STEP)? as f32)
    }

    fn surface(&self, p: DVec2, below: f64) -> Option<f64> {
        let world = self.world()?;
        let coord = ChunkCoord::containing(p, world.settings().chunk_size);
        let loaded = self.data(coord).map(|ChunkData(chunk)| chunk.surface(chunk.origin.to_local(p), below));
        Some(loaded.unwrap_or_else(|| world.height_at(p)))
    }

    /// The name of the chunk at a Bevy point. `None` until there is a world.
    pub fn chunk_at(&self, p: Vec3) -> Option<ChunkCoord> {
        Some(ChunkCoord::containing(self.to_plan(p), self.world()?.settings().chunk_size))
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

    /// The settlement whose outline holds a Bevy point.
    pub fn settlement_at(&self, p: Vec3) -> Option<Arc<Settlement>> {
        logged(self.world()?.settlement_at(self.to_plan(p))).flatten()
    }

    /// The street nearest to a Bevy point, within `reach` metres.
    pub fn nearest_street(&self, p: Vec3, reach: f64) -> Option<NearestStreet> {
        logged(self.world()?.nearest_street(self.to_plan(p), reach, &Cancel::new())).flatten()
    }

    /// The shortest way along streets between two Bevy points. Streets within 500 m of the box around both points are used.
    pub fn route(&self, from: Vec3, to: Vec3) -> Option<Route> {
        logged(self.world()?.route(self.to_plan(from), self.to_plan(to), ROUTE_MARGIN, &Cancel::new())).flatten()
    }

    /// The town or city (not a village) whose centre is nearest to a Bevy point, within 128 km.
    pub fn nearest_town(&self, p: Vec3) -> Option<Arc<Settlement>> {
        logged(nearest_town(self.world()?, self.to_plan(p))).flatten()
    }

    /// A place on a street: near the point if there is a street, otherwise in the middle of the nearest town or city.
    pub fn spawn_point(&self, near: Vec3) -> Option<SpawnPoint> {
        spawn_point(self.world()?, *self.origin, self.to_plan(near))
    }
}
