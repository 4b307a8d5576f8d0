//! What the world is streamed around.

use super::frame_time::Stopwatch;
use super::origin::SprawlOrigin;
use super::schedule::SprawlSystems;
use super::stream_settings::StreamSettings;
use bevy::prelude::*;
use glam::DVec2;

/// Chunks are loaded around an entity with this component: the player, a camera, a server's client. There may be any
/// number of anchors; a chunk is loaded while at least one of them wants it.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, AnchorMotion)]
pub struct StreamAnchor {
    /// Chunks within this distance are loaded, in metres, 0 to 50,000.
    pub load_radius: f32,
    /// Chunks beyond this distance are unloaded, in metres, up to 50,000. It is larger than `load_radius`, so that walking
    /// to and fro over a border does not load and unload the same chunks.
    pub unload_radius: f32,
    /// Chunks within this distance are shown in full detail, in metres; the others in reduced detail.
    pub detail_radius: f32,
    /// Whether the plugin puts the anchor on a street as soon as there is a world. It does so only if the anchor has no
    /// parent and its transform is still the default. Then the anchor stands at eye height on the street that
    /// [`Sprawl::spawn_point`](super::Sprawl::spawn_point) finds. Set it to false to begin at Bevy's origin.
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

    /// The radii (load, unload, detail), with values that make no sense replaced.
    fn radii(&self) -> (f64, f64, f64) {
        let metres = |r: f32| if r.is_finite() { f64::from(r).clamp(0.0, 50_000.0) } else { 0.0 };
        let load = metres(self.load_radius);
        (load, metres(self.unload_radius).max(load), metres(self.detail_radius))
    }
}

/// How an anchor moves. The plugin keeps it up to date; games only read it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct AnchorMotion {
    /// Smoothed velocity in the plan (x east, y north), in metres per second.
    pub velocity: DVec2,
    last: Option<DVec2>,
    pub(super) started: bool,
}

/// An anchor in the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AnchorView {
    /// Where it is.
    pub at: DVec2,
    /// Where it will be in a moment.
    pub ahead: DVec2,
    /// The radii of [`StreamAnchor`], in metres.
    pub load: f64,
    pub unload: f64,
    pub detail: f64,
}

/// All anchors of this frame.
#[derive(Resource, Default, Deref, DerefMut)]
pub(super) struct Anchors(Vec<AnchorView>);

pub(super) struct AnchorPlugin;

impl Plugin for AnchorPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Anchors>()
            .register_type::<(StreamAnchor, AnchorMotion)>()
            .add_systems(PostUpdate, read_anchors.in_set(SprawlSystems::Anchors));
    }
}

/// The velocity of an anchor is smoothed over this time, in seconds.
const SMOOTHING: f64 = 0.3;

/// An anchor that moves faster than this, in metres per second, has been teleported: it will not go on.
const FASTEST: f64 = 2_000.0;

/// Reads transforms through their parents, since global transforms are those of the last frame.
pub(super) fn read_anchors(
    mut stopwatch: Stopwatch,
    time: Option<Res<Time>>,
    origin: Res<SprawlOrigin>,
    settings: Res<StreamSettings>,
    mut views: ResMut<Anchors>,
    transforms: TransformHelper,
    mut anchors: Query<(Entity, &StreamAnchor, &mut AnchorMotion)>,
) {
    let _running = stopwatch.start();
    let seconds = time.map_or(0.0, |t| t.delta_secs_f64());
    views.clear();
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
        let at = origin.to_plan(position);
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
        views.push(AnchorView { at, ahead: at + ahead, load, unload, detail });
    }
}
