//! The default filler: patches chosen by their semantics (Teng 2017, section 3), with parametric growth as fall-back and
//! a repair pass.

mod at_ports;
mod bend;
mod breadth_first;
mod choice;
mod coarse;
mod counts;
mod depth_first;
mod filler;
mod find_place;
mod panorama;
mod pattern;
mod pinned;
mod placement;
mod placer;
mod prepared;
mod start;
#[cfg(test)]
mod tests;
mod unused;

pub use filler::SemanticPatches;
pub use pinned::{PinnedPatch, lay_pinned, pieces_left_out};
pub use placer::Placer;
pub use prepared::PatchFiller;
pub use unused::{Extent, NeverLaid, StyleCells, patch_never_laid, pattern_never_laid};
