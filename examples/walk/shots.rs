//! Screenshots without a window. The camera draws only for screenshots, since a frame in software takes seconds.

use crate::args::Args;
use crate::headless::Phase;
use crate::tour::{Tour, Tourist, is_loading};
use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy_sprawl::prelude::*;
use std::path::PathBuf;
use std::time::Instant;

/// Size of a screenshot in pixels.
const SIZE: (u32, u32) = (1280, 720);

/// When screenshots are taken, as shares of the walk, and their names.
const MOMENTS: [(f64, &str); 6] =
    [(0.03, "country"), (0.25, "outskirts"), (0.5, "centre"), (0.5, "above"), (0.5, "horizon"), (0.75, "street")];

/// What draws the frames.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draws {
    Not,
    /// A software adapter.
    InSoftware,
    WithCard,
}

impl Draws {
    /// Antialiasing, where it costs little.
    pub fn msaa(self) -> Msaa {
        if self == Self::WithCard { Msaa::Sample4 } else { Msaa::Off }
    }
}

/// Screenshots taken and to be taken.
#[derive(Resource)]
pub struct Shots {
    dir: PathBuf,
    draws: Draws,
    target: Option<Handle<Image>>,
    next: usize,
    waiting: bool,
    since: Option<Instant>,
    /// Where the walker was before it was lifted for a view from above.
    stood: Option<Transform>,
    /// The files that were written.
    pub taken: Vec<PathBuf>,
}

impl Shots {
    pub fn new(args: &Args, draws: Draws) -> Self {
        Self {
            dir: args.screenshots.clone(),
            draws,
            target: None,
            next: 0,
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
    if shots.draws == Draws::Not {
        return;
    }
    let Some(mut images) = images else { return };
    let image = images.add(Image::new_target_texture(SIZE.0, SIZE.1, TextureFormat::Rgba8UnormSrgb, None));
    commands.entity(entity).insert((RenderTarget::Image(image.clone().into()), shots.draws.msaa()));
    shots.target = Some(image);
}

/// For the views from above: how far the camera goes back and up, and how much lower it looks there, in metres.
fn lifted(name: &str) -> Option<(f32, f32, f32)> {
    match name {
        "above" => Some((420.0, 260.0, 260.0)),
        "horizon" => Some((420.0, 160.0, 40.0)),
        _ => None,
    }
}

/// Stands still at the chosen moments and draws one frame. Pipelines are compiled before the frame, so that it shows
/// everything.
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
        shots.since = Some(Instant::now());
        if let Some((back, up, down)) = lifted(name) {
            shots.stood = Some(*transform);
            let (back, stood) = (transform.forward() * -back, transform.translation);
            let eye = stood + Vec3::new(back.x, up, back.z);
            *transform = Transform::from_translation(eye).looking_at(stood + Vec3::Y * (up - down), Vec3::Y);
        }
    }
    if *phase != Phase::Shoot || shots.waiting {
        // The frame with the screenshot has gone to the renderer, so no more frames are drawn.
        camera.is_active = false;
        return;
    }
    let patient = shots.since.is_some_and(|s| s.elapsed().as_secs() < 15);
    if is_loading(&stats) && patient {
        return;
    }
    camera.is_active = true;
    shots.waiting = true;
    let file = shots.dir.join(format!("{}-{name}.png", shots.next + 1));
    commands.spawn(Screenshot::image(target)).observe(save_to_disk(file.clone())).observe(
        move |_: On<ScreenshotCaptured>,
              mut shots: ResMut<Shots>,
              mut phase: ResMut<Phase>,
              mut tourist: Single<&mut Transform, With<Tourist>>| {
            if let Some(stood) = shots.stood.take() {
                **tourist = stood;
            }
            shots.taken.push(file.clone());
            shots.waiting = false;
            shots.next += 1;
            *phase = Phase::Walk;
        },
    );
}
