//! Putting entities on a street.

use super::anchor::{StartOnStreet, StreamAnchor, read_anchors};
use super::frame_time::Stopwatch;
use super::origin::SprawlOrigin;
use super::schedule::SprawlSystems;
use super::source::SprawlWorld;
use super::spawn_point::{SpawnPoint, spawn_point};
use super::task::SprawlTask;
use bevy::prelude::*;
use glam::DVec2;

/// Height of the eyes over the ground, in metres.
const EYE_HEIGHT: f32 = 1.7;

/// If an entity has moved farther than this since the search began, in metres, the game has put it elsewhere.
const MOVED: f64 = 0.01;

/// The search for a place.
#[derive(Component)]
struct StartSearch {
    place: SprawlTask<SpawnPoint>,
    /// The plan point and height of the entity when the search began.
    from: (DVec2, f32),
}

pub(super) struct StartPlugin;

impl Plugin for StartPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PostUpdate,
            (ask_for_new_anchors, begin_searches, finish_searches)
                .chain()
                .in_set(SprawlSystems::Anchors)
                .before(read_anchors),
        );
    }
}

type NewAnchor = (Entity, &'static StreamAnchor, &'static Transform);

/// Gives new anchors a [`StartOnStreet`] if they ask for it.
fn ask_for_new_anchors(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    anchors: Query<NewAnchor, (Added<StreamAnchor>, Without<ChildOf>)>,
) {
    let _running = stopwatch.start();
    for (entity, anchor, transform) in &anchors {
        if anchor.start_on_street && *transform == Transform::IDENTITY {
            commands.entity(entity).insert_if_new(StartOnStreet::default());
        }
    }
}

/// Entities that ask to start on a street and have no search yet.
type Waiting = (With<StartOnStreet>, Without<StartSearch>);

fn begin_searches(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    (world, origin): (Res<SprawlWorld>, Res<SprawlOrigin>),
    entities: Query<(Entity, &Transform), Waiting>,
) {
    let _running = stopwatch.start();
    let Some(world) = world.get() else { return };
    for (entity, transform) in &entities {
        let near = origin.to_plan(transform.translation);
        let place = SprawlTask::new(Some(world), move |world, cancel| spawn_point(world, near, cancel).map(Some));
        commands.entity(entity).insert(StartSearch { place, from: (near, transform.translation.y) });
    }
}

type Searching =
    (Entity, &'static mut StartSearch, Option<&'static StartOnStreet>, &'static mut Transform, Has<Camera>);

fn finish_searches(
    mut stopwatch: Stopwatch,
    mut commands: Commands,
    origin: Res<SprawlOrigin>,
    mut entities: Query<Searching>,
) {
    let _running = stopwatch.start();
    for (entity, mut search, wish, mut transform, is_camera) in &mut entities {
        let Some(wish) = wish else {
            // The game has removed the component to take its wish back.
            commands.entity(entity).remove::<StartSearch>();
            continue;
        };
        let Some(answer) = search.place.poll() else { continue };
        commands.entity(entity).remove::<(StartOnStreet, StartSearch)>();
        let (from, height) = search.from;
        let is_where_it_was = origin.to_plan(transform.translation).distance(from) < MOVED
            && f64::from((transform.translation.y - height).abs()) < MOVED;
        match answer {
            Ok(place) if is_where_it_was => {
                let height = wish.height.unwrap_or(if is_camera { EYE_HEIGHT } else { 0.0 });
                *transform = place.transform(*origin, height).with_scale(transform.scale);
            }
            Ok(_) => {}
            Err(error) => warn!("{entity} begins where it is, since no street was found: {error}"),
        }
    }
}
