//! Anchors: the entities around which the world is streamed.

use super::frame_time::Stopwatch;
use super::origin::SprawlOrigin;
use super::schedule::SprawlSystems;
use super::source::SprawlSource;
use super::stream_settings::StreamSettings;
use bevy::prelude::*;
use glam::DVec2;

/// Chunks are loaded around an entity with this component: the player, a camera, a server's client. There may be any
/// number of anchors; a chunk is loaded while at least one of them wants it.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, AnchorMotion)]
pub struct StreamAnchor {
    /// What lies within this distance is loaded, in metres, 0 to 50,000: the chunks there, and chunks beyond whose streets reach
    /// there.
    pub load_radius: f32,
    /// Chunks beyond this distance are unloaded, in metres, up to 50,000. It should be larger than `load_radius`, so that
    /// walking to and fro over a border does not load and unload the same chunks; a smaller value counts as `load_radius`.
    pub unload_radius: f32,
    /// What lies within this distance is shown in full detail, in metres, up to 50,000; chunks beyond in reduced detail.
    pub detail_radius: f32,
    /// The land beyond the chunks is shown out to this distance, in metres, 0 to 50,000: coarse ground, water, and towns as boxes. 0
    /// shows none. Nothing is made where nothing could draw it. A camera needs a far plane to match (Bevy's is 1,000 m).
    pub horizon: f32,
    /// Whether the origin follows this anchor: see [`OriginSettings`](super::OriginSettings). Unset it for an anchor that is
    /// far from the others, such as a second view of another town.
    pub moves_origin: bool,
    /// Whether the plugin gives the anchor a [`StartOnStreet`] when it is spawned. It does so only if the anchor has no
    /// parent and its transform is still the default. Set it to false to begin at Bevy's origin.
    pub start_on_street: bool,
}

impl Default for StreamAnchor {
    fn default() -> Self {
        Self {
            load_radius: 1200.0,
            unload_radius: 1700.0,
            detail_radius: 600.0,
            horizon: 8_000.0,
            moves_origin: true,
            start_on_street: true,
        }
    }
}

/// Asks the plugin to put an entity on a street. The plugin searches in the background for a street within 150 m of the
/// entity, otherwise in the middle of the nearest town or city. Then it sets the entity's transform, looking along the street,
/// and removes this component; observe the removal to know when the entity stands there.
///
/// An anchor that waits for its place, or whose parent does, loads no chunks. If a game moves the entity meanwhile, the entity
/// stays where the game has put it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform)]
pub struct StartOnStreet {
    /// Height over the street in metres. `None` means 1.7 m, the height of the eyes, for an entity with a [`Camera`], and
    /// 0 for any other: its feet are on the street.
    pub height: Option<f32>,
}

impl StreamAnchor {
    /// An anchor that loads chunks within `load_radius` metres, the nearer half of them in full detail.
    pub fn new(load_radius: f32) -> Self {
        let (unload_radius, detail_radius) = (load_radius * 1.25 + 200.0, load_radius * 0.5);
        Self { load_radius, unload_radius, detail_radius, ..default() }
    }

    /// The radii (load, unload, detail, horizon) in metres, limited to their ranges; a radius that is not finite counts as 0.
    fn radii(&self) -> [f64; 4] {
        let metres = |r: f32| if r.is_finite() { f64::from(r).clamp(0.0, 50_000.0) } else { 0.0 };
        let load = metres(self.load_radius);
        [load, metres(self.unload_radius).max(load), metres(self.detail_radius), metres(self.horizon)]
    }
}

/// How an anchor moves. The plugin keeps it up to date; games only read it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct AnchorMotion {
    /// Smoothed velocity in the plan (x east, y north), in metres per second.
    pub velocity: DVec2,
    last: Option<DVec2>,
}

/// An anchor in the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AnchorView {
    /// The anchor's plan point.
    pub at: DVec2,
    /// The plan point that the anchor moves towards, at most half the load radius away.
    pub ahead: DVec2,
    /// The radii of [`StreamAnchor`], in metres.
    pub load: f64,
    pub unload: f64,
    pub detail: f64,
    pub horizon: f64,
    pub moves_origin: bool,
}

#[cfg(test)]
impl AnchorView {
    /// An anchor that stands still and sees no horizon.
    pub fn standing(x: f64, y: f64) -> Self {
        let at = DVec2::new(x, y);
        Self { at, ahead: at, load: 1000.0, unload: 1400.0, detail: 400.0, horizon: 0.0, moves_origin: true }
    }
}

/// All anchors of this frame.
#[derive(Resource, Default, Deref, DerefMut)]
pub(super) struct Anchors(Vec<AnchorView>);

pub(super) struct AnchorPlugin;

impl Plugin for AnchorPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Anchors>()
            .register_type::<(StreamAnchor, AnchorMotion, StartOnStreet)>()
            .add_systems(PostUpdate, read_anchors.in_set(SprawlSystems::Anchors));
    }
}

/// The velocity of an anchor is smoothed over this time, in seconds.
const SMOOTHING: f64 = 0.3;

/// An anchor that moves faster than this, in metres per second, has been teleported: its velocity counts as 0.
const FASTEST: f64 = 2_000.0;

/// Reads transforms through their parents, since global transforms still come from the last frame.
pub(super) fn read_anchors(
    mut stopwatch: Stopwatch,
    time: Option<Res<Time>>,
    (origin, source, settings): (Res<SprawlOrigin>, Res<SprawlSource>, Res<StreamSettings>),
    mut views: ResMut<Anchors>,
    (transforms, parents, starting): (TransformHelper, Query<&ChildOf>, Query<(), With<StartOnStreet>>),
    mut anchors: Query<(Entity, &StreamAnchor, &mut AnchorMotion)>,
) {
    let _running = stopwatch.start();
    let seconds = time.map_or(0.0, |t| t.delta_secs_f64());
    views.clear();
    let size = source.settings.chunk_size;
    for (entity, anchor, mut motion) in &mut anchors {
        if starting.contains(entity) || parents.iter_ancestors(entity).any(|e| starting.contains(e)) {
            continue;
        }
        let position = match transforms.compute_global_transform(entity) {
            Ok(transform) => transform.translation(),
            Err(error) => {
                warn_once!("a StreamAnchor has no position and loads nothing: {error}");
                continue;
            }
        };
        let at = origin.to_plan(position);
        if !SprawlOrigin::is_in_world(at, size) {
            warn_once!("a StreamAnchor is at {position}, outside of the world, and loads nothing");
            continue;
        }
        let [load, unload, detail, horizon] = anchor.radii();
        let moved = at - motion.last.unwrap_or(at);
        if moved.length() > FASTEST * seconds {
            motion.velocity = DVec2::ZERO;
        } else if seconds > 0.0 {
            let share = (seconds / SMOOTHING).min(1.0);
            motion.velocity = motion.velocity.lerp(moved / seconds, share);
        }
        motion.last = Some(at);
        let ahead = (motion.velocity * f64::from(settings.lookahead_s.max(0.0))).clamp_length_max(load / 2.0);
        let moves_origin = anchor.moves_origin;
        views.push(AnchorView { at, ahead: at + ahead, load, unload, detail, horizon, moves_origin });
    }
}
