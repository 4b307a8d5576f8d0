//! The plugin as a server runs it: without a window, without a renderer, with the real generator.

use bevy::prelude::*;
use bevy::tasks::block_on;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::plugin::SprawlEdits;
use bevy_sprawl::prelude::*;
use bevy_sprawl::terrain::{Band, Holes, Raster, RasterTerrain, Terrain};
use bevy_sprawl::world::World as Sprawled;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

mod collision;
mod horizon;

const PATIENCE: Duration = Duration::from_secs(120);

fn app(plugin: SprawlPlugin, assets: AssetPlugin) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, assets, plugin));
    app.finish();
    app.cleanup();
    app
}

fn anchor() -> StreamAnchor {
    StreamAnchor { load_radius: 500.0, unload_radius: 800.0, detail_radius: 250.0, ..default() }
}

fn run_until(app: &mut App, what: &str, mut done: impl FnMut(&mut App) -> bool) {
    let start = Instant::now();
    loop {
        app.update();
        if done(app) {
            return;
        }
        assert!(start.elapsed() < PATIENCE, "waited in vain until {what}: {:?}", app.world().resource::<SprawlStats>());
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn settle(app: &mut App) {
    let mut quiet = 0;
    run_until(app, "everything is there", |app| {
        let stats = app.world().resource::<SprawlStats>();
        let busy = stats.chunks_loaded == 0 || stats.chunks_missing + stats.tiles_missing + stats.tasks_in_flight > 0;
        quiet = if busy { 0 } else { quiet + 1 };
        quiet > 20
    });
}

fn world(app: &App) -> Sprawled {
    app.world().resource::<SprawlWorld>().get().expect("there is a world").clone()
}

fn ask<T: Send + Sync + 'static>(app: &mut App, question: impl Fn(&Sprawl) -> T + Send + Sync + 'static) -> T {
    app.world_mut().run_system_once(move |sprawl: Sprawl| question(&sprawl)).expect("the question can be asked")
}

use bevy::ecs::system::RunSystemOnce;

/// Everything in the chunks that are there is what the generator makes, and each is where it belongs.
fn check_chunks(app: &mut App) -> usize {
    let (world, origin) = (world(app), *app.world().resource::<SprawlOrigin>());
    let mut query = app.world_mut().query::<(&ChunkCoord, &ChunkData, &ChunkDetail, &Transform, &ChunkStatus)>();
    let mut count = 0;
    for (coord, data, _, transform, status) in query.iter(app.world()) {
        let made = world.chunk(*coord, &Cancel::new()).expect("it can be made");
        assert_eq!(data.streets, made.streets, "streets of {coord}");
        assert_eq!(data.footprints, made.footprints, "buildings of {coord}");
        assert_eq!(origin.to_plan(transform.translation), made.origin.plan());
        assert_eq!(*status, ChunkStatus::Ready);
        count += 1;
    }
    count
}

#[test]
fn three_lines_put_a_player_on_a_street_with_ground_around() {
    let mut app = app(SprawlPlugin::new(42), AssetPlugin::default());
    let player = app.world_mut().spawn(anchor()).id();
    // The place is searched in the background.
    app.update();
    assert!(app.world().get::<StartOnStreet>(player).is_some());
    let first_frame = app.world().resource::<SprawlStats>().main_thread_ms;
    assert!(first_frame < 100.0, "{first_frame} ms");
    settle(&mut app);
    assert!(app.world().get::<StartOnStreet>(player).is_none());
    assert!(check_chunks(&mut app) >= 4);
    let at = app.world().get::<Transform>(player).expect("it is there").translation;
    let (ground, street, ready) =
        ask(&mut app, move |s| (s.height(at), s.nearest_street(at, 5.0).map(|s| s.distance), s.is_ready(at)));
    assert!((at.y - ground.expect("there is ground")).abs() < 0.01, "its feet are on the ground");
    assert!(street.expect("there is a street") < 0.1);
    assert!(ready);
    assert!(app.world().get_resource::<Assets<Mesh>>().is_none(), "nothing could draw a mesh");
    // On foot for a kilometre: chunks come ahead and go behind.
    let start = ask(&mut app, move |s| s.chunk_at(at));
    for step in 0..50 {
        app.world_mut().get_mut::<Transform>(player).expect("it is there").translation =
            at + Vec3::X * 25.0 * step as f32;
        app.update();
    }
    settle(&mut app);
    check_chunks(&mut app);
    assert_eq!(ask(&mut app, move |s| start.and_then(|c| s.status(c))), None, "the first chunk is gone");
}

#[test]
fn a_start_place_is_asked_for_by_component() {
    let mut app = app(SprawlPlugin::new(42), AssetPlugin::default());
    let camera = app.world_mut().spawn((Camera3d::default(), StartOnStreet::default())).id();
    let tree = app.world_mut().spawn(StartOnStreet { height: Some(-0.5) }).id();
    let moved = app.world_mut().spawn(StartOnStreet::default()).id();
    app.update();
    app.world_mut().get_mut::<Transform>(moved).expect("it is there").translation = Vec3::new(7.0, 8.0, 9.0);
    run_until(&mut app, "all places are found", |app| {
        [camera, tree, moved].into_iter().all(|e| app.world().get::<StartOnStreet>(e).is_none())
    });
    let at = |app: &App, e: Entity| app.world().get::<Transform>(e).expect("it is there").translation;
    for (entity, height) in [(camera, 1.7), (tree, -0.5)] {
        let at = at(&app, entity);
        let ground = ask(&mut app, move |s| s.height(at)).expect("there is ground");
        assert!((at.y - ground - height).abs() < 0.01, "{at} over {ground}");
    }
    assert_eq!(at(&app, moved), Vec3::new(7.0, 8.0, 9.0), "the game has put it elsewhere");
}

#[test]
fn far_out_the_same_world_is_near_the_origin() {
    let far = DVec2::new(3.0e8, -2.0e8);
    let mut app = app(SprawlPlugin::new(7).starting_at(far), AssetPlugin::default());
    let shifts: Arc<Mutex<Vec<Vec3>>> = Arc::default();
    let log = shifts.clone();
    app.add_observer(move |shift: On<OriginShifted>| log.lock().expect("not poisoned").push(shift.by));
    let player = app.world_mut().spawn(anchor()).id();
    let friend = app.world_mut().spawn(Transform::from_xyz(10.0, 0.0, 0.0)).id();
    settle(&mut app);
    let at = |app: &App, e: Entity| app.world().get::<Transform>(e).expect("it is there").translation;
    let before = app.world().resource::<SprawlOrigin>().to_plan(at(&app, friend));
    let start = at(&app, player);
    app.world_mut().get_mut::<Transform>(player).expect("it is there").translation = start + Vec3::X * 9_000.0;
    settle(&mut app);
    assert!(check_chunks(&mut app) >= 4);
    assert!(!shifts.lock().expect("not poisoned").is_empty());
    assert!(at(&app, player).length() < 6_000.0);
    assert_eq!(app.world().resource::<SprawlOrigin>().to_plan(at(&app, friend)), before);
}

#[test]
fn questions_are_answered_from_loaded_chunks_or_in_the_background() {
    let mut app = app(SprawlPlugin::new(42), AssetPlugin::default());
    app.update();
    let start = block_on(ask(&mut app, |s| s.spawn_point(Vec3::ZERO))).expect("there is a street somewhere");
    let position = start.position(*app.world().resource::<SprawlOrigin>());
    let town = block_on(ask(&mut app, move |s| s.nearest_town(position))).expect("there is a town");
    let centre = town.centre.plan();
    let there = ask(&mut app, move |s| s.on_ground(centre)).expect("there is ground");
    let back = ask(&mut app, move |s| s.to_plan(there));
    assert!(back.distance(centre) < 0.01);
    let way = block_on(ask(&mut app, move |s| s.route(position, there))).expect("streets of a town are connected");
    assert!(way.length >= position.xz().distance(there.xz()) as f64 - 200.0);
    let none = block_on(ask(&mut app, |s| s.ask(|_, _| Ok(None::<u8>))));
    assert_eq!(none, Err(NoAnswer::NotFound));

    // Nothing is loaded yet.
    let known = move |s: &Sprawl| (s.settlement_at(there).map(|t| t.id), s.nearest_street(there, 300.0));
    assert_eq!(ask(&mut app, known), (None, None));
    assert_eq!(ask(&mut app, |s| s.height(Vec3::splat(3.0e38))), None, "outside of the world");
    let at = Transform::from_translation(there);
    app.world_mut().spawn((StreamAnchor { start_on_street: false, ..anchor() }, at));
    settle(&mut app);
    let (settlement, street) = ask(&mut app, known);
    assert_eq!(settlement, Some(town.id));
    let street = street.expect("there is a street");
    let expected = world(&app).nearest_street(back, 300.0, &Cancel::new()).expect("it can be made");
    let expected = expected.expect("there is a street");
    // At a junction, several streets are equally near.
    assert!((street.distance - expected.distance).abs() < 1e-6);
    let (id, end) = (street.street.id, street.street.from);
    assert_eq!(ask(&mut app, move |s| s.street(id).map(|(_, street)| street.from)), Some(end));
    assert!(ask(&mut app, move |s| s.junction(end).is_some_and(|(_, junction)| junction.id == end)));
}

#[test]
fn a_question_without_a_world_has_no_answer() {
    let mut app = app(SprawlPlugin::new(1).edits_from("missing/wishes.edits.ron"), AssetPlugin::default());
    let town = ask(&mut app, |s| s.nearest_town(Vec3::ZERO));
    assert_eq!(block_on(town), Err(NoAnswer::NoWorld));
}

/// A copy of the bundled assets that a test may change.
fn folder(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&root);
    for kind in ["styles", "patches"] {
        let to = root.join("sprawl").join(kind);
        std::fs::create_dir_all(&to).expect("a folder");
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(kind);
        for file in std::fs::read_dir(from).expect("the bundled assets") {
            let file = file.expect("a file").path();
            std::fs::copy(&file, to.join(file.file_name().expect("a name"))).expect("a copy");
        }
    }
    root
}

#[test]
fn saved_files_change_what_depends_on_them_and_mistakes_change_nothing() {
    let root = folder("reload");
    let watch_for_changes_override = Some(true);
    let assets =
        AssetPlugin { file_path: root.to_string_lossy().into_owned(), watch_for_changes_override, ..default() };
    let mut app = app(SprawlPlugin::new(42).assets_from("sprawl"), assets);
    let rejected: Arc<Mutex<Vec<AssetRejected>>> = Arc::default();
    let remade: Arc<Mutex<Vec<ChunkCoord>>> = Arc::default();
    let (no, yes) = (rejected.clone(), remade.clone());
    app.add_observer(move |event: On<AssetRejected>| no.lock().expect("not poisoned").push(event.clone()));
    app.add_observer(move |event: On<ChunkReady>| {
        if event.change == ChunkChange::Data {
            yes.lock().expect("not poisoned").push(event.coord);
        }
    });
    app.add_observer(|event: On<WorldRejected>| panic!("{}", event.error));
    let player = app.world_mut().spawn(anchor()).id();
    settle(&mut app);
    let at = app.world().get::<Transform>(player).expect("it is there").translation;
    let style = block_on(ask(&mut app, move |s| s.nearest_town(at))).expect("a town").style.clone();
    let (asset, file) = (format!("sprawl/styles/{style}.ron"), root.join(format!("sprawl/styles/{style}.ron")));
    let good = std::fs::read_to_string(&file).expect("the style");
    let loaded = check_chunks(&mut app);
    remade.lock().expect("not poisoned").clear();

    std::fs::write(&file, "(\n    main: (length: 250.0),\n    nonsense: 3,\n)").expect("written");
    app.world().resource::<AssetServer>().reload(asset.clone());
    run_until(&mut app, "the file is refused", |_| !rejected.lock().expect("not poisoned").is_empty());
    let error = rejected.lock().expect("not poisoned")[0].clone();
    assert!(error.file.ends_with(&format!("{style}.ron")) && error.line == 3, "{error:?}");
    assert!(error.reason.contains("nonsense"), "{error:?}");
    for _ in 0..50 {
        app.update();
    }
    assert_eq!(app.world().resource::<SprawlWorld>().revision(), 1);
    assert!(remade.lock().expect("not poisoned").is_empty());
    assert_eq!(check_chunks(&mut app), loaded);

    // The same style with every lot empty.
    let before = world(&app);
    let mut changed = bevy_sprawl::style::Style::from_ron(&file.to_string_lossy(), &good).expect("the bundled style");
    changed.parcels.vacant = 1.0;
    let text = ron::ser::to_string(&changed).expect("a style can be written");
    std::fs::write(&file, text).expect("written");
    app.world().resource::<AssetServer>().reload(asset);
    run_until(&mut app, "there is a new world", |app| app.world().resource::<SprawlWorld>().revision() == 2);
    settle(&mut app);
    let after = world(&app);
    assert_eq!(check_chunks(&mut app), loaded);
    let mut remade = remade.lock().expect("not poisoned").clone();
    remade.sort();
    remade.dedup();
    let mut query = app.world_mut().query::<&ChunkCoord>();
    for coord in query.iter(app.world()) {
        let chunk = |world: &Sprawled| world.chunk(*coord, &Cancel::new()).expect("it can be made");
        let same = chunk(&before).footprints == chunk(&after).footprints;
        assert!(same || remade.contains(coord), "{coord} was forgotten");
        assert!(
            chunk(&after).settlements.iter().any(|s| s.style == style)
                || chunk(&after).footprints == chunk(&before).footprints
        );
    }
    assert!(!remade.is_empty());

    // A new file is found, since the folder is watched.
    std::fs::write(root.join("sprawl/styles/another.ron"), good).expect("written");
    run_until(&mut app, "the new file is known", |app| {
        app.world().resource::<SprawlSource>().assets.styles.contains_key("another")
    });
}

#[test]
fn files_moved_into_place_are_loaded_and_mistakes_are_located_and_mended() {
    let root = folder("moved");
    let watch_for_changes_override = Some(true);
    let file_path = root.to_string_lossy().into_owned();
    let assets = AssetPlugin { file_path, watch_for_changes_override, ..default() };
    std::fs::write(root.join("wishes.edits.ron"), "()").expect("written");
    let mut app = app(SprawlPlugin::new(42).assets_from("sprawl").edits_from("wishes.edits.ron"), assets);
    let revision = |app: &App| app.world().resource::<SprawlWorld>().revision();
    run_until(&mut app, "there is a world", |app| revision(app) == 1);
    let log: Arc<Mutex<Vec<String>>> = Arc::default();
    let (refused, mended, rejected, again) = (log.clone(), log.clone(), log.clone(), log.clone());
    let note = |log: &Mutex<Vec<String>>, what: String| log.lock().expect("not poisoned").push(what);
    app.add_observer(move |e: On<AssetRejected>| note(&refused, format!("refused {}:{}", e.file, e.line)));
    app.add_observer(move |e: On<AssetMended>| note(&mended, format!("mended {}", e.file)));
    app.add_observer(move |e: On<WorldRejected>| {
        let place = e.place.as_ref().expect("it is in a file");
        note(&rejected, format!("rejected {}:{}", place.file, place.line));
    });
    app.add_observer(move |_: On<WorldMended>| note(&again, "world mended".into()));
    let save = |app: &mut App, file: &str, text: &str, expected: &str| {
        let file = root.join(file);
        let new = file.with_extension("new");
        std::fs::write(&new, text).expect("written");
        std::fs::rename(new, file).expect("moved");
        run_until(app, expected, |_| log.lock().expect("not poisoned").iter().any(|line| line == expected));
        log.lock().expect("not poisoned").clear();
    };
    let (style, file) = ("sprawl/styles/grid.ron", root.join("sprawl/styles/grid.ron"));
    let good = std::fs::read_to_string(file).expect("the style");
    save(&mut app, style, &format!("({}\n nonsense: 3,\n)", "\n"), "refused sprawl/styles/grid.ron:3");
    save(&mut app, style, &good, "mended sprawl/styles/grid.ron");
    let sets = good.lines().position(|line| line.contains("patch_sets")).expect("it names its patch sets") + 1;
    let missing = good.replacen("\"common\"", "\"uncommon\"", 1);
    save(&mut app, style, &missing, &format!("rejected sprawl/styles/grid.ron:{sets}"));
    assert_eq!(revision(&app), 1);
    save(&mut app, style, &good, "world mended");
    assert_eq!(revision(&app), 1, "it is the world that there was");
    save(&mut app, "wishes.edits.ron", "(nonsense)", "refused wishes.edits.ron:1");
    save(&mut app, "wishes.edits.ron", "()", "mended wishes.edits.ron");
}

#[test]
fn other_sizes_of_caches_remake_nothing() {
    let mut app = app(SprawlPlugin::new(1), AssetPlugin::default());
    app.world_mut().spawn(StreamAnchor { start_on_street: false, ..anchor() });
    settle(&mut app);
    app.add_observer(|event: On<ChunkReady>| panic!("{} is made again", event.coord));
    app.world_mut().resource_mut::<SprawlSource>().settings.cache.chunk_mib = 32.0;
    run_until(&mut app, "there is a new world", |app| app.world().resource::<SprawlWorld>().revision() == 2);
    settle(&mut app);
    assert_eq!(world(&app).settings().cache.chunk_mib, 32.0);
}

#[test]
fn another_seed_replaces_the_world_under_the_player() {
    let mut app = app(SprawlPlugin::new(1), AssetPlugin::default());
    app.world_mut().spawn(StreamAnchor { start_on_street: false, ..anchor() });
    settle(&mut app);
    app.world_mut().resource_mut::<SprawlSource>().seed = Seed(2);
    run_until(&mut app, "there is a new world", |app| app.world().resource::<SprawlWorld>().revision() == 2);
    settle(&mut app);
    assert_eq!(world(&app).seed(), Seed(2));
    assert!(check_chunks(&mut app) >= 4);
    // Settings that make no world are refused, and the last world stays.
    app.world_mut().resource_mut::<SprawlSource>().settings.chunk_size = 500;
    for _ in 0..100 {
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(app.world().resource::<SprawlWorld>().revision(), 2);
    assert!(check_chunks(&mut app) >= 4);
}

/// The entities of all chunks that are there.
fn entities(app: &mut App) -> BTreeMap<[i32; 2], Entity> {
    let mut query = app.world_mut().query_filtered::<(Entity, &ChunkCoord), With<ChunkData>>();
    query.iter(app.world()).map(|(e, c)| (c.0.to_array(), e)).collect()
}

#[test]
fn a_saved_file_of_edits_makes_anew_what_depends_on_it_and_nothing_else() {
    let root = folder("edits");
    let file = root.join("wishes.edits.ron");
    let save = |app: &App, text: &str| {
        std::fs::write(&file, text).expect("written");
        app.world().resource::<AssetServer>().reload("wishes.edits.ron");
    };
    std::fs::write(&file, "()").expect("written");
    let file_path = root.to_string_lossy().into_owned();
    let assets = AssetPlugin { file_path, watch_for_changes_override: Some(false), ..default() };
    let mut app = app(SprawlPlugin::new(42).edits_from("wishes.edits.ron"), assets);
    let refused: Arc<Mutex<Vec<AssetRejected>>> = Arc::default();
    let rejected: Arc<Mutex<Vec<EditRejected>>> = Arc::default();
    let remade: Arc<Mutex<BTreeSet<[i32; 2]>>> = Arc::default();
    let (no, cannot, yes) = (refused.clone(), rejected.clone(), remade.clone());
    app.add_observer(move |event: On<AssetRejected>| no.lock().expect("not poisoned").push(event.clone()));
    app.add_observer(move |event: On<EditRejected>| cannot.lock().expect("not poisoned").push(event.clone()));
    app.add_observer(move |event: On<ChunkReady>| {
        if event.change == ChunkChange::Data {
            yes.lock().expect("not poisoned").insert(event.coord.0.to_array());
        }
    });
    app.add_observer(|event: On<WorldRejected>| panic!("{}", event.error));
    let wide = StreamAnchor { load_radius: 1_600.0, unload_radius: 2_000.0, detail_radius: 1.0, ..default() };
    let player = app.world_mut().spawn(wide).id();
    settle(&mut app);
    let revision = |app: &App| app.world().resource::<SprawlWorld>().revision();
    assert_eq!(revision(&app), 1);
    let there = entities(&mut app);
    assert!(there.len() >= 36, "{}", there.len());
    remade.lock().expect("not poisoned").clear();

    // A mistake is named, and nothing changes.
    save(&app, "(\n settlements: [\n  Ban(at: (0, 0), radius: -5),\n ],\n)");
    run_until(&mut app, "the file is refused", |_| !refused.lock().expect("not poisoned").is_empty());
    let error = refused.lock().expect("not poisoned")[0].clone();
    assert!(error.file.ends_with("wishes.edits.ron") && (error.line, error.column) == (3, 3), "{error:?}");
    assert!(error.reason.contains("radius is -5"), "{error:?}");
    settle(&mut app);
    assert!(world(&app).edits().is_empty() && revision(&app) == 1);

    // Edits far away make another world of the same chunks; one of them cannot be.
    save(
        &app,
        "(\n settlements: [\n  Ban(at: (900000, 0), radius: 5000),\n ],\n roads: [\n  Ban(from: (1e9, 0), to: (0, 0)),\n ],\n)",
    );
    run_until(&mut app, "there is a new world", |app| revision(app) == 2);
    run_until(&mut app, "the edits are looked at", |app| app.world().resource::<RejectedEdits>().revision == 2);
    settle(&mut app);
    let place = rejected.lock().expect("not poisoned")[0].place.clone().expect("it is in a file");
    assert_eq!((place.line, place.column), (6, 3), "{place}");
    assert_eq!(app.world().resource::<RejectedEdits>().edits.len(), 1);
    assert!(remade.lock().expect("not poisoned").is_empty());
    assert_eq!(entities(&mut app), there);
    assert_eq!(check_chunks(&mut app), there.len());

    // A village or town next to the player goes: chunks around it are made anew in their entities, others stay as they are.
    let at = app.world().get::<Transform>(player).expect("it is there").translation;
    let middle = app.world().resource::<SprawlOrigin>().to_plan(at);
    let before = world(&app);
    let shown = bevy_sprawl::space::Bounds::square(middle, 3_000.0);
    let all = before.settlements().overlapping(shown).expect("settlements");
    let small = all.iter().min_by(|a, b| a.radius.total_cmp(&b.radius)).expect("a settlement").centre.plan();
    save(&app, &format!("(settlements: [Ban(at: ({:?}, {:?}), radius: 1)])", small.x, small.y));
    run_until(&mut app, "there is a new world", |app| revision(app) == 3);
    settle(&mut app);
    assert_eq!(entities(&mut app), there);
    assert_eq!(check_chunks(&mut app), there.len());
    assert!(app.world().resource::<SprawlEdits>().file().is_some_and(|f| f.edits == *world(&app).edits()));
    let remade = remade.lock().expect("not poisoned").clone();
    let after = world(&app);
    let chunk = |world: &Sprawled, c: &[i32; 2]| {
        world.chunk(ChunkCoord::new(c[0], c[1]), &Cancel::new()).expect("it can be made")
    };
    let differs = |c: &&[i32; 2]| format!("{:?}", chunk(&before, c)) != format!("{:?}", chunk(&after, c));
    let differing: BTreeSet<[i32; 2]> = there.keys().filter(differs).copied().collect();
    assert!(!differing.is_empty() && differing.is_subset(&remade), "{differing:?} {remade:?}");
    println!("{} chunks there, {} made anew, {} differ", there.len(), remade.len(), differing.len());
}

#[test]
fn a_ground_of_ones_own_is_the_ground_and_can_be_replaced() {
    let raster = |heights: &[u8]| {
        let raster = Raster::from_ascii("own.asc", heights, Band::Height, Holes::Refuse).expect("a raster");
        RasterTerrain::new(raster).expect("a terrain")
    };
    let low = b"ncols 3\nnrows 3\nxllcorner -30000\nyllcorner -30000\ncellsize 20000\n12 14 20\n30 8 11\n10 10 10\n";
    let high = b"ncols 3\nnrows 3\nxllcorner -30000\nyllcorner -30000\ncellsize 20000\n112 114 120\n130 108 111\n110 110 110\n";
    let mut app = app(SprawlPlugin::new(42).terrain(raster(low)), AssetPlugin::default());
    app.world_mut().spawn(anchor());
    settle(&mut app);
    let expected = raster(low).height(DVec2::new(300.0, 200.0));
    assert_eq!(world(&app).terrain().height(DVec2::new(300.0, 200.0)), expected);
    assert!(check_chunks(&mut app) >= 4);
    // The same again is no change; another ground is another world, everywhere.
    let same = app.world().resource::<SprawlSource>().terrain.clone();
    app.world_mut().resource_mut::<SprawlSource>().terrain = same;
    settle(&mut app);
    assert_eq!(app.world().resource::<SprawlWorld>().revision(), 1);
    app.world_mut().resource_mut::<SprawlSource>().terrain = TerrainSource::own(raster(high));
    run_until(&mut app, "there is a new world", |app| app.world().resource::<SprawlWorld>().revision() == 2);
    settle(&mut app);
    let mut query = app.world_mut().query::<&ChunkData>();
    assert!(query.iter(app.world()).all(|c| c.ground.samples.iter().all(|s| s.height > 100.0)));
}
