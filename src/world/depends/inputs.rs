//! What differs between the inputs of two worlds, and which loaded chunks stay the same.

use super::TOWN_STEPS;
use crate::layer::{Cancel, LayerError};
use crate::region::{Settlement, SettlementId};
use crate::space::ChunkCoord;
use crate::world::{Settings, World, WorldAssets, WorldSource};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What differs between the inputs of two worlds.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// Nothing.
    None,
    /// Only styles, edits and sizes of caches.
    Some {
        /// Names of the styles that make other towns: the style itself, a patch set that it uses, or the style of its
        /// fringe has changed.
        styles: BTreeSet<String>,
        /// Whether the edits differ.
        edits: bool,
    },
    /// Something that every chunk may depend on.
    All,
}

/// Compares the inputs of two worlds.
pub fn difference(old: &WorldSource, new: &WorldSource) -> Difference {
    // The sizes of caches change how fast a world is made, not the world.
    let settings = Settings { cache: old.settings.cache.clone(), ..new.settings.clone() };
    if (old.seed, &old.settings, &old.terrain) != (new.seed, &settings, &new.terrain) {
        return Difference::All;
    }
    let cache = old.settings.cache != new.settings.cache;
    let (before, assets) = (&old.assets, &new.assets);
    // Settlements choose among the style names that the settings list, so a changed style changes no choice. A style that has
    // come or gone counts as a change of everything: that happens while assets are written, not while a game is played.
    if !before.styles.keys().eq(assets.styles.keys()) {
        return Difference::All;
    }
    let patch_sets = differing(&before.patch_sets, &assets.patch_sets);
    let styles = dependent_styles(assets, differing(&before.styles, &assets.styles), &patch_sets);
    let edits = old.edits != new.edits;
    if styles.is_empty() && patch_sets.is_empty() && !edits && !cache {
        Difference::None
    } else {
        Difference::Some { styles, edits }
    }
}

/// Names of all styles that depend on a changed style or patch set. A style depends on its own patch sets, and on the style and
/// patch sets of its fringe, but not on the fringe of its fringe.
fn dependent_styles(
    assets: &WorldAssets,
    mut changed: BTreeSet<String>,
    patch_sets: &BTreeSet<String>,
) -> BTreeSet<String> {
    let uses_sets = assets.styles.iter().filter(|(_, s)| s.patch_sets.iter().any(|p| patch_sets.contains(p)));
    changed.extend(uses_sets.map(|(name, _)| name.clone()));
    let has_fringe = |name: &&String| {
        let fringe = assets.styles.get(*name).and_then(|s| s.fringe.as_ref());
        fringe.is_some_and(|f| changed.contains(&f.style))
    };
    let fringed: Vec<String> = assets.styles.keys().filter(has_fringe).cloned().collect();
    changed.extend(fringed);
    changed
}

/// Names whose values differ, or that only one of the maps has.
fn differing<T: PartialEq>(a: &BTreeMap<String, Arc<T>>, b: &BTreeMap<String, Arc<T>>) -> BTreeSet<String> {
    let same = |x: &Arc<T>, y: &Arc<T>| Arc::ptr_eq(x, y) || x == y;
    let names = a.keys().chain(b.keys());
    let differs = |name: &&String| !matches!((a.get(*name), b.get(*name)), (Some(x), Some(y)) if same(x, y));
    names.filter(differs).cloned().collect()
}

/// The loaded chunks that are the same in `world`, the next world. Each of `loaded` comes with the settlements that it shows.
///
/// A chunk is left out if it shows a settlement of one of `styles`, or a settlement that depends on such a settlement across
/// borders of towns. With `before`, the world of other edits, a chunk is also left out if it depends on edits that differ.
///
/// # Errors
///
/// As [`World::chunk`], when settlements or roads cannot be made.
pub fn unchanged_chunks(
    world: &World,
    before: Option<&World>,
    styles: &BTreeSet<String>,
    loaded: Vec<(ChunkCoord, Vec<Arc<Settlement>>)>,
) -> Result<BTreeSet<ChunkCoord>, LayerError> {
    let mut known: BTreeMap<SettlementId, bool> = BTreeMap::new();
    let mut is_touched = |settlement: &Arc<Settlement>| -> Result<bool, LayerError> {
        if let Some(known) = known.get(&settlement.id) {
            return Ok(*known);
        }
        let touched = towns_within_steps(world, settlement)?.iter().any(|s| styles.contains(&s.style));
        known.insert(settlement.id, touched);
        Ok(touched)
    };
    let mut unchanged = BTreeSet::new();
    for (coord, settlements) in loaded {
        let mut touched = false;
        for settlement in settlements.iter().filter(|_| !styles.is_empty()) {
            touched = touched || is_touched(settlement)?;
        }
        if !touched {
            unchanged.insert(coord);
        }
    }
    if let Some(before) = before {
        let changed = world.changed_chunks(before, unchanged.iter().copied(), &Cancel::new())?;
        unchanged.retain(|coord| !changed.contains(coord));
    }
    Ok(unchanged)
}

/// A settlement and all settlements that it depends on across borders.
fn towns_within_steps(world: &World, settlement: &Arc<Settlement>) -> Result<Vec<Arc<Settlement>>, LayerError> {
    let mut found = vec![settlement.clone()];
    let mut seen = BTreeSet::from([settlement.id]);
    let mut first = 0;
    for _ in 0..TOWN_STEPS {
        let ring = first..found.len();
        first = ring.end;
        for i in ring {
            let touching = world.settlements().touching(&found[i])?;
            found.extend(touching.into_iter().filter(|s| seen.insert(s.id)));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;
    use crate::style::Style;

    #[test]
    fn values_are_compared_not_pointers() {
        let one = || Arc::new(Style::default());
        let mut other = Style::default();
        other.main.length += 1.0;
        let a = BTreeMap::from([("x".to_owned(), one()), ("y".to_owned(), one())]);
        let b = BTreeMap::from([("x".to_owned(), one()), ("y".to_owned(), Arc::new(other)), ("z".to_owned(), one())]);
        assert!(differing(&a, &a.clone()).is_empty());
        assert_eq!(differing(&a, &b).into_iter().collect::<Vec<_>>(), ["y", "z"]);
    }

    /// The styles that depend on what `change` changes in the bundled assets.
    fn changed_styles(change: impl FnOnce(&mut WorldAssets)) -> Vec<String> {
        let old = WorldSource::new(Seed(1));
        let mut new = old.clone();
        change(&mut new.assets);
        match difference(&old, &new) {
            Difference::Some { styles, edits: false } => styles.into_iter().collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn towns_depend_on_the_style_of_their_fringe() {
        let bundled = WorldAssets::bundled();
        let fringed_by = |fringe: &str| {
            let styles = bundled.styles.iter().filter(|(_, s)| s.fringe.as_ref().is_some_and(|f| f.style == fringe));
            styles.map(|(name, _)| name.clone()).chain([fringe.to_owned()]).collect::<BTreeSet<_>>()
        };
        let suburb = changed_styles(|assets| {
            let mut style = (*assets.styles["suburb"]).clone();
            style.parcels.vacant = 1.0;
            assets.styles.insert("suburb".into(), Arc::new(style));
        });
        assert!(suburb.iter().any(|s| s == "european"), "{suburb:?}");
        assert_eq!(suburb.into_iter().collect::<BTreeSet<_>>(), fringed_by("suburb"));
        let patches = changed_styles(|assets| {
            let mut set = (*assets.patch_sets["suburb"]).clone();
            set.patches.truncate(1);
            assets.patch_sets.insert("suburb".into(), Arc::new(set));
        });
        assert!(patches.iter().any(|s| s == "european"), "{patches:?}");
    }

    #[test]
    fn sizes_of_caches_change_no_style() {
        let old = WorldSource::new(Seed(1));
        let mut new = old.clone();
        assert_eq!(difference(&old, &new), Difference::None);
        new.settings.cache.chunk_mib *= 2.0;
        assert_eq!(difference(&old, &new), Difference::Some { styles: BTreeSet::new(), edits: false });
        new.settings.chunk_size *= 2;
        assert_eq!(difference(&old, &new), Difference::All);
    }
}
