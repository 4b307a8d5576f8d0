//! Balls that roll down a street, over the borders of chunks, with the physics engine Avian: `cargo run --example physics --features
//! avian`. With `-- --headless` it needs no display, ends after half a minute of the balls' time, and fails if one falls through.
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_sprawl::prelude::*;
use std::time::Duration;

/// Number of balls, their radius in metres, and how far they lie apart.
const BALLS: u32 = 200;
const RADIUS: f32 = 0.3;
const APART: f32 = 3.0;

/// How far below the ground the middle of a ball lies, in metres, when it has fallen through.
const BELOW: f32 = 0.5;

/// Frames that a headless run lasts once the balls are there, 60 for each second of the balls' time.
const FRAMES: u32 = 1800;

fn main() -> AppExit {
    let mut app = App::new();
    let headless = std::env::args().any(|a| a == "--headless");
    if headless {
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 60.0)))
            .add_systems(Last, judge);
    } else {
        app.add_plugins(DefaultPlugins).add_systems(Update, follow);
    }
    let mut plugin = SprawlPlugin::new(42);
    plugin.streaming.collision = true;
    app.add_plugins((plugin, PhysicsPlugins::default())).add_systems(Startup, setup).add_systems(Update, drop).run()
}

#[derive(Component)]
struct Ball;

fn setup(mut commands: Commands) {
    let far = Projection::from(PerspectiveProjection { far: 20_000.0, ..default() });
    commands.spawn((Camera3d::default(), far, StreamAnchor::default()));
    commands.spawn((DirectionalLight::default(), Transform::default().looking_to(Vec3::new(1.0, -1.0, -0.5), Vec3::Y)));
}

/// Drops all balls on the border of two chunks near the camera, once the ground there is solid.
fn drop(
    mut commands: Commands,
    sprawl: Sprawl,
    camera: Single<&Transform, With<StreamAnchor>>,
    solid: Query<(), With<ChunkCollision>>,
    balls: Query<(), With<Ball>>,
    meshes: Option<ResMut<Assets<Mesh>>>,
    materials: Option<ResMut<Assets<StandardMaterial>>>,
) {
    if solid.iter().count() < 9 || !balls.is_empty() {
        return;
    }
    let look = meshes.zip(materials).map(|(mut meshes, mut materials)| {
        let red = StandardMaterial::from(Color::srgb(0.8, 0.1, 0.1));
        (Mesh3d(meshes.add(Sphere::new(RADIUS))), MeshMaterial3d(materials.add(red)))
    });
    let Some(world) = sprawl.world() else { return };
    // Bevy's origin is a corner of a chunk.
    let size = world.settings().chunk_size as f32;
    let middle = camera.translation.with_x((camera.translation.x / size).round() * size);
    for i in 0..BALLS {
        let by = Vec2::from_angle(i as f32 * 2.4) * APART * (i as f32).sqrt();
        let at = middle + Vec3::new(by.x, 0.0, by.y);
        let Some(ground) = sprawl.surface_at(at) else { continue };
        let at = Transform::from_translation(at.with_y(ground.height as f32 + 2.0));
        let mut ball = commands.spawn((Ball, at, RigidBody::Dynamic, Collider::sphere(RADIUS)));
        ball.insert((Friction::new(0.3), AngularVelocity(Vec3::new(by.y, 0.0, -by.x).normalize_or_zero() * 30.0)));
        if let Some(look) = &look {
            ball.insert(look.clone());
        }
    }
}

/// Looks at the balls from behind.
fn follow(
    mut camera: Single<&mut Transform, (With<StreamAnchor>, Without<Ball>)>,
    balls: Query<&Transform, With<Ball>>,
) {
    let Some(first) = balls.iter().next() else { return };
    let eye = first.translation + Vec3::new(-12.0, 7.0, 12.0);
    **camera = Transform::from_translation(camera.translation.lerp(eye, 0.05)).looking_at(first.translation, Vec3::Y);
}

/// Counts the frames, and ends the run.
fn judge(mut commands: Commands, mut frames: Local<u32>, sprawl: Sprawl, balls: Query<&Transform, With<Ball>>) {
    if balls.is_empty() {
        return;
    }
    *frames += 1;
    let below = |at: &&Transform| {
        sprawl.surface_at(at.translation).is_some_and(|ground| at.translation.y < ground.height as f32 - BELOW)
    };
    let fallen = balls.iter().filter(below).count();
    if fallen > 0 {
        println!("{fallen} balls of {} fell through the ground", balls.iter().count());
        commands.write_message(AppExit::error());
    } else if *frames == FRAMES {
        println!("{} balls rolled for {} s, and none fell through", balls.iter().count(), FRAMES / 60);
        commands.write_message(AppExit::Success);
    }
}
