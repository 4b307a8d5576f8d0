//! How the anchors see the land: which tiles are wanted.

use crate::mesh::HorizonTile;
use crate::plugin::anchor::AnchorView;
use crate::space::{Bounds, ChunkCoord};
use std::collections::{BTreeMap, BTreeSet};

/// How a tile is seen. One that is out of sight has no view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum View {
    /// The tile itself is wanted.
    Whole,
    /// Tiles inside it are wanted.
    Split,
}

/// A tile stays in sight, and stays split, up to this many times the distance at which it came, so that nothing changes while an
/// anchor walks to and fro.
const KEPT: f64 = 1.15;

/// The views of all tiles in sight of `anchors`, for chunks of edge `size` metres. The places of `chunks` are split down to level 1.
/// `before` are the views so far.
pub(super) fn views(
    anchors: &[AnchorView],
    size: i64,
    chunks: impl Iterator<Item = ChunkCoord>,
    before: &BTreeMap<HorizonTile, View>,
) -> BTreeMap<HorizonTile, View> {
    let anchors: Vec<AnchorView> = anchors.iter().copied().filter(|a| a.horizon > 0.0).collect();
    let mut out = BTreeMap::new();
    if anchors.is_empty() {
        return out;
    }
    let mut with_chunks = BTreeSet::new();
    for chunk in chunks {
        // What holds a tile that is in the set already is in the set, too.
        let _ = places(chunk).skip(2).all(|tile| with_chunks.insert(tile));
    }
    let look = Look { anchors: &anchors, size, with_chunks, before };
    for anchor in &anchors {
        for tile in HorizonTile::largest_in(Bounds::square(anchor.at, 2.0 * KEPT * anchor.horizon), size) {
            if !out.contains_key(&tile) {
                look.at(tile, &mut out);
            }
        }
    }
    out
}

struct Look<'a> {
    anchors: &'a [AnchorView],
    size: i64,
    with_chunks: BTreeSet<HorizonTile>,
    before: &'a BTreeMap<HorizonTile, View>,
}

impl Look<'_> {
    fn at(&self, tile: HorizonTile, out: &mut BTreeMap<HorizonTile, View>) {
        let before = self.before.get(&tile);
        let seen = if before.is_some() { KEPT } else { 1.0 };
        let split = if before == Some(&View::Split) { KEPT } else { 1.0 } * tile.split_distance(self.size);
        let distances = || self.anchors.iter().map(|a| (tile.distance(a.at, self.size), a.horizon));
        if !distances().any(|(distance, horizon)| distance <= seen * horizon) {
            return;
        }
        let is_near = || distances().any(|(distance, _)| distance < split);
        if tile.level > 1 && (self.with_chunks.contains(&tile) || is_near()) {
            out.insert(tile, View::Split);
            tile.children().into_iter().for_each(|child| self.at(child, out));
        } else {
            out.insert(tile, View::Whole);
        }
    }
}

/// The tiles in which a chunk lies, from level 0.
pub(super) fn places(chunk: ChunkCoord) -> impl Iterator<Item = HorizonTile> {
    let next = |tile: &HorizonTile| (tile.level < HorizonTile::LEVELS).then(|| tile.parent());
    std::iter::successors(Some(HorizonTile::of_chunk(chunk)), next)
}

/// Tiles are made in the order of this number, the lowest first. It is small beside the distances by which chunks are made, since a
/// tile takes little time.
pub(super) fn priority(tile: HorizonTile, anchors: &[AnchorView], size: i64) -> f64 {
    anchors.iter().map(|a| 0.1 * tile.distance(a.at, size)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn anchor(x: f64, y: f64) -> AnchorView {
        AnchorView { horizon: 9_000.0, ..AnchorView::standing(x, y) }
    }

    #[test]
    fn nothing_changes_while_an_anchor_walks_to_and_fro() {
        let mut views_now = views(&[anchor(0.0, 0.0)], 512, std::iter::empty(), &BTreeMap::new());
        for x in [60.0, 0.0, -60.0] {
            views_now = views(&[anchor(x, 40.0)], 512, std::iter::empty(), &views_now);
        }
        let settled = views_now.clone();
        for x in [60.0, 0.0, -60.0, 30.0] {
            views_now = views(&[anchor(x, 40.0)], 512, std::iter::empty(), &views_now);
            assert_eq!(views_now, settled, "at {x}");
        }
        let far = views(&[anchor(5_000.0, 40.0)], 512, std::iter::empty(), &views_now);
        assert_ne!(far, settled);
    }

    #[test]
    fn the_places_of_chunks_are_split_wherever_they_are_in_sight() {
        let chunks = [ChunkCoord::new(11, -12), ChunkCoord::new(400, 400)];
        let views = views(&[anchor(0.0, 0.0)], 512, chunks.into_iter(), &BTreeMap::new());
        let view = |chunk: ChunkCoord| views.get(&HorizonTile::of_chunk(chunk).parent());
        assert_eq!((view(chunks[0]), view(chunks[1])), (Some(&View::Whole), None));
        let none = super::views(&[AnchorView { horizon: 0.0, ..anchor(0.0, 0.0) }], 512, chunks.into_iter(), &views);
        assert!(none.is_empty());
    }
}
