//! Layer 4: a settlement's main streets and main cells, planned whole.
//!
//! Reads terrain, the settlement with its outline and its gates, and the style. Everything lies within the outline, so the
//! padding is the settlement's radius. Streets along shared borders come with the outline, so the plans of both settlements
//! hold the same streets.

mod field;
mod layout;
mod plan;

pub use field::DirectionField;
pub use layout::{CellId, CellSide, CellUse, MainCell, MainStreet, Town};
pub use plan::plan;
