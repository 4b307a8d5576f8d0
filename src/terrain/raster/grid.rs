//! Rasters: values on a rectangular grid over a part of the plan.

use super::band::Band;
use super::holes::{Holes, HolesError};
use crate::layer::RangeError;
use crate::space::{Bounds, Geographic};
use glam::DVec2;

/// Greatest number of cells of a raster: 64 Mi.
pub const MOST_CELLS: usize = 64 << 20;
/// Least width of a cell of a raster in plan metres.
const LEAST_STEP: f64 = 0.1;

/// Row and column, from 1, of the cell at an index in a file of so many columns.
pub(super) fn cell_name(index: usize, columns: usize) -> String {
    format!("row {}, column {}", index / columns + 1, index % columns + 1)
}

/// Values at the centres of the cells of a grid, and the position of the grid: in plan metres, or in degrees until it is
/// [projected](Self::projected). Values are stored in 32 bits; at the height of the highest peaks that is half a millimetre.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// South-west corner of the south-west cell.
    pub(super) corner: DVec2,
    pub(super) step: DVec2,
    /// Rows from south to north, each from west to east.
    pub(super) values: Vec<f32>,
    /// Number of cells that had no value and were filled.
    pub(super) filled: usize,
    /// Where tiles overlap with different values, if it was joined from tiles that do.
    pub(super) disagreement: Option<Disagreement>,
}

/// Tiles of one raster that overlap with different values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Number of cells with different values.
    pub cells: usize,
    /// Greatest difference between two values of a cell, in units of the values.
    pub most: f32,
}

impl Raster {
    /// A raster of `columns` by `rows` cells (at least 2 by 2, at most 64 Mi cells). Cells are `step` wide and high (0.000,001 to
    /// 1,000,000), and `corner` is the south-west corner (each coordinate within 10,000,000,000 of 0). `values` holds the rows
    /// from south to north, each from west to east.
    ///
    /// # Errors
    ///
    /// Fails if an argument is out of range, or if there is not one value for each cell.
    pub fn new(columns: usize, rows: usize, corner: DVec2, step: DVec2, values: Vec<f32>) -> Result<Self, RangeError> {
        let cells = count(columns, rows)?;
        check_place(corner, step)?;
        if values.len() != cells {
            return Err(RangeError {
                field: "values".into(),
                value: format!("{} values", values.len()),
                allowed: format!("{cells}, one for each cell"),
            });
        }
        Ok(Self { columns, rows, corner, step, values, filled: 0, disagreement: None })
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Width and height of a cell.
    pub fn step(&self) -> DVec2 {
        self.step
    }

    /// The box of all cells: in metres, or in degrees (longitude, latitude) until the raster is projected.
    pub fn bounds(&self) -> Bounds {
        let size = self.step * DVec2::new(self.columns as f64, self.rows as f64);
        Bounds::new(self.corner, self.corner + size)
    }

    /// The value of the cell at a column from the west and a row from the south, both counted from 0.
    pub fn value(&self, column: usize, row: usize) -> Option<f32> {
        let inside = column < self.columns && row < self.rows;
        inside.then(|| self.values[row * self.columns + column])
    }

    /// Number of cells that had no value in the file, and were filled as [`Holes`](super::Holes) say.
    pub fn filled(&self) -> usize {
        self.filled
    }

    /// Where tiles that were [joined](Self::join) overlap with different values.
    pub fn disagreement(&self) -> Option<Disagreement> {
        self.disagreement
    }

    /// The raster of rows from north to south, as files have them, once its cells without a value are filled.
    pub(super) fn turned_north(self, band: Band, holes: Holes) -> Result<Self, HolesError> {
        let Self { columns, rows, mut values, .. } = self;
        let filled = holes.fill(&mut values, columns, band)?;
        let (mut south, mut north) = (0, rows - 1);
        while south < north {
            let (low, high) = values.split_at_mut(north * columns);
            low[south * columns..(south + 1) * columns].swap_with_slice(&mut high[..columns]);
            (south, north) = (south + 1, north - 1);
        }
        Ok(Self { values, filled, ..self })
    }

    /// Centre of a cell, where its value applies.
    pub fn middle(&self, column: usize, row: usize) -> DVec2 {
        self.corner + self.step * DVec2::new(column as f64 + 0.5, row as f64 + 0.5)
    }

    /// The projection around the centre of a raster in degrees (longitude and latitude).
    ///
    /// # Errors
    ///
    /// Fails if the raster does not lie on the globe, or if its centre lies within 5 degrees of a pole.
    pub fn geographic(&self) -> Result<Geographic, RangeError> {
        let b = self.bounds();
        let allowed = "longitude -180 to 360, latitude -90 to 90, and a middle between the latitudes -85 and 85";
        let on_globe = Bounds::new(DVec2::new(-180.0, -90.0), DVec2::new(360.0, 90.0)).grown(self.step.max_element());
        Geographic::around(b.centre()).filter(|_| on_globe.encloses(b)).ok_or_else(|| RangeError {
            field: "box of the raster in degrees".into(),
            value: format!("{},{} to {},{}", b.min.x, b.min.y, b.max.x, b.max.y),
            allowed: allowed.into(),
        })
    }

    /// The raster in plan metres, if it is in degrees. Its cells become as wide and as high as they are at the centre of the
    /// projection, so they are not square.
    pub fn projected(self, geographic: &Geographic) -> Self {
        let size = self.bounds().size();
        // From the centre, so that a raster that begins beyond the date line does not wrap around.
        let middle = geographic.to_plan(self.bounds().centre());
        let scale = geographic.metres_per_degree();
        Self { corner: middle - size * scale / 2.0, step: self.step * scale, ..self }
    }

    /// Fails if the band does not allow a value, or if cells are too small to be in metres.
    pub(super) fn check(&self, band: Band) -> Result<(), RangeError> {
        self.values.iter().try_for_each(|v| band.check(f64::from(*v)))?;
        RangeError::check("edge of a cell", self.step.min_element(), LEAST_STEP, 1e6).map_err(|e| RangeError {
            allowed: format!("{} m; a raster in degrees must be projected first", e.allowed),
            ..e
        })
    }
}

/// Number of cells of a raster, if that many are allowed.
pub(super) fn count(columns: usize, rows: usize) -> Result<usize, RangeError> {
    let cells = columns.saturating_mul(rows);
    if columns >= 2 && rows >= 2 && cells <= MOST_CELLS {
        return Ok(cells);
    }
    Err(RangeError {
        field: "size of the raster".into(),
        value: format!("{columns} x {rows} cells"),
        allowed: format!("at least 2 x 2 cells, and at most {MOST_CELLS} in all"),
    })
}

/// Checks the corner and the step of a raster.
pub(super) fn check_place(corner: DVec2, step: DVec2) -> Result<(), RangeError> {
    for (name, value) in [("x of the corner", corner.x), ("y of the corner", corner.y)] {
        RangeError::check(name, value, -1e10, 1e10)?;
    }
    for (name, value) in [("width of a cell", step.x), ("height of a cell", step.y)] {
        RangeError::check(name, value, 1e-6, 1e6)?;
    }
    Ok(())
}
