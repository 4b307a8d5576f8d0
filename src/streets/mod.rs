//! Layer 6: local streets inside a main cell. Reads town, seams and patch sets; nothing outside the cell, so the padding
//! is that of the town.

mod cell;
mod filler;
mod semantic;

pub use filler::{CellBrief, CellFiller, CellStreets, LocalStreet, MadeBy, PinnedPatch};
pub use semantic::{SemanticPatches, find_place};
