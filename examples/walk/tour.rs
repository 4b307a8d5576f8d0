//! The walk without a window: from open country through a town and out on the other side.

use crate::args::Args;
use crate::headless::{Phase, RATE};
use crate::report::Measures;
use crate::scene;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::tasks::block_on;
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::prelude::*;
use bevy_sprawl::region::Settlement;
use bevy_sprawl::space::{Bounds, closest_on_line, cut_line, line_length, point_at};
use bevy_sprawl::world::World as Sprawled;
use std::sync::Arc;
use std::time::Instant;

/// Height of the eyes over the ground, in metres.
const EYES: f32 = 1.7;

/// The walker waits this long for the first ground, or for everything around to be loaded, in seconds. Then it goes on
/// regardless.
const PATIENCE: f64 = 30.0;

/// The walk.
#[derive(Resource)]
pub struct Tour {
    at: DVec2,
    seconds: f64,
    speed: Option<f64>,
    laps: f64,
    horizon: f32,
    /// The town that is walked through.
    pub town: Option<Arc<Settlement>>,
    /// The way, in plan metres.
    pub way: Vec<DVec2>,
    /// Whether the way follows streets; otherwise it is a straight line.
    pub on_streets: bool,
    /// Metres per second.
    pub pace: f64,
    /// Metres walked.
    pub walked: f64,
    /// Length of the walk in metres, all laps together.
    pub length: f64,
    planning: Option<SprawlTask<Vec<DVec2>>>,
    since: Instant,
}

/// The walker. Screenshots show what the walker sees.
#[derive(Component)]
pub struct Tourist;

impl Tour {
    pub fn new(args: &Args) -> Self {
        Self {
            at: args.at,
            seconds: args.seconds,
            speed: args.speed,
            laps: f64::from(args.laps),
            horizon: args.horizon,
            town: None,
            way: vec![args.at],
            on_streets: false,
            pace: 0.0,
            walked: 0.0,
            length: 0.0,
            planning: None,
            since: Instant::now(),
        }
    }

    /// Where the walker is, in plan metres. At the end of the way it turns and walks back.
    pub fn place(&self) -> Option<DVec2> {
        Some(point_at(&self.way, self.along().0).0).filter(|_| !self.way.is_empty())
    }

    /// Length of the walk once, in metres.
    fn lap(&self) -> f64 {
        self.length / self.laps
    }

    /// Laps that are done.
    pub fn laps_done(&self) -> usize {
        if self.length > 0.0 { (self.walked / self.lap()) as usize } else { 0 }
    }

    /// Metres along the way, and whether the walker goes forward.
    fn along(&self) -> (f64, bool) {
        let length = line_length(&self.way).max(1e-9);
        let lap = self.walked.rem_euclid(2.0 * length);
        if lap <= length { (lap, true) } else { (2.0 * length - lap, false) }
    }

    /// The point `metres` farther on.
    fn ahead(&self, metres: f64) -> DVec2 {
        let (along, forward) = self.along();
        let to = if forward { along + metres } else { along - metres };
        point_at(&self.way, to.clamp(0.0, line_length(&self.way))).0
    }

    /// Share of the walk that is done, 0 to 1.
    pub fn share(&self) -> f64 {
        if self.length > 0.0 { (self.walked / self.length).min(1.0) } else { 0.0 }
    }
}

/// Puts the walker in open country outside the nearest town.
pub fn spawn(mut commands: Commands, mut tour: ResMut<Tour>, sprawl: Sprawl) {
    let anchor = StreamAnchor { start_on_street: false, horizon: tour.horizon, ..default() };
    let mut start = tour.at;
    // This waits for the answer, which a game should not do. Here there is no window that could freeze.
    if let Ok(town) = block_on(sprawl.nearest_town(sprawl.to_bevy(tour.at, 0.0))) {
        // At the default pace, the walk leads from 500 m before the outline to 500 m behind it.
        let through = 2.0 * (town.radius + 500.0) * tour.laps;
        tour.pace = tour.speed.unwrap_or((through / tour.seconds).clamp(5.0, 100.0));
        tour.length = tour.pace * tour.seconds;
        let away = (tour.at - town.centre.plan()).normalize_or(DVec2::Y);
        start = town.centre.plan() + away * (tour.lap() / 2.0).max(town.radius + 500.0);
        tour.town = Some(town);
    } else {
        tour.pace = tour.speed.unwrap_or(30.0);
        tour.length = tour.pace * tour.seconds;
    }
    tour.way = vec![start, start + DVec2::new(0.0, tour.lap())];
    tour.since = Instant::now();
    let at = sprawl.on_ground(start).unwrap_or_default();
    commands.spawn((Tourist, anchor, scene::camera(tour.horizon), Transform::from_translation(at + Vec3::Y * EYES)));
}

pub fn arrive(mut phase: ResMut<Phase>, mut tour: ResMut<Tour>, mut measures: ResMut<Measures>, sprawl: Sprawl) {
    let Some(place) = tour.place().filter(|_| *phase == Phase::Arrive) else { return };
    if sprawl.is_ready(sprawl.to_bevy(place, 0.0)) {
        measures.first_chunk();
    } else if tour.since.elapsed().as_secs_f64() < PATIENCE {
        return;
    }
    *phase = Phase::Plan;
    let Some(town) = tour.town.clone() else { return };
    let (from, length) = (place, tour.lap());
    tour.planning = Some(sprawl.ask(move |world, cancel| way_through(world, &town, from, length, cancel)));
}

/// Takes the way once it has been found. If there is none, the way is a straight line through the middle of the town.
pub fn plan(mut phase: ResMut<Phase>, mut tour: ResMut<Tour>) {
    if *phase != Phase::Plan {
        return;
    }
    let answer = match &mut tour.planning {
        Some(task) => match task.poll() {
            Some(answer) => answer,
            None => return,
        },
        None => Err(NoAnswer::NotFound),
    };
    match answer {
        Ok(way) => {
            tour.way = way;
            tour.on_streets = true;
        }
        Err(NoAnswer::NotFound) => {
            let start = tour.way[0];
            let to = tour.town.as_ref().map_or(start + DVec2::Y, |t| t.centre.plan());
            let along = (to - start).normalize_or(DVec2::Y);
            tour.way = vec![start, start + along * tour.lap()];
        }
        Err(error) => eprintln!("warning: no way through the town: {error}"),
    }
    tour.since = Instant::now();
    *phase = Phase::Wait;
}

/// Waits until everything around the beginning of the way is loaded.
pub fn wait(
    mut phase: ResMut<Phase>,
    tour: Res<Tour>,
    stats: Res<SprawlStats>,
    mut measures: ResMut<Measures>,
    sprawl: Sprawl,
    mut tourist: Single<&mut Transform, With<Tourist>>,
) {
    if *phase != Phase::Wait {
        return;
    }
    stand(&tour, &sprawl, &mut tourist);
    let waited = tour.since.elapsed().as_secs_f64();
    if (waited > 0.5 && !is_loading(&stats)) || waited > PATIENCE {
        measures.start_walk(&stats);
        *phase = Phase::Walk;
    }
}

/// Whether anything around the walker is still to come.
pub fn is_loading(stats: &SprawlStats) -> bool {
    stats.chunks_missing > 0 || stats.tiles_missing > 0 || stats.tasks_in_flight > 0
}

/// Takes a step.
pub fn walk(
    mut phase: ResMut<Phase>,
    mut tour: ResMut<Tour>,
    sprawl: Sprawl,
    mut tourist: Single<&mut Transform, With<Tourist>>,
) {
    if *phase != Phase::Walk {
        return;
    }
    tour.walked += tour.pace / RATE;
    stand(&tour, &sprawl, &mut tourist);
    if tour.walked >= tour.length {
        *phase = Phase::Done;
    }
}

/// Puts the walker where the tour is, looking along the way.
fn stand(tour: &Tour, sprawl: &Sprawl, transform: &mut Transform) {
    let Some(eyes) = tour.place().and_then(|p| sprawl.on_ground(p)).map(|p| p + Vec3::Y * EYES) else { return };
    transform.translation = eyes;
    let Some(target) = sprawl.on_ground(tour.ahead(25.0)) else { return };
    let mut along = target + Vec3::Y * EYES - eyes;
    along.y *= 0.5;
    if along.length() > 1.0 {
        let wanted = Transform::IDENTITY.looking_to(along, Vec3::Y).rotation;
        transform.rotation = transform.rotation.slerp(wanted, if tour.walked == 0.0 { 1.0 } else { 0.08 });
    }
}

/// A way of about `length` metres along roads and streets. It leads to the town from the side of `from`, through the middle
/// of the town, and out on the other side. `None` if the network does not lead there.
fn way_through(
    world: &Sprawled,
    town: &Settlement,
    from: DVec2,
    length: f64,
    cancel: &Cancel,
) -> Result<Option<Vec<DVec2>>, LayerError> {
    let centre = town.centre.plan();
    let reach = (length / 2.0).max(town.radius + 200.0);
    let outside = (reach * 0.8).max(town.radius * 0.8);
    // Points on roads outside of the town, one for each section of road.
    let mut ends: Vec<DVec2> = Vec::new();
    for road in world.roads().overlapping(Bounds::square(centre, 2.0 * reach + 1_000.0), cancel)? {
        let line: Vec<DVec2> = road.street.line.iter().map(|p| road.origin.to_plan(*p)).collect();
        let near = |p: &&DVec2| (outside..reach + 500.0).contains(&p.distance(centre));
        ends.extend(line.iter().filter(near).min_by(|a, b| a.distance(from).total_cmp(&b.distance(from))));
    }
    let Some(start) = ends.iter().copied().min_by(|a, b| a.distance(from).total_cmp(&b.distance(from))) else {
        return Ok(None);
    };
    let opposite = 2.0 * centre - start;
    ends.sort_by(|a, b| a.distance(opposite).total_cmp(&b.distance(opposite)));
    let Some(first) = world.route(start, centre, 800.0, cancel)? else { return Ok(None) };
    let mut way = first.points;
    let middle = line_length(&way);
    // The first end whose way does not go back along the way to the middle.
    for end in ends.into_iter().filter(|e| e.distance(start) > town.radius) {
        let Some(second) = world.route(centre, end, 800.0, cancel)? else { continue };
        let back = second.points.iter().filter(|p| closest_on_line(**p, &way).1.distance(**p) < 1.0).count();
        if back * 3 < second.points.len() || second.points.len() < 4 {
            way.extend(second.points.into_iter().skip(1));
            break;
        }
    }
    // Cut to the wanted length around the middle of the town.
    let all = line_length(&way);
    let begin = (middle - length / 2.0).clamp(0.0, (all - length).max(0.0));
    Ok(Some(cut_line(&way, begin, (begin + length).min(all))))
}
