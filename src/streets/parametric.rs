//! Parametric growth alone (Teng 2017, Fig. 3): from the stub of every port streets grow along the direction field, meet,
//! and are mended. It lays no pieces and needs no assets.

use super::cell::{Draft, finish, grow_from_stubs, lay_stubs, make_fair, propagate, repair};
use super::filler::{CellBrief, CellFiller, CellStreets, Filler, LeftOut, TownToFill};
use crate::layer::{Cancel, LayerError, Weigh};
use std::sync::Arc;

/// The name by which styles call this filler.
pub const NAME: &str = "Parametric";

/// Parametric growth alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parametric {
    /// Number of pieces that the user pinned in the cell; none of them can stand.
    pinned: usize,
}

impl Filler for Parametric {
    fn prepare(&self, town: &TownToFill<'_>) -> Result<Vec<Arc<dyn CellFiller>>, LayerError> {
        let cells = town.cells.iter().map(|cell| Arc::new(Self { pinned: cell.pinned.len() }) as Arc<dyn CellFiller>);
        Ok(cells.collect())
    }

    fn has_piece(&self, _: &str) -> bool {
        false
    }
}

impl CellFiller for Parametric {
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError> {
        let mut draft = Draft::new(brief);
        lay_stubs(&mut draft);
        grow_from_stubs(&mut draft);
        cancel.check()?;
        propagate(&mut draft, cancel, |_, _, _, _| false)?;
        repair(&mut draft, &[], cancel)?;
        make_fair(&mut draft);
        let left_out = (0..self.pinned).map(|piece| LeftOut { piece, reason: "cannot stand where streets only grow" });
        Ok(CellStreets { left_out: left_out.collect(), ..finish(&draft, NAME, &[]) })
    }
}

impl Weigh for Parametric {
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
