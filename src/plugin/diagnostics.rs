//! Figures about streaming, as a resource and as Bevy diagnostics.

use super::frame_time::{FrameTime, Stopwatch};
use super::schedule::SprawlSystems;
use super::streaming::{ChunkIndex, Horizon, Scheduler};
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;

/// Number of loaded chunks.
pub const DIAGNOSTIC_CHUNKS_LOADED: DiagnosticPath = DiagnosticPath::const_new("sprawl/chunks_loaded");
/// Number of tasks in flight.
pub const DIAGNOSTIC_TASKS_IN_FLIGHT: DiagnosticPath = DiagnosticPath::const_new("sprawl/tasks_in_flight");
/// Milliseconds of the frame for applying and removing chunks and tiles.
pub const DIAGNOSTIC_APPLY_MS: DiagnosticPath = DiagnosticPath::const_new("sprawl/apply_ms");
/// Milliseconds of the frame for all systems of the plugin.
pub const DIAGNOSTIC_MAIN_THREAD_MS: DiagnosticPath = DiagnosticPath::const_new("sprawl/main_thread_ms");
/// Number of chunks made since the start.
pub const DIAGNOSTIC_CHUNKS_MADE: DiagnosticPath = DiagnosticPath::const_new("sprawl/chunks_made");

/// Number of tiles of the horizon that are there, shown or not.
pub const DIAGNOSTIC_TILES_LOADED: DiagnosticPath = DiagnosticPath::const_new("sprawl/tiles_loaded");
/// Number of tiles of the horizon made since the start.
pub const DIAGNOSTIC_TILES_MADE: DiagnosticPath = DiagnosticPath::const_new("sprawl/tiles_made");

/// Figures about streaming in the last frame.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct SprawlStats {
    /// Number of loaded chunks.
    pub chunks_loaded: usize,
    /// Number of chunks that are wanted and not loaded yet.
    pub chunks_missing: usize,
    /// Number of tasks in flight, including cancelled tasks that have not stopped yet.
    pub tasks_in_flight: usize,
    /// Number of chunks made since the start.
    pub chunks_made: u64,
    /// Number of chunks that could not be made since the start.
    pub chunks_failed: u64,
    /// Mean time to make a chunk with its meshes, in milliseconds of a background thread.
    pub chunk_ms: f32,
    /// Number of tiles of the horizon that are there, shown or not.
    pub tiles_loaded: usize,
    /// Number of tiles of the horizon that are wanted and not there yet.
    pub tiles_missing: usize,
    /// Number of tiles of the horizon made since the start.
    pub tiles_made: u64,
    /// Number of tiles of the horizon that could not be made since the start.
    pub tiles_failed: u64,
    /// Mean time to make a tile of the horizon, in milliseconds of a background thread.
    pub tile_ms: f32,
    /// Milliseconds of the frame for applying and removing chunks and tiles.
    pub apply_ms: f32,
    /// Milliseconds of the frame for all systems of the plugin, applying included.
    pub main_thread_ms: f32,
}

pub(super) struct DiagnosticsPlugin;

impl Plugin for DiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<SprawlStats>()
            .register_type::<SprawlStats>()
            .register_diagnostic(Diagnostic::new(DIAGNOSTIC_CHUNKS_LOADED))
            .register_diagnostic(Diagnostic::new(DIAGNOSTIC_TASKS_IN_FLIGHT))
            .register_diagnostic(Diagnostic::new(DIAGNOSTIC_APPLY_MS).with_suffix("ms"))
            .register_diagnostic(Diagnostic::new(DIAGNOSTIC_MAIN_THREAD_MS).with_suffix("ms"))
            .register_diagnostic(Diagnostic::new(DIAGNOSTIC_CHUNKS_MADE))
            .register_diagnostic(Diagnostic::new(DIAGNOSTIC_TILES_LOADED))
            .register_diagnostic(Diagnostic::new(DIAGNOSTIC_TILES_MADE))
            .add_systems(PostUpdate, report.in_set(SprawlSystems::Report));
    }
}

/// Reports the frame. The time that this takes counts towards the next frame.
fn report(
    mut stopwatch: Stopwatch,
    (index, horizon, scheduler): (Res<ChunkIndex>, Res<Horizon>, Res<Scheduler>),
    mut stats: ResMut<SprawlStats>,
    mut diagnostics: Diagnostics,
) {
    let FrameTime { total, apply } = stopwatch.take();
    let _running = stopwatch.start();
    let now = SprawlStats {
        chunks_loaded: index.loaded(),
        chunks_missing: index.missing(),
        tasks_in_flight: scheduler.tasks_in_flight(&index, &horizon),
        chunks_made: scheduler.chunks.made,
        chunks_failed: scheduler.chunks.failed,
        chunk_ms: scheduler.chunks.mean_ms(),
        tiles_loaded: horizon.loaded(),
        tiles_missing: horizon.missing(),
        tiles_made: scheduler.tiles.made,
        tiles_failed: scheduler.tiles.failed,
        tile_ms: scheduler.tiles.mean_ms(),
        apply_ms: apply.as_secs_f32() * 1000.0,
        main_thread_ms: total.as_secs_f32() * 1000.0,
    };
    *stats = now;
    diagnostics.add_measurement(&DIAGNOSTIC_CHUNKS_LOADED, || now.chunks_loaded as f64);
    diagnostics.add_measurement(&DIAGNOSTIC_TASKS_IN_FLIGHT, || now.tasks_in_flight as f64);
    diagnostics.add_measurement(&DIAGNOSTIC_APPLY_MS, || f64::from(now.apply_ms));
    diagnostics.add_measurement(&DIAGNOSTIC_MAIN_THREAD_MS, || f64::from(now.main_thread_ms));
    diagnostics.add_measurement(&DIAGNOSTIC_CHUNKS_MADE, || now.chunks_made as f64);
    diagnostics.add_measurement(&DIAGNOSTIC_TILES_LOADED, || now.tiles_loaded as f64);
    diagnostics.add_measurement(&DIAGNOSTIC_TILES_MADE, || now.tiles_made as f64);
}
