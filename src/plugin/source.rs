//! What the world is made from, the world that is streamed, and replacing one with the next.

use super::schedule::SprawlSystems;
use super::streaming::{Dirty, Streaming};
use crate::edits::Edits;
use crate::layer::{Cancel, LayerError};
use crate::region::Settlement;
use crate::space::{Bounds, ChunkCoord, Seed};
use crate::world::{Settings, TerrainSource, World, WorldError, WorldSource};
use bevy::prelude::{
    App, Commands, Deref, DerefMut, DetectChanges, Event, IntoScheduleConfigs, Message, MessageWriter, Plugin,
    PostUpdate, Res, ResMut, Resource, error,
};
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What the world is made from. Change it at any time: the next world is made in the background, and chunks that differ
/// are replaced one by one. Another chunk size unloads every chunk at once.
#[derive(Resource, Clone, Debug, Deref, DerefMut)]
pub struct SprawlSource(pub WorldSource);

impl SprawlSource {
    fn make(&self) -> Result<World, WorldError> {
        World::new(self.0.clone())
    }
}

/// The world that is streamed.
#[derive(Resource, Default)]
pub struct SprawlWorld {
    world: Option<World>,
    terrain: TerrainSource,
    revision: u32,
}

impl SprawlWorld {
    /// The generator; `None` until it has been made (assets from a folder are loaded first).
    pub fn get(&self) -> Option<&World> {
        self.world.as_ref()
    }

    /// Number of worlds so far: it grows when anything in the [`SprawlSource`] has changed.
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
    pub hold_assets: bool,
    /// Whether it waits until edits have been loaded from a file.
    pub hold_edits: bool,
}

impl Plugin for SourcePlugin {
    fn build(&self, app: &mut App) {
        let (hold_assets, hold_edits) = (self.hold_assets, self.hold_edits);
        app.register_type::<Settings>()
            .register_type::<Edits>()
            .init_resource::<SprawlWorld>()
            .insert_resource(Making { hold_assets, hold_edits, task: None, wanted: false })
            .add_message::<WorldChanged>()
            .add_message::<WorldRejected>()
            .add_systems(PostUpdate, (start_making, finish_making).chain().in_set(SprawlSystems::World));
        if hold_assets || hold_edits {
            return;
        }
        // The first world is made at once, so that systems in `Startup` can ask it where to put the player.
        let source = app.world().resource::<SprawlSource>().clone();
        match source.make() {
            Ok(made) => {
                app.world_mut().resource_mut::<Streaming>().replace(&made, Dirty::All);
                app.insert_resource(SprawlWorld { world: Some(made), terrain: source.terrain, revision: 1 });
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
    pub hold_assets: bool,
    /// Nothing is made while this is set.
    pub hold_edits: bool,
    task: Option<Task<Result<Made, WorldError>>>,
    wanted: bool,
}

/// The next world, what it stands on, and what of the last one it replaces.
struct Made {
    world: World,
    terrain: TerrainSource,
    dirty: Dirty,
}

/// Several changes while a world is being made lead to one more world after it.
pub(super) fn start_making(
    source: Res<SprawlSource>,
    current: Res<SprawlWorld>,
    streaming: Res<Streaming>,
    mut making: ResMut<Making>,
) {
    making.wanted |= source.is_changed();
    if !making.wanted || making.hold_assets || making.hold_edits || making.task.is_some() {
        return;
    }
    making.wanted = false;
    let source = source.clone();
    let old = current.world.clone().filter(|_| current.terrain == source.terrain);
    let change = old.as_ref().map_or(Difference::All, |old| difference(old, &source));
    if change == Difference::None {
        return;
    }
    let loaded = streaming.settlements();
    making.task = Some(AsyncComputeTaskPool::get().spawn(async move {
        let world = source.make()?;
        let dirty = match (change, old) {
            // Where the new world cannot be compared, nothing is known to be the same.
            (Difference::Some { styles, edits }, Some(old)) => {
                let before = if edits { Some(&old) } else { None };
                same(&world, before, &styles, loaded).map_or(Dirty::All, Dirty::AllBut)
            }
            _ => Dirty::All,
        };
        Ok(Made { world, terrain: source.terrain, dirty })
    }));
}

pub(super) fn finish_making(
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
        Ok(Made { world, terrain, dirty }) => {
            streaming.replace(&world, dirty);
            (current.world, current.terrain) = (Some(world), terrain);
            current.revision += 1;
            let event = WorldChanged { revision: current.revision };
            changed.write(event);
            commands.trigger(event);
        }
        Err(error) => {
            error!("what the world is made from has changed and makes none, the last one stays: {error}");
            let event = WorldRejected { error };
            rejected.write(event.clone());
            commands.trigger(event);
        }
    }
}

/// What differs between a world and what the next one is to be made from.
#[derive(Debug, PartialEq)]
enum Difference {
    None,
    Some {
        /// The styles with these names, or patch sets that they use.
        styles: BTreeSet<String>,
        /// Whether the edits differ.
        edits: bool,
    },
    All,
}

/// What differs, between worlds on the same terrain.
fn difference(old: &World, new: &SprawlSource) -> Difference {
    if old.seed() != new.seed || *old.settings() != new.settings {
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
    let edits = *old.edits() != new.edits;
    if styles.is_empty() && sets.is_empty() && !edits { Difference::None } else { Difference::Some { styles, edits } }
}

/// Names whose value is not the same in both maps.
fn differing<T: PartialEq>(a: &BTreeMap<String, Arc<T>>, b: &BTreeMap<String, Arc<T>>) -> BTreeSet<String> {
    let same = |x: &Arc<T>, y: &Arc<T>| Arc::ptr_eq(x, y) || x == y;
    let names = a.keys().chain(b.keys());
    let differs = |name: &&String| !matches!((a.get(*name), b.get(*name)), (Some(x), Some(y)) if same(x, y));
    names.filter(differs).cloned().collect()
}

/// The loaded chunks that are the same in the next world: those that show no settlement of one of the styles and none that
/// touches such a settlement, since a main street that two towns share has ports from the styles of both; and, where edits
/// differ, those that do not depend on them.
fn same(
    world: &World,
    before: Option<&World>,
    styles: &BTreeSet<String>,
    loaded: Vec<(ChunkCoord, Vec<Arc<Settlement>>)>,
) -> Result<BTreeSet<ChunkCoord>, LayerError> {
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
    let mut out = BTreeSet::new();
    for (coord, settlements) in loaded {
        let mut touched = false;
        for settlement in settlements.iter().filter(|_| !styles.is_empty()) {
            touched = touched || is_touched(settlement)?;
        }
        if !touched {
            out.insert(coord);
        }
    }
    if let Some(before) = before {
        let changed = world.changed_chunks(before, out.iter().copied(), &Cancel::new())?;
        out.retain(|coord| !changed.contains(coord));
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::Style;

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
