//! Layer 6: local streets inside a main cell. Reads town, seams, styles and what a filler needs besides, such as patch sets;
//! nothing outside the cell, so the padding is that of the town.
//!
//! # Fillers
//!
//! A style names what fills its cells. A [`Filler`] holds the rules and assets of a world; prepared for a town, it gives a
//! [`CellFiller`] for each cell, which turns a [`CellBrief`] into [`CellStreets`]. The brief knows only of the cell:
//! whatever else a filler needs (patches, weights, counts over a town, pinned pieces) lives with the filler.
//!
//! To add a filler: name it in [`style::Filler`](crate::style::Filler) and list it in
//! [`style::Filler::ALL`](crate::style::Filler::ALL); write a module here that implements [`Filler`] and [`CellFiller`] with
//! the tools of `cell` (`parametric` is the smallest example); map the name to it in `fillers`. The tests in `contract` run
//! over every filler of the list. The streets that it lays carry its name and the names of its pieces ([`MadeBy`]).

mod cell;
#[cfg(test)]
mod contract;
mod filler;
mod fillers;
mod parametric;
mod patchcity;
mod semantic;

pub use filler::{
    Cause, CellBrief, CellFiller, CellStreets, CellToFill, Exception, FilledTown, Filler, LeftOut, LocalStreet, MadeBy,
    PinnedPiece, Rule, ShortCount, StreetOrigin, TownToFill,
};
pub use fillers::Fillers;
pub use parametric::Parametric;
pub use patchcity::{PatchCity, Synthesis, TileTable, synthesize};
pub use semantic::{
    Extent, NeverLaid, PatchFiller, PinnedPatch, SemanticPatches, StyleCells, patch_never_laid, pattern_never_laid,
};
