//! Which tiles stand side by side on a grid (Bustard and de Valmency 2015, section 3).

use super::choose::{Asked, choose, cost_of_side};
use super::figures::Balance;
use super::side::{Crossing, Side};
use super::table::{Choice, TileTable};
use crate::layer::{Cancel, LayerError};
use crate::space::Stream;
use glam::DVec2;
use std::collections::BTreeMap;

/// Distance within which no part of a map is seen twice, as far as there are others, in metres.
const SEEN: f64 = 400.0;
/// Share of a tile's edge by which the places of two tiles in a map must differ along an axis so that they show other parts.
const OTHER_PART: f64 = 0.75;
/// Cost of the sides of a tile above which another is looked for, once all tiles stand: as much as four local streets that are 4 m
/// off.
const POOR: f32 = 4.0 * 16.0 * 36.0;
/// Number of times that others are looked for.
const ROUNDS: usize = 2;

/// A tile that stands.
pub struct Placed {
    /// The tile.
    pub choice: Choice,
    /// Where streets cross each side.
    pub sides: [Vec<Crossing>; 4],
}

/// Tiles that stand side by side. Positions are metres from the south-west corner of the grid.
pub struct Mosaic<'t> {
    /// The tiles that it is made of.
    pub table: &'t TileTable,
    columns: usize,
    cells: Vec<Option<Placed>>,
    /// How much the tiles that stand are off those of the table.
    balance: Balance,
}

/// What a grid is filled with.
pub struct Plan<'a> {
    /// Number of columns and rows.
    pub grid: (usize, usize),
    /// Whether a tile stands at a column and row.
    pub wanted: &'a dyn Fn(usize, usize) -> bool,
    /// Cost of a tile at a column and row besides that of its sides.
    pub also: &'a dyn Fn(u32, usize, usize) -> f32,
    /// Cost of tiles of each map around the middle of a tile, if there are several.
    pub maps: &'a dyn Fn(DVec2) -> Vec<f32>,
}

impl<'t> Mosaic<'t> {
    /// Fills a grid of tiles from the south-west to the north-east; then looks for others where streets do not go on well.
    ///
    /// # Errors
    ///
    /// Only if the work is cancelled.
    pub fn fill(table: &'t TileTable, plan: &Plan<'_>, rng: &mut Stream, cancel: &Cancel) -> Result<Self, LayerError> {
        let (columns, rows) = plan.grid;
        let cells = (0..columns * rows).map(|_| None).collect();
        let mut mosaic = Self { table, columns, cells, balance: Balance::default() };
        for round in 0..=ROUNDS {
            for row in 0..rows {
                cancel.check()?;
                for column in (0..columns).filter(|column| (plan.wanted)(*column, row)) {
                    let maps = (plan.maps)(mosaic.middle(column, row));
                    let also = |tile: u32| {
                        let map = table.window(tile).map as usize;
                        (plan.also)(tile, column, row) + maps.get(map).copied().unwrap_or(0.0)
                    };
                    let cost = || mosaic.at(column, row).map(|own| mosaic.cost(column, row) + also(own.choice.tile));
                    if round == 0 || cost().is_some_and(|cost| cost > POOR) {
                        mosaic.place(column, row, &also, rng);
                    }
                }
            }
        }
        Ok(mosaic)
    }

    /// The tile at a column and row.
    pub fn at(&self, column: usize, row: usize) -> Option<&Placed> {
        if column >= self.columns {
            return None;
        }
        self.cells.get(row * self.columns + column)?.as_ref()
    }

    /// The place in the grid beside another.
    pub fn beside(&self, column: usize, row: usize, side: Side) -> Option<(usize, usize)> {
        match side {
            Side::West => Some((column.checked_sub(1)?, row)),
            Side::East => Some((column + 1, row)).filter(|place| place.0 < self.columns),
            Side::South => Some((column, row.checked_sub(1)?)),
            Side::North => Some((column, row + 1)),
        }
    }

    /// The tile that stands beside a place.
    fn neighbour(&self, column: usize, row: usize, side: Side) -> Option<&Placed> {
        let (column, row) = self.beside(column, row, side)?;
        self.at(column, row)
    }

    /// Cost of the sides of the tile at a place.
    fn cost(&self, column: usize, row: usize) -> f32 {
        let Some(own) = self.at(column, row) else { return 0.0 };
        let cost = |side: Side| {
            let other = self.neighbour(column, row, side)?;
            Some(cost_of_side(&other.sides[side.opposite() as usize], &own.sides[side as usize]))
        };
        Side::ALL.into_iter().filter_map(cost).sum()
    }

    /// Places the tile that fits best; one that stands is left if none fits better.
    fn place(&mut self, column: usize, row: usize, also: &dyn Fn(u32) -> f32, rng: &mut Stream) {
        let beside = Side::ALL.map(|side| self.neighbour(column, row, side));
        let fixed = |side: Side| Some(beside[side as usize]?.sides[side.opposite() as usize].as_slice());
        let repeats = |tile: u32| self.repeats(tile, column, row);
        let onward: Vec<Choice> = Side::ALL
            .into_iter()
            .filter_map(|side| self.table.onward(beside[side as usize]?.choice, side.opposite()))
            .collect();
        let balance = self.balance;
        let also = &|tile: u32| also(tile) + balance.cost(self.table.figures(tile));
        let asked = Asked { sides: Side::ALL.map(fixed), onward: &onward, also, repeats: &repeats };
        let Some((cost, choice)) = choose(self.table, &asked, rng) else { return };
        let is_better = self
            .at(column, row)
            .is_none_or(|placed| placed.choice != choice && cost < self.cost(column, row) + also(placed.choice.tile));
        if is_better {
            let sides = self.table.window(choice.tile).crossings(self.table.tile(choice.tile).turns, choice.shift);
            let before = self.at(column, row).map(|placed| self.table.figures(placed.choice.tile));
            self.balance.count(self.table.figures(choice.tile), before);
            self.cells[row * self.columns + column] = Some(Placed { choice, sides });
        }
    }

    /// How a tile would be seen twice at a place: 2 as a whole, 1 in part, 0 not at all.
    fn repeats(&self, tile: u32, column: usize, row: usize) -> u8 {
        let size = self.table.size;
        let reach = (SEEN / size).ceil() as usize;
        let window = self.table.window(tile);
        let patch = self.table.tile(tile).patch;
        let mut found = 0;
        for r in row.saturating_sub(reach)..=row + reach {
            for c in column.saturating_sub(reach)..=column + reach {
                let off = DVec2::new(c as f64 - column as f64, r as f64 - row as f64) * size;
                let is_near = off != DVec2::ZERO && off.length() < SEEN;
                let Some(placed) = self.at(c, r).filter(|_| is_near) else { continue };
                if self.table.tile(placed.choice.tile).patch == patch {
                    return 2;
                }
                let other = self.table.window(placed.choice.tile);
                let apart = (window.place - other.place).abs();
                if window.map == other.map && apart.max_element() < OTHER_PART * size {
                    found = 1;
                }
            }
        }
        found
    }

    /// Number of tiles for which the same patch stands within 400 m.
    pub fn repeated(&self) -> usize {
        let tiles: Vec<(u32, DVec2)> =
            self.tiles().map(|(choice, at)| (self.table.tile(choice.tile).patch, at)).collect();
        let mut places: BTreeMap<u32, Vec<DVec2>> = BTreeMap::new();
        tiles.iter().for_each(|(patch, at)| places.entry(*patch).or_default().push(*at));
        let near = |a: DVec2, b: DVec2| a != b && a.distance(b) < SEEN;
        tiles.iter().filter(|(patch, at)| places[patch].iter().any(|other| near(*at, *other))).count()
    }

    /// The tiles that stand, with their middles.
    pub fn tiles(&self) -> impl Iterator<Item = (Choice, DVec2)> + '_ {
        self.places().map(|((column, row), placed)| (placed.choice, self.middle(column, row)))
    }

    /// The columns and rows at which tiles stand, row by row.
    pub fn places(&self) -> impl Iterator<Item = ((usize, usize), &Placed)> + '_ {
        let placed = self.cells.iter().enumerate().filter_map(|(i, cell)| Some((i, cell.as_ref()?)));
        placed.map(|(i, placed)| ((i % self.columns, i / self.columns), placed))
    }

    /// The middle of the tile at a column and row.
    pub fn middle(&self, column: usize, row: usize) -> DVec2 {
        DVec2::new(column as f64 + 0.5, row as f64 + 0.5) * self.table.size
    }
}
