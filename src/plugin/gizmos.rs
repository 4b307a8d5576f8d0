//! Debug lines: chunk borders, centre lines of streets, ports. Off by default.

use super::chunk::{ChunkData, ChunkStatus};
use super::frame_time::Stopwatch;
use super::origin::SprawlOrigin;
use super::source::SprawlSource;
use crate::chunk::Chunk;
use crate::network::{JunctionId, StreetClass};
use crate::space::ChunkCoord;
use bevy::color::palettes::tailwind;
use bevy::gizmos::GizmoPlugin;
use bevy::gizmos::config::{GizmoConfig, GizmoConfigGroup, GizmoConfigStore};
use bevy::prelude::*;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// The colours of the debug lines; `None` leaves lines out. The group is off by default. To switch it on:
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_sprawl::plugin::SprawlGizmos;
/// fn show(mut store: ResMut<GizmoConfigStore>) {
///     store.config_mut::<SprawlGizmos>().0.enabled = true;
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Reflect, GizmoConfigGroup)]
#[reflect(Default)]
pub struct SprawlGizmos {
    /// Borders of loaded chunks.
    pub chunk_borders: Option<Color>,
    /// Borders of chunks that are wanted and not loaded yet.
    pub missing_borders: Option<Color>,
    /// Centre lines of roads and main streets.
    pub main_streets: Option<Color>,
    /// Centre lines of local streets.
    pub local_streets: Option<Color>,
    /// Ports: junctions at which a local street leaves a main street.
    pub ports: Option<Color>,
}

impl Default for SprawlGizmos {
    fn default() -> Self {
        Self {
            chunk_borders: Some(tailwind::SKY_400.into()),
            missing_borders: Some(tailwind::RED_500.into()),
            main_streets: Some(tailwind::AMBER_400.into()),
            local_streets: Some(tailwind::LIME_400.into()),
            ports: Some(tailwind::FUCHSIA_400.into()),
        }
    }
}

pub(super) struct GizmosPlugin;

impl Plugin for GizmosPlugin {
    fn build(&self, _: &mut App) {}

    /// Runs after all plugins are added, since gizmos need Bevy's own plugin.
    fn finish(&self, app: &mut App) {
        if app.is_plugin_added::<GizmoPlugin>() {
            let config = GizmoConfig { enabled: false, depth_bias: -0.005, ..default() };
            app.register_type::<SprawlGizmos>()
                .insert_gizmo_config(SprawlGizmos::default(), config)
                .add_systems(Update, draw.run_if(|s: Res<GizmoConfigStore>| s.config::<SprawlGizmos>().0.enabled));
        }
    }
}

/// Height of the lines over the ground, in metres.
const LIFT: f64 = 1.5;

fn draw(
    mut stopwatch: Stopwatch,
    mut gizmos: Gizmos<SprawlGizmos>,
    store: Res<GizmoConfigStore>,
    origin: Res<SprawlOrigin>,
    chunks: Query<(&ChunkCoord, &Transform, &ChunkStatus, Option<&ChunkData>)>,
    source: Res<SprawlSource>,
) {
    let _running = stopwatch.start();
    let (_, colours) = store.config::<SprawlGizmos>();
    let edge = source.settings.chunk_size as f32;
    for (coord, transform, status, data) in &chunks {
        let Some(ChunkData(chunk)) = data else {
            let corner = origin.chunk_translation(*coord, source.settings.chunk_size);
            if let (Some(colour), false) = (colours.missing_borders, status.is_there()) {
                let centre = corner + Vec3::new(edge / 2.0, 0.0, -edge / 2.0);
                gizmos.rect(
                    Isometry3d::new(centre, Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)),
                    Vec2::splat(edge * 0.98),
                    colour,
                );
            }
            continue;
        };
        let at = |p: DVec2| {
            // Streets leave the chunk's square. Outside, the height at its edge is near enough, and costs no sample.
            let inside = p.clamp(DVec2::ZERO, DVec2::splat(chunk.size as f64));
            let height = chunk.surface(inside, f64::INFINITY).unwrap_or(0.0);
            transform.translation + Vec3::new(p.x as f32, (height + LIFT) as f32, -p.y as f32)
        };
        if let Some(colour) = colours.chunk_borders {
            let size = chunk.size as f64;
            let corners = [DVec2::ZERO, DVec2::new(size, 0.0), DVec2::splat(size), DVec2::new(0.0, size), DVec2::ZERO];
            let side = |i: usize| (0..16).map(move |k| corners[i].lerp(corners[i + 1], f64::from(k) / 16.0));
            gizmos.linestrip((0..4).flat_map(side).chain([DVec2::ZERO]).map(at), colour);
        }
        for placed in &chunk.streets {
            let local = placed.street.class == StreetClass::Local;
            if let Some(colour) = if local { colours.local_streets } else { colours.main_streets } {
                gizmos.linestrip(placed.street.line.iter().copied().map(at), colour);
            }
        }
        if let Some(colour) = colours.ports {
            for p in ports(chunk) {
                gizmos.sphere(Isometry3d::from_translation(at(p)), 3.0, colour).resolution(12);
            }
        }
    }
}

/// Junctions of a chunk at which local streets meet main streets of the same chunk.
fn ports(chunk: &Chunk) -> Vec<DVec2> {
    let ends = |local: bool| -> BTreeSet<JunctionId> {
        let streets = chunk.streets.iter().map(|s| &s.street);
        let wanted = streets.filter(|s| if local { s.class == StreetClass::Local } else { s.class.is_main() });
        wanted.flat_map(|s| [s.from, s.to]).collect()
    };
    let places: BTreeMap<JunctionId, DVec2> = chunk.junctions.iter().map(|j| (j.id, j.at)).collect();
    ends(true).intersection(&ends(false)).filter_map(|id| places.get(id).copied()).collect()
}
