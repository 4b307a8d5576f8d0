//! The walk without a window: the walker follows a route by itself, at 60 frames a second with a simulated step of 1/60 s.

use crate::args::Args;
use crate::report::{Measures, write_report};
use crate::tour::{self, Tour};
use crate::{map, scene, shots};
use bevy::app::ScheduleRunnerPlugin;
use bevy::log::{Level, LogPlugin};
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::settings::{RenderCreation, WgpuSettings};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use bevy_sprawl::prelude::*;
use std::time::{Duration, Instant};

/// Frames per second.
pub const RATE: f64 = 60.0;

/// The phase of the walk.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Waits for the first chunk, out in the country. This measures a cold start.
    Arrive,
    /// Searches for a way through the town, in the background.
    Plan,
    /// Waits at the beginning of the way until everything around is loaded.
    Wait,
    /// Walks. Only these frames are measured.
    Walk,
    /// Stands still for a screenshot.
    Shoot,
    /// Writes the map and the report.
    Done,
}

/// Walks, writes the map, the screenshots and the report, and ends.
pub fn run(args: Args, adapter: Option<RenderCreation>, draws: shots::Draws) -> AppExit {
    if draws == shots::Draws::Not {
        println!("There is no graphics adapter, not even in software: no screenshots.");
    }
    for dir in [Some(args.screenshots.as_path()), args.report.parent()].into_iter().flatten() {
        if let Err(error) = std::fs::create_dir_all(dir) {
            eprintln!("error: {}: {error}", dir.display());
            return AppExit::from_code(2);
        }
    }
    // Without an adapter, Bevy's own messages about it say nothing new.
    let filter = match draws {
        shots::Draws::Not => "warn,bevy_render=off,bevy_gizmos_render=off",
        _ => "warn,wgpu=error,bevy_render=error",
    };
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(RenderPlugin {
                render_creation: adapter.unwrap_or_else(|| WgpuSettings { backends: None, ..default() }.into()),
                // The few frames that are drawn must show everything.
                synchronous_pipeline_compilation: true,
                ..default()
            })
            .set(LogPlugin { level: Level::WARN, filter: filter.into(), ..default() })
            .disable::<WinitPlugin>(),
    );
    let start = Instant::now();
    app.add_plugins(SprawlPlugin::new(args.seed).starting_at(args.at));
    let making = start.elapsed();
    app.add_plugins(ScheduleRunnerPlugin::run_loop(Duration::from_secs_f64(1.0 / RATE)))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / RATE)))
        .insert_resource(Measures::new(making))
        .insert_resource(Phase::Arrive)
        .insert_resource(Tour::new(&args))
        .insert_resource(shots::Shots::new(&args, draws))
        .insert_resource(Outputs(args))
        .add_systems(PreStartup, |mut measures: ResMut<Measures>| measures.begin_frame())
        .add_systems(First, |mut measures: ResMut<Measures>| measures.begin_frame())
        .add_systems(Startup, (tour::spawn, (scene::light, shots::setup)).chain())
        .add_systems(Update, (tour::arrive, tour::plan, tour::wait, tour::walk, shots::shoot, scene::keep_sky).chain())
        .add_systems(Last, (measure, leave).chain());
    app.run()
}

/// The arguments that say where files are written.
#[derive(Resource)]
struct Outputs(Args);

fn measure(
    phase: Res<Phase>,
    stats: Res<SprawlStats>,
    tour: Res<Tour>,
    sprawl: Sprawl,
    mut measures: ResMut<Measures>,
) {
    measures.end_frame(*phase, &stats, &tour, || tour.place().is_some_and(|p| sprawl.is_ready(sprawl.to_bevy(p, 0.0))));
}

/// Writes the files and ends the app, once.
fn leave(
    mut left: Local<bool>,
    (phase, outputs): (Res<Phase>, Res<Outputs>),
    (tour, shots): (Res<Tour>, Res<shots::Shots>),
    (measures, stats): (Res<Measures>, Res<SprawlStats>),
    sprawl: Sprawl,
    mut exit: MessageWriter<AppExit>,
) {
    if *phase != Phase::Done || std::mem::replace(&mut *left, true) {
        return;
    }
    let args = &outputs.0;
    let map = args.screenshots.join("map.svg");
    let drawn =
        sprawl.world().map(|world| map::draw(world, &tour, args.seed).and_then(|svg| Ok(std::fs::write(&map, svg)?)));
    let report = measures.report(&stats, &tour);
    let written = write_report(&args.report, &report);
    println!("{}", report.summary(&tour));
    println!("  report       {}", args.report.display());
    println!("  map          {}", map.display());
    for shot in &shots.taken {
        println!("  screenshot   {}", shot.display());
    }
    let failed =
        [drawn.unwrap_or(Ok(())).err().map(|e| (map, e)), written.err().map(|e| (args.report.clone(), e.into()))];
    let mut code = AppExit::Success;
    for (file, error) in failed.into_iter().flatten() {
        eprintln!("error: {}: {error}", file.display());
        code = AppExit::error();
    }
    exit.write(code);
}
