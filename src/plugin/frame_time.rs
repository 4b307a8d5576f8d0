//! How much of a frame's time the plugin takes.

use bevy::ecs::system::SystemParam;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use std::time::Duration;

/// Time that the plugin's systems have taken in this frame.
#[derive(Resource, Default)]
pub(super) struct FrameTime {
    /// All systems together.
    pub total: Duration,
    /// Applying and removing chunks alone.
    pub apply: Duration,
}

/// Measures the system that has it as a parameter.
#[derive(SystemParam)]
pub(super) struct Stopwatch<'w> {
    time: ResMut<'w, FrameTime>,
}

impl Stopwatch<'_> {
    /// Counts the time until the returned guard is dropped.
    #[must_use]
    pub fn start(&mut self) -> Running<'_> {
        Running { total: &mut self.time.total, start: Instant::now() }
    }

    /// Takes the time of the frame, and begins the next one.
    pub fn take(&mut self) -> FrameTime {
        std::mem::take(&mut *self.time)
    }
}

/// A measurement that ends when it is dropped.
pub(super) struct Running<'a> {
    total: &'a mut Duration,
    start: Instant,
}

impl Drop for Running<'_> {
    fn drop(&mut self) {
        *self.total += self.start.elapsed();
    }
}

/// Runs `queue`, and counts the time in which the commands that it queues are applied.
pub(super) fn measure_commands(commands: &mut Commands, queue: impl FnOnce(&mut Commands)) {
    commands.queue(|world: &mut World| world.resource_mut::<CommandsStart>().0 = Some(Instant::now()));
    queue(commands);
    commands.queue(|world: &mut World| {
        if let Some(start) = world.resource_mut::<CommandsStart>().0.take() {
            world.resource_mut::<FrameTime>().total += start.elapsed();
        }
    });
}

/// When the application of the measured commands began.
#[derive(Resource, Default)]
struct CommandsStart(Option<Instant>);

pub(super) struct FrameTimePlugin;

impl Plugin for FrameTimePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<FrameTime>().init_resource::<CommandsStart>();
    }
}
