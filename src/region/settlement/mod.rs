//! Layer 2, first half: settlements on jittered lattices, one lattice for each size class.
//!
//! Makes the settlements of a lattice cell. Reads the terrain around the cell and the settlements of higher tiers within the
//! distance at which two settlements conflict, which is the padding that `Lattices` declares.
//!
//! Each lattice cell tries a few places and takes the most suitable one. A place that conflicts with a settlement of a
//! higher tier is dropped. When two settlements of one tier conflict, the one with the higher rank (a hash) stays. Both rules
//! look at nearby cells only and never at earlier decisions, so the order of queries changes nothing. The user's pins,
//! moves and bans are applied on top of the finished lattices (`pinned`).

mod change;
pub(super) mod lattice;
mod model;
mod name;
pub(super) mod pinned;
pub(super) mod radii;
pub(super) mod ray;
mod settings;
pub(super) mod spacing;
mod suitability;
mod table;

pub use model::{PerSize, Settlement, SettlementId};
pub use settings::SettlementSettings;
pub use table::{Moved, Populations, SettlementRow, SettlementTable, TableOptions, TableReport};
