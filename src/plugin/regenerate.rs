//! Making the next world when the inputs change.

use super::assets::{FileContents, SprawlFolder};
use super::frame_time::Stopwatch;
use super::schedule::WorldSystems;
use super::source::{AwaitedFiles, SprawlSource, SprawlWorld, WorldChanged, WorldMended, WorldRejected};
use super::streaming::{ChunkIndex, Stale, Streaming};
use super::task::catch_panic;
use crate::world::{Difference, World, WorldError, difference, unchanged_chunks};
use bevy::ecs::system::SystemState;
use bevy::prelude::{
    App, Commands, DetectChanges, IntoScheduleConfigs, MessageWriter, Plugin, PostUpdate, Res, ResMut, Resource, error,
};
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};

pub(super) struct RegeneratePlugin;

impl Plugin for RegeneratePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Regeneration>().add_systems(
            PostUpdate,
            (start_regeneration, finish_regeneration).chain().in_set(WorldSystems::Regenerate),
        );
        if !app.world().resource::<AwaitedFiles>().any() {
            make_first_world(app);
        }
    }
}

/// The first world is made at once, so that systems in `Startup` can ask it where to put the player.
fn make_first_world(app: &mut App) {
    let source = app.world().resource::<SprawlSource>().0.clone();
    match World::new(source) {
        Ok(world) => {
            if let Ok(mut streaming) = SystemState::<Streaming>::new(app.world_mut()).get_mut(app.world_mut()) {
                streaming.replace(&world, Stale::All);
            }
            let mut current = app.world_mut().resource_mut::<SprawlWorld>();
            current.replace(world);
            let revision = current.revision();
            app.world_mut().write_message(WorldChanged { revision });
        }
        Err(error) => {
            error!("there is no world: {error}");
            app.world_mut().resource_mut::<Regeneration>().is_rejected = true;
            app.world_mut().write_message(WorldRejected { error, place: None });
        }
    }
}

/// The next world, while it is made.
#[derive(Resource, Default)]
struct Regeneration {
    task: Option<Task<Result<NextWorld, WorldError>>>,
    wanted: bool,
    /// Whether the last source made no world.
    is_rejected: bool,
}

/// A world that is ready to replace the current one.
struct NextWorld {
    world: World,
    stale: Stale,
}

/// Starts to make the next world if the source has changed. All changes while a world is being made lead to one further world.
fn start_regeneration(
    mut stopwatch: Stopwatch,
    (source, awaited): (Res<SprawlSource>, Res<AwaitedFiles>),
    current: Res<SprawlWorld>,
    index: Res<ChunkIndex>,
    mut regeneration: ResMut<Regeneration>,
    (mut commands, mut mended): (Commands, MessageWriter<WorldMended>),
) {
    let _running = stopwatch.start();
    regeneration.wanted |= source.is_changed();
    if !regeneration.wanted || awaited.any() || regeneration.task.is_some() {
        return;
    }
    regeneration.wanted = false;
    let source = source.0.clone();
    let old = current.get().cloned();
    let change = old.as_ref().map_or(Difference::All, |old| difference(old.source(), &source));
    if change == Difference::None {
        // After a mistake, the source is again what the current world was made from.
        if std::mem::take(&mut regeneration.is_rejected) {
            report_mended(&mut commands, &mut mended, current.revision());
        }
        return;
    }
    let loaded = index.settlements();
    let make = move || {
        let world = match &old {
            Some(old) => old.remade(source)?,
            None => World::new(source)?,
        };
        let stale = match (change, old) {
            (Difference::Some { styles, edits }, Some(old)) => {
                let before = if edits { Some(&old) } else { None };
                // If the new world cannot be compared, nothing is known to be the same.
                unchanged_chunks(&world, before, &styles, loaded).map_or(Stale::All, Stale::AllBut)
            }
            _ => Stale::All,
        };
        Ok(NextWorld { world, stale })
    };
    regeneration.task = Some(
        AsyncComputeTaskPool::get()
            .spawn(async move { catch_panic(make).unwrap_or_else(|defect| Err(WorldError::Defect(defect))) }),
    );
}

fn finish_regeneration(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    mut regeneration: ResMut<Regeneration>,
    mut current: ResMut<SprawlWorld>,
    mut streaming: Streaming,
    (folder, contents): (Option<Res<SprawlFolder>>, Res<FileContents>),
    (mut changed, mut rejected, mut mended): (
        MessageWriter<WorldChanged>,
        MessageWriter<WorldRejected>,
        MessageWriter<WorldMended>,
    ),
) {
    let _running = stopwatch.start();
    let Some(result) = regeneration.task.as_mut().and_then(check_ready) else { return };
    regeneration.task = None;
    match result {
        Ok(NextWorld { world, stale }) => {
            streaming.replace(&world, stale);
            current.replace(world);
            let event = WorldChanged { revision: current.revision() };
            changed.write(event);
            commands.trigger(event);
            if std::mem::take(&mut regeneration.is_rejected) {
                report_mended(&mut commands, &mut mended, current.revision());
            }
        }
        Err(error) => {
            regeneration.is_rejected = true;
            let place = folder.and_then(|folder| folder.locate(&error, &contents));
            match &place {
                Some(place) => error!("{place}; the last world stays"),
                None => error!("the changed inputs make no world, and the last one stays: {error}"),
            }
            let event = WorldRejected { error, place };
            rejected.write(event.clone());
            commands.trigger(event);
        }
    }
}

fn report_mended(commands: &mut Commands, mended: &mut MessageWriter<WorldMended>, revision: u32) {
    let event = WorldMended { revision };
    mended.write(event);
    commands.trigger(event);
}
