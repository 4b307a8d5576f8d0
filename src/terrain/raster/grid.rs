//! Rasters: numbers on a rectangular grid over a piece of the plan.

use crate::layer::RangeError;
use crate::space::{Bounds, Geographic};
use glam::DVec2;

/// Cells that a raster may have: 64 Mi.
pub const MOST_CELLS: usize = 64 << 20;
/// Cells of a raster in plan metres are at least this wide.
const LEAST_STEP: f64 = 0.1;

/// What the numbers of a raster mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Band {
    /// Heights in metres: -100,000 to 100,000.
    Height,
    /// Depths of water in metres, 0 on land: 0 to 100,000.
    Depth,
    /// Vegetation densities: 0 (bare) to 1 (dense wood).
    Vegetation,
}

impl Band {
    /// Least and greatest value.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::Height => (-1e5, 1e5),
            Self::Depth => (0.0, 1e5),
            Self::Vegetation => (0.0, 1.0),
        }
    }

    /// What one value is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Height => "height",
            Self::Depth => "water depth",
            Self::Vegetation => "vegetation density",
        }
    }

    /// Fails on a value out of range; NaN is.
    pub(super) fn check(self, value: f64) -> Result<(), RangeError> {
        let (low, high) = self.range();
        RangeError::check(self.name(), value, low, high)
    }
}

/// Numbers at the middles of the cells of a grid, with the place of the grid: in plan metres, or in degrees until it is
/// [projected](Self::projected). Numbers are kept in 32 bits, which is half a millimetre at the height of the highest peaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// South-west corner of the south-west cell.
    pub(super) corner: DVec2,
    pub(super) step: DVec2,
    /// Rows from the south, each from the west.
    pub(super) values: Vec<f32>,
}

impl Raster {
    /// A raster of `columns` by `rows` cells (2 by 2 to 64 Mi cells) that are `step` wide and high (0.000,001 to 1,000,000),
    /// whose south-west corner is `corner` (each coordinate at most 10,000,000,000 away from 0). `values` are the rows from
    /// the south, each from the west.
    pub fn new(columns: usize, rows: usize, corner: DVec2, step: DVec2, values: Vec<f32>) -> Result<Self, RangeError> {
        let cells = count(columns, rows)?;
        check_place(corner, step)?;
        if values.len() != cells {
            return Err(RangeError {
                field: "values".into(),
                value: format!("{} numbers", values.len()),
                allowed: format!("{cells}, one for each cell"),
            });
        }
        Ok(Self { columns, rows, corner, step, values })
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

    /// The box of all cells, whole. In metres, or in degrees (longitude, latitude) until it is projected.
    pub fn bounds(&self) -> Bounds {
        let size = self.step * DVec2::new(self.columns as f64, self.rows as f64);
        Bounds::new(self.corner, self.corner + size)
    }

    /// The number of the cell at a column from the west and a row from the south, counted from 0.
    pub fn value(&self, column: usize, row: usize) -> Option<f32> {
        let inside = column < self.columns && row < self.rows;
        inside.then(|| self.values[row * self.columns + column])
    }

    /// Middle of a cell, where its number holds.
    pub fn middle(&self, column: usize, row: usize) -> DVec2 {
        self.corner + self.step * DVec2::new(column as f64 + 0.5, row as f64 + 0.5)
    }

    /// The projection around the middle of a raster in degrees (longitude and latitude). Fails when it does not lie on the
    /// globe, or within 5 degrees of a pole.
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

    /// A raster in degrees moved to plan metres. Its cells become as wide and as high as they are in the middle of the
    /// projection, so they are no squares.
    pub fn projected(self, geographic: &Geographic) -> Self {
        let size = self.bounds().size();
        // From the middle, so that a raster which begins on the far side of the date line is not wrapped.
        let middle = geographic.to_plan(self.bounds().centre());
        let scale = geographic.metres_per_degree();
        Self { corner: middle - size * scale / 2.0, step: self.step * scale, ..self }
    }

    /// Fails on a number that the band does not allow, and on cells too small to be in metres.
    pub(super) fn check(&self, band: Band) -> Result<(), RangeError> {
        self.values.iter().try_for_each(|v| band.check(f64::from(*v)))?;
        RangeError::check("edge of a cell", self.step.min_element(), LEAST_STEP, 1e6).map_err(|e| RangeError {
            allowed: format!("{} m; a raster in degrees has to be projected", e.allowed),
            ..e
        })
    }
}

/// Number of cells of a raster, if it may have so many.
pub(super) fn count(columns: usize, rows: usize) -> Result<usize, RangeError> {
    let cells = columns.saturating_mul(rows);
    if columns >= 2 && rows >= 2 && cells <= MOST_CELLS {
        return Ok(cells);
    }
    Err(RangeError {
        field: "size of the raster".into(),
        value: format!("{columns} x {rows} cells"),
        allowed: format!("2 x 2 to {MOST_CELLS} cells in all"),
    })
}

/// Checks corner and step of a raster.
pub(super) fn check_place(corner: DVec2, step: DVec2) -> Result<(), RangeError> {
    for (name, value) in [("x of the corner", corner.x), ("y of the corner", corner.y)] {
        RangeError::check(name, value, -1e10, 1e10)?;
    }
    for (name, value) in [("width of a cell", step.x), ("height of a cell", step.y)] {
        RangeError::check(name, value, 1e-6, 1e6)?;
    }
    Ok(())
}
