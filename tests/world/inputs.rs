//! Which chunks stay the same when an input of the world changes.

use super::{block, built_up, conurbation, print};
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::space::{ChunkCoord, Seed};
use bevy_sprawl::world::{Difference, World, WorldSource, difference, unchanged_chunks};
use glam::DVec2;
use std::sync::Arc;

#[test]
fn chunks_that_a_changed_style_does_not_reach_are_equal() {
    let (mut kept, mut changed) = (0, 0);
    for (seed, style) in [(61, "grid"), (62, "suburb"), (63, "organic")] {
        let old = WorldSource { settings: conurbation(), ..WorldSource::new(Seed(seed)) };
        let mut new = old.clone();
        let mut edited = (*new.assets.styles[style]).clone();
        // Ports of main streets come to lie elsewhere, also on borders that towns share.
        edited.seam.spacing *= 1.4;
        new.assets.styles.insert(style.to_owned(), Arc::new(edited));
        let Difference::Some { styles, edits: false } = difference(&old, &new) else { panic!("a style differs") };
        let [before, after] = [old, new].map(|source| World::new(source).expect("settings are valid"));
        let middle = built_up(&before, DVec2::new(7e5, -3e6)).0;
        let coords: Vec<ChunkCoord> =
            [-4, 0, 4].iter().flat_map(|x| block(ChunkCoord::new(middle.x + x, middle.y))).collect();
        let chunk = |world: &World, at: ChunkCoord| world.chunk(at, &Cancel::new()).expect("not cancelled");
        let loaded = coords.iter().map(|c| (*c, chunk(&before, *c).settlements.clone())).collect();
        let unchanged = unchanged_chunks(&after, None, &styles, loaded).expect("not cancelled");
        for &at in &coords {
            let same = print(&chunk(&before, at)) == print(&chunk(&after, at));
            assert!(same || !unchanged.contains(&at), "seed {seed}: {style} changes {at:?}");
            changed += usize::from(!same);
        }
        kept += unchanged.len();
    }
    assert!(kept > 0 && changed > 10, "{kept} {changed}");
}
