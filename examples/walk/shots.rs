//! Screenshots without a window. The camera draws only for these: in software a frame takes a good part of a second.

use crate::args::Args;
use crate::headless::Phase;
use crate::tour::{Tour, Tourist};
use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy_sprawl::prelude::*;
use std::path::PathBuf;
use std::time::Instant;

/// Size of a screenshot in pixels.
const SIZE: (u32, u32) = (1280, 720);

/// When screenshots are taken, as shares of the walk, and what they are called.
const MOMENTS: [(f64, &str); 5] =
    [(0.02, "country"), (0.25, "outskirts"), (0.5, "centre"), (0.5, "above"), (0.75, "street")];

/// Frames that are drawn before the one that is kept: pipelines are compiled and meshes uploaded meanwhile.
const WARM_UP: u32 = 4;

/// Frames drawn before the first screenshot of all, which waits for every pipeline.
const FIRST_WARM_UP: u32 = 12;

/// Screenshots taken and to be taken.
#[derive(Resource)]
pub struct Shots {
    dir: PathBuf,
    draws: bool,
    target: Option<Handle<Image>>,
    next: usize,
    frames: u32,
    waiting: bool,
    since: Option<Instant>,
    /// Where the walker was before it was lifted for a view from above.
    stood: Option<Transform>,
    /// Files written.
    pub taken: Vec<PathBuf>,
}

impl Shots {
    pub fn new(args: &Args, draws: bool) -> Self {
        Self {
            dir: args.screenshots.clone(),
            draws,
            target: None,
            next: 0,
            frames: 0,
            waiting: false,
            since: None,
            stood: None,
            taken: Vec::new(),
        }
    }
}

/// Lets the walker's camera draw into an image, later.
pub fn setup(
    mut commands: Commands,
    mut shots: ResMut<Shots>,
    images: Option<ResMut<Assets<Image>>>,
    tourist: Single<(Entity, &mut Camera), With<Tourist>>,
) {
    let (entity, mut camera) = tourist.into_inner();
    camera.is_active = false;
    let (true, Some(mut images)) = (shots.draws, images) else { return };
    let image = images.add(Image::new_target_texture(SIZE.0, SIZE.1, TextureFormat::Rgba8UnormSrgb, None));
    commands.entity(entity).insert(RenderTarget::Image(image.clone().into()));
    shots.target = Some(image);
}

/// Stands still at the chosen moments, draws a few frames, and keeps the last.
pub fn shoot(
    mut commands: Commands,
    mut phase: ResMut<Phase>,
    mut shots: ResMut<Shots>,
    tour: Res<Tour>,
    stats: Res<SprawlStats>,
    tourist: Single<(&mut Camera, &mut Transform), With<Tourist>>,
) {
    let Some(target) = shots.target.clone() else { return };
    let (mut camera, mut transform) = tourist.into_inner();
    let Some((share, name)) = MOMENTS.get(shots.next).copied() else { return };
    if *phase == Phase::Walk && tour.share() >= share {
        *phase = Phase::Shoot;
        shots.frames = 0;
        shots.since = Some(Instant::now());
        if name == "above" {
            shots.stood = Some(*transform);
            let back = transform.forward() * -420.0;
            let eye = transform.translation + Vec3::new(back.x, 260.0, back.z);
            *transform = Transform::from_translation(eye).looking_at(transform.translation, Vec3::Y);
        }
    }
    if *phase != Phase::Shoot || shots.waiting {
        return;
    }
    let patient = shots.since.is_some_and(|s| s.elapsed().as_secs() < 15);
    if (stats.chunks_missing > 0 || stats.tasks_in_flight > 0) && patient {
        return;
    }
    camera.is_active = true;
    shots.frames += 1;
    let warm_up = if shots.next == 0 { FIRST_WARM_UP } else { WARM_UP };
    if shots.frames > warm_up {
        shots.waiting = true;
        let file = shots.dir.join(format!("{}-{name}.png", shots.next + 1));
        commands.spawn(Screenshot::image(target)).observe(save_to_disk(file.clone())).observe(
            move |_: On<ScreenshotCaptured>,
                  mut shots: ResMut<Shots>,
                  mut phase: ResMut<Phase>,
                  tourist: Single<(&mut Camera, &mut Transform), With<Tourist>>| {
                let (mut camera, mut transform) = tourist.into_inner();
                camera.is_active = false;
                if let Some(stood) = shots.stood.take() {
                    *transform = stood;
                }
                shots.taken.push(file.clone());
                shots.waiting = false;
                shots.next += 1;
                *phase = Phase::Walk;
            },
        );
    }
}
