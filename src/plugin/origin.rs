//! Which plan point Bevy's origin stands for, and shifting it when anchors are far away.
//!
//! Bevy's transforms are 32-bit floats: 10 km from the origin they resolve a millimetre, 1,000 km from it 6 cm. The plan
//! has no such limit, so the plugin moves the origin with the anchors and everything that is marked with it.

use super::anchor::StreamAnchor;
use super::schedule::SprawlSystems;
use super::source::SprawlSource;
use super::streaming::Streaming;
use crate::space::{ChunkCoord, Origin};
use bevy::prelude::*;
use glam::{DVec2, I64Vec2};

/// The plan point that Bevy's (0, 0, 0) stands for: whole metres, the corner of a chunk. Height 0 is Bevy's y 0.
///
/// The plugin moves it; see [`OriginShifted`].
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SprawlOrigin(Origin);

impl SprawlOrigin {
    /// The corner of a chunk of edge `size` that is nearest to a plan point.
    pub fn near(p: DVec2, size: i64) -> Self {
        let size = size.max(1);
        let nearest = (p / size as f64).round().as_i64vec2();
        Self(Origin(nearest * size))
    }

    /// The plan point.
    pub fn origin(self) -> Origin {
        self.0
    }

    /// Plan point below a Bevy point.
    pub fn to_plan(self, p: Vec3) -> DVec2 {
        to_plan(self.0, p)
    }

    /// Bevy point at a plan point and a height.
    pub fn to_bevy(self, p: DVec2, height: f64) -> Vec3 {
        to_bevy(self.0, p, height)
    }
}

/// Plan (x east, y north) is Bevy's (x, height, -y).
pub(super) fn to_plan(origin: Origin, p: Vec3) -> DVec2 {
    origin.to_plan(DVec2::new(f64::from(p.x), -f64::from(p.z)))
}

pub(super) fn to_bevy(origin: Origin, p: DVec2, height: f64) -> Vec3 {
    let local = origin.to_local(p);
    Vec3::new(local.x as f32, height as f32, -local.y as f32)
}

/// When the origin is shifted.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct OriginSettings {
    /// The origin is shifted when the middle of all anchors is farther from it than so many metres. Infinite: never.
    pub distance: f32,
}

impl Default for OriginSettings {
    fn default() -> Self {
        Self { distance: 4096.0 }
    }
}

/// Marks a root entity whose [`Transform`] is shifted together with the origin: everything in the scene that is not a
/// child of something else. Chunks, and the roots that anchors belong to, are shifted without it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform)]
pub struct ShiftsWithOrigin;

/// The origin has moved: a point that was at `p` in Bevy is now at `p + by`. Sent as a message and as an event, after
/// the transforms of chunks, anchors and [`ShiftsWithOrigin`] have been changed. Add `by` to positions you keep elsewhere.
#[derive(Message, Event, Clone, Copy, Debug, PartialEq)]
pub struct OriginShifted {
    /// What to add to Bevy positions.
    pub by: Vec3,
    /// The new origin.
    pub origin: Origin,
}

pub(super) struct OriginPlugin;

impl Plugin for OriginPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<OriginSettings>()
            .add_message::<OriginShifted>()
            .register_type::<(OriginSettings, ShiftsWithOrigin)>()
            .add_systems(PostUpdate, shift_origin.in_set(SprawlSystems::Anchors).after(super::anchor::read_anchors));
    }
}

/// Entities without a parent, and what says whether they are shifted.
type Root = (Entity, &'static mut Transform, Has<ShiftsWithOrigin>, Option<&'static ChunkCoord>);

fn shift_origin(
    mut origin: ResMut<SprawlOrigin>,
    (settings, source, streaming): (Res<OriginSettings>, Res<SprawlSource>, Res<Streaming>),
    (anchors, parents): (Query<Entity, With<StreamAnchor>>, Query<&ChildOf>),
    mut roots: Query<Root, Without<ChildOf>>,
    (mut commands, mut shifted): (Commands, MessageWriter<OriginShifted>),
) {
    let Some(middle) = middle(streaming.anchors.iter().map(|a| a.at)) else { return };
    let far = origin.origin().to_local(middle).abs().max_element();
    if far.is_nan() || far <= f64::from(settings.distance) {
        return;
    }
    let next = SprawlOrigin::near(middle, source.settings.chunk_size);
    let moved: I64Vec2 = origin.origin().0 - next.origin().0;
    if moved == I64Vec2::ZERO {
        return;
    }
    let by = Vec3::new(moved.x as f32, 0.0, -moved.y as f32);
    let mut anchor_roots: Vec<Entity> = anchors.iter().map(|e| parents.root_ancestor(e)).collect();
    anchor_roots.sort_unstable();
    for (entity, mut transform, marked, chunk) in &mut roots {
        if let Some(coord) = chunk {
            // From integers, so that a thousand shifts add up to no error.
            transform.translation = chunk_translation(next.origin(), *coord, streaming.size);
        } else if marked || anchor_roots.binary_search(&entity).is_ok() {
            transform.translation += by;
        }
    }
    *origin = next;
    let event = OriginShifted { by, origin: next.origin() };
    shifted.write(event);
    commands.trigger(event);
}

/// Where the entity of a chunk is.
pub(super) fn chunk_translation(origin: Origin, coord: ChunkCoord, size: i64) -> Vec3 {
    let from = coord.origin(size).0 - origin.0;
    Vec3::new(from.x as f32, 0.0, -from.y as f32)
}

/// Middle of the box around some points.
fn middle(points: impl Iterator<Item = DVec2>) -> Option<DVec2> {
    let bounds = crate::space::Bounds::of(points);
    bounds.min.is_finite().then(|| bounds.centre())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plan_and_bevy_convert_both_ways() {
        let origin = SprawlOrigin::near(DVec2::new(1.0e9, -1.0e9), 512);
        assert_eq!(origin.origin().0 % 512, I64Vec2::ZERO);
        let p = Vec3::new(12.5, 3.0, -80.25);
        let plan = origin.to_plan(p);
        assert_eq!(plan - origin.origin().plan(), DVec2::new(12.5, 80.25));
        assert_eq!(origin.to_bevy(plan, 3.0), p);
    }
}
