//! The smallest program: the plugin, a camera that streams, a sun. With `-- --headless` it needs no display and ends
//! when the first chunk is loaded.
use bevy::{core_pipeline::tonemapping::Tonemapping, prelude::*};
use bevy_sprawl::prelude::*;

fn main() -> AppExit {
    let mut app = App::new();
    if std::env::args().any(|a| a == "--headless") {
        app.add_plugins((MinimalPlugins, AssetPlugin::default())).add_observer(report);
    } else {
        app.add_plugins(DefaultPlugins);
    }
    app.add_plugins(SprawlPlugin::new(42)).add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands) {
    let far = Projection::from(PerspectiveProjection { far: 20_000.0, ..default() });
    commands.spawn((Camera3d::default(), far, Tonemapping::ReinhardLuminance, StreamAnchor::default()));
    commands.spawn((DirectionalLight::default(), Transform::default().looking_to(Vec3::new(1.0, -1.0, -0.5), Vec3::Y)));
}

fn report(ready: On<ChunkReady>, mut commands: Commands) {
    println!("chunk {} is ready", ready.coord);
    commands.write_message(AppExit::Success);
}
