//! Planning which tiles are made.

use super::entry::TileEntry;
use super::index::Horizon;
use super::view::{View, priority, views};
use crate::plugin::anchor::AnchorView;
use crate::plugin::streaming::index::ChunkIndex;
use crate::plugin::streaming::job::Stopping;
use std::collections::BTreeMap;

/// Plans the tiles around anchors, none if nothing could draw them. Returns the tasks that are cancelled, since their tiles are no
/// longer wanted.
pub(in crate::plugin::streaming) fn plan(
    horizon: &mut Horizon,
    index: &ChunkIndex,
    anchors: &[AnchorView],
    drawn: bool,
) -> Vec<Stopping> {
    let chunks = index.entries.keys().copied();
    let views = if drawn { views(anchors, index.size, chunks, &horizon.views) } else { BTreeMap::new() };
    let mut stopping = Vec::new();
    horizon.entries.retain(|tile, entry| {
        entry.wanted = views.get(tile) == Some(&View::Whole);
        if !entry.wanted {
            stopping.extend(entry.cancel());
        }
        entry.wanted || entry.pieces.is_some()
    });
    for (tile, _) in views.iter().filter(|(_, view)| **view == View::Whole) {
        let entry = horizon.entries.entry(*tile).or_insert_with(|| TileEntry { wanted: true, ..Default::default() });
        entry.priority = priority(*tile, anchors, index.size);
    }
    horizon.views = views;
    horizon.changed = true;
    stopping
}
