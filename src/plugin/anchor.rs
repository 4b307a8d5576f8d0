//! What the world is streamed around.

use super::origin::{SprawlOrigin, to_plan};
use super::param::spawn_point;
use super::schedule::SprawlSystems;
use super::source::SprawlWorld;
use super::streaming::{StreamSettings, Streaming};
use bevy::prelude::*;
use glam::DVec2;

/// Chunks are loaded around an entity with this component: the player, a camera, a server's client. There may be any
/// number; a chunk is loaded while any of them wants it.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, AnchorMotion)]
pub struct StreamAnchor {
    /// Chunks that come within so many metres are loaded.
    pub load_radius: f32,
    /// Chunks farther away than so many metres are unloaded. More than `load_radius`, so that walking to and fro over a
    /// border does not load and unload the same chunks.
    pub unload_radius: f32,
    /// Chunks within so many metres are shown in full detail, the others with less.
    pub detail_radius: f32,
    /// An anchor that is a root and has an untouched transform when there is first a world is put at eye height on a
    /// street, as [`Sprawl::spawn_point`](super::Sprawl::spawn_point) finds it. Unset it to begin at Bevy's origin.
    pub start_on_street: bool,
}

impl Default for StreamAnchor {
    fn default() -> Self {
        Self { load_radius: 1200.0, unload_radius: 1700.0, detail_radius: 600.0, start_on_street: true }
    }
}

impl StreamAnchor {
    /// An anchor that loads chunks within `load_radius` metres, the nearer half of them in full detail.
    pub fn new(load_radius: f32) -> Self {
        let (unload_radius, detail_radius) = (load_radius * 1.25 + 200.0, load_radius * 0.5);
        Self { load_radius, unload_radius, detail_radius, ..default() }
    }

    /// The radii with values that make no sense mended: (load, unload, detail).
    fn radii(&self) -> (f64, f64, f64) {
        let metres = |r: f32| if r.is_finite() { f64::from(r).clamp(0.0, 50_000.0) } else { 0.0 };
        let load = metres(self.load_radius);
        (load, metres(self.unload_radius).max(load), metres(self.detail_radius))
    }
}

/// How an anchor moves, as the plugin sees it. Kept up to date by the plugin; for reading.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct AnchorMotion {
    /// Smoothed velocity in the plan (x east, y north), in metres per second.
    pub velocity: DVec2,
    last: Option<DVec2>,
    started: bool,
}

/// An anchor in the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AnchorView {
    /// Where it is.
    pub at: DVec2,
    /// Where it will be in a moment.
    pub ahead: DVec2,
    pub load: f64,
    pub unload: f64,
    pub detail: f64,
}

pub(super) struct AnchorPlugin;

impl Plugin for AnchorPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(StreamAnchor, AnchorMotion)>()
            .add_systems(PostUpdate, (start_on_street, read_anchors).chain().in_set(SprawlSystems::Anchors));
    }
}

/// Height of the eyes over the ground, in metres.
const EYES: f32 = 1.7;

fn start_on_street(
    world: Option<Res<SprawlWorld>>,
    origin: Res<SprawlOrigin>,
    mut anchors: Query<(&StreamAnchor, &mut AnchorMotion, &mut Transform, Has<ChildOf>)>,
) {
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
            *transform = start.eye(EYES);
        }
    }
}

/// Seconds over which the velocity of an anchor is smoothed.
const SMOOTHING: f64 = 0.3;

/// What moves faster, in metres per second, has been put elsewhere and does not go on.
const FASTEST: f64 = 2_000.0;

/// Transforms are read through their parents, since global transforms are those of the last frame.
pub(super) fn read_anchors(
    time: Option<Res<Time>>,
    origin: Res<SprawlOrigin>,
    settings: Res<StreamSettings>,
    mut streaming: ResMut<Streaming>,
    transforms: TransformHelper,
    mut anchors: Query<(Entity, &StreamAnchor, &mut AnchorMotion)>,
) {
    let seconds = time.map_or(0.0, |t| t.delta_secs_f64());
    streaming.anchors.clear();
    for (entity, anchor, mut motion) in &mut anchors {
        let position = match transforms.compute_global_transform(entity) {
            Ok(transform) => transform.translation(),
            Err(error) => {
                warn_once!("a StreamAnchor has no position and loads nothing: {error}");
                continue;
            }
        };
        if !position.is_finite() {
            warn_once!("a StreamAnchor is at {position} and loads nothing");
            continue;
        }
        let at = to_plan(origin.origin(), position);
        let (load, unload, detail) = anchor.radii();
        let moved = at - motion.last.unwrap_or(at);
        if moved.length() > FASTEST * seconds {
            motion.velocity = DVec2::ZERO;
        } else if seconds > 0.0 {
            let share = (seconds / SMOOTHING).min(1.0);
            motion.velocity = motion.velocity.lerp(moved / seconds, share);
        }
        motion.last = Some(at);
        let ahead = (motion.velocity * f64::from(settings.lookahead_s.max(0.0))).clamp_length_max(load / 2.0);
        streaming.anchors.push(AnchorView { at, ahead: at + ahead, load, unload, detail });
    }
}
