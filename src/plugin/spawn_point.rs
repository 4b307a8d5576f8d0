//! Finding a place for a player to begin.

use super::origin::SprawlOrigin;
use crate::layer::{Cancel, LayerError};
use crate::network::SizeClass;
use crate::region::Settlement;
use crate::space::{Bounds, distance_to_segment};
use crate::world::{NearestStreet, World};
use bevy::prelude::{Dir3, Transform, Vec3, warn_once};
use glam::DVec2;
use std::sync::Arc;

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

/// A street within this distance of the wanted point is near, in metres.
const NEAR: f64 = 150.0;

/// Streets are searched within this distance of the middle of a town, in metres.
const TOWN_MIDDLE: f64 = 400.0;

/// Towns are searched within this distance, in metres.
const FARTHEST_TOWN: f64 = 128_000.0;

/// A place on a street near a plan point, otherwise in the middle of the nearest town or city, otherwise the point itself.
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

/// The town or city whose centre is nearest to a plan point.
pub(super) fn nearest_town(world: &World, p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
    let mut reach = 4_000.0;
    while reach <= FARTHEST_TOWN {
        let mut best: Option<(f64, Arc<Settlement>)> = None;
        for size in [SizeClass::Town, SizeClass::City] {
            for settlement in world.settlements().centred_in_of(Bounds::square(p, 2.0 * reach), size)? {
                let distance = settlement.centre.plan().distance(p);
                // A town in a corner of the square may be farther away than one outside of the square.
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
    let nearest = found.street.line.windows(2).min_by(|a, b| {
        let distance = |w: &[DVec2]| distance_to_segment(local, w[0], w[1]);
        distance(a).total_cmp(&distance(b))
    });
    nearest.map_or(DVec2::Y, |w| (w[1] - w[0]).normalize_or(DVec2::Y))
}

/// An answer that could not be made is a defect of a layer: it is logged once, and there is no answer.
pub(super) fn logged<T>(answer: Result<T, LayerError>) -> Option<T> {
    match answer {
        Ok(answer) => Some(answer),
        Err(error) => {
            warn_once!("the world gave no answer: {error}");
            None
        }
    }
}
