//! Finding a place for a player to begin.

use super::origin::SprawlOrigin;
use crate::layer::{Cancel, LayerError};
use crate::network::SizeClass;
use crate::region::Settlement;
use crate::space::{Bounds, distance_to_segment};
use crate::world::{NearestStreet, World};
use bevy::prelude::{Dir3, Transform, Vec3};
use glam::DVec2;
use std::sync::Arc;

/// A place on a street for a player to begin. It stays valid when the origin is shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpawnPoint {
    /// The plan point (x east, y north, metres).
    pub at: DVec2,
    /// Height of the ground there, in metres.
    pub height: f64,
    /// Direction of the street in the plan, of length 1.
    pub along: DVec2,
}

impl SpawnPoint {
    /// The Bevy point on the ground.
    pub fn position(self, origin: SprawlOrigin) -> Vec3 {
        origin.to_bevy(self.at, self.height)
    }

    /// A transform `height` metres over the ground, looking along the street.
    pub fn transform(self, origin: SprawlOrigin, height: f32) -> Transform {
        let facing = Dir3::new(Vec3::new(self.along.x as f32, 0.0, -self.along.y as f32)).unwrap_or(Dir3::NEG_Z);
        Transform::from_translation(self.position(origin) + Vec3::Y * height).looking_to(facing, Vec3::Y)
    }
}

/// Streets are first searched for within this distance of the wanted point, in metres.
const NEAR: f64 = 150.0;

/// Then they are searched for within these distances of the middle of a town, in metres, one after the other.
const TOWN_MIDDLE: [f64; 2] = [400.0, 1_200.0];

/// Towns are searched for within this distance, in metres.
const FARTHEST_TOWN: f64 = 128_000.0;

/// A place on a street near a plan point, otherwise in the middle of the nearest town or city. Without a town it is the point
/// itself, on the ground.
pub(super) fn spawn_point(world: &World, near: DVec2, cancel: &Cancel) -> Result<SpawnPoint, LayerError> {
    let mut street = world.nearest_street(near, NEAR, cancel)?;
    if street.is_none()
        && let Some(town) = nearest_town(world, near, cancel)?
    {
        for reach in TOWN_MIDDLE {
            if street.is_none() {
                street = world.nearest_street(town.centre.plan(), reach, cancel)?;
            }
        }
    }
    let (at, along) = street.map_or((near, DVec2::Y), |s| (s.at, heading(&s)));
    Ok(SpawnPoint { at, height: world.height_at(at, cancel)?, along })
}

/// The town or city whose centre is nearest to a plan point.
pub(super) fn nearest_town(world: &World, p: DVec2, cancel: &Cancel) -> Result<Option<Arc<Settlement>>, LayerError> {
    let mut reach = 4_000.0;
    while reach <= FARTHEST_TOWN {
        cancel.check()?;
        let mut best: Option<(f64, Arc<Settlement>)> = None;
        for size in [SizeClass::Town, SizeClass::City] {
            for settlement in world.settlements().centred_in_of(Bounds::square(p, 2.0 * reach), size)? {
                let distance = settlement.centre.plan().distance(p);
                // A town in a corner of the square may be farther away than a town outside the square.
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
