//! The order of the plugin's systems.

use bevy::asset::AssetEventSystems;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

/// The steps of the plugin in each frame. They are sets of `PostUpdate`, run in this order, and all run before Bevy
/// propagates transforms and passes new meshes on to the renderer. So a game may move its anchors in `Update`, and a chunk is drawn
/// in the frame in which its entity gets its meshes.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SprawlSystems {
    /// Takes up changed assets, edits and settings, and makes a new world from them in the background.
    World,
    /// Reads the places and motions of the anchors. Shifts the origin when they are far from it.
    Anchors,
    /// Decides which chunks are wanted, cancels stale tasks and starts new ones.
    Stream,
    /// Gives finished chunks to their entities and removes unwanted chunks, within the frame's budget.
    Apply,
    /// Reports the figures of the frame.
    Report,
}

/// The steps within [`SprawlSystems::World`], run in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum WorldSystems {
    /// Puts loaded files into the source of the world.
    Load,
    /// Makes the next world, and replaces the current one.
    Regenerate,
    /// Looks for edits that the current world cannot fulfil.
    Check,
}

pub(super) struct SchedulePlugin;

impl Plugin for SchedulePlugin {
    fn build(&self, app: &mut App) {
        use SprawlSystems::{Anchors, Apply, Report, Stream, World};
        use WorldSystems::{Check, Load, Regenerate};
        app.configure_sets(
            PostUpdate,
            // Bevy passes new meshes on to the renderer in the frame in which they come, and not in the next.
            (World, Anchors, Stream, Apply, Report)
                .chain()
                .before(TransformSystems::Propagate)
                .before(AssetEventSystems),
        )
        .configure_sets(PostUpdate, (Load, Regenerate, Check).chain().in_set(World));
    }
}
