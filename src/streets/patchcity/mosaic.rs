//! Tiles side by side on a grid, their streets joined (Bustard and de Valmency 2015, section 3).

use super::choose::{ALONE, Asked, choose};
use super::cost::pairs;
use super::side::{Crossing, Side};
use super::table::TileTable;
use crate::layer::{Cancel, LayerError};
use crate::network::{PlanarGraph, StreetClass, VertexIx};
use crate::space::Stream;
use glam::DVec2;
use std::collections::BTreeMap;

/// Distance within which no part of a map is seen twice, as far as there are others, in metres.
const SEEN: f64 = 400.0;
/// Share of a tile's edge by which the places of two tiles in a map must differ along an axis so that they show other parts.
const OTHER_PART: f64 = 0.75;

/// What an edge of a mosaic is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Of {
    /// Class of the street.
    pub class: StreetClass,
    /// The patch that the street is from, as index into [`TileTable::patches`]; `None` for a street that joins others.
    pub patch: Option<u32>,
}

/// A tile that stands.
struct Placed {
    tile: u32,
    /// Where streets cross each side, with their vertices.
    sides: [Vec<(Crossing, VertexIx)>; 4],
}

/// Tiles that stand side by side, and their streets. Positions are metres from the south-west corner of the grid.
pub struct Mosaic<'t> {
    table: &'t TileTable,
    columns: usize,
    cells: Vec<Option<Placed>>,
    /// The streets.
    pub graph: PlanarGraph<Of>,
    /// Vertices at which a street ends at the side of a tile, because none goes on there.
    pub loose: Vec<VertexIx>,
    /// Vertices at which streets of two tiles were joined.
    pub joined: Vec<VertexIx>,
}

impl<'t> Mosaic<'t> {
    /// Fills a grid of tiles from the south-west to the north-east. A tile stands where `wanted` holds for its column and row; `also`
    /// is a cost of a tile at a place besides that of its sides.
    ///
    /// # Errors
    ///
    /// Only if the work is cancelled.
    pub fn fill(
        table: &'t TileTable,
        (columns, rows): (usize, usize),
        wanted: impl Fn(usize, usize) -> bool,
        also: impl Fn(u32, usize, usize) -> f32,
        rng: &mut Stream,
        cancel: &Cancel,
    ) -> Result<Self, LayerError> {
        let cells = (0..columns * rows).map(|_| None).collect();
        let graph = PlanarGraph::without_index();
        let mut mosaic = Self { table, columns, cells, graph, loose: Vec::new(), joined: Vec::new() };
        for row in 0..rows {
            cancel.check()?;
            for column in (0..columns).filter(|column| wanted(*column, row)) {
                mosaic.place(column, row, &|tile| also(tile, column, row), rng);
            }
        }
        mosaic.loose.retain(|v| mosaic.graph.degree(*v) == 1);
        Ok(mosaic)
    }

    /// The tile at a column and row.
    fn at(&self, column: usize, row: usize) -> Option<&Placed> {
        if column >= self.columns {
            return None;
        }
        self.cells.get(row * self.columns + column)?.as_ref()
    }

    /// The place in the grid beside another.
    fn beside(&self, column: usize, row: usize, side: Side) -> Option<(usize, usize)> {
        match side {
            Side::West => Some((column.checked_sub(1)?, row)),
            Side::East => Some((column + 1, row)).filter(|place| place.0 < self.columns),
            Side::South => Some((column, row.checked_sub(1)?)),
            Side::North => Some((column, row + 1)),
        }
    }

    /// Places the tile that fits best.
    fn place(&mut self, column: usize, row: usize, also: &dyn Fn(u32) -> f32, rng: &mut Stream) {
        let beside = Side::ALL.map(|side| self.beside(column, row, side));
        let fixed: [Option<Vec<Crossing>>; 4] = Side::ALL.map(|side| {
            let (column, row) = beside[side as usize]?;
            let placed = self.at(column, row)?;
            Some(placed.sides[side.opposite() as usize].iter().map(|(crossing, _)| *crossing).collect())
        });
        let sides = [0, 1, 2, 3].map(|side| fixed[side].as_deref());
        let repeats = |tile: u32| self.repeats(tile, column, row);
        let Some(choice) = choose(self.table, &Asked { sides, also, repeats: &repeats }, rng) else { return };
        let tile = self.table.tile(choice.tile);
        let cut = self.table.window(choice.tile).cut(tile.turns, choice.shift);
        let size = self.table.size;
        let middle = DVec2::new(column as f64 + 0.5, row as f64 + 0.5) * size;
        let mut vertices: Vec<Option<VertexIx>> = vec![None; cut.points.len()];
        let mut alone: Vec<u32> = Vec::new();
        for side in Side::ALL {
            let Some(fixed) = &fixed[side as usize] else { continue };
            let Some((column, row)) = beside[side as usize] else { continue };
            let own: Vec<Crossing> = cut.sides[side as usize].iter().map(|(crossing, _)| *crossing).collect();
            let there: Vec<VertexIx> = self
                .at(column, row)
                .map_or(Vec::new(), |placed| placed.sides[side.opposite() as usize].iter().map(|(_, v)| *v).collect());
            let together = pairs(fixed, &own, ALONE);
            for &(i, k) in &together {
                let point = cut.sides[side as usize][k].1;
                let v = there[i];
                // Each of both ends moves half of the distance between them (section 3).
                let own = middle + cut.points[point as usize];
                self.graph.move_vertex(v, (self.graph.at(v) + own) / 2.0);
                vertices[point as usize] = Some(v);
                self.joined.push(v);
            }
            let is_alone = |i: &usize| !together.iter().any(|pair| pair.0 == *i);
            self.loose.extend((0..there.len()).filter(is_alone).map(|i| there[i]));
            let is_paired = |k: usize| together.iter().any(|pair| pair.1 == k);
            let own = cut.sides[side as usize].iter().enumerate();
            alone.extend(own.filter(|(k, _)| !is_paired(*k)).map(|(_, (_, point))| *point));
        }
        for (vertex, point) in vertices.iter_mut().zip(&cut.points) {
            vertex.get_or_insert_with(|| self.graph.add_vertex(middle + *point));
        }
        let vertex = |point: u32| vertices[point as usize].unwrap_or_default();
        let of_patch = Some(tile.patch);
        for &(a, b, class) in &cut.edges {
            let (a, b) = (vertex(a), vertex(b));
            if a != b && self.graph.edge_between(a, b).is_none() {
                self.graph.add_edge(a, b, Of { class, patch: of_patch });
            }
        }
        self.loose.extend(alone.iter().map(|point| vertex(*point)));
        let sides = cut.sides.map(|side| side.into_iter().map(|(c, point)| (c, vertex(point))).collect());
        self.cells[row * self.columns + column] = Some(Placed { tile: choice.tile, sides });
    }

    /// How a tile would be seen twice at a place: 2 as a whole, 1 in part, 0 not at all.
    fn repeats(&self, tile: u32, column: usize, row: usize) -> u8 {
        let size = self.table.size;
        let reach = (SEEN / size).ceil() as usize;
        let window = self.table.window(tile);
        let patch = self.table.tile(tile).patch;
        let mut found = 0;
        for r in row.saturating_sub(reach)..=row {
            for c in column.saturating_sub(reach)..=column + reach {
                let off = DVec2::new(c as f64 - column as f64, r as f64 - row as f64) * size;
                let Some(placed) = self.at(c, r).filter(|_| off.length() < SEEN) else { continue };
                if self.table.tile(placed.tile).patch == patch {
                    return 2;
                }
                let other = self.table.window(placed.tile);
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
        let tiles: Vec<(u32, DVec2)> = self.tiles().map(|(tile, at)| (self.table.tile(tile).patch, at)).collect();
        let mut places: BTreeMap<u32, Vec<DVec2>> = BTreeMap::new();
        tiles.iter().for_each(|(patch, at)| places.entry(*patch).or_default().push(*at));
        let near = |a: DVec2, b: DVec2| a != b && a.distance(b) < SEEN;
        tiles.iter().filter(|(patch, at)| places[patch].iter().any(|other| near(*at, *other))).count()
    }

    /// The tiles that stand, with their middles.
    pub fn tiles(&self) -> impl Iterator<Item = (u32, DVec2)> + '_ {
        let middle = |i: usize| DVec2::new((i % self.columns) as f64 + 0.5, (i / self.columns) as f64 + 0.5);
        let placed = self.cells.iter().enumerate().filter_map(|(i, cell)| Some((i, cell.as_ref()?)));
        placed.map(move |(i, placed)| (placed.tile, middle(i) * self.table.size))
    }
}
