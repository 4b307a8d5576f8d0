//! Painted influences from rasters.

use crate::edits::{InfluenceMap, Painted};
use crate::terrain::Raster;
use std::sync::Arc;

impl InfluenceMap {
    /// Sets the cells from a raster of [`Band::Influence`](crate::terrain::Band::Influence) in plan metres.
    pub fn paint(&mut self, raster: &Raster) {
        let (columns, rows) = (raster.columns(), raster.rows());
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| raster.value(column, row).unwrap_or(0.0)));
        let (first, step) = (raster.middle(0, 0), raster.step());
        self.cells = Some(Arc::new(Painted { first, step, columns, values: cells.collect() }));
    }
}
