//! Several tiles joined to one raster.

use super::band::Band;
use super::grid::{Disagreement, Raster, count};
use super::holes::Holes;
use crate::layer::RangeError;
use crate::space::Bounds;
use glam::DVec2;

/// How far cells of tiles may lie off each other, as a share of a cell.
const OFF: f64 = 0.05;

/// Why tiles cannot be joined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JoinError {
    /// There is no tile.
    #[error("there is no tile to join")]
    Empty,
    /// A tile's cells are not those of the first tile.
    #[error("its cells are {step} wide and high, those of the first tile {first}", step = show(*.step), first = show(*.first))]
    Step {
        /// Index of the tile.
        tile: usize,
        /// Width and height of its cells.
        step: DVec2,
        /// Width and height of the cells of the first tile.
        first: DVec2,
    },
    /// A tile's cells lie between those of the first tile.
    #[error("its cells lie {off} of a cell off those of the first tile", off = show(*.off))]
    Off {
        /// Index of the tile.
        tile: usize,
        /// How far, as shares of a cell east and north.
        off: DVec2,
    },
    /// The box around all tiles has too many cells.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Cells have no value in any tile, and it is not said how to fill them.
    #[error("{count} of {cells} cells have no {name} in any tile, the first near {at}; fill them, or say how to fill them (`--fill`)",
        name = .band.name(), at = show(*.at))]
    Holes {
        /// How many.
        count: usize,
        /// Number of all cells.
        cells: usize,
        /// What they lack.
        band: Band,
        /// Middle of the first of them.
        at: DVec2,
    },
    /// No cell has a value, or that for cells without one is out of range.
    #[error("{0}")]
    Fill(String),
}

fn show(p: DVec2) -> String {
    format!("{},{}", p.x, p.y)
}

impl Raster {
    /// One raster of tiles whose cells are alike and in line. Where tiles overlap, the first that has a value counts, and
    /// [`Raster::disagreement`] says whether others differ. Cells of no tile, and those without a value (see [`Holes::Keep`]), are
    /// filled as `holes` says.
    ///
    /// # Errors
    ///
    /// Names the tile that does not fit, or the cells that no tile has.
    pub fn join(tiles: &[Self], band: Band, holes: Holes) -> Result<Self, JoinError> {
        let first = tiles.first().ok_or(JoinError::Empty)?;
        let bounds = tiles.iter().map(Self::bounds).fold(Bounds::EMPTY, Bounds::union);
        let size = (bounds.size() / first.step).round();
        let (columns, rows) = (size.x as usize, size.y as usize);
        let mut values = vec![f32::NAN; count(columns, rows)?];
        let mut differing = Disagreement { cells: 0, most: 0.0 };
        for (tile, it) in tiles.iter().enumerate() {
            let cells = DVec2::new(it.columns as f64, it.rows as f64);
            if ((it.step - first.step) / first.step * cells).abs().max_element() > OFF {
                return Err(JoinError::Step { tile, step: it.step, first: first.step });
            }
            let place = (it.corner - bounds.min) / first.step;
            let off = place - place.round();
            if off.abs().max_element() > OFF {
                return Err(JoinError::Off { tile, off });
            }
            let (west, south) = (place.x.round() as usize, place.y.round() as usize);
            for row in 0..it.rows.min(rows - south) {
                let to = &mut values[(south + row) * columns + west..(south + row + 1) * columns];
                for (to, from) in to.iter_mut().zip(&it.values[row * it.columns..(row + 1) * it.columns]) {
                    if to.is_nan() {
                        *to = *from;
                    } else if *to != *from && !from.is_nan() {
                        differing.cells += 1;
                        differing.most = differing.most.max((*to - *from).abs());
                    }
                }
            }
        }
        let joined = Self::new(columns, rows, bounds.min, first.step, values)?;
        let first_hole = joined.values.iter().position(|v| v.is_nan());
        if let (Some(hole), Holes::Refuse) = (first_hole, holes) {
            let count = joined.values.iter().filter(|v| v.is_nan()).count();
            let at = joined.middle(hole % columns, hole / columns);
            return Err(JoinError::Holes { count, cells: joined.values.len(), band, at });
        }
        let Self { mut values, .. } = joined;
        let filled = holes.fill(&mut values, columns, band).map_err(|e| JoinError::Fill(e.to_string()))?;
        let disagreement = (differing.cells > 0).then_some(differing);
        Ok(Self { values, filled, disagreement, columns, rows, corner: bounds.min, step: first.step })
    }
}
