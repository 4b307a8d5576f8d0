//! The default filler: patches chosen by their semantics (Teng 2017, section 3), with parametric growth as fall-back and
//! a repair pass.

mod bend;
mod breadth_first;
mod choice;
mod coarse;
mod depth_first;
mod fill;
mod find_place;
mod panorama;
mod pattern;
mod pinned;
mod placement;
mod placer;
#[cfg(test)]
mod sample;
mod start;
#[cfg(test)]
mod tests;

pub use fill::SemanticPatches;
pub use find_place::find_place;
