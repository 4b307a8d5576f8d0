//! Putting new anchors on a street.

use super::anchor::{AnchorMotion, StreamAnchor, read_anchors};
use super::frame_time::Stopwatch;
use super::origin::SprawlOrigin;
use super::schedule::SprawlSystems;
use super::source::SprawlWorld;
use super::spawn_point::spawn_point;
use bevy::prelude::*;

/// Height of the eyes over the ground, in metres.
const EYE_HEIGHT: f32 = 1.7;

pub(super) struct StartPlugin;

impl Plugin for StartPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PostUpdate, start_on_street.in_set(SprawlSystems::Anchors).before(read_anchors));
    }
}

fn start_on_street(
    mut stopwatch: Stopwatch,
    world: Option<Res<SprawlWorld>>,
    origin: Res<SprawlOrigin>,
    mut anchors: Query<(&StreamAnchor, &mut AnchorMotion, &mut Transform, Has<ChildOf>)>,
) {
    let _running = stopwatch.start();
    let Some(world) = world.as_ref().and_then(|w| w.get()) else { return };
    for (anchor, mut motion, mut transform, is_child) in &mut anchors {
        if motion.started {
            continue;
        }
        motion.started = true;
        if anchor.start_on_street
            && !is_child
            && *transform == Transform::IDENTITY
            && let Some(start) = spawn_point(world, *origin, origin.to_plan(Vec3::ZERO))
        {
            *transform = start.eye(EYE_HEIGHT);
        }
    }
}
