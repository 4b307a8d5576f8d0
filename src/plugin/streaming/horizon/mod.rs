//! The land beyond the chunks: which tiles are wanted, and which of those that are made are shown.
//!
//! Tiles are the nodes of quadtrees whose leaves are chunks. Two rules keep the ground whole and let nothing be shown twice:
//!
//! - A tile makes way for smaller ones, or for a larger one, when all that take its place are made.
//! - A tile of level 1 has a piece for each chunk in it, which is hidden while that chunk is loaded. The place of every chunk that is
//!   wanted is split down to level 1, and a finished chunk waits until no larger tile is shown there.

mod apply;
mod cut;
mod entry;
mod index;
mod plan;
mod view;

pub(super) use apply::{apply, remove, show_and_hide};
pub(super) use entry::TileEntry;
pub(in crate::plugin) use index::Horizon;
pub(super) use plan::plan;
