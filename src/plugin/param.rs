//! What games ask the world.

use super::chunk::{ChunkData, ChunkStatus};
use super::origin::SprawlOrigin;
use super::source::SprawlWorld;
use super::streaming::Streaming;
use crate::layer::{Cancel, LayerError};
use crate::network::SizeClass;
use crate::region::Settlement;
use crate::space::{Bounds, ChunkCoord};
use crate::world::{NearestStreet, Route, World};
use bevy::ecs::system::SystemParam;
use bevy::prelude::{Dir3, Entity, Query, Res, Transform, Vec3, warn_once};
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
    streaming: Res<'w, Streaming>,
    chunks: Query<'w, 's, (&'static ChunkStatus, Option<&'static ChunkData>)>,
}

/// A place for a player to begin: on a street.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpawnPoint {
    /// On the ground, in Bevy's coordinates.
    pub position: Vec3,
    /// Level, along the street.
    pub facing: Dir3,
}

impl SpawnPoint {
    /// A transform `height` metres over the point, looking along the street.
    pub fn eye(self, height: f32) -> Transform {
        Transform::from_translation(self.position + Vec3::Y * height).looking_to(self.facing, Vec3::Y)
    }
}

impl Sprawl<'_, '_> {
    /// The generator, for all other questions; `None` until there is a world.
    pub fn world(&self) -> Option<&World> {
        self.world.get()
    }

    /// Plan point (x east, y north, metres) below a Bevy point.
    pub fn to_plan(&self, p: Vec3) -> DVec2 {
        self.origin.to_plan(p)
    }

    /// Bevy point at a plan point and a height in metres.
    pub fn to_bevy(&self, p: DVec2, height: f64) -> Vec3 {
        self.origin.to_bevy(p, height)
    }

    /// Bevy point on the ground at a plan point, or on the deck of a bridge over it where the chunk is there.
    pub fn on_ground(&self, p: DVec2) -> Option<Vec3> {
        Some(self.to_bevy(p, self.surface(p, f64::INFINITY)?))
    }

    /// Height of what one stands on at a Bevy point: the drawn ground below or above it or, where the chunk is there, the
    /// deck of a bridge that is below it or at most a step of half a metre above.
    pub fn height(&self, p: Vec3) -> Option<f32> {
        Some(self.surface(self.to_plan(p), f64::from(p.y) + STEP)? as f32)
    }

    fn surface(&self, p: DVec2, below: f64) -> Option<f64> {
        let world = self.world()?;
        let coord = ChunkCoord::containing(p, world.settings().chunk_size);
        let there = self.data(coord).map(|ChunkData(chunk)| chunk.surface(chunk.origin.to_local(p), below));
        Some(there.unwrap_or_else(|| world.height_at(p)))
    }

    /// Name of the chunk at a Bevy point.
    pub fn chunk_at(&self, p: Vec3) -> Option<ChunkCoord> {
        Some(ChunkCoord::containing(self.to_plan(p), self.world()?.settings().chunk_size))
    }

    /// The entity of a chunk, if it is wanted or there.
    pub fn entity(&self, coord: ChunkCoord) -> Option<Entity> {
        self.streaming.entity(coord)
    }

    /// Status of a chunk, if it is wanted or there.
    pub fn status(&self, coord: ChunkCoord) -> Option<ChunkStatus> {
        Some(*self.chunks.get(self.entity(coord)?).ok()?.0)
    }

    /// What a chunk is made of, if it is there.
    pub fn data(&self, coord: ChunkCoord) -> Option<&ChunkData> {
        self.chunks.get(self.entity(coord)?).ok()?.1
    }

    /// Whether the chunk at a Bevy point is there, so that there is ground to stand on.
    pub fn is_ready(&self, p: Vec3) -> bool {
        self.chunk_at(p).and_then(|coord| self.status(coord)).is_some_and(ChunkStatus::is_there)
    }

    /// The settlement at a Bevy point.
    pub fn settlement_at(&self, p: Vec3) -> Option<Arc<Settlement>> {
        logged(self.world()?.settlement_at(self.to_plan(p))).flatten()
    }

    /// The street nearest to a Bevy point, within `reach` metres.
    pub fn nearest_street(&self, p: Vec3, reach: f64) -> Option<NearestStreet> {
        logged(self.world()?.nearest_street(self.to_plan(p), reach, &Cancel::new())).flatten()
    }

    /// The shortest way along streets between two Bevy points, looking at streets within 500 m of the box around both.
    pub fn route(&self, from: Vec3, to: Vec3) -> Option<Route> {
        logged(self.world()?.route(self.to_plan(from), self.to_plan(to), 500.0, &Cancel::new())).flatten()
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

/// How far up one steps onto a bridge, in metres.
const STEP: f64 = 0.5;

/// Distance within which a street is near, in metres.
const NEAR: f64 = 150.0;

/// Streets are looked for within so many metres of the middle of a town.
const TOWN_MIDDLE: f64 = 400.0;

/// Farthest town that is looked for, in metres.
const FARTHEST: f64 = 128_000.0;

pub(super) fn spawn_point(world: &World, origin: SprawlOrigin, near: DVec2) -> Option<SpawnPoint> {
    let street = |p, reach| logged(world.nearest_street(p, reach, &Cancel::new())).flatten();
    let found = street(near, NEAR)
        .or_else(|| street(logged(nearest_town(world, near)).flatten()?.centre.plan(), TOWN_MIDDLE))
        .or_else(|| street(logged(nearest_town(world, near)).flatten()?.centre.plan(), 3.0 * TOWN_MIDDLE));
    let (at, along) = match &found {
        Some(found) => (found.at, heading(found)),
        // A world without towns still has a ground.
        None => (near, DVec2::Y),
    };
    let position = origin.to_bevy(at, world.height_at(at));
    let facing = Dir3::new(Vec3::new(along.x as f32, 0.0, -along.y as f32)).unwrap_or(Dir3::NEG_Z);
    Some(SpawnPoint { position, facing })
}

/// The town or city whose centre is nearest.
pub(super) fn nearest_town(world: &World, p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
    let mut reach = 4_000.0;
    while reach <= FARTHEST {
        let mut best: Option<(f64, Arc<Settlement>)> = None;
        for size in [SizeClass::Town, SizeClass::City] {
            for settlement in world.settlements().centred_in_of(Bounds::square(p, 2.0 * reach), size)? {
                let distance = settlement.centre.plan().distance(p);
                // Nearer ones may lie outside the square of those that are farther than its half edge.
                if distance <= reach && best.as_ref().is_none_or(|(d, _)| distance < *d) {
                    best = Some((distance, settlement));
                }
            }
        }
        if let Some((_, settlement)) = best {
            return Ok(Some(settlement));
        }
        reach *= 2.0;
    }
    Ok(None)
}

/// Direction of a street at its nearest point.
fn heading(found: &NearestStreet) -> DVec2 {
    let local = found.origin.to_local(found.at);
    let of = found.street.line.windows(2).min_by(|a, b| {
        let d = |w: &[DVec2]| crate::space::distance_to_segment(local, w[0], w[1]);
        d(a).total_cmp(&d(b))
    });
    of.map_or(DVec2::Y, |w| (w[1] - w[0]).normalize_or(DVec2::Y))
}

/// An answer that could not be made is a defect of a layer: it is logged once, and there is no answer.
fn logged<T>(answer: Result<T, LayerError>) -> Option<T> {
    match answer {
        Ok(answer) => Some(answer),
        Err(error) => {
            warn_once!("the world gave no answer: {error}");
            None
        }
    }
}
