//! Sun, sky and haze.

use bevy::camera::Exposure;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::{CascadeShadowConfigBuilder, light_consts::lux};
use bevy::prelude::*;

/// Colour of the sky at the horizon, into which distant things fade.
const HAZE: Color = Color::srgb(0.72, 0.80, 0.88);

/// Distance at which nothing is seen any more, in metres: a little less than what is loaded.
const SIGHT: f32 = 1_450.0;

/// A camera for a clear day.
pub fn camera() -> impl Bundle {
    (
        Camera3d::default(),
        Projection::from(PerspectiveProjection { near: 0.1, far: 6_000.0, fov: 1.1, ..default() }),
        Tonemapping::AcesFitted,
        Exposure { ev100: 14.0 },
        DistanceFog {
            color: HAZE,
            directional_light_color: Color::srgba(1.0, 0.95, 0.8, 0.35),
            directional_light_exponent: 24.0,
            falloff: FogFalloff::from_visibility_squared(SIGHT),
        },
    )
}

/// Sun and sky.
pub fn light(mut commands: Commands) {
    commands.insert_resource(ClearColor(HAZE));
    commands.insert_resource(GlobalAmbientLight {
        color: Color::srgb(0.75, 0.85, 1.0),
        brightness: 9_000.0,
        ..default()
    });
    commands.spawn((
        DirectionalLight { illuminance: lux::DIRECT_SUNLIGHT * 0.7, shadow_maps_enabled: true, ..default() },
        CascadeShadowConfigBuilder { num_cascades: 3, maximum_distance: 300.0, ..default() }.build(),
        Transform::default().looking_to(Vec3::new(0.55, -0.75, -0.45), Vec3::Y),
    ));
}
