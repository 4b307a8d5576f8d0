//! Streaming: which chunks and tiles of the horizon are wanted, the tasks that make them, and giving the results to entities within
//! a budget.
//!
//! | file | has |
//! |---|---|
//! | `generator` | the maker of chunks and meshes: the world, or a stand-in in tests |
//! | `build`, `job` | what tasks make; a task in flight |
//! | `entry`, `index` | what is known about each chunk that has an entity |
//! | `wanted`, `plan` | which chunks the anchors want, and spawning and despawning their entities |
//! | `scheduler` | the tasks in flight |
//! | `apply`, `parts` | giving finished chunks to their entities, and removing unwanted chunks |
//! | `horizon` | the same for tiles of the horizon, and which of them are shown |
//! | `replace` | going over to another world |

mod apply;
mod build;
mod entry;
mod generator;
mod horizon;
mod index;
mod job;
mod parts;
mod plan;
mod replace;
mod scheduler;
#[cfg(test)]
mod tests;
mod wanted;

pub(super) use horizon::Horizon;
pub(super) use index::ChunkIndex;
pub(super) use replace::{Stale, Streaming};
pub(super) use scheduler::Scheduler;

use super::schedule::SprawlSystems;
use super::stream_settings::StreamSettings;
use bevy::prelude::*;

pub(super) struct StreamingPlugin {
    pub settings: StreamSettings,
}

impl Plugin for StreamingPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.settings.clone())
            .init_resource::<ChunkIndex>()
            .init_resource::<Horizon>()
            .init_resource::<Scheduler>()
            .init_resource::<plan::Planned>()
            .register_type::<StreamSettings>()
            .add_systems(
                PostUpdate,
                (plan::notice_despawned, plan::plan_chunks, scheduler::run_tasks).chain().in_set(SprawlSystems::Stream),
            )
            .add_systems(PostUpdate, apply::apply_finished.in_set(SprawlSystems::Apply));
    }
}
