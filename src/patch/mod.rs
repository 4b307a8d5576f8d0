//! Patches (small example street graphs with tags), patterns, patch sets, and the database that is searched (Teng 2017,
//! section 3).
//!
//! Part of the ground floor: knows no layer but the file errors of [`crate::layer`].

mod database;
mod set;

pub use database::PatchDatabase;
pub use set::{Connectable, Pair, Patch, PatchEdge, PatchSet, Pattern};
