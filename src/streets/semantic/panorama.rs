//! The panorama of a vertex: how far it is to the next obstacle in all directions. It tells which patches may have room
//! there before any is placed.

use crate::patch::{SECTORS, SectorReach, in_sectors};
use crate::space::math;
use crate::streets::cell::{Draft, STEP, WEDGE};
use glam::DVec2;
use std::f64::consts::TAU;

/// Distances from a vertex to the next obstacles, in the same sectors as a [`PatchView`](crate::patch::PatchView).
pub struct Panorama {
    /// Direction of the first ray, in which the street leads on. The other rays follow counter-clockwise.
    direction: DVec2,
    /// Distance to the next obstacle along each ray, in metres.
    far: [f32; RAYS * SECTORS],
    /// Distance in each sector up to which a patch may have room, in metres.
    room: SectorReach,
    /// The same distances for mirrored patches.
    mirrored: SectorReach,
}

/// Number of rays in each sector.
const RAYS: usize = 2;

/// Number of rays that are followed at once.
const TOGETHER: usize = 4;
const _: () = assert!((RAYS * SECTORS).is_multiple_of(TOGETHER));

impl Panorama {
    /// The panorama of `at`, where a street leads on in `direction`, up to `reach` metres.
    pub fn of(draft: &Draft<'_>, at: DVec2, direction: DVec2, reach: f64) -> Self {
        let turn = math::direction(TAU / (RAYS * SECTORS) as f64);
        let mut ray = DVec2::new(turn.x, -turn.y).rotate(direction);
        let mut far = [0.0; RAYS * SECTORS];
        for far in far.as_chunks_mut::<TOGETHER>().0 {
            let rays = [(); TOGETHER].map(|()| {
                ray = turn.rotate(ray);
                (at, ray)
            });
            *far = draft.canvas.free.ahead(rays, reach).map(|far| far as f32);
        }
        let gap = draft.rules.growth.gap as f32;
        let room: [f32; SECTORS] = std::array::from_fn(|sector| {
            let middle = RAYS * sector + far.len();
            let rays = middle - RAYS / 2..=middle + RAYS / 2;
            let far = rays.map(|k| far[k % far.len()]).fold(0.0, f32::max);
            // Something is nearer beside it.
            (far - gap).max(far / (1.0 + WEDGE as f32))
        });
        let mirrored = in_sectors(|sector| room[(SECTORS - sector) % SECTORS]);
        Self { direction, far, room: in_sectors(|sector| room[sector]), mirrored }
    }

    /// Greatest distance in metres at which the next obstacle straight on may lie.
    pub fn ahead(&self) -> f64 {
        f64::from(self.far[0]) + STEP
    }

    /// Whether a patch that reaches so far in each sector may have room.
    pub fn may_hold(&self, reach: &SectorReach, mirrored: bool) -> bool {
        let room = if mirrored { &self.mirrored } else { &self.room };
        reach.iter().zip(room).all(|(reach, room)| reach.cmple(*room).all())
    }

    /// Whether a point may be in sight that lies `distance` metres away in the direction of `to`.
    pub fn may_see(&self, to: DVec2, distance: f64) -> bool {
        let rays = self.far.len() as i32;
        let turned = DVec2::new(self.direction.dot(to), self.direction.perp_dot(to));
        // It is off by less than half a ray.
        let ray = (math::quarters(turned) * f64::from(rays) / 4.0).round() as i32;
        let far = |ray: i32| self.far[ray.rem_euclid(rays) as usize];
        far(ray - 1).max(far(ray)).max(far(ray + 1)) + 3.0 * STEP as f32 > distance as f32
    }
}
