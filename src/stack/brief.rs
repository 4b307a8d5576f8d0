//! What a filler is told about a main cell of a town.

use crate::seam::{self, CellPort, Seam};
use crate::space::Seed;
use crate::streets::CellBrief;
use crate::style::Style;
use crate::town::{MainCell, Town};

/// What lies along the border of a main cell.
pub struct CellEdges {
    widths: Vec<Option<f64>>,
    ports: Vec<CellPort>,
}

impl CellEdges {
    /// The edges of the main cell with index `cell`.
    pub fn of(town: &Town, seams: &[Seam], cell: usize) -> Self {
        Self { widths: border_widths(town, &town.cells[cell]), ports: seam::cell_ports(town, seams, cell) }
    }

    /// The brief of the main cell with index `cell`, whose style is `style`.
    pub fn brief<'a>(&'a self, seed: Seed, town: &'a Town, cell: usize, style: &'a Style) -> CellBrief<'a> {
        let main_cell = &town.cells[cell];
        CellBrief {
            seed,
            id: main_cell.id,
            border: &main_cell.border,
            street_half_width: &self.widths,
            ports: &self.ports,
            field: &town.field,
            field_kind: style.main.field,
            rules: &style.local,
        }
    }
}

/// Half the width of the street along each border edge of a cell.
fn border_widths(town: &Town, cell: &MainCell) -> Vec<Option<f64>> {
    let mut widths = vec![None; cell.border.len()];
    for side in &cell.sides {
        let width = side.main.map(|m| town.mains[m].street.class.half_width());
        for edge in side.first..side.first + side.count {
            widths[edge % cell.border.len()] = width;
        }
    }
    widths
}
