//! The walk in a window, in the first person.

use crate::args::Args;
use crate::shots::Draws;
use crate::{panel, scene};
use bevy::input::mouse::AccumulatedMouseMotion;
use bevy::prelude::*;
use bevy::window::{CursorGrabMode, CursorOptions, PrimaryWindow};
use bevy_egui::{EguiPlugin, EguiPrimaryContextPass, input::EguiWantsInput};
use bevy_sprawl::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// Height of the eyes over the ground, in metres.
const EYES: f32 = 1.7;

/// The walker, with the camera as its eyes.
#[derive(Component, Default)]
pub struct Walker {
    yaw: f32,
    pitch: f32,
    /// Whether the walker flies.
    pub flies: bool,
    started: bool,
}

/// How far the land is seen, in metres.
#[derive(Resource)]
struct Horizon(f32);

/// Opens the window and runs until it is closed.
pub fn window(args: Args, draws: Draws) -> AppExit {
    let mut window = Window { title: "bevy_sprawl".into(), ..default() };
    if draws == Draws::InSoftware {
        println!("There is no graphics card: a small window, and few frames a second.");
        window.resolution = (640, 360).into();
    }
    App::new()
        .add_plugins(DefaultPlugins.set(WindowPlugin { primary_window: Some(window), ..default() }))
        .add_plugins(EguiPlugin::default())
        .add_plugins(SprawlPlugin::new(args.seed).starting_at(args.at))
        .insert_resource(panel::Begin(args.at))
        .insert_resource(draws)
        .insert_resource(Horizon(args.horizon))
        .add_observer(panel::begun)
        .add_systems(Startup, (scene::light, spawn, panel::setup))
        .add_systems(Update, (panel::begin, grab_mouse, look, walk, scene::keep_sky).chain())
        .add_systems(EguiPrimaryContextPass, panel::show)
        .run()
}

fn spawn(mut commands: Commands, draws: Res<Draws>, horizon: Res<Horizon>) {
    let anchor = StreamAnchor { start_on_street: false, horizon: horizon.0, ..default() };
    commands.spawn((Walker::default(), anchor, scene::camera(horizon.0), draws.msaa(), Transform::default()));
}

impl Walker {
    /// Stands still until [`Walker::begin_at`].
    pub fn wait(&mut self) {
        self.started = false;
    }

    /// Takes the heading of a transform that was set from outside, and may walk.
    pub fn begin_at(&mut self, transform: &Transform) {
        let (yaw, pitch, _) = transform.rotation.to_euler(EulerRot::YXZ);
        (self.yaw, self.pitch, self.started) = (yaw, pitch, true);
    }
}

/// A click catches the mouse; Esc frees it.
fn grab_mouse(
    mut cursor: Single<&mut CursorOptions, With<PrimaryWindow>>,
    mouse: Res<ButtonInput<MouseButton>>,
    keys: Res<ButtonInput<KeyCode>>,
    egui: Res<EguiWantsInput>,
) {
    let grab = if keys.just_pressed(KeyCode::Escape) {
        false
    } else if mouse.just_pressed(MouseButton::Left) && !egui.is_pointer_over_area() {
        true
    } else {
        return;
    };
    cursor.visible = !grab;
    cursor.grab_mode = if grab { CursorGrabMode::Locked } else { CursorGrabMode::None };
}

fn look(
    cursor: Single<&CursorOptions, With<PrimaryWindow>>,
    motion: Res<AccumulatedMouseMotion>,
    walker: Single<(&mut Walker, &mut Transform)>,
) {
    let (mut walker, mut transform) = walker.into_inner();
    if cursor.grab_mode != CursorGrabMode::None {
        let turn = motion.delta * 0.0025;
        walker.yaw -= turn.x;
        walker.pitch = (walker.pitch - turn.y).clamp(-FRAC_PI_2 + 0.02, FRAC_PI_2 - 0.02);
    }
    transform.rotation = Quat::from_euler(EulerRot::YXZ, walker.yaw, walker.pitch, 0.0);
}

fn walk(
    time: Res<Time>,
    keys: Res<ButtonInput<KeyCode>>,
    egui: Res<EguiWantsInput>,
    sprawl: Sprawl,
    walker: Single<(&mut Walker, &mut Transform)>,
) {
    let (mut walker, mut transform) = walker.into_inner();
    if !walker.started || egui.wants_keyboard_input() {
        return;
    }
    if keys.just_pressed(KeyCode::KeyF) {
        walker.flies = !walker.flies;
    }
    let axis = |plus: [KeyCode; 2], minus: [KeyCode; 2]| {
        f32::from(u8::from(keys.any_pressed(plus))) - f32::from(u8::from(keys.any_pressed(minus)))
    };
    let ahead = axis([KeyCode::KeyW, KeyCode::ArrowUp], [KeyCode::KeyS, KeyCode::ArrowDown]);
    let aside = axis([KeyCode::KeyD, KeyCode::ArrowRight], [KeyCode::KeyA, KeyCode::ArrowLeft]);
    let up = axis([KeyCode::Space, KeyCode::KeyE], [KeyCode::ControlLeft, KeyCode::KeyQ]);
    let runs = keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    if walker.flies {
        let speed = if runs { 120.0 } else { 30.0 };
        let direction = transform.forward() * ahead + transform.right() * aside + Vec3::Y * up;
        transform.translation += direction.normalize_or_zero() * speed * time.delta_secs();
    } else {
        let speed = if runs { 9.0 } else { 3.0 };
        let direction = Quat::from_rotation_y(walker.yaw) * Vec3::new(aside, 0.0, -ahead);
        transform.translation += direction.normalize_or_zero() * speed * time.delta_secs();
    }
    // The eyes follow the ground with a delay, so that kerbs do not jolt.
    let Some(ground) = sprawl.height(transform.translation) else { return };
    let eyes = ground + EYES;
    if walker.flies {
        transform.translation.y = transform.translation.y.max(eyes);
    } else {
        let share = (12.0 * time.delta_secs()).min(1.0);
        transform.translation.y += (eyes - transform.translation.y) * share;
    }
}
