//! Figures about streaming, as a resource and as Bevy diagnostics.

use super::schedule::SprawlSystems;
use super::streaming::Streaming;
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;

/// Number of chunks that are there.
pub const DIAGNOSTIC_CHUNKS_LOADED: DiagnosticPath = DiagnosticPath::const_new("sprawl/chunks_loaded");
/// Number of tasks in flight.
pub const DIAGNOSTIC_TASKS_IN_FLIGHT: DiagnosticPath = DiagnosticPath::const_new("sprawl/tasks_in_flight");
/// Milliseconds of this frame for applying and removing chunks.
pub const DIAGNOSTIC_APPLY_MS: DiagnosticPath = DiagnosticPath::const_new("sprawl/apply_ms");
/// Milliseconds of this frame for all of the plugin's work on the main thread.
pub const DIAGNOSTIC_MAIN_THREAD_MS: DiagnosticPath = DiagnosticPath::const_new("sprawl/main_thread_ms");
/// Number of chunks made since the start.
pub const DIAGNOSTIC_CHUNKS_MADE: DiagnosticPath = DiagnosticPath::const_new("sprawl/chunks_made");

/// Figures about streaming, of the last frame.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct SprawlStats {
    /// Chunks that are there.
    pub chunks_loaded: usize,
    /// Chunks that are wanted and not there yet.
    pub chunks_missing: usize,
    /// Tasks in flight, those included that were cancelled and have not stopped yet.
    pub tasks_in_flight: usize,
    /// Chunks made since the start.
    pub chunks_made: u64,
    /// Chunks that could not be made since the start.
    pub chunks_failed: u64,
    /// Mean time to make a chunk with its meshes, in milliseconds of a background thread.
    pub chunk_ms: f32,
    /// Milliseconds for applying and removing chunks.
    pub apply_ms: f32,
    /// Milliseconds for all of the plugin's work on the main thread, applying included.
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
            .add_systems(PostUpdate, report.in_set(SprawlSystems::Report));
    }
}

fn report(streaming: Res<Streaming>, mut stats: ResMut<SprawlStats>, mut diagnostics: Diagnostics) {
    let (loaded, missing, tasks) = streaming.load();
    let counts = streaming.counts;
    *stats = SprawlStats {
        chunks_loaded: loaded,
        chunks_missing: missing,
        tasks_in_flight: tasks,
        chunks_made: counts.made,
        chunks_failed: counts.failed,
        chunk_ms: (counts.task_seconds * 1000.0 / counts.made.max(1) as f64) as f32,
        apply_ms: counts.apply_ms,
        main_thread_ms: counts.frame_ms,
    };
    diagnostics.add_measurement(&DIAGNOSTIC_CHUNKS_LOADED, || loaded as f64);
    diagnostics.add_measurement(&DIAGNOSTIC_TASKS_IN_FLIGHT, || tasks as f64);
    diagnostics.add_measurement(&DIAGNOSTIC_APPLY_MS, || f64::from(counts.apply_ms));
    diagnostics.add_measurement(&DIAGNOSTIC_MAIN_THREAD_MS, || f64::from(counts.frame_ms));
    diagnostics.add_measurement(&DIAGNOSTIC_CHUNKS_MADE, || counts.made as f64);
}
