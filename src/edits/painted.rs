//! Influences on roads that are painted.

use super::checks::{STRENGTHS, number, place, road_classes};
use crate::network::StreetClass;
use crate::space::Bounds;
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A painted influence: a grid of extra cost per metre of road, for which [`Influence`](super::Influence) says what it does.
/// Between the middles of cells it is interpolated; beyond the outermost it ends.
///
/// A file of edits names a file beside it: an ESRI ASCII grid (`.asc`), whose numbers are the cost, or a grey `.png`, whose
/// greys are costs from `black` to `white`. Cells without a number are not painted. Whoever reads the edits reads that file, too,
/// and [sets](Self::cells) the cells; the command line does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(deny_unknown_fields)]
pub struct InfluenceMap {
    /// Name of the file.
    pub file: String,
    /// South-west corner of a picture.
    #[serde(default)]
    pub corner: Option<DVec2>,
    /// Edge of a picture's pixel in metres: 0.1 to 1,000,000.
    #[serde(default)]
    pub cell: Option<f64>,
    /// Cost of black in a picture: -10 to 100; 0 if not given.
    #[serde(default)]
    pub black: Option<f64>,
    /// Cost of white in a picture: -10 to 100.
    #[serde(default)]
    pub white: Option<f64>,
    /// Classes of roads that it works on: highway, major, minor; none for all.
    #[serde(default)]
    pub classes: Vec<StreetClass>,
    /// The cells that were read.
    #[serde(skip)]
    #[cfg_attr(feature = "bevy", reflect(ignore))]
    pub cells: Option<Arc<Painted>>,
}

/// A grid of extra cost per metre of road: -10 to 100.
#[derive(Clone, Debug, PartialEq)]
pub struct Painted {
    /// Middle of the south-west cell, in plan metres.
    pub first: DVec2,
    /// Width and height of a cell in metres.
    pub step: DVec2,
    /// Number of columns, at least 2.
    pub columns: usize,
    /// Rows from south to north, each from west to east; at least 2.
    pub values: Vec<f32>,
}

impl InfluenceMap {
    pub(super) fn check(&self) -> Result<(), String> {
        if let Some(corner) = self.corner {
            place("corner", corner)?;
        }
        for (field, value, range) in
            [("cell", self.cell, (0.1, 1e6)), ("black", self.black, STRENGTHS), ("white", self.white, STRENGTHS)]
        {
            value.map_or(Ok(()), |v| number(field, v, range))?;
        }
        if let Some(cells) = &self.cells {
            cells.check()?;
        }
        road_classes(&self.classes)
    }
}

impl Painted {
    fn check(&self) -> Result<(), String> {
        let rows = self.values.len().checked_div(self.columns).unwrap_or(0);
        if self.columns < 2 || rows < 2 || self.values.len() != rows * self.columns {
            let (count, columns) = (self.values.len(), self.columns);
            return Err(format!(
                "{count} cells in {columns} columns are no grid; there must be 2 columns and 2 rows or more"
            ));
        }
        if !(self.step.is_finite() && self.step.min_element() > 0.0 && self.first.is_finite()) {
            return Err(format!("cells of {} metres at {} are no grid", self.step, self.first));
        }
        self.values.iter().try_for_each(|v| number("cells", f64::from(*v), STRENGTHS))
    }

    /// The box between the middles of the outermost cells, in plan metres.
    pub fn bounds(&self) -> Bounds {
        let count = DVec2::new(self.columns as f64, (self.values.len() / self.columns) as f64);
        Bounds::new(self.first, self.first + self.step * (count - 1.0))
    }

    /// Extra cost per metre at a plan point.
    pub fn at(&self, p: DVec2) -> f64 {
        if !self.bounds().contains(p) {
            return 0.0;
        }
        let rows = self.values.len() / self.columns;
        let at = (p - self.first) / self.step;
        let low = at.floor().min(DVec2::new((self.columns - 2) as f64, (rows - 2) as f64)).max(DVec2::ZERO);
        let (t, south) = (at - low, low.y as usize * self.columns + low.x as usize);
        let row = |i: usize| f64::from(self.values[i]) * (1.0 - t.x) + f64::from(self.values[i + 1]) * t.x;
        row(south) * (1.0 - t.y) + row(south + self.columns) * t.y
    }

    /// Whether some cell draws roads near.
    pub fn draws(&self) -> bool {
        self.values.iter().any(|v| *v < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_interpolated_and_end_at_the_outermost_cells() {
        let values = vec![0.0, 1.0, 2.0, 4.0, -3.0, 6.0];
        let map = Painted { first: DVec2::new(10.0, 20.0), step: DVec2::new(2.0, 4.0), columns: 3, values };
        let at = |x: f64, y: f64| map.at(DVec2::new(x, y));
        assert_eq!((at(10.0, 20.0), at(14.0, 24.0), at(11.0, 20.0), at(12.0, 22.0)), (0.0, 6.0, 0.5, -1.0));
        assert_eq!((at(9.9, 20.0), at(14.1, 22.0), map.draws()), (0.0, 0.0, true));
    }
}
