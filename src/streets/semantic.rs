//! The default filler.
use crate::layer::{Cancel, LayerError};
use crate::streets::{CellBrief, CellFiller, CellStreets};

/// The default filler: patches chosen by their semantics (Teng 2017).
#[derive(Clone, Copy, Debug, Default)]
pub struct SemanticPatches;

impl CellFiller for SemanticPatches {
    fn fill(&self, _brief: &CellBrief<'_>, _cancel: &Cancel) -> Result<CellStreets, LayerError> {
        todo!()
    }
}
