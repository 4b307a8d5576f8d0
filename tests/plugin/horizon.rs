//! The land beyond the chunks, with the real generator.

use super::*;
use bevy_sprawl::edits::{Edits, SettlementEdit};
use bevy_sprawl::plugin::HorizonTile;

/// The tiles with an entity, each with the vertices of its meshes by part.
fn tiles(app: &mut App) -> BTreeMap<HorizonTile, BTreeMap<&'static str, usize>> {
    let mut query = app.world_mut().query::<(&HorizonTile, Option<&Children>)>();
    let (world, meshes) = (app.world(), app.world().resource::<Assets<Mesh>>());
    let vertices = |part: &Entity| {
        let mesh = meshes.get(&world.get::<Mesh3d>(*part)?.0)?;
        Some((world.get::<ChunkPart>(*part)?.material().name, mesh.count_vertices()))
    };
    let tile = |(tile, parts): (&HorizonTile, Option<&Children>)| {
        (*tile, parts.into_iter().flatten().filter_map(vertices).collect())
    };
    query.iter(world).map(tile).collect()
}

/// Each tile shows what the generator makes.
fn check_tiles(app: &mut App) -> usize {
    let (world, tiles) = (world(app), tiles(app));
    for (tile, shown) in &tiles {
        let made = world.horizon(*tile, &Cancel::new()).expect("it can be made");
        let parts = made.parts().filter(|(_, buffers)| !buffers.indices.is_empty());
        let expected = parts.map(|(part, buffers)| (part.material().name, buffers.positions.len())).collect();
        assert_eq!(*shown, expected, "{tile:?}");
    }
    tiles.values().filter(|parts| parts.contains_key("buildings")).count()
}

#[test]
fn the_land_goes_on_to_the_horizon_and_changes_with_the_world() {
    let streaming = StreamSettings { keep_meshes: true, ..default() };
    let mut app = app(SprawlPlugin { streaming, ..SprawlPlugin::new(42) }, AssetPlugin::default());
    app.init_asset::<Mesh>();
    let player = app.world_mut().spawn(StreamAnchor { horizon: 5_000.0, ..anchor() }).id();
    settle(&mut app);
    let stats = *app.world().resource::<SprawlStats>();
    assert_eq!((stats.tiles_missing, stats.tiles_failed), (0, 0));
    let with_towns = check_tiles(&mut app);
    assert!(stats.tiles_loaded > 16 && with_towns > 0, "{stats:?}");
    println!("{} tiles, {:.2} ms each, {with_towns} pieces with towns", stats.tiles_loaded, stats.tile_ms);

    // Without the towns around, no boxes stand there.
    let at = app.world().get::<Transform>(player).expect("it is there").translation;
    let middle = app.world().resource::<SprawlOrigin>().to_plan(at);
    let ban = SettlementEdit::Ban { at: middle, radius: 30_000.0 };
    app.world_mut().resource_mut::<SprawlSource>().edits = Edits { settlements: vec![ban], ..default() };
    run_until(&mut app, "there is a new world", |app| app.world().resource::<SprawlWorld>().revision() == 2);
    settle(&mut app);
    assert_eq!(check_tiles(&mut app), 0);

    app.world_mut().get_mut::<StreamAnchor>(player).expect("it is there").horizon = 0.0;
    run_until(&mut app, "the tiles are gone", |app| tiles(app).is_empty());
}
