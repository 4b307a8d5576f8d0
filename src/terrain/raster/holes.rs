//! Cells without a value.

use super::band::Band;
use crate::layer::RangeError;

/// What to do with the cells of a file that have no value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Holes {
    /// Reject the file.
    #[default]
    Refuse,
    /// Leave them without a value (NaN), for [`Raster::join`](super::Raster::join), which fills them from other tiles.
    Keep,
    /// Fill them ring by ring from the rim inwards, each cell with the mean of its neighbours. Suits small gaps.
    FromNeighbours,
    /// Fill them with this value: for example one below the sea level, if the file leaves the sea out.
    Value(f64),
}

/// Why cells without a value cannot be filled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum HolesError {
    #[error("{count} of {cells} cells have no {name}; fill them, or say how to fill them (`--fill`)", name = .band.name())]
    Refused { count: usize, cells: usize, band: Band },
    #[error("no cell of this file has a value: {} is missing everywhere", .0.name())]
    NoValue(Band),
    #[error("the value for cells without a value: {0}")]
    Range(#[from] RangeError),
}

impl Holes {
    /// Fills the cells that are NaN, and gives their number. Rows are of `columns` cells, in any order.
    pub(super) fn fill(self, values: &mut [f32], columns: usize, band: Band) -> Result<usize, HolesError> {
        let (cells, count) = (values.len(), values.iter().filter(|v| v.is_nan()).count());
        match self {
            _ if count == 0 => return Ok(0),
            Self::Keep => return Ok(0),
            Self::Refuse => return Err(HolesError::Refused { count, cells, band }),
            // A mask may be empty: there is no water or wood. Ground without a height is a mistake.
            _ if count == cells && (band == Band::Height || self == Self::FromNeighbours) => {
                return Err(HolesError::NoValue(band));
            }
            Self::FromNeighbours => from_neighbours(values, columns),
            Self::Value(value) => {
                band.check(value)?;
                values.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = value as f32);
            }
        }
        Ok(count)
    }
}

/// Fills the cells that are NaN, ring by ring. Each gets the mean of those of its eight neighbours that have a value before its
/// ring is filled. At least one cell must have a value.
fn from_neighbours(values: &mut [f32], columns: usize) {
    let rows = values.len() / columns;
    let near = |i: usize| {
        let (x, y) = (i % columns, i / columns);
        let xs = x.saturating_sub(1)..=(x + 1).min(columns - 1);
        let ys = y.saturating_sub(1)..=(y + 1).min(rows - 1);
        ys.flat_map(move |y| xs.clone().map(move |x| y * columns + x)).filter(move |n| *n != i)
    };
    let mut queued: Vec<bool> = values.iter().map(|v| !v.is_nan()).collect();
    let mut ring: Vec<usize> = (0..values.len()).filter(|i| !queued[*i] && near(*i).any(|n| queued[n])).collect();
    ring.iter().for_each(|i| queued[*i] = true);
    while !ring.is_empty() {
        let mean = |i: usize| {
            let known = near(i).map(|n| f64::from(values[n])).filter(|v| !v.is_nan());
            let (sum, count) = known.fold((0.0, 0.0), |(s, c), v| (s + v, c + 1.0));
            (sum / count) as f32
        };
        let means: Vec<f32> = ring.iter().map(|i| mean(*i)).collect();
        let mut next = Vec::new();
        for (i, mean) in ring.iter().zip(means) {
            values[*i] = mean;
            for n in near(*i) {
                if !queued[n] {
                    queued[n] = true;
                    next.push(n);
                }
            }
        }
        ring = next;
    }
}
