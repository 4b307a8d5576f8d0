//! The order of the plugin's systems.

use bevy::prelude::*;
use bevy::transform::TransformSystems;

/// What the plugin does each frame: sets in `PostUpdate`, in this order, all before Bevy propagates transforms. So
/// anchors may move in `Update`, and a chunk that is applied is drawn in the same frame.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SprawlSystems {
    /// Takes up changed assets and settings, and makes a new world from them in the background.
    World,
    /// Reads where anchors are and how they move, and shifts the origin when they are far from it.
    Anchors,
    /// Decides which chunks are wanted, cancels stale work, starts new work.
    Stream,
    /// Turns finished work into entities and removes those that are not wanted, within the frame's budget.
    Apply,
    /// Measures.
    Report,
}

pub(super) struct SchedulePlugin;

impl Plugin for SchedulePlugin {
    fn build(&self, app: &mut App) {
        use SprawlSystems::{Anchors, Apply, Report, Stream, World};
        app.configure_sets(
            PostUpdate,
            (World, Anchors, Stream, Apply, Report).chain().before(TransformSystems::Propagate),
        );
    }
}
