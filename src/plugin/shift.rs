//! Moving the origin when the anchors are far from it.

use super::anchor::{Anchors, StreamAnchor, read_anchors};
use super::frame_time::Stopwatch;
use super::origin::SprawlOrigin;
use super::schedule::SprawlSystems;
use super::source::SprawlSource;
use super::streaming::ChunkIndex;
use crate::mesh::HorizonTile;
use crate::space::{Bounds, ChunkCoord, Origin};
use bevy::prelude::*;
use glam::{DVec2, I64Vec2};

/// When the origin is shifted.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct OriginSettings {
    /// The origin is shifted when the middle of all anchors with [`StreamAnchor::moves_origin`] is farther than this from
    /// the origin, in metres along an axis. With infinity it is never shifted.
    pub distance: f32,
}

impl Default for OriginSettings {
    fn default() -> Self {
        Self { distance: 4096.0 }
    }
}

/// Whether the [`Transform`] of a root entity is shifted together with the origin. Every root is shifted by default, so that
/// distances between things stay the same; children move with their roots. Insert `ShiftsWithOrigin::No` for a root that
/// belongs to no place in the world. Chunks, tiles of the horizon, and the roots that anchors belong to, are always shifted.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform)]
pub enum ShiftsWithOrigin {
    /// It is shifted, as it would be without this component.
    #[default]
    Yes,
    /// It keeps its transform.
    No,
}

/// The origin has moved: a point that was at `p` in Bevy is now at `p + by`. Sent as a message and as an event, after
/// the transforms of all roots have changed. Add `by` to the positions that a game keeps elsewhere.
#[derive(Message, Event, Clone, Copy, Debug, PartialEq)]
pub struct OriginShifted {
    /// The vector to add to Bevy positions, in metres.
    pub by: Vec3,
    /// The new origin.
    pub origin: Origin,
}

pub(super) struct ShiftPlugin;

impl Plugin for ShiftPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<OriginSettings>()
            .add_message::<OriginShifted>()
            .register_type::<(OriginSettings, ShiftsWithOrigin)>()
            .add_systems(PostUpdate, shift_origin.in_set(SprawlSystems::Anchors).after(read_anchors));
    }
}

/// Entities without a parent, with the components that decide whether they are shifted.
type Root = (
    Entity,
    &'static mut Transform,
    Option<&'static ShiftsWithOrigin>,
    Option<&'static ChunkCoord>,
    Option<&'static HorizonTile>,
);

fn shift_origin(
    mut stopwatch: Stopwatch,
    mut origin: ResMut<SprawlOrigin>,
    (settings, source, index): (Res<OriginSettings>, Res<SprawlSource>, Res<ChunkIndex>),
    (views, anchors, parents): (Res<Anchors>, Query<Entity, With<StreamAnchor>>, Query<&ChildOf>),
    mut roots: Query<Root, Without<ChildOf>>,
    (mut commands, mut shifted): (Commands, MessageWriter<OriginShifted>),
) {
    let _running = stopwatch.start();
    let Some(middle) = middle(views.iter().filter(|a| a.moves_origin).map(|a| a.at)) else { return };
    let distance = origin.origin().to_local(middle).abs().max_element();
    if distance.is_nan() || distance <= f64::from(settings.distance) {
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
    for (entity, mut transform, shifts, chunk, tile) in &mut roots {
        let stays = shifts == Some(&ShiftsWithOrigin::No) && anchor_roots.binary_search(&entity).is_err();
        match (chunk, tile) {
            (Some(coord), _) if index.entity(*coord) == Some(entity) => {
                transform.translation = next.chunk_translation(*coord, index.size);
            }
            (None, Some(tile)) => transform.translation = next.translation(tile.origin(index.size)),
            (None, None) if stays => {}
            _ => transform.translation += by,
        }
    }
    *origin = next;
    let event = OriginShifted { by, origin: next.origin() };
    shifted.write(event);
    commands.trigger(event);
}

/// The middle of the box around some points.
fn middle(points: impl Iterator<Item = DVec2>) -> Option<DVec2> {
    let bounds = Bounds::of(points);
    bounds.min.is_finite().then(|| bounds.centre())
}
