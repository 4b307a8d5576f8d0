//! Tests of the land beyond the chunks.

use super::*;
use crate::mesh::horizon_tiles;
use crate::space::Bounds;

const HORIZON: f64 = 6_000.0;

fn far() -> StreamAnchor {
    StreamAnchor { horizon: HORIZON as f32, ..small() }
}

/// The squares of everything that is shown: loaded chunks and visible tiles.
fn shown(app: &mut App) -> Vec<Bounds> {
    let size = app.world().resource::<ChunkIndex>().size;
    let mut query = app.world_mut().query::<(&ChunkCoord, &ChunkStatus)>();
    let chunks = query.iter(app.world()).filter(|(_, status)| status.is_there());
    let mut out: Vec<Bounds> = chunks.map(|(coord, _)| coord.bounds(size)).collect();
    let mut query = app.world_mut().query::<(&HorizonTile, &Visibility)>();
    let tiles = query.iter(app.world()).filter(|(_, visibility)| **visibility != Visibility::Hidden);
    out.extend(tiles.map(|(tile, _)| tile.bounds(size)));
    out
}

/// How many of the shown squares hold a point. West and south borders belong to a square.
fn layers(shown: &[Bounds], p: DVec2) -> usize {
    shown.iter().filter(|b| p.cmpge(b.min).all() && p.cmplt(b.max).all()).count()
}

fn plan_point(app: &App, entity: Entity) -> DVec2 {
    let at = app.world().get::<Transform>(entity).unwrap().translation;
    app.world().resource::<SprawlOrigin>().to_plan(at)
}

/// Points of a lattice around a place, out to the horizon.
fn points_around(centre: DVec2) -> Vec<DVec2> {
    let step = 443.0;
    let first = (centre / step).round();
    let all = (-14..=14).flat_map(|y| (-14..=14).map(move |x| (first + DVec2::new(f64::from(x), f64::from(y))) * step));
    all.filter(|p| p.distance(centre) < HORIZON).collect()
}

#[track_caller]
fn check_whole(app: &mut App, anchor: Entity) {
    let (shown, centre) = (shown(app), plan_point(app, anchor));
    for p in points_around(centre) {
        assert_eq!(layers(&shown, p), 1, "{p} from {centre}");
    }
}

#[test]
fn the_ground_is_whole_and_nothing_is_shown_twice_on_random_walks() {
    for walk in 0..2 {
        let maker = Fake::new(|_| How::Make);
        let (mut app, anchor) = app(&maker, far());
        settle(&mut app);
        check_whole(&mut app, anchor);
        let mut rng = Seed(walk).stream("walk", &[]);
        let mut covered: Vec<DVec2> = Vec::new();
        for step in 0..80 {
            let place = app.world().get::<Transform>(anchor).unwrap().translation;
            // Strides, runs, and now and then a leap.
            let stride = if rng.chance(0.03) { 4_000.0 } else { rng.range(0.0, 300.0) };
            let turn = rng.range(0.0, 6.3);
            let by = crate::space::math::direction(turn) * stride;
            move_to(&mut app, anchor, place + Vec3::new(by.x as f32, 0.0, by.y as f32));
            for _ in 0..1 + rng.index(4) {
                app.update();
            }
            let (shown, centre) = (shown(&mut app), plan_point(&app, anchor));
            let points = points_around(centre);
            assert!(points.iter().all(|p| layers(&shown, *p) <= 1), "walk {walk}, step {step}: twice");
            let mut lost = covered.iter().filter(|p| p.distance(centre) < HORIZON && layers(&shown, **p) == 0);
            assert_eq!(lost.next(), None, "walk {walk}, step {step}, from {centre}: a hole");
            covered = points.into_iter().filter(|p| layers(&shown, *p) == 1).collect();
            if rng.chance(0.1) {
                settle(&mut app);
                check_whole(&mut app, anchor);
            }
        }
    }
}

#[test]
fn tiles_are_those_that_are_seen_and_stand_in_their_places() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, far());
    settle(&mut app);
    let stats = *app.world().resource::<SprawlStats>();
    let wanted = horizon_tiles(DVec2::ZERO, HORIZON, 512);
    assert_eq!((stats.tiles_loaded, stats.tiles_missing, stats.tiles_failed), (wanted.len(), 0, 0));
    assert_eq!(stats.tiles_made, wanted.len() as u64);
    // Both move, and the origin with them.
    move_to(&mut app, anchor, Vec3::new(9_000.0, 0.0, -7_000.0));
    settle(&mut app);
    let origin = *app.world().resource::<SprawlOrigin>();
    assert_ne!(origin, SprawlOrigin::default());
    let mut query = app.world_mut().query::<(&HorizonTile, &Transform)>();
    for (tile, transform) in query.iter(app.world()) {
        assert_eq!(origin.to_plan(transform.translation), tile.origin(512).plan());
    }
    check_whole(&mut app, anchor);
}

#[test]
fn walking_to_and_fro_makes_no_tile_anew() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, far());
    for x in [0.0, 100.0, 0.0] {
        move_to(&mut app, anchor, Vec3::new(x, 0.0, 0.0));
        settle(&mut app);
    }
    let made = maker.tiles.load(Ordering::Relaxed);
    for x in [100.0, 0.0, 100.0, 0.0] {
        move_to(&mut app, anchor, Vec3::new(x, 0.0, 0.0));
        settle(&mut app);
    }
    assert_eq!(maker.tiles.load(Ordering::Relaxed), made);
}

#[test]
fn no_horizon_shows_no_tile() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, small());
    settle(&mut app);
    let tiles = |app: &mut App| app.world_mut().query::<&HorizonTile>().iter(app.world()).count();
    assert_eq!((tiles(&mut app), maker.tiles.load(Ordering::Relaxed)), (0, 0));
    let before = entities(&mut app);
    app.world_mut().get_mut::<StreamAnchor>(anchor).unwrap().horizon = 3_000.0;
    settle(&mut app);
    assert!(tiles(&mut app) > 0);
    for none in [0.0, -1.0, f32::NAN] {
        app.world_mut().get_mut::<StreamAnchor>(anchor).unwrap().horizon = none;
        settle(&mut app);
        assert_eq!((tiles(&mut app), entities(&mut app)), (0, before), "{none}");
    }
    assert_eq!(app.world().resource::<SprawlStats>().tiles_loaded, 0);
}

#[test]
fn a_new_world_makes_every_tile_again_and_shows_the_old_until_then() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, far());
    settle(&mut app);
    let made = maker.tiles.load(Ordering::Relaxed);
    let next = Fake::new(|_| How::Make);
    let same = chunks(&mut app).into_keys().collect();
    replace(&mut app, &next, Stale::AllBut(same));
    for _ in 0..300 {
        app.update();
        check_whole(&mut app, anchor);
    }
    settle(&mut app);
    assert_eq!(next.tiles.load(Ordering::Relaxed), made);
    assert_eq!(next.made.load(Ordering::Relaxed), 0, "chunks stay");
    // Chunks of another size take tiles of another size with them.
    let next = Fake { size: 256, ..Fake::new(|_| How::Make) };
    app.world_mut().resource_mut::<SprawlSource>().settings.chunk_size = 256;
    replace(&mut app, &next, Stale::All);
    settle(&mut app);
    check_whole(&mut app, anchor);
}

#[test]
fn tiles_that_a_game_despawns_come_again() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, far());
    settle(&mut app);
    let made = maker.tiles.load(Ordering::Relaxed);
    let before = entities(&mut app);
    let mut query = app.world_mut().query::<(Entity, &HorizonTile)>();
    let of_level = |level| query.iter(app.world()).find(|(_, tile)| tile.level == level).map(|(e, _)| e).unwrap();
    for entity in [0, 2].map(of_level) {
        app.world_mut().despawn(entity);
    }
    app.update();
    settle(&mut app);
    check_whole(&mut app, anchor);
    assert_eq!(entities(&mut app), before);
    assert_eq!(maker.tiles.load(Ordering::Relaxed), made + 5, "four pieces and one");
}

#[test]
fn stale_tiles_are_cancelled_and_none_leak() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, far());
    settle(&mut app);
    let (before, meshes) = (entities(&mut app), app.world().resource::<Assets<Mesh>>().len());
    for round in 0..30 {
        let x = if round % 2 == 0 { 40_960.0 } else { 0.0 };
        let origin = *app.world().resource::<SprawlOrigin>();
        move_to(&mut app, anchor, origin.to_bevy(DVec2::new(x, 0.0), 0.0));
        app.update();
    }
    settle(&mut app);
    check_whole(&mut app, anchor);
    assert_eq!((entities(&mut app), app.world().resource::<Assets<Mesh>>().len()), (before, meshes));
}
