//! The look-up table of tiles: windows of maps, turned by quarter turns, indexed by how many streets cross their sides (Bustard and
//! de Valmency 2015, section 3).

use super::side::{Crossing, Side};
use super::window::{Window, windows};
use crate::patch::Patch;
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Greatest number of streets that cross a side of a tile, less one; tiles with more are left out.
const COUNTS: usize = 16;
/// The place in the index of tiles with any number of streets.
const ANY: usize = COUNTS;

/// A window of a map, turned.
#[derive(Clone, Copy, Debug)]
pub struct Tile {
    /// Index into [`TileTable::patches`].
    pub patch: u32,
    /// Number of quarter turns, counter-clockwise.
    pub turns: u8,
    /// Where the crossings of each side begin among all crossings, and where those of the last end.
    crossings: [u32; 5],
}

/// The tiles that streets may be made of.
#[derive(Debug)]
pub struct TileTable {
    /// The windows, all of one size.
    pub patches: Vec<Arc<Patch>>,
    /// Their names.
    pub names: Vec<Arc<str>>,
    /// The streets of each window.
    windows: Vec<Window>,
    /// Edge of a tile in metres.
    pub size: f64,
    tiles: Vec<Tile>,
    crossings: Vec<Crossing>,
    /// Tiles by the numbers of streets that cross their west and south sides, either of which may be any.
    by_counts: Vec<Vec<u32>>,
}

/// The place in the index of tiles whose west and south sides are crossed by so many streets.
fn drawer(west: usize, south: usize) -> usize {
    west * (COUNTS + 1) + south
}

impl TileTable {
    /// The table of the windows among some patches, each as it is and, if `turned`, by every number of quarter turns. Windows of
    /// another size than most are left out.
    pub fn new<'a>(patches: impl IntoIterator<Item = (&'a Arc<Patch>, Arc<str>)>, turned: bool) -> Self {
        let all: Vec<(f64, &Arc<Patch>, Arc<str>)> =
            patches.into_iter().filter_map(|(patch, name)| Some((patch.window.as_ref()?.size, patch, name))).collect();
        let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
        all.iter().for_each(|(size, ..)| *counts.entry(size.to_bits()).or_default() += 1);
        let size = counts.into_iter().max_by_key(|(_, count)| *count).map_or(0.0, |(bits, _)| f64::from_bits(bits));
        let usual = all.into_iter().filter(|window| window.0 == size);
        let (patches, names): (Vec<_>, Vec<_>) = usual.map(|(_, patch, name)| (patch.clone(), name)).unzip();
        let windows = windows(&patches);
        let mut table = Self {
            by_counts: vec![Vec::new(); (COUNTS + 1) * (COUNTS + 1)],
            tiles: Vec::new(),
            crossings: Vec::new(),
            patches,
            names,
            windows,
            size,
        };
        let turns = if turned { 4 } else { 1 };
        (0..table.patches.len() as u32).for_each(|patch| (0..turns).for_each(|turns| table.add(patch, turns)));
        table
    }

    fn add(&mut self, patch: u32, turns: u8) {
        let sides = self.windows[patch as usize].crossings(turns, DVec2::ZERO);
        if sides.iter().any(|side| side.len() >= COUNTS) {
            return;
        }
        let mut tile = Tile { patch, turns, crossings: [self.crossings.len() as u32; 5] };
        for (i, side) in sides.into_iter().enumerate() {
            self.crossings.extend(side);
            tile.crossings[i + 1] = self.crossings.len() as u32;
        }
        let number = self.tiles.len() as u32;
        self.tiles.push(tile);
        let count = |side| self.side(number, side).len();
        let (west, south) = (count(Side::West), count(Side::South));
        for place in [drawer(west, south), drawer(west, ANY), drawer(ANY, south), drawer(ANY, ANY)] {
            self.by_counts[place].push(number);
        }
    }

    /// Whether there is no tile.
    pub fn is_empty(&self) -> bool {
        self.tiles.is_empty()
    }

    /// The tile of a number.
    pub fn tile(&self, number: u32) -> Tile {
        self.tiles[number as usize]
    }

    /// The streets of a tile's window.
    pub fn window(&self, number: u32) -> &Window {
        &self.windows[self.tile(number).patch as usize]
    }

    /// Where streets cross a side of a tile, in order.
    pub fn side(&self, number: u32, side: Side) -> &[Crossing] {
        let ends = self.tiles[number as usize].crossings;
        &self.crossings[ends[side as usize] as usize..ends[side as usize + 1] as usize]
    }

    /// The tiles whose west and south sides are crossed by as many streets as given; `None` is any number.
    pub fn with_counts(&self, west: Option<usize>, south: Option<usize>) -> &[u32] {
        let place = |count: Option<usize>| count.map_or(Some(ANY), |count| (count < COUNTS).then_some(count));
        match (place(west), place(south)) {
            (Some(west), Some(south)) => &self.by_counts[drawer(west, south)],
            _ => &[],
        }
    }

    /// Bytes in memory, about.
    pub fn bytes(&self) -> usize {
        let windows: usize = self.windows.iter().map(Window::bytes).sum();
        windows + 8 * self.crossings.len() + 40 * self.tiles.len() + 64 * self.patches.len()
    }
}
