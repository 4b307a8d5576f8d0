//! Sun, sky and haze.

use bevy::asset::RenderAssetUsages;
use bevy::camera::Exposure;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::{CascadeShadowConfigBuilder, DirectionalLightShadowMap, NotShadowCaster, NotShadowReceiver};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_sprawl::prelude::*;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Colour of the air at the horizon, into which distant things fade.
const HAZE: Color = Color::srgb(0.80, 0.87, 0.93);

/// Colour of the sky overhead.
const ZENITH: Color = Color::srgb(0.30, 0.52, 0.82);

/// Haze hides everything beyond the horizon; without a horizon, beyond this distance in metres, which is about the load radius.
const LEAST_SIGHT: f32 = 1_300.0;

/// Density of the haze times the distance that it hides: one part in a hundred is left there.
const HIDDEN: f32 = 2.15;

/// Radius of the dome of the sky, in metres. It is larger than any horizon, with the tiles that reach beyond it.
const DOME: f32 = 90_000.0;

/// The direction of sunlight.
const SUN: Vec3 = Vec3::new(0.55, -0.75, -0.45);

/// A camera for a clear day, which sees `horizon` metres far.
pub fn camera(horizon: f32) -> impl Bundle {
    let density = HIDDEN / horizon.max(LEAST_SIGHT);
    (
        Camera3d::default(),
        Projection::from(PerspectiveProjection { near: 0.1, far: DOME, fov: 1.0, ..default() }),
        Tonemapping::None,
        Exposure { ev100: 13.8 },
        DistanceFog { color: HAZE, falloff: FogFalloff::ExponentialSquared { density }, ..default() },
    )
}

/// The dome of the sky, which stays around the camera.
#[derive(Component)]
pub struct Sky;

/// Sun and sky.
pub fn light(
    mut commands: Commands,
    meshes: Option<ResMut<Assets<Mesh>>>,
    materials: Option<ResMut<Assets<StandardMaterial>>>,
) {
    commands.insert_resource(ClearColor(HAZE));
    commands.insert_resource(DirectionalLightShadowMap { size: 2048 });
    commands.insert_resource(GlobalAmbientLight {
        color: Color::srgb(0.86, 0.92, 1.0),
        brightness: 9_000.0,
        ..default()
    });
    commands.spawn((
        DirectionalLight { illuminance: 60_000.0, shadow_maps_enabled: true, shadow_normal_bias: 0.7, ..default() },
        CascadeShadowConfigBuilder {
            num_cascades: 3,
            first_cascade_far_bound: 18.0,
            maximum_distance: 280.0,
            ..default()
        }
        .build(),
        Transform::default().looking_to(SUN, Vec3::Y),
    ));
    // Light from the sky opposite the sun shapes walls in the shade.
    commands.spawn((
        DirectionalLight { illuminance: 9_000.0, color: Color::srgb(0.8, 0.9, 1.0), ..default() },
        Transform::default().looking_to(Vec3::new(-SUN.x, -0.9, -SUN.z + 0.4), Vec3::Y),
    ));
    let (Some(mut meshes), Some(mut materials)) = (meshes, materials) else { return };
    let material = StandardMaterial { unlit: true, fog_enabled: false, cull_mode: None, ..default() };
    commands.spawn((
        Sky,
        Mesh3d(meshes.add(dome(DOME))),
        MeshMaterial3d(materials.add(material)),
        (NotShadowCaster, NotShadowReceiver, NoFrustumCulling),
    ));
}

/// Keeps the sky around the camera.
pub fn keep_sky(
    camera: Single<&Transform, (With<StreamAnchor>, Without<Sky>)>,
    mut sky: Query<&mut Transform, With<Sky>>,
) {
    for mut sky in &mut sky {
        sky.translation = camera.translation;
    }
}

/// A dome with the colour of haze from a little over the horizon downwards.
fn dome(radius: f32) -> Mesh {
    const RINGS: u32 = 12;
    const SIDES: u32 = 32;
    let (haze, zenith) = (HAZE.to_linear(), ZENITH.to_linear());
    let (mut positions, mut colours, mut indices) = (vec![], vec![], vec![]);
    for ring in 0..=RINGS {
        let height = -0.35 + (FRAC_PI_2 + 0.35) * ring as f32 / RINGS as f32;
        let share = ((height - 0.03) / 0.9).clamp(0.0, 1.0).sqrt();
        for side in 0..SIDES {
            let Vec2 { x: out, y } = Vec2::from_angle(height);
            let Vec2 { x, y: z } = Vec2::from_angle(side as f32 / SIDES as f32 * TAU);
            positions.push((Vec3::new(x * out, y, z * out) * radius).to_array());
            colours.push(haze.mix(&zenith, share).to_f32_array());
            if ring < RINGS {
                let [a, b] = [ring * SIDES + side, ring * SIDES + (side + 1) % SIDES];
                indices.extend([a, b, a + SIDES, b, b + SIDES, a + SIDES]);
            }
        }
    }
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, -1.0, 0.0]; positions.len()])
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colours)
        .with_inserted_indices(Indices::U32(indices))
}
