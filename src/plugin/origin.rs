//! Coordinates: which plan point Bevy's origin stands for.
//!
//! Bevy's transforms are 32-bit floats. 10 km from the origin they resolve a millimetre, 1,000 km from it 6 cm. The plan
//! has no such limit, so the plugin moves the origin along with the anchors (see `shift`).

use crate::space::{ChunkCoord, Origin};
use bevy::prelude::{Resource, Vec3};
use glam::DVec2;

/// The plan point that Bevy's (0, 0, 0) stands for. It is the corner of a chunk, in whole metres; height 0 is Bevy's y 0.
///
/// The plugin moves it and sends [`OriginShifted`](super::OriginShifted) when it does.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SprawlOrigin(Origin);

impl SprawlOrigin {
    /// The chunk corner nearest to a plan point (x east, y north, metres), for chunks with an edge of `size` metres. A point
    /// outside of the world counts as the nearest point inside of it.
    pub fn near(p: DVec2, size: i64) -> Self {
        let size = size.max(1);
        let limit = Self::limit(size);
        let nearest = (p.clamp(DVec2::splat(-limit), DVec2::splat(limit)) / size as f64).round().as_i64vec2();
        Self(Origin(nearest * size))
    }

    /// Greatest coordinate of the world on each axis of the plan, in metres: the names of chunks are 32-bit integers, and
    /// positions are exact up to 10^12 m.
    pub(super) fn limit(size: i64) -> f64 {
        // Room for the chunks around an anchor that stands at the limit.
        let columns = f64::from(i32::MAX) - 2_000.0;
        (columns * size.max(1) as f64).min(1.0e12)
    }

    /// Whether a plan point lies in the world.
    pub(super) fn is_in_world(p: DVec2, size: i64) -> bool {
        p.abs().max_element() <= Self::limit(size)
    }

    /// The plan point.
    pub fn origin(self) -> Origin {
        self.0
    }

    /// The plan point below a Bevy point: x east and y north, in metres.
    pub fn to_plan(self, p: Vec3) -> DVec2 {
        self.0.to_plan(DVec2::new(f64::from(p.x), -f64::from(p.z)))
    }

    /// The Bevy point at a plan point and a height in metres.
    pub fn to_bevy(self, p: DVec2, height: f64) -> Vec3 {
        let local = self.0.to_local(p);
        Vec3::new(local.x as f32, height as f32, -local.y as f32)
    }

    /// The translation of the entity of a chunk: its south-west corner at height 0.
    pub(super) fn chunk_translation(self, coord: ChunkCoord, size: i64) -> Vec3 {
        self.translation(coord.origin(size))
    }

    /// The translation of an entity that stands at `corner` and height 0.
    pub(super) fn translation(self, corner: Origin) -> Vec3 {
        // Integers keep the errors of many shifts of the origin from adding up.
        let offset = corner.0 - self.0.0;
        Vec3::new(offset.x as f32, 0.0, -offset.y as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::I64Vec2;

    #[test]
    fn plan_and_bevy_convert_both_ways() {
        let origin = SprawlOrigin::near(DVec2::new(1.0e9, -1.0e9), 512);
        assert_eq!(origin.origin().0 % 512, I64Vec2::ZERO);
        let p = Vec3::new(12.5, 3.0, -80.25);
        let plan = origin.to_plan(p);
        assert_eq!(plan - origin.origin().plan(), DVec2::new(12.5, 80.25));
        assert_eq!(origin.to_bevy(plan, 3.0), p);
    }

    #[test]
    fn points_outside_of_the_world_do_not_overflow() {
        for p in [DVec2::splat(3.0e38), DVec2::new(f64::INFINITY, -3.0e38), DVec2::splat(f64::MIN)] {
            for size in [64, 512, 4096] {
                let near = SprawlOrigin::near(p, size).origin().plan();
                assert!(SprawlOrigin::is_in_world(near, size) && near.abs().min_element() > 1.0e11, "{near}");
                assert!(!SprawlOrigin::is_in_world(p, size));
            }
        }
        assert!(!SprawlOrigin::is_in_world(DVec2::NAN, 512));
    }
}
