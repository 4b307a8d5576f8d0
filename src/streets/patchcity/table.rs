//! The look-up table of tiles: windows of maps, turned by quarter turns, indexed by how many streets cross their sides (Bustard and
//! de Valmency 2015, section 3).

use super::figures::Figures;
use super::side::{Crossing, Side};
use super::window::{Window, turned, windows};
use crate::patch::Patch;
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Greatest number of streets that cross a side of a tile, less one; tiles with more are left out.
const COUNTS: usize = 16;
/// The place in the index of tiles with any number of streets.
const ANY: usize = COUNTS;

/// Edge of the squares by which patches are found by their places, in metres.
const SQUARE: f64 = 25.0;

/// Share of dead ends among junctions and dead ends from which on dead ends are usual.
const MANY_DEAD_ENDS: f32 = 0.14;

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

/// A tile and how it is moved over its map, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Number of the tile.
    pub tile: u32,
    /// How far its window is moved.
    pub shift: DVec2,
}

/// The tiles that streets may be made of.
#[derive(Debug)]
pub struct TileTable {
    /// The windows, all of one size.
    pub patches: Vec<Arc<Patch>>,
    /// Their names.
    pub names: Vec<Arc<str>>,
    /// What each window holds, against the others.
    figures: Vec<Figures>,
    /// Length of streets in a tile, in metres: the mean over the land of the maps.
    pub length: f64,
    /// Share of dead ends among junctions and dead ends.
    dead_ends: f32,
    /// The streets of each window.
    windows: Vec<Window>,
    /// Names of the maps that they are from, by the number of `Window::map`.
    pub maps: Vec<u64>,
    /// Edge of a tile in metres.
    pub size: f64,
    tiles: Vec<Tile>,
    crossings: Vec<Crossing>,
    /// Tiles by the numbers of streets that cross their west and south sides, either of which may be any.
    by_counts: Vec<Vec<u32>>,
    /// The number of each patch's tile by its quarter turns, where there is one.
    tile_of: Vec<[Option<u32>; 4]>,
    /// Patches by their map and the square of [`SQUARE`] metres in which they lie there.
    by_place: BTreeMap<(u32, i64, i64), Vec<u32>>,
}

/// The square that a place lies in.
fn square_of(place: DVec2) -> (i64, i64) {
    let square = (place / SQUARE).floor().as_i64vec2();
    (square.x, square.y)
}

/// What windows hold, against each other, the mean length of their streets in metres, and the share of dead ends among their junctions
/// and dead ends.
fn figures(patches: &[Arc<Patch>], windows: &[Window]) -> (Vec<Figures>, f64, f32) {
    let figures = |(patch, window): (&Arc<Patch>, &Window)| {
        let Some(of) = &patch.window else { return Figures::default() };
        Figures::of(&window.cut(0, DVec2::ZERO), &of.buildings, of.size / 2.0)
    };
    let mut out: Vec<Figures> = patches.iter().zip(windows).map(figures).collect();
    let (junctions, ends) = out.iter().map(Figures::ends).fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    let weights = weights(windows);
    let length: f32 = out.iter().zip(&weights).map(|(of, weight)| of.length() * weight).sum();
    Figures::compare(&mut out, &weights);
    let whole = weights.iter().sum::<f32>().max(f32::MIN_POSITIVE);
    (out, f64::from(length / whole), ends / (junctions + ends).max(1.0))
}

/// What windows count for, so that all land of their maps counts the same: land at the border of a map is in few windows.
fn weights(windows: &[Window]) -> Vec<f32> {
    let squares = |window: &Window| {
        let (low, high) = (square_of(window.place - window.half), square_of(window.place + window.half));
        let map = window.map;
        (low.1..high.1).flat_map(move |y| (low.0..high.0).map(move |x| (map, x, y)))
    };
    let mut covered: BTreeMap<(u32, i64, i64), f32> = BTreeMap::new();
    windows.iter().flat_map(squares).for_each(|square| *covered.entry(square).or_default() += 1.0);
    windows.iter().map(|window| squares(window).map(|square| 1.0 / covered[&square]).sum()).collect()
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
        let (windows, maps) = windows(&patches);
        let mut by_place: BTreeMap<(u32, i64, i64), Vec<u32>> = BTreeMap::new();
        for (patch, window) in windows.iter().enumerate() {
            let (x, y) = square_of(window.place);
            by_place.entry((window.map, x, y)).or_default().push(patch as u32);
        }
        let (figures, length, dead_ends) = figures(&patches, &windows);
        let mut table = Self {
            tile_of: vec![[None; 4]; patches.len()],
            by_place,
            by_counts: vec![Vec::new(); (COUNTS + 1) * (COUNTS + 1)],
            tiles: Vec::new(),
            crossings: Vec::new(),
            length,
            dead_ends,
            figures,
            patches,
            names,
            windows,
            maps,
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
        self.tile_of[patch as usize][usize::from(turns)] = Some(number);
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

    /// Whether dead ends are usual in its maps.
    pub fn has_dead_ends(&self) -> bool {
        self.dead_ends > MANY_DEAD_ENDS
    }

    /// What a tile holds, against the others.
    pub fn figures(&self, number: u32) -> Figures {
        self.figures[self.tile(number).patch as usize]
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

    /// The tile that goes on beside another one as the map does, on its side `side`; `None` where the map ends.
    pub fn onward(&self, from: Choice, side: Side) -> Option<Choice> {
        let Tile { turns, .. } = self.tile(from.tile);
        let window = self.window(from.tile);
        let step = side.outward() * self.size + from.shift;
        let place = window.place + turned(step, 4 - turns % 4);
        let (low, high) = (square_of(place - window.margin), square_of(place + window.margin));
        let squares = (low.1..=high.1).flat_map(|y| (low.0..=high.0).map(move |x| (window.map, x, y)));
        let near = squares.filter_map(|square| self.by_place.get(&square)).flatten();
        let choice = |patch: &u32| {
            let other = &self.windows[*patch as usize];
            let shift = step - turned(other.place - window.place, turns);
            let tile = self.tile_of[*patch as usize][usize::from(turns)]?;
            (shift.abs().max_element() <= other.margin).then_some(Choice { tile, shift })
        };
        let choices = near.filter_map(choice);
        choices.min_by(|a, b| a.shift.length_squared().total_cmp(&b.shift.length_squared()))
    }

    /// Bytes in memory, about.
    pub fn bytes(&self) -> usize {
        let windows: usize = self.windows.iter().map(Window::bytes).sum();
        windows + 8 * self.crossings.len() + 40 * self.tiles.len() + 64 * self.patches.len()
    }
}
