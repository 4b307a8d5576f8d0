//! Patches extracted from maps: square windows that slide over a map (Bustard and de Valmency 2015, section 3), and semantic
//! pieces, connected pieces of local streets around main streets (Nishida et al. 2016; Teng and Bidarra 2017, section 3.1).
//!
//! `ground` makes one plane graph of a map's streets, without the sharp corners that no street of a town has; `windows` and
//! `pieces` cut drawings out of it, `shape` tells drawings of the same shape and picks the most varied.

mod all;
mod drawing;
mod found;
mod ground;
mod options;
mod pieces;
mod shape;
#[cfg(test)]
mod tests;
mod tidy;
mod windows;

pub use all::{extract, select};
pub use found::{Extracted, MapPatches};
pub use options::{ExtractError, ExtractOptions, NoPatch, PatchKind};
