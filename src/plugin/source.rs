//! What the world is made from, the world that is streamed, and replacing one with the next.

use super::schedule::SprawlSystems;
use super::streaming::{Dirty, Streaming};
use crate::layer::{Cancel, LayerError};
use crate::region::{Edits, Settlement};
use crate::space::{Bounds, ChunkCoord, Seed};
use crate::world::{Settings, World, WorldAssets, WorldError};
use bevy::prelude::{
    App, Commands, DetectChanges, Event, IntoScheduleConfigs, Message, MessageWriter, Plugin, PostUpdate, Res, ResMut,
    Resource, error, warn,
};
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What the world is made from. Change it at any time: the next world is made in the background, and chunks that differ
/// are replaced one by one.
#[derive(Resource, Clone, Debug)]
pub struct SprawlSource {
    /// The seed.
    pub seed: Seed,
    /// Settings of the generator. Another chunk size unloads every chunk at once.
    pub settings: Settings,
    /// Styles and patch sets.
    pub assets: WorldAssets,
    /// Wishes for settlements and roads. Those that the world cannot fulfil are logged; it goes on without them.
    pub edits: Edits,
}

/// The world that is streamed.
#[derive(Resource, Default)]
pub struct SprawlWorld {
    world: Option<World>,
    revision: u32,
}

impl SprawlWorld {
    /// The generator; `None` until it has been made (assets from a folder are loaded first).
    pub fn get(&self) -> Option<&World> {
        self.world.as_ref()
    }

    /// Number of worlds so far: it grows when assets, settings or seed have changed.
    pub fn revision(&self) -> u32 {
        self.revision
    }
}

/// There is a new world, the first one included. Sent as a message and as an event, before its chunks are there.
#[derive(Message, Event, Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorldChanged {
    /// [`SprawlWorld::revision`].
    pub revision: u32,
}

/// No world can be made from the [`SprawlSource`]; the last one stays. Sent as a message and as an event.
#[derive(Message, Event, Clone, Debug, PartialEq)]
pub struct WorldRejected {
    /// Why.
    pub error: WorldError,
}

pub(super) struct SourcePlugin {
    /// Whether the first world waits until assets have been loaded from a folder.
    pub wait_for_assets: bool,
}

impl Plugin for SourcePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Settings>()
            .init_resource::<SprawlWorld>()
            .insert_resource(Making { hold: self.wait_for_assets, task: None, wanted: false })
            .add_message::<WorldChanged>()
            .add_message::<WorldRejected>()
            .add_systems(PostUpdate, (start_making, finish_making).chain().in_set(SprawlSystems::World));
        if self.wait_for_assets {
            return;
        }
        // The first world is made at once, so that systems in `Startup` can ask it where to put the player.
        let source = app.world().resource::<SprawlSource>().clone();
        match World::with_edits(source.seed, source.settings, source.assets, source.edits) {
            Ok(made) => {
                tell_rejected(made.clone());
                app.world_mut().resource_mut::<Streaming>().replace(&made, Dirty::All);
                app.insert_resource(SprawlWorld { world: Some(made), revision: 1 });
                app.world_mut().write_message(WorldChanged { revision: 1 });
            }
            Err(error) => {
                error!("no world can be made: {error}");
                app.world_mut().write_message(WorldRejected { error });
            }
        }
    }
}

/// The next world, while it is made.
#[derive(Resource)]
pub(super) struct Making {
    /// Nothing is made while this is set.
    pub hold: bool,
    task: Option<Task<Result<(World, Dirty), WorldError>>>,
    wanted: bool,
}

/// Several changes while a world is being made lead to one more world after it.
pub(super) fn start_making(
    source: Res<SprawlSource>,
    current: Res<SprawlWorld>,
    streaming: Res<Streaming>,
    mut making: ResMut<Making>,
) {
    making.wanted |= source.is_changed();
    if !making.wanted || making.hold || making.task.is_some() {
        return;
    }
    making.wanted = false;
    let source = source.clone();
    let old = current.world.clone();
    if old.as_ref().is_some_and(|old| matches!(difference(old, &source), Difference::None)) {
        return;
    }
    let loaded = streaming.settlements();
    making.task = Some(AsyncComputeTaskPool::get().spawn(async move {
        let change = old.map_or(Difference::All, |old| difference(&old, &source));
        let made = World::with_edits(source.seed, source.settings, source.assets, source.edits)?;
        let dirty = match change {
            Difference::All => Dirty::All,
            Difference::Styles(styles) => touched(&made, &styles, loaded),
            Difference::None => Dirty::Chunks(BTreeSet::new()),
        };
        Ok((made, dirty))
    }));
}

fn finish_making(
    mut commands: Commands,
    mut making: ResMut<Making>,
    mut current: ResMut<SprawlWorld>,
    mut streaming: ResMut<Streaming>,
    mut changed: MessageWriter<WorldChanged>,
    mut rejected: MessageWriter<WorldRejected>,
) {
    let Some(result) = making.task.as_mut().and_then(check_ready) else { return };
    making.task = None;
    match result {
        Ok((made, dirty)) => {
            tell_rejected(made.clone());
            streaming.replace(&made, dirty);
            current.world = Some(made);
            current.revision += 1;
            let event = WorldChanged { revision: current.revision };
            changed.write(event);
            commands.trigger(event);
        }
        Err(error) => {
            error!("the changed assets or settings make no world, the last one stays: {error}");
            let event = WorldRejected { error };
            rejected.write(event.clone());
            commands.trigger(event);
        }
    }
}

/// Logs the edits that a world cannot fulfil, in the background: it takes the roads that they are about.
fn tell_rejected(world: World) {
    if *world.edits() == Edits::default() {
        return;
    }
    let tell = async move {
        for edit in world.rejected_edits(&Cancel::new()).unwrap_or_default() {
            warn!("{edit}");
        }
    };
    if let Some(pool) = AsyncComputeTaskPool::try_get() {
        pool.spawn(tell).detach();
    }
}

/// What differs between a world and what the next one is to be made from.
#[derive(Debug, PartialEq)]
enum Difference {
    None,
    /// The styles with these names, or patch sets that they use.
    Styles(BTreeSet<String>),
    All,
}

fn difference(old: &World, new: &SprawlSource) -> Difference {
    if old.seed() != new.seed || *old.settings() != new.settings || *old.edits() != new.edits {
        return Difference::All;
    }
    let (before, after) = (old.assets(), &new.assets);
    // A settlement's style is chosen among the names that the settings list, so names alone change nothing; but a style
    // that has gone or come is treated as everything: it happens while assets are being written, not while a game is
    // played.
    if !before.styles.keys().eq(after.styles.keys()) {
        return Difference::All;
    }
    let sets = differing(&before.patch_sets, &after.patch_sets);
    let mut styles = differing(&before.styles, &after.styles);
    styles.extend(
        after.styles.iter().filter(|(_, s)| s.patch_sets.iter().any(|p| sets.contains(p))).map(|(n, _)| n.clone()),
    );
    if styles.is_empty() && sets.is_empty() { Difference::None } else { Difference::Styles(styles) }
}

/// Names whose value is not the same in both maps.
fn differing<T: PartialEq>(a: &BTreeMap<String, Arc<T>>, b: &BTreeMap<String, Arc<T>>) -> BTreeSet<String> {
    let same = |x: &Arc<T>, y: &Arc<T>| Arc::ptr_eq(x, y) || x == y;
    let names = a.keys().chain(b.keys());
    let differs = |name: &&String| !matches!((a.get(*name), b.get(*name)), (Some(x), Some(y)) if same(x, y));
    names.filter(differs).cloned().collect()
}

/// The loaded chunks that show a settlement of one of the styles, or one that touches such a settlement: a main street
/// that two towns share has ports from the styles of both.
fn touched(world: &World, styles: &BTreeSet<String>, loaded: Vec<(ChunkCoord, Vec<Arc<Settlement>>)>) -> Dirty {
    let mut known: BTreeMap<_, bool> = BTreeMap::new();
    let mut is_touched = |settlement: &Settlement| -> Result<bool, LayerError> {
        if let Some(known) = known.get(&settlement.id) {
            return Ok(*known);
        }
        let around = Bounds::square(settlement.centre.plan(), settlement.radius * 2.0);
        let near = world.settlements().overlapping(around)?;
        let touched = styles.contains(&settlement.style) || near.iter().any(|s| styles.contains(&s.style));
        known.insert(settlement.id, touched);
        Ok(touched)
    };
    let mut dirty = BTreeSet::new();
    for (coord, settlements) in loaded {
        for settlement in settlements {
            match is_touched(&settlement) {
                Ok(false) => {}
                Ok(true) => {
                    dirty.insert(coord);
                }
                Err(_) => return Dirty::All,
            }
        }
    }
    Dirty::Chunks(dirty)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::town::Style;

    #[test]
    fn what_differs_is_found_by_value() {
        let one = || Arc::new(Style::default());
        let mut other = Style::default();
        other.main.length += 1.0;
        let a = BTreeMap::from([("x".to_owned(), one()), ("y".to_owned(), one())]);
        let b = BTreeMap::from([("x".to_owned(), one()), ("y".to_owned(), Arc::new(other)), ("z".to_owned(), one())]);
        assert!(differing(&a, &a.clone()).is_empty());
        assert_eq!(differing(&a, &b).into_iter().collect::<Vec<_>>(), ["y", "z"]);
    }
}
