//! Which of the made tiles are shown.

use super::entry::TileEntry;
use super::view::View;
use crate::mesh::HorizonTile;
use std::collections::{BTreeMap, BTreeSet};

/// The tiles to show: no two share ground, and what is covered now stays covered wherever it is still in sight.
pub(super) fn shown(
    views: &BTreeMap<HorizonTile, View>,
    entries: &BTreeMap<HorizonTile, TileEntry>,
) -> BTreeSet<HorizonTile> {
    let mut cut = Cut { views, entries, out: BTreeSet::new() };
    for tile in views.keys().filter(|tile| tile.level == HorizonTile::LEVELS) {
        cut.choose(*tile);
    }
    cut.out
}

struct Cut<'a> {
    views: &'a BTreeMap<HorizonTile, View>,
    entries: &'a BTreeMap<HorizonTile, TileEntry>,
    out: BTreeSet<HorizonTile>,
}

impl Cut<'_> {
    fn choose(&mut self, tile: HorizonTile) {
        match self.views.get(&tile) {
            None => {}
            Some(View::Whole) if self.is_ready(tile) => {
                self.out.insert(tile);
            }
            // Smaller tiles stay until the larger one is made.
            Some(View::Whole) => self.keep(tile),
            Some(View::Split) if self.is_shown(tile) && !self.is_replaced(tile) => {
                self.out.insert(tile);
            }
            Some(View::Split) => tile.children().into_iter().for_each(|child| self.choose(child)),
        }
    }

    /// Keeps what is shown of a tile.
    fn keep(&mut self, tile: HorizonTile) {
        if self.is_shown(tile) {
            self.out.insert(tile);
        } else if tile.level > 1 {
            tile.children().into_iter().for_each(|child| self.keep(child));
        }
    }

    /// Whether everything in sight of a tile is made in the wanted detail.
    fn is_replaced(&self, tile: HorizonTile) -> bool {
        match self.views.get(&tile) {
            None => true,
            Some(View::Whole) => self.is_ready(tile),
            Some(View::Split) => tile.children().into_iter().all(|child| self.is_replaced(child)),
        }
    }

    fn is_ready(&self, tile: HorizonTile) -> bool {
        self.entries.get(&tile).is_some_and(TileEntry::is_ready)
    }

    fn is_shown(&self, tile: HorizonTile) -> bool {
        self.entries.get(&tile).is_some_and(|entry| entry.shown)
    }
}
