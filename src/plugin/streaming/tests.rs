//! Tests of streaming with a stand-in for the generator, without a renderer.

use super::generator::ChunkGenerator;
use super::*;
use crate::chunk::{Chunk, Ground};
use crate::layer::{Cancel, LayerError};
use crate::mesh::{ChunkMesh, Detail, HorizonTile, MeshBuffers};
use crate::plugin::source::SprawlSource;
use crate::plugin::{
    ChunkChange, ChunkData, ChunkDetail, ChunkFailed, ChunkPart, ChunkReady, ChunkStatus, ChunkUnloaded, OriginShifted,
    ShiftsWithOrigin, SprawlOrigin, SprawlStats, StreamAnchor, anchor, appearance, chunk, diagnostics, frame_time,
    schedule, shift,
};
use crate::region::Outline;
use crate::space::{ChunkCoord, Seed};
use crate::terrain::{GROUND_STEP, Terrain};
use crate::testing::Flat;
use crate::world::{WorldAssets, WorldSource};
use bevy::ecs::system::SystemState;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

mod horizon;

/// Makes flat chunks with a ground, no water, no roads and no buildings.
#[derive(Clone)]
struct Fake {
    size: i64,
    made: Arc<AtomicUsize>,
    tiles: Arc<AtomicUsize>,
    waiting: Arc<AtomicUsize>,
    cancelled: Arc<AtomicUsize>,
    how: fn(ChunkCoord) -> How,
}

enum How {
    Make,
    Defect,
    Panic,
    WaitUntilCancelled,
}

impl Fake {
    fn new(how: fn(ChunkCoord) -> How) -> Self {
        let [made, tiles, waiting, cancelled] = [(); 4].map(|()| Arc::default());
        Self { size: 512, made, tiles, waiting, cancelled, how }
    }
}

impl ChunkGenerator for Fake {
    fn chunk_size(&self) -> i64 {
        self.size
    }

    fn chunk(&self, coord: ChunkCoord, cancel: &Cancel) -> Result<Arc<Chunk>, LayerError> {
        match (self.how)(coord) {
            How::Make => {}
            How::Defect => return Err(LayerError::Padding { layer: "test", declared: 1.0, needed: 2.0 }),
            How::Panic => panic!("a defect at {coord}"),
            How::WaitUntilCancelled => {
                self.waiting.fetch_add(1, Ordering::Relaxed);
                while !cancel.is_cancelled() {
                    std::thread::sleep(Duration::from_millis(1));
                }
                self.cancelled.fetch_add(1, Ordering::Relaxed);
                return Err(LayerError::Cancelled);
            }
        }
        self.made.fetch_add(1, Ordering::Relaxed);
        let cells = (self.size as f64 / GROUND_STEP) as usize;
        let ground = Ground { cells, samples: vec![Flat.sample(DVec2::ZERO); (cells + 1) * (cells + 1)] };
        Ok(Arc::new(Chunk::empty(coord, self.size, ground)))
    }

    fn outlines(&self, _: &Chunk) -> Result<Vec<Arc<Outline>>, LayerError> {
        Ok(Vec::new())
    }

    fn mesh(&self, chunk: &Chunk, _: Detail, _: &Cancel) -> Result<ChunkMesh, LayerError> {
        Ok(ground(chunk.size))
    }

    fn horizon(&self, tile: HorizonTile, _: &Cancel) -> Result<ChunkMesh, LayerError> {
        self.tiles.fetch_add(1, Ordering::Relaxed);
        Ok(ground(tile.size(self.size)))
    }
}

/// A mesh with a ground of `size` metres.
fn ground(size: i64) -> ChunkMesh {
    let s = size as f32;
    let mut mesh = ChunkMesh::default();
    mesh[ChunkPart::Ground] = MeshBuffers {
        positions: vec![[0.0, 0.0, 0.0], [s, 0.0, 0.0], [0.0, 0.0, -s]],
        normals: vec![[0, 127, 0, 0]; 3],
        colours: vec![[u16::MAX; 4]; 3],
        indices: vec![0, 1, 2],
    };
    mesh
}

/// An app with the plugin's parts but the world, and an anchor.
fn app(maker: &Fake, anchor: StreamAnchor) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default()))
        .init_asset::<Mesh>()
        .insert_resource(SprawlSource(WorldSource { assets: WorldAssets::default(), ..WorldSource::new(Seed(0)) }))
        .insert_resource(SprawlOrigin::default())
        .add_plugins((
            schedule::SchedulePlugin,
            frame_time::FrameTimePlugin,
            chunk::ChunkPlugin,
            anchor::AnchorPlugin,
            shift::ShiftPlugin,
            StreamingPlugin { settings: StreamSettings::default() },
            appearance::AppearancePlugin,
            diagnostics::DiagnosticsPlugin,
        ));
    app.finish();
    app.cleanup();
    replace(&mut app, maker, Stale::All);
    let anchor = app.world_mut().spawn(anchor).id();
    (app, anchor)
}

fn replace(app: &mut App, generator: &Fake, stale: Stale) {
    let mut state = SystemState::<Streaming>::new(app.world_mut());
    state.get_mut(app.world_mut()).expect("streaming has its resources").replace(generator, stale);
}

fn small() -> StreamAnchor {
    let (load_radius, unload_radius, detail_radius) = (600.0, 900.0, 300.0);
    StreamAnchor { load_radius, unload_radius, detail_radius, horizon: 0.0, start_on_street: false, ..default() }
}

/// Runs until everything that is wanted is there and everything else is gone.
fn settle(app: &mut App) {
    // Other tests may keep the threads of the pool busy for a while.
    for _ in 0..60_000 {
        app.update();
        let stats = *app.world().resource::<SprawlStats>();
        let index = app.world().resource::<ChunkIndex>();
        let horizon = app.world().resource::<Horizon>();
        let busy = index.entries.values().any(|e| e.leaving || e.needs_work() || e.finished.is_some())
            || horizon.entries.values().any(|e| e.needs_work() || e.finished.is_some());
        let removing = !index.retired.is_empty() || !horizon.leaving.is_empty();
        if stats.chunks_missing == 0 && stats.tasks_in_flight == 0 && !busy && !removing {
            return;
        }
        std::thread::sleep(Duration::from_micros(300));
    }
    panic!("streaming did not settle: {:?}", app.world().resource::<SprawlStats>());
}

fn move_to(app: &mut App, entity: Entity, p: Vec3) {
    app.world_mut().get_mut::<Transform>(entity).unwrap().translation = p;
}

fn chunks(app: &mut App) -> BTreeMap<ChunkCoord, (Entity, ChunkStatus)> {
    let mut query = app.world_mut().query::<(Entity, &ChunkCoord, &ChunkStatus)>();
    query.iter(app.world()).map(|(e, c, s)| (*c, (e, *s))).collect()
}

fn entities(app: &mut App) -> usize {
    app.world_mut().query::<&Transform>().iter(app.world()).count()
}

fn messages<M: Message + Clone>(app: &App) -> Vec<M> {
    app.world().resource::<Messages<M>>().iter_current_update_messages().cloned().collect()
}

#[test]
fn chunks_come_around_an_anchor_and_go_behind_it() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, small());
    settle(&mut app);
    let here = chunks(&mut app);
    assert!(here.values().all(|(_, status)| *status == ChunkStatus::Ready));
    assert_eq!(here.keys().copied().collect::<Vec<_>>(), {
        let mut around: Vec<_> = (-2..=1).flat_map(|x| (-2..=1).map(move |y| ChunkCoord::new(x, y))).collect();
        // The corners of this 4 by 4 square are 724 m away.
        around.retain(|c| !((c.0.x == -2 || c.0.x == 1) && (c.0.y == -2 || c.0.y == 1)));
        around
    });
    let meshes = |app: &App| app.world().resource::<Assets<Mesh>>().len();
    assert_eq!(meshes(&app), here.len());
    let mut parts = app.world_mut().query::<(&ChunkPart, &ChildOf)>();
    assert!(parts.iter(app.world()).all(|(part, _)| *part == ChunkPart::Ground), "an empty mesh was spawned");
    assert_eq!(parts.iter(app.world()).count(), here.len());
    move_to(&mut app, anchor, Vec3::new(0.0, 0.0, -3000.0));
    settle(&mut app);
    let there = chunks(&mut app);
    assert_eq!(there.len(), here.len());
    assert!(there.keys().all(|c| c.0.y >= 3), "north is -z");
    assert_eq!(meshes(&app), there.len());
}

#[test]
fn a_hundred_rounds_leak_nothing() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, small());
    settle(&mut app);
    let (entities_before, slots) = (entities(&mut app), app.world().resource::<ChunkIndex>().entries.len());
    for round in 0..100 {
        move_to(&mut app, anchor, Vec3::new(if round % 2 == 0 { 3000.0 } else { 0.0 }, 0.0, 0.0));
        settle(&mut app);
    }
    assert_eq!(entities(&mut app), entities_before);
    let loaded = app.world().resource::<ChunkIndex>().entries.len();
    assert_eq!((loaded, app.world().resource::<Scheduler>().cancelled.len()), (slots, 0));
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), slots);
}

#[test]
fn walking_to_and_fro_over_a_border_makes_nothing_anew() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, small());
    for x in [0.0, 100.0, 0.0] {
        move_to(&mut app, anchor, Vec3::new(x, 0.0, 0.0));
        settle(&mut app);
    }
    let made = maker.made.load(Ordering::Relaxed);
    for x in [100.0, 0.0, 100.0, 0.0] {
        move_to(&mut app, anchor, Vec3::new(x, 0.0, 0.0));
        settle(&mut app);
    }
    assert_eq!(maker.made.load(Ordering::Relaxed), made);
}

#[test]
fn stale_work_is_cancelled_and_tasks_are_bounded() {
    let maker = Fake::new(|c| if c.0.x < 5 { How::WaitUntilCancelled } else { How::Make });
    let (mut app, anchor) = app(&maker, small());
    app.world_mut().resource_mut::<StreamSettings>().max_tasks = 3;
    // Other tests may keep the threads of the pool busy for a while.
    for round in 0..60_000 {
        app.update();
        assert!(app.world().resource::<SprawlStats>().tasks_in_flight <= 3);
        std::thread::sleep(Duration::from_millis(1));
        if round >= 20 && maker.waiting.load(Ordering::Relaxed) > 0 {
            break;
        }
    }
    move_to(&mut app, anchor, Vec3::new(6000.0, 0.0, 0.0));
    settle(&mut app);
    assert!(chunks(&mut app).keys().all(|c| c.0.x > 5));
    // Tasks that had begun noticed; the others never began.
    assert!((1..=3).contains(&maker.cancelled.load(Ordering::Relaxed)));
}

#[test]
fn a_shifted_origin_keeps_everything_in_its_place() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, walker) = app(&maker, small());
    let tree = app.world_mut().spawn(Transform::from_xyz(9_000.5, 3.0, -20.25)).id();
    let bird = app.world_mut().spawn((ShiftsWithOrigin::Yes, Transform::from_xyz(9_001.0, 30.0, 4.0))).id();
    let fixed = app.world_mut().spawn((ShiftsWithOrigin::No, Transform::from_xyz(1.0, 2.0, 3.0))).id();
    // An anchor may be a child: its root is shifted, and the anchor is not shifted a second time.
    let head = app.world_mut().spawn((small(), Transform::from_xyz(0.0, 1.7, 0.0))).id();
    app.world_mut().entity_mut(head).insert(ChildOf(walker));
    app.world_mut().entity_mut(walker).remove::<StreamAnchor>();
    move_to(&mut app, walker, Vec3::new(9_000.0, 0.0, -30.0));
    app.update();
    let [shift] = messages::<OriginShifted>(&app)[..] else { panic!("one shift") };
    settle(&mut app);
    let at = |app: &App, e: Entity| app.world().get::<Transform>(e).unwrap().translation;
    assert_eq!(shift.by, Vec3::new(-9_216.0, 0.0, 0.0));
    assert_eq!(at(&app, tree) - at(&app, walker), Vec3::new(0.5, 3.0, 9.75));
    assert_eq!(at(&app, bird), Vec3::new(-215.0, 30.0, 4.0));
    assert_eq!(at(&app, walker), Vec3::new(-216.0, 0.0, -30.0));
    assert_eq!(at(&app, head), Vec3::new(0.0, 1.7, 0.0));
    assert_eq!(at(&app, fixed), Vec3::new(1.0, 2.0, 3.0));
    let origin = *app.world().resource::<SprawlOrigin>();
    assert_eq!(origin.to_plan(at(&app, walker)), DVec2::new(9_000.0, 30.0));
    for (coord, (entity, _)) in chunks(&mut app) {
        assert_eq!(origin.to_plan(at(&app, entity)), coord.origin(512).plan());
    }
}

#[test]
fn an_anchor_may_leave_the_origin_where_it_is() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, walker) = app(&maker, small());
    let far = Transform::from_xyz(50_000.0, 0.0, 0.0);
    let view = app.world_mut().spawn((StreamAnchor { moves_origin: false, ..small() }, far)).id();
    settle(&mut app);
    assert_eq!(*app.world().resource::<SprawlOrigin>(), SprawlOrigin::default());
    assert!(chunks(&mut app).contains_key(&ChunkCoord::new(97, 0)), "its chunks are loaded all the same");
    // The anchor is shifted with the others.
    move_to(&mut app, walker, Vec3::new(9_216.0, 0.0, 0.0));
    settle(&mut app);
    assert_eq!(app.world().get::<Transform>(view).unwrap().translation.x, 50_000.0 - 9_216.0);
}

#[test]
fn an_anchor_outside_of_the_world_loads_nothing() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, small());
    for place in [Vec3::splat(3.0e38), Vec3::new(f32::NEG_INFINITY, 0.0, 0.0), Vec3::splat(f32::NAN)] {
        move_to(&mut app, anchor, place);
        settle(&mut app);
        assert!(chunks(&mut app).is_empty(), "{place}");
    }
    move_to(&mut app, anchor, Vec3::new(9.0e11, 0.0, -9.0e11));
    settle(&mut app);
    assert!(!chunks(&mut app).is_empty());
}

#[test]
fn a_chunk_that_fails_says_why_and_the_others_come() {
    let maker = Fake::new(|c| match (c.0.x, c.0.y) {
        (0, 0) => How::Defect,
        (-1, 0) => How::Panic,
        _ => How::Make,
    });
    let (mut app, _) = app(&maker, small());
    let seen: Arc<Mutex<Vec<String>>> = Arc::default();
    let log = seen.clone();
    app.add_observer(move |failed: On<ChunkFailed>| {
        log.lock().unwrap().push(format!("{} {}", failed.coord, failed.reason));
    });
    settle(&mut app);
    let statuses = chunks(&mut app);
    assert_eq!(statuses[&ChunkCoord::new(0, 0)].1, ChunkStatus::Failed);
    assert_eq!(statuses[&ChunkCoord::new(-1, 0)].1, ChunkStatus::Failed);
    assert_eq!(statuses.values().filter(|(_, s)| *s == ChunkStatus::Ready).count(), statuses.len() - 2);
    let mut seen = seen.lock().unwrap().clone();
    seen.sort();
    assert_eq!(seen.len(), 2);
    assert!(seen[0].starts_with("-1,0 the generator panicked: a defect at -1,0"), "{seen:?}");
    assert!(seen[1].starts_with("0,0 layer `test` reads"), "{seen:?}");
}

#[test]
fn in_a_new_world_only_what_differs_is_made_anew_and_the_old_stays_until_then() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, _) = app(&maker, small());
    settle(&mut app);
    let before = chunks(&mut app);
    let next = Fake::new(|_| How::Make);
    let changed = ChunkCoord::new(0, 0);
    let part = |app: &mut App| {
        let mut query = app.world_mut().query_filtered::<(Entity, &ChildOf), With<ChunkPart>>();
        query.iter(app.world()).filter(|(_, c)| c.parent() == before[&changed].0).map(|(e, _)| e).collect::<Vec<_>>()
    };
    let old = part(&mut app);
    let same: BTreeSet<ChunkCoord> = before.keys().copied().filter(|c| *c != changed).collect();
    replace(&mut app, &next, Stale::AllBut(same));
    let mut frames = 0;
    while next.made.load(Ordering::Relaxed) == 0 {
        assert_eq!(part(&mut app), old);
        app.update();
        frames += 1;
        assert!(frames < 1000);
        std::thread::sleep(Duration::from_micros(200));
    }
    settle(&mut app);
    let new = part(&mut app);
    assert!(new.len() == 1 && new != old, "its mesh was replaced");
    assert_eq!(chunks(&mut app), before, "the entities stay");
    assert_eq!(next.made.load(Ordering::Relaxed), 1);
    replace(&mut app, &next, Stale::All);
    settle(&mut app);
    assert_eq!(next.made.load(Ordering::Relaxed), 1 + before.len());
}

#[test]
fn another_chunk_size_replaces_every_chunk() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, _) = app(&maker, small());
    settle(&mut app);
    let before = chunks(&mut app).len();
    let next = Fake { size: 256, ..Fake::new(|_| How::Make) };
    app.world_mut().resource_mut::<SprawlSource>().settings.chunk_size = 256;
    replace(&mut app, &next, Stale::All);
    settle(&mut app);
    let after = chunks(&mut app).len();
    assert!(after > 2 * before, "{before} {after}");
    assert_eq!(entities(&mut app), 2 * after + 1);
}

/// What an app has announced: the changes of ready chunks, and the chunks unloaded.
#[derive(Clone, Default)]
struct Log {
    ready: Arc<Mutex<Vec<(ChunkCoord, ChunkChange)>>>,
    unloaded: Arc<Mutex<Vec<ChunkCoord>>>,
}

impl Log {
    fn of(app: &mut App) -> Self {
        let log = Self::default();
        let (ready, unloaded) = (log.ready.clone(), log.unloaded.clone());
        app.add_observer(move |event: On<ChunkReady>, details: Query<&ChunkDetail>| {
            assert_eq!(details.get(event.entity).unwrap().0, event.detail);
            ready.lock().unwrap().push((event.coord, event.change));
        });
        app.add_observer(move |event: On<ChunkUnloaded>| {
            assert_eq!(event.data.coord, event.coord);
            unloaded.lock().unwrap().push(event.coord);
        });
        log
    }

    fn count(&self, change: ChunkChange) -> usize {
        self.ready.lock().unwrap().iter().filter(|(_, c)| *c == change).count()
    }
}

#[test]
fn detail_follows_the_anchor_and_events_tell() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, anchor) = app(&maker, small());
    let log = Log::of(&mut app);
    app.add_observer(|event: On<ChunkUnloaded>, details: Query<&ChunkDetail>| {
        assert!(details.contains(event.entity), "everything is still in place");
    });
    settle(&mut app);
    let loaded = chunks(&mut app).len();
    assert_eq!(log.ready.lock().unwrap().len(), loaded);
    assert_eq!(log.count(ChunkChange::Loaded), loaded);
    let data = |app: &mut App| {
        let mut query = app.world_mut().query::<(&ChunkCoord, Ref<ChunkData>)>();
        query.iter(app.world()).map(|(c, d)| (*c, Arc::as_ptr(&d.0))).collect::<BTreeMap<_, _>>()
    };
    let before = data(&mut app);
    move_to(&mut app, anchor, Vec3::new(512.0, 0.0, 0.0));
    settle(&mut app);
    let details = |app: &mut App| {
        let mut query = app.world_mut().query::<(&ChunkCoord, &ChunkDetail)>();
        query.iter(app.world()).map(|(c, d)| (*c, d.0)).collect::<BTreeMap<_, _>>()
    };
    let detail = details(&mut app);
    assert_eq!(detail[&ChunkCoord::new(1, 0)], Detail::Full);
    assert_eq!(detail[&ChunkCoord::new(-1, 0)], Detail::Reduced);
    assert!(log.count(ChunkChange::Detail) > 0, "meshes were replaced");
    assert_eq!(log.count(ChunkChange::Data), 0);
    assert!(data(&mut app).iter().all(|(c, data)| before.get(c).is_none_or(|b| b == data)), "data stays");
}

#[test]
fn a_new_world_changes_data() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, _) = app(&maker, small());
    settle(&mut app);
    let (log, loaded) = (Log::of(&mut app), chunks(&mut app).len());
    replace(&mut app, &Fake::new(|_| How::Make), Stale::All);
    settle(&mut app);
    assert_eq!((log.count(ChunkChange::Data), log.ready.lock().unwrap().len()), (loaded, loaded));
}

#[test]
fn chunks_that_a_game_despawns_are_announced_and_come_again_at_once() {
    let maker = Fake::new(|_| How::Make);
    let (mut app, _) = app(&maker, small());
    settle(&mut app);
    let log = Log::of(&mut app);
    let despawned = [ChunkCoord::new(0, 0), ChunkCoord::new(-1, 1)];
    for coord in despawned {
        let (entity, _) = chunks(&mut app)[&coord];
        app.world_mut().despawn(entity);
    }
    // No anchor moves.
    app.update();
    let mut unloaded = log.unloaded.lock().unwrap().clone();
    unloaded.sort();
    assert_eq!(unloaded, [despawned[1], despawned[0]]);
    assert_eq!(messages::<ChunkUnloaded>(&app).len(), 2);
    settle(&mut app);
    assert!(despawned.iter().all(|coord| chunks(&mut app)[coord].1 == ChunkStatus::Ready));
    assert_eq!(log.count(ChunkChange::Loaded), 2);
}

#[test]
fn what_was_never_loaded_goes_at_once_and_without_notice() {
    let maker = Fake::new(|c| if c.0.x < 100 { How::WaitUntilCancelled } else { How::Make });
    let (mut app, anchor) = app(&maker, small());
    let log = Log::of(&mut app);
    app.update();
    let around = chunks(&mut app).len();
    for step in 1..40 {
        move_to(&mut app, anchor, Vec3::new(step as f32 * -3_000.0, 0.0, 0.0));
        app.update();
        assert!(chunks(&mut app).len() <= around + 8, "{} entities", chunks(&mut app).len());
    }
    let origin = *app.world().resource::<SprawlOrigin>();
    move_to(&mut app, anchor, origin.to_bevy(DVec2::new(90_000.0, 0.0), 0.0));
    settle(&mut app);
    assert!(log.unloaded.lock().unwrap().is_empty());
    let loaded = log.count(ChunkChange::Loaded);
    move_to(&mut app, anchor, Vec3::new(9.0e7, 0.0, 0.0));
    settle(&mut app);
    assert_eq!(log.unloaded.lock().unwrap().len(), loaded, "each that was ready");
}
